/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form `spline`: the gas curve at its medians (with the solid fraction, if it is known) times the
 * exponential of a cubic B-spline d(e) with knots every 0.15 strain. Its coefficients have a level, a growth
 * from one to the next, and second differences; those are the parameters, as exp of them, so that independent
 * priors around 1 are a smoothness prior on the logarithm of the stress (P-spline, Eilers and Marx 1996). The
 * gas curve's modulus is E exp(-d(0)): the initial slope stays E. */
#include "study/fit/form/form.h"
#include "study/fit/form/gas.h"

#include <math.h>

enum { COEFFICIENTS = 9, INTERVALS = COEFFICIENTS - 3, MIDDLE = COEFFICIENTS / 2 };
static const double KNOT_STEP = 0.15; /* strain */

static const sf_form_entry entries[] = {
    {SF_PARAMETER_SPLINE_1, 0.4, true},  {SF_PARAMETER_SPLINE_2, 0.1, true},
    {SF_PARAMETER_SPLINE_3, 0.15, true}, {SF_PARAMETER_SPLINE_4, 0.15, true},
    {SF_PARAMETER_SPLINE_5, 0.15, true}, {SF_PARAMETER_SPLINE_6, 0.15, true},
    {SF_PARAMETER_SPLINE_7, 0.15, true}, {SF_PARAMETER_SPLINE_8, 0.15, true},
    {SF_PARAMETER_SPLINE_9, 0.15, true}, {SF_PARAMETER_S0, 0.7, true},
    {SF_PARAMETER_P0, 0.15, false},      {SF_PARAMETER_B, 1, false},
    {SF_PARAMETER_M, 0.3, false},        {SF_PARAMETER_SOLID_FRACTION, 0.1, false}};

static void start(double *value) {
    sf_gas_curve_start(value, value[SF_PARAMETER_SOLID_FRACTION]);
    for (int k = 0; k < COEFFICIENTS; k++)
        value[SF_PARAMETER_SPLINE_1 + k] = 1;
}

/* Level and growth about the middle coefficient; the bend at coefficient j adds to those on the side away
 * from the middle, so that the level stays. */
static void fill_coefficients(const double *value, double c[COEFFICIENTS]) {
    const double *z = &value[SF_PARAMETER_SPLINE_1];
    for (int k = 0; k < COEFFICIENTS; k++) {
        c[k] = log(z[0]) + (k - MIDDLE) * log(z[1]);
        for (int j = 1; j <= COEFFICIENTS - 2; j++) /* second difference at j: z[j + 1] */
            c[k] += log(z[j + 1]) * (j < MIDDLE ? fmax(0, j - k) : fmax(0, k - j));
    }
}

/* d; constant beyond the last knot. */
static double deviation(const double c[COEFFICIENTS], double strain) {
    double t = fmin(strain / KNOT_STEP, INTERVALS);
    int i = (int)fmin(t, INTERVALS - 1);
    double u = t - i, v = 1 - u;
    return (v * v * v * c[i] + (3 * u * u * u - 6 * u * u + 4) * c[i + 1] +
            (3 * v * v * v - 6 * v * v + 4) * c[i + 2] + u * u * u * c[i + 3]) /
           6;
}

static sf_gas_curve curve_of(const double *value, const double c[COEFFICIENTS]) {
    sf_gas_curve curve = sf_gas_curve_of(value, fmax(0, value[SF_PARAMETER_SOLID_FRACTION]));
    curve.modulus *= exp(-deviation(c, 0));
    return curve;
}

static sf_status check(const double *value, sf_error *err) {
    double c[COEFFICIENTS];
    fill_coefficients(value, c);
    const sf_gas_curve curve = curve_of(value, c);
    return sf_gas_curve_check(&curve, err);
}

static double pole(const double *value) {
    return sf_form_dense_strain(fmax(0, value[SF_PARAMETER_SOLID_FRACTION]));
}

static void stress(const double *value, int count, const double *strain, double *out) {
    double c[COEFFICIENTS];
    fill_coefficients(value, c);
    const sf_gas_curve curve = curve_of(value, c);
    for (int k = 0; k < count; k++)
        out[k] = exp(deviation(c, strain[k])) * sf_gas_curve_stress(&curve, strain[k]);
}

const sf_curve_form sf_form_spline = {
    .name = "spline",
    .formula = "the gas curve at its medians times exp(d(e)), d a cubic spline with knots every 0.15",
    .entry = entries,
    .entry_count = sizeof entries / sizeof *entries,
    .start = start,
    .check = check,
    .pole = pole,
    .stress = stress,
};
