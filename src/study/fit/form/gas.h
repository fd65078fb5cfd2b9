/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A physically shaped compression curve of a closed-cell foam:
 *
 *     sigma(e) = s0 (1 - exp(-(E - p0/(1 - Phi)) e/s0)) + p0 e/(1 - e - Phi) + B (e/(e_D - e))^m,
 *
 * yield of the cell walls at s0; isothermal compression of the gas in the cells, which is beside the solid
 * fraction Phi (Gibson and Ashby); densification with its pole at e_D = 1 - 1.4 Phi. The initial slope is E.
 * With Phi = 0 both poles are at 1. */
#ifndef SF_FIT_FORM_GAS_H
#define SF_FIT_FORM_GAS_H

#include "base/error.h"

/* Size of a foam's stresses, for medians: the atmosphere's pressure (Pa), at most half the modulus E (Pa). */
double sf_form_pressure(double modulus);
/* Strain at which a foam of this solid fraction is dense, 1 - 1.4 Phi (Gibson and Ashby). */
double sf_form_dense_strain(double solid);

typedef struct sf_gas_curve {
    double modulus;  /* Pa, E > p0/(1 - Phi) */
    double yield;    /* Pa, s0 > 0 */
    double pressure; /* Pa, p0 */
    double factor;   /* Pa, B >= 0 */
    double exponent; /* -, m > 1 */
    double solid;    /* -, Phi >= 0 */
} sf_gas_curve;

/* Nominal stress (Pa) at a compressive strain, 0 <= strain < e_D = sf_form_dense_strain(Phi). */
double sf_gas_curve_stress(const sf_gas_curve *curve, double strain);
/* The same at `count` strains. */
void sf_gas_curve_stresses(const sf_gas_curve *curve, int count, const double *strain, double *out);

/* SF_ERR_NUMERIC: no rising curve of initial slope E. */
sf_status sf_gas_curve_check(const sf_gas_curve *curve, sf_error *err);

/* The curve of a set of values (parameter.h), with its solid fraction or without. */
sf_gas_curve sf_gas_curve_of(const double *value, double solid);

/* Medians of s0, p0, B and m: s0 = 0.02 E; p0 = 101 kPa, at most E/2; B and m such that a foam with or
 * without solid fraction densifies alike. */
void sf_gas_curve_start(double *value, double solid);

#endif
