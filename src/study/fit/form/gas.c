/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form `gas`: cells full of gas, the solid fraction neglected. */
#include "study/fit/form/gas.h"

#include "study/fit/form/form.h"
#include <math.h>

static const double ATMOSPHERE = 101325; /* Pa */
static const double DENSE = 1.4;         /* e_D = 1 - DENSE Phi (Gibson and Ashby) */
static const double MOST_SOLID = 0.6;    /* Phi, with which e_D is 0.16 */
static const double LEAST_PART = 1e-3;   /* of E that the cell walls have at least */

double sf_form_pressure(double modulus) {
    return fmin(ATMOSPHERE, modulus / 2);
}

double sf_form_dense_strain(double solid) {
    return 1 - DENSE * solid;
}

double sf_gas_curve_stress(const sf_gas_curve *curve, double strain) {
    double gas = curve->pressure / (1 - curve->solid),
           slope = fmax(curve->modulus - gas, LEAST_PART * curve->modulus);
    return -curve->yield * expm1(-slope * strain / curve->yield) +
           curve->pressure * strain / (1 - strain - curve->solid) +
           curve->factor * pow(strain / (sf_form_dense_strain(curve->solid) - strain), curve->exponent);
}

void sf_gas_curve_stresses(const sf_gas_curve *curve, int count, const double *strain, double *out) {
    for (int k = 0; k < count; k++)
        out[k] = sf_gas_curve_stress(curve, strain[k]);
}

sf_status sf_gas_curve_check(const sf_gas_curve *c, sf_error *err) {
    if (!(c->solid >= 0 && c->solid < MOST_SOLID))
        return SF_FAIL(err, SF_ERR_NUMERIC, "the solid fraction %g is not between 0 and %g: that is no foam",
                       c->solid, MOST_SOLID);
    if (!(c->pressure / (1 - c->solid) < c->modulus && c->exponent > 1))
        return SF_FAIL(err, SF_ERR_NUMERIC,
                       "p0 = %g Pa is not below E = %g Pa, or m = %g not above 1: no rising curve of initial "
                       "slope E",
                       c->pressure, c->modulus, c->exponent);
    return SF_OK;
}

sf_gas_curve sf_gas_curve_of(const double *value, double solid) {
    return (sf_gas_curve){.modulus = value[SF_PARAMETER_E],
                          .yield = value[SF_PARAMETER_S0],
                          .pressure = value[SF_PARAMETER_P0],
                          .factor = value[SF_PARAMETER_B],
                          .exponent = value[SF_PARAMETER_M],
                          .solid = solid};
}

void sf_gas_curve_start(double *value, double solid) {
    double pressure = sf_form_pressure(value[SF_PARAMETER_E]);
    value[SF_PARAMETER_S0] = 0.02 * value[SF_PARAMETER_E];
    value[SF_PARAMETER_P0] = pressure;
    value[SF_PARAMETER_B] = solid > 0 ? pressure / 5 : pressure / 4;
    value[SF_PARAMETER_M] = solid > 0 ? 2.5 : 3;
}

/* ---- the form ---- */

static const sf_form_entry entries[] = {{SF_PARAMETER_S0, 0.7, true},
                                        {SF_PARAMETER_P0, 0.3, true},
                                        {SF_PARAMETER_B, 1, true},
                                        {SF_PARAMETER_M, 0.3, true}};

static void start(double *value) {
    sf_gas_curve_start(value, 0);
}

static sf_status check(const double *value, sf_error *err) {
    const sf_gas_curve curve = sf_gas_curve_of(value, 0);
    return sf_gas_curve_check(&curve, err);
}

static double pole(const double *value) {
    (void)value;
    return 1;
}

static void stress(const double *value, int count, const double *strain, double *out) {
    const sf_gas_curve curve = sf_gas_curve_of(value, 0);
    sf_gas_curve_stresses(&curve, count, strain, out);
}

const sf_curve_form sf_form_gas = {
    .name = "gas",
    .formula = "s0 (1 - exp(-(E - p0) e/s0)) + p0 x + B x^m with x = e/(1 - e)",
    .entry = entries,
    .entry_count = sizeof entries / sizeof *entries,
    .start = start,
    .check = check,
    .pole = pole,
    .stress = stress,
};
