/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mms_field.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* Half waves of w's components along x, y, z. */
static const int wave[3][3] = {{1, 2, 1}, {2, 1, 1}, {1, 1, 1}};

sf_mms_field sf_mms_field_on(double side) {
    return (sf_mms_field){
        .side = side,
        .stretch = {1.15, 1.15, 0.65},
        .amplitude = {0.02 / PI, -0.025 / PI, 0.2 / PI},
    };
}

void sf_mms_disturbance(const sf_mms_field *field, const double x[3], double w[3]) {
    for (int i = 0; i < 3; i++) {
        w[i] = field->amplitude[i] * field->side;
        for (int k = 0; k < 3; k++)
            w[i] *= sin(wave[i][k] * PI * x[k] / field->side);
    }
}

void sf_mms_gradient(const sf_mms_field *field, const double x[3], double f[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double value = field->amplitude[i];
            for (int k = 0; k < 3; k++) {
                double argument = wave[i][k] * PI * x[k] / field->side;
                value *= k == j ? wave[i][k] * PI * cos(argument) : sin(argument);
            }
            f[3 * i + j] = value + (i == j ? field->stretch[i] : 0);
        }
}

void sf_mms_stress(const sf_mms_field *field, const sf_foam *foam, const double x[3], double p[9],
                   double stretch[3]) {
    sf_law_batch batch;
    double f[9];
    memset(&batch, 0, sizeof batch);
    sf_mms_gradient(field, x, f);
    for (int l = 0; l < SF_LANES; l++) {
        for (int k = 0; k < 9; k++)
            batch.f[k][l] = batch.f_old[k][l] = f[k];
        batch.length[l] = 1;
    }
    sf_foam_update(foam, 0, &batch);
    for (int k = 0; k < 9; k++)
        p[k] = batch.p[k][0];
    for (int k = 0; stretch && k < 3; k++)
        stretch[k] = batch.stretch[k][0];
}

void sf_mms_body_force(const sf_mms_field *field, const sf_foam *foam, const double x[3], double b[3]) {
    static const double weight[4] = {1.0 / 12, -8.0 / 12, 8.0 / 12, -1.0 / 12};
    static const int place[4] = {-2, -1, 1, 2};
    const double step = 2e-5 * field->side;
    memset(b, 0, 3 * sizeof *b);
    for (int j = 0; j < 3; j++)
        for (int q = 0; q < 4; q++) {
            double y[3] = {x[0], x[1], x[2]}, p[9];
            y[j] += place[q] * step;
            sf_mms_stress(field, foam, y, p, NULL);
            for (int i = 0; i < 3; i++)
                b[i] -= weight[q] / step * p[3 * i + j];
        }
}
