/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form `avalle` (Avalle, Belingardi and Ibba 2007): a plateau that saturates, and a power of e/(1 - e).
 */
#include "study/fit/form/form.h"
#include "study/fit/form/gas.h"

#include <math.h>

static const sf_form_entry entries[] = {{SF_PARAMETER_AVALLE_A, 0.7, true},
                                        {SF_PARAMETER_AVALLE_M, 0.7, true},
                                        {SF_PARAMETER_AVALLE_B, 1, true},
                                        {SF_PARAMETER_AVALLE_N, 0.3, true}};

/* Starts with a foam like that of the gas curve at its medians. */
static void start(double *value) {
    double size = sf_form_pressure(value[SF_PARAMETER_E]);
    value[SF_PARAMETER_AVALLE_A] = 0.4 * size;
    value[SF_PARAMETER_AVALLE_M] = 1;
    value[SF_PARAMETER_AVALLE_B] = 0.75 * size;
    value[SF_PARAMETER_AVALLE_N] = 2.35;
}

static sf_status check(const double *value, sf_error *err) {
    if (!(value[SF_PARAMETER_AVALLE_N] > 1))
        return SF_FAIL(err, SF_ERR_NUMERIC, "avalle_n = %g is not above 1: the initial slope is not E",
                       value[SF_PARAMETER_AVALLE_N]);
    return SF_OK;
}

static double pole(const double *value) {
    (void)value;
    return 1;
}

static void stress(const double *value, int count, const double *strain, double *out) {
    double a = value[SF_PARAMETER_AVALLE_A], ratio = value[SF_PARAMETER_E] / a,
           m = value[SF_PARAMETER_AVALLE_M], b = value[SF_PARAMETER_AVALLE_B],
           n = value[SF_PARAMETER_AVALLE_N];
    for (int k = 0; k < count; k++) {
        double e = strain[k];
        out[k] = -a * expm1(-ratio * e * pow(1 - e, m)) + b * pow(e / (1 - e), n);
    }
}

const sf_curve_form sf_form_avalle = {
    .name = "avalle",
    .formula = "A (1 - exp(-(E/A) e (1 - e)^m)) + B (e/(1 - e))^n",
    .entry = entries,
    .entry_count = sizeof entries / sizeof *entries,
    .start = start,
    .check = check,
    .pole = pole,
    .stress = stress,
};
