/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form `plateau`: a plateau that saturates, over a power of the remaining height. */
#include "study/fit/form/form.h"
#include "study/fit/form/gas.h"

#include <math.h>

static const sf_form_entry entries[] = {{SF_PARAMETER_PLATEAU_A, 0.7, true},
                                        {SF_PARAMETER_PLATEAU_N, 0.3, true}};

static void start(double *value) {
    value[SF_PARAMETER_PLATEAU_A] = 0.4 * sf_form_pressure(value[SF_PARAMETER_E]);
    value[SF_PARAMETER_PLATEAU_N] = 2.35;
}

static sf_status check(const double *value, sf_error *err) {
    if (!(value[SF_PARAMETER_PLATEAU_A] > 0))
        return SF_FAIL(err, SF_ERR_NUMERIC, "plateau_A = %g is not above 0", value[SF_PARAMETER_PLATEAU_A]);
    return SF_OK;
}

static double pole(const double *value) {
    (void)value;
    return 1;
}

static void stress(const double *value, int count, const double *strain, double *out) {
    double a = value[SF_PARAMETER_PLATEAU_A], n = value[SF_PARAMETER_PLATEAU_N];
    for (int k = 0; k < count; k++)
        out[k] = -a * expm1(-value[SF_PARAMETER_E] / a * strain[k]) * pow(1 - strain[k], -n);
}

const sf_curve_form sf_form_plateau = {
    .name = "plateau",
    .formula = "A (1 - exp(-(E/A) e)) (1 - e)^-n",
    .entry = entries,
    .entry_count = sizeof entries / sizeof *entries,
    .start = start,
    .check = check,
    .pole = pole,
    .stress = stress,
};
