/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sheet_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

double sheet_stress(double e) {
    return 9 * (1 - exp(-410 * e / 9)) + 24 * (pow(1 - e, -2.6) - 1);
}

double sheet_energy(double e) {
    return 9 * e - 81.0 / 410 * (1 - exp(-410 * e / 9)) + 24 * ((pow(1 - e, -1.6) - 1) / 1.6 - e);
}

sheet sheet_good(double factor) {
    sheet s = {.header = "strain,stress_kPa", .unloading = SHEET_POINTS};
    for (int i = 0; i < SHEET_POINTS; i++) {
        double e = 0.8 * pow((i + 1.0) / SHEET_POINTS, 1.5);
        s.strain[i] = e;
        s.stress[i] = factor * sheet_stress(e);
        int back = 2 * SHEET_POINTS - 1 - i;
        s.strain[back] = e - 1e-4;
        s.stress[back] =
            sheet_stress(e - 1e-4) * (0.05 + 0.95 * pow(sheet_energy(e - 1e-4) / sheet_energy(0.8), 2.5));
    }
    return s;
}

const char *sheet_write(const program_place *place, const char *name, const sheet *s) {
    const char *path = program_path(place, name);
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fprintf(out, "# a test\n%s\n", s->header);
    for (int i = 0; i < SHEET_POINTS + s->unloading; i++)
        fprintf(out, "%.9g,%.9g\n", s->strain[i], s->stress[i]);
    assert_int_equal(fclose(out), 0);
    return path;
}
