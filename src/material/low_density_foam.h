/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/curve.h"
#include "material/foam_point.h"

/* The low-density foam at material points (theory, section "Foam"): uncoupled principal nominal stresses from
 * the compression curve, rate-dependent loading curves; the rest is shared (foam_point.h). Pure functions. */

typedef struct sf_foam {
    sf_foam_options options;
    double modulus; /* Pa, E */
    double cutoff;  /* Pa */
    int64_t curve_count;
    double *curve_rate; /* [curve_count] s-1, owned */
    sf_curve *curve;    /* [curve_count] owned */
} sf_foam;
_Static_assert(offsetof(sf_foam, options) == 0, "a foam's numbers begin with sf_foam_options");

/* The foam's entry in the table of laws (low_density_foam.c). */
extern const sf_law sf_low_density_foam;

/* A material of this card, which it borrows: not for sf_material_free. */
static inline sf_material sf_foam_material(const sf_foam_card *card) {
    return (sf_material){.law = &sf_low_density_foam, .card = (void *)(uintptr_t)card};
}

sf_status sf_foam_build(const sf_foam_card *card, sf_foam *foam, sf_error *err);
void sf_foam_free(sf_foam *foam);

/* Advances the batch over a step of dt (s); dt = 0 evaluates without viscous terms. */
void sf_foam_update(const void *foam, double dt, sf_law_batch *batch);

/* sf_law.uniaxial: the law of a point under uniaxial compression, without DAMP. */
double sf_foam_uniaxial(const void *foam, double dt, double strain, sf_uniaxial *point);

/* Rate overstress sigma(eps, rate) - sigma(eps, slowest curve) in Pa, interpolated over the logarithm of the
 * rate (s-1), with its derivatives by strain and rate. Needs two curves or more. */
double sf_foam_overstress(const sf_foam *foam, double strain, double rate, double *slope, double *rate_slope);
