/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form `rusch` (Rusch 1969): two powers of the strain, for plateau and densification. A power below 1 has
 * an infinite slope at 0; the strain is shifted by e_0, so that the initial slope is E. Two powers are finite
 * at full compression: from rusch_end on, the densification law with its pole continues them. */
#include "material/curve.h"
#include "study/fit/form/form.h"
#include "study/fit/form/gas.h"

#include <math.h>

static const sf_form_entry entries[] = {
    {SF_PARAMETER_RUSCH_A, 0.7, true},    {SF_PARAMETER_RUSCH_M, 0.4, true},
    {SF_PARAMETER_RUSCH_B, 1, true},      {SF_PARAMETER_RUSCH_N, 0.3, true},
    {SF_PARAMETER_RUSCH_END, 0.1, false}, {SF_PARAMETER_SOLID_FRACTION, 0.1, false}};

/* Starts with a foam like that of the gas curve at its medians. */
static void start(double *value) {
    double size = sf_form_pressure(value[SF_PARAMETER_E]);
    value[SF_PARAMETER_RUSCH_A] = 0.6 * size;
    value[SF_PARAMETER_RUSCH_M] = 0.4;
    value[SF_PARAMETER_RUSCH_B] = 32 * size;
    value[SF_PARAMETER_RUSCH_N] = 5.2;
    value[SF_PARAMETER_RUSCH_END] = 0.8;
}

static double pole(const double *value) {
    return sf_form_dense_strain(fmax(0, value[SF_PARAMETER_SOLID_FRACTION]));
}

static sf_status check(const double *value, sf_error *err) {
    double m = value[SF_PARAMETER_RUSCH_M], n = value[SF_PARAMETER_RUSCH_N],
           end = value[SF_PARAMETER_RUSCH_END], limit = pole(value);
    if (!(m > 0 && m < 1 && n > 1))
        return SF_FAIL(err, SF_ERR_NUMERIC,
                       "rusch_m = %g is not between 0 and 1, or rusch_n = %g not above 1: no curve with a "
                       "plateau",
                       m, n);
    if (!(end > 0 && end < limit))
        return SF_FAIL(err, SF_ERR_NUMERIC, "rusch_end = %g is not between 0 and the pole of the curve, %g",
                       end, limit);
    return SF_OK;
}

typedef struct powers {
    double a, m, b, n, shift;
} powers;

/* e_0, where A m e^(m - 1) = E. */
static powers powers_of(const double *value) {
    powers p = {value[SF_PARAMETER_RUSCH_A], value[SF_PARAMETER_RUSCH_M], value[SF_PARAMETER_RUSCH_B],
                value[SF_PARAMETER_RUSCH_N], 0};
    p.shift = pow(p.a * p.m / value[SF_PARAMETER_E], 1 / (1 - p.m));
    return p;
}

static double sum(const powers *p, double strain) {
    return p->a * (pow(strain + p->shift, p->m) - pow(p->shift, p->m)) + p->b * pow(strain, p->n);
}

static double slope(const powers *p, double strain) {
    return p->a * p->m * pow(strain + p->shift, p->m - 1) + p->b * p->n * pow(strain, p->n - 1);
}

static void stress(const double *value, int count, const double *strain, double *out) {
    const powers p = powers_of(value);
    double end = value[SF_PARAMETER_RUSCH_END], limit = pole(value), at_end = sum(&p, end),
           slope_at_end = slope(&p, end), ignored[2];
    const sf_densification beyond =
        sf_densification_join(end, limit, sf_densification_steep_exponent(end, limit, at_end, slope_at_end),
                              at_end, slope_at_end, 0);
    for (int k = 0; k < count; k++)
        if (strain[k] <= end)
            out[k] = sum(&p, strain[k]);
        else
            sf_densification_evaluate(&beyond, strain[k], &out[k], &ignored[0], &ignored[1]);
}

const sf_curve_form sf_form_rusch = {
    .name = "rusch",
    .formula = "A ((e + e0)^m - e0^m) + B e^n with e0 from the initial slope E, to the strain rusch_end; "
               "beyond it A' + B'/(1 - 1.4 Phi - e)^n'",
    .entry = entries,
    .entry_count = sizeof entries / sizeof *entries,
    .start = start,
    .check = check,
    .pole = pole,
    .stress = stress,
};
