/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A physically shaped compression curve of a closed-cell foam, for identification where no curve was
 * measured:
 *
 *     sigma(eps) = s0 (1 - exp(-(E - p0) eps / s0)) + p0 x + B x^m,   x = eps / (1 - eps):
 *
 * yield of the cell walls at s0, isothermal compression of the gas in the cells (Mills, with the foam's solid
 * fraction neglected), densification. The initial slope is E. */
#ifndef SF_FIT_GAS_CURVE_H
#define SF_FIT_GAS_CURVE_H

#include "core/foam_card.h"

typedef struct sf_gas_curve {
    double modulus;  /* Pa, E > p0 */
    double yield;    /* Pa, s0 > 0 */
    double pressure; /* Pa, p0 */
    double factor;   /* Pa, B */
    double exponent; /* -, m > 1 */
} sf_gas_curve;

/* Nominal stress (Pa) at a compressive strain, 0 <= strain < 1. */
double sf_gas_curve_stress(const sf_gas_curve *curve, double strain);

/* Puts the curve, as a table to a strain of 0.975, in place of every curve of the card. On failure the card
 * is unchanged. */
sf_status sf_gas_curve_tabulate(const sf_gas_curve *curve, sf_foam_card *card, sf_error *err);

#endif
