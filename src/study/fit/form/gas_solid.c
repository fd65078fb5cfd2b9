/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form `gas_solid`: the gas has the room that the solid fraction Phi leaves, and the foam is dense at
 * 1 - 1.4 Phi. Phi is known from the densities of foam and solid; p0 is near the atmosphere's. */
#include "study/fit/form/form.h"
#include "study/fit/form/gas.h"

static const double USUAL_SOLID_FRACTION = 0.05;

static const sf_form_entry entries[] = {{SF_PARAMETER_S0, 0.7, true},
                                        {SF_PARAMETER_P0, 0.15, true},
                                        {SF_PARAMETER_B, 1, true},
                                        {SF_PARAMETER_M, 0.3, true},
                                        {SF_PARAMETER_SOLID_FRACTION, 0.1, false}};

static sf_gas_curve curve_of(const double *value) {
    return sf_gas_curve_of(value, value[SF_PARAMETER_SOLID_FRACTION]);
}

static void start(double *value) {
    if (!(value[SF_PARAMETER_SOLID_FRACTION] > 0))
        value[SF_PARAMETER_SOLID_FRACTION] = USUAL_SOLID_FRACTION;
    sf_gas_curve_start(value, value[SF_PARAMETER_SOLID_FRACTION]);
}

static sf_status check(const double *value, sf_error *err) {
    const sf_gas_curve curve = curve_of(value);
    return sf_gas_curve_check(&curve, err);
}

static double pole(const double *value) {
    return sf_form_dense_strain(value[SF_PARAMETER_SOLID_FRACTION]);
}

static void stress(const double *value, int count, const double *strain, double *out) {
    const sf_gas_curve curve = curve_of(value);
    sf_gas_curve_stresses(&curve, count, strain, out);
}

const sf_curve_form sf_form_gas_solid = {
    .name = "gas_solid",
    .formula = "s0 (1 - exp(-(E - p0/(1 - Phi)) e/s0)) + p0 e/(1 - e - Phi) + B (e/(e_D - e))^m with Phi = "
               "solid_fraction, e_D = 1 - 1.4 Phi",
    .entry = entries,
    .entry_count = sizeof entries / sizeof *entries,
    .start = start,
    .check = check,
    .pole = pole,
    .stress = stress,
};
