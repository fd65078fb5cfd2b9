/* SPDX-License-Identifier: GPL-3.0-or-later */
/* In principal axes the normal parts of dF stand alone, and each pair of directions has a quadratic form of
 * its own in its two off-diagonal parts. */
#include "solver/foam_tangent.h"

#include <math.h>

/* Raises a[i], a[j] until a[j] x^2 + a[i] y^2 covers p x^2 + 2 o x y + q y^2, x = dF_ij, y = dF_ji; the
 * larger one first, since little of it then makes the other superfluous. */
static void cover_pair(double *ai, double *aj, double p, double o, double q) {
    if (*ai > *aj) {
        double *other = ai;
        ai = aj;
        aj = other;
        double swap = p;
        p = q;
        q = swap;
    }
    if (*ai >= q && *aj >= p && (*aj - p) * (*ai - q) >= o * o)
        return;
    *aj = fmax(*aj, p + fabs(o));
    if (*aj > p)
        *ai = fmax(*ai, q + o * o / (*aj - p));
}

void sf_foam_tangent_elastic(const sf_foam_principal *law, double maxwell, double a[3]) {
    const double *t = law->stress, *stretch = law->stretch;
    double size = fabs(t[0]) + fabs(t[1]) + fabs(t[2]), half = 0.5 * maxwell;
    for (int i = 0; i < 3; i++) /* |T_i| sum |T_j| covers the rank-one term T T^T of unloading */
        a[i] = law->factor * law->slope[i] + law->softening * fabs(t[i]) * size +
               maxwell * stretch[i] * stretch[i];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double gap = stretch[i] - stretch[j];
        double equal = fabs(gap) > 1e-7 ? (t[i] - t[j]) / gap : fmax(law->slope[i], law->slope[j]);
        double opposite = (t[i] + t[j]) / (stretch[i] + stretch[j]);
        double mean = 0.5 * law->factor * (equal + opposite),
               difference = 0.5 * law->factor * (equal - opposite);
        cover_pair(&a[i], &a[j], mean + half * stretch[i] * stretch[i],
                   difference + half * stretch[i] * stretch[j], mean + half * stretch[j] * stretch[j]);
    }
}

void sf_foam_tangent_viscous(const double stretch[3], double kelvin, double damp, double eta[3]) {
    for (int i = 0; i < 3; i++)
        eta[i] = kelvin * stretch[i] * stretch[i];
    for (int i = 0; i < 3 && kelvin > 0; i++) {
        int j = (i + 1) % 3;
        double half = 0.5 * kelvin;
        cover_pair(&eta[i], &eta[j], half * stretch[i] * stretch[i], half * stretch[i] * stretch[j],
                   half * stretch[j] * stretch[j]);
    }
    for (int i = 0; i < 3; i++) { /* DAMP needs no more than its normal parts */
        double area = stretch[(i + 1) % 3] * stretch[(i + 2) % 3];
        eta[i] += damp * area * area;
    }
}
