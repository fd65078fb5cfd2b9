/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Unloading of the foam laws (theory eq. 14 to 16): the factor f = 1 - (1 - HU) (1 - w^SHAPE)^ALPHA on the
 * stress, w = W / (its largest so far), and the energies that follow from its integral over w. With ALPHA
 * other than 1 the integral is a pair of power series, in w^SHAPE and in 1 - w^SHAPE, each for values up to
 * 1/2. */
#pragma once
#include "base/lanes.h"
#include <math.h>

enum { SF_UNLOADING_TERMS = 48 };

/* Below this SHAPE the second series does not converge: for ALPHA other than 1. */
#define SF_UNLOADING_LEAST_SHAPE 0.05
/* Part of the largest W over which the tangent of unloading is a mean (theory, "Hysteresis"). */
#define SF_UNLOADING_BAND 1e-3

typedef struct sf_unloading {
    double hu, shape, alpha; /* - */
    double whole;            /* -, integral of (1 - w^SHAPE)^ALPHA from 0 to 1 */
    double steepest;         /* -, bound on the derivative of f by w */
    double low[SF_UNLOADING_TERMS], high[SF_UNLOADING_TERMS]; /* of the series; ALPHA other than 1 */
} sf_unloading;

void sf_unloading_build(double hu, double shape, double alpha, sf_unloading *out);

/* The factor at w = `ratio`. */
static inline double sf_unloading_factor(double hu, double shape, double alpha, double ratio) {
    double rest = 1 - (shape == 1 ? ratio : pow(ratio, shape));
    return 1 - (1 - hu) * (alpha == 1 ? rest : pow(rest, alpha));
}

/* Integral of (1 - w^SHAPE)^ALPHA from 0 to `ratio`. */
double sf_unloading_integral(const sf_unloading *u, double ratio);

/* At W = energy (J m-3) and the largest so far, `peak`, which it raises: the factor, its derivative by W
 * (m3 J-1; for the time step), the recoverable energy and the energy lost (J m-3). */
void sf_unloading_lanes(const sf_unloading *u, const double energy[SF_LANES], double peak[SF_LANES],
                        double factor[SF_LANES], double softening[SF_LANES], double stored[SF_LANES],
                        double lost[SF_LANES]);
