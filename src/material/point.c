/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/point.h"

#include <math.h>
#include <string.h>

void sf_material_point_stretch(double f[9][SF_LANES], double stretch) {
    memset(f, 0, 9 * sizeof *f);
    for (int l = 0; l < SF_LANES; l++) {
        f[0][l] = f[4][l] = 1;
        f[8][l] = stretch;
    }
}

void sf_material_point_drive(const sf_material_law *law, double rate, double step, int count,
                             const double *strain, double *stress) {
    sf_law_batch batch;
    double at = 0, last = 0;
    memset(&batch, 0, sizeof batch);
    sf_material_point_stretch(batch.f, 1);
    for (int i = 0; i < count; i++) {
        int steps = (int)ceil(fabs(strain[i] - at) / step);
        double from = at;
        for (int k = 1; k <= steps; k++) {
            double next = from + (strain[i] - from) * k / steps;
            memcpy(batch.f_old, batch.f, sizeof batch.f);
            sf_material_point_stretch(batch.f, 1 - next);
            law->law->update(law->numbers, fabs(next - at) / rate, &batch);
            at = next;
            last = -batch.p[8][0];
        }
        stress[i] = last;
    }
}
