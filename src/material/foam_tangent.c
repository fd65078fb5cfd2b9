/* SPDX-License-Identifier: GPL-3.0-or-later */
/* In principal axes the normal parts of dF stand alone, and each pair of directions has a quadratic form of
 * its own in its two off-diagonal parts. */
#include "material/foam_tangent.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Raises ai, aj until aj x^2 + ai y^2 covers p x^2 + 2 o x y + q y^2, x = dF_ij, y = dF_ji; the larger one
 * first, since little of it then makes the other superfluous. */
static inline void cover_pair(double *ai, double *aj, double p, double o, double q) {
    bool turned = *ai > *aj;
    double low = turned ? *aj : *ai, high = turned ? *ai : *aj;
    double under_high = turned ? q : p, under_low = turned ? p : q;
    bool covered =
        (low >= under_low) & (high >= under_high) & ((high - under_high) * (low - under_low) >= o * o);
    double raised = sf_larger(under_high + fabs(o), high), room = raised - under_high;
    double other = room > 0 ? sf_larger(under_low + o * o / room, low) : low;
    high = covered ? high : raised;
    low = covered ? low : other;
    *ai = turned ? high : low;
    *aj = turned ? low : high;
}

SF_KERNEL void sf_foam_tangent_elastic(const sf_foam_principal *law, double maxwell, double a[3][SF_LANES]) {
    double half = 0.5 * maxwell, size[SF_LANES];
    const double *factor = law->factor, *softening = law->softening;
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++)
        size[l] = fabs(law->stress[0][l]) + fabs(law->stress[1][l]) + fabs(law->stress[2][l]);
    for (int i = 0; i < 3; i++) { /* |T_i| sum |T_j| covers the rank-one term T T^T of unloading */
        const double *t = law->stress[i], *slope = law->slope[i], *stretch = law->stretch[i];
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++)
            a[i][l] = factor[l] * slope[l] + softening[l] * fabs(t[l]) * size[l] +
                      maxwell * stretch[l] * stretch[l];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        const double *ti = law->stress[i], *tj = law->stress[j], *xi = law->stretch[i], *xj = law->stretch[j];
        const double *slope_i = law->slope[i], *slope_j = law->slope[j];
        double *restrict ai = a[i], *restrict aj = a[j];
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            double gap = xi[l] - xj[l], secant = (ti[l] - tj[l]) / gap;
            double equal = fabs(gap) > 1e-7 ? secant : sf_larger(slope_i[l], slope_j[l]);
            double opposite = (ti[l] + tj[l]) / (xi[l] + xj[l]);
            double mean = 0.5 * factor[l] * (equal + opposite),
                   difference = 0.5 * factor[l] * (equal - opposite);
            double first = ai[l], second = aj[l];
            cover_pair(&first, &second, mean + half * xi[l] * xi[l], difference + half * xi[l] * xj[l],
                       mean + half * xj[l] * xj[l]);
            ai[l] = first;
            aj[l] = second;
        }
    }
}

/* Kelvin viscosity alone. */
static void kelvin_bounds(double stretch[3][SF_LANES], double kelvin, double eta[3][SF_LANES]) {
    double half = 0.5 * kelvin;
    for (int i = 0; i < 3; i++)
        for (int l = 0; l < SF_LANES; l++)
            eta[i][l] = kelvin * stretch[i][l] * stretch[i][l];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        for (int l = 0; l < SF_LANES; l++) {
            double xi = stretch[i][l], xj = stretch[j][l];
            cover_pair(&eta[i][l], &eta[j][l], half * xi * xi, half * xi * xj, half * xj * xj);
        }
    }
}

SF_KERNEL void sf_foam_tangent_viscous(double stretch[3][SF_LANES], double kelvin,
                                       const double damp[SF_LANES], double eta[3][SF_LANES]) {
    if (kelvin > 0)
        kelvin_bounds(stretch, kelvin, eta);
    else
        memset(eta, 0, 3 * sizeof eta[0]);
    for (int i = 0; i < 3; i++) { /* DAMP needs no more than its normal parts */
        const double *x = stretch[(i + 1) % 3], *y = stretch[(i + 2) % 3];
        double *restrict out = eta[i];
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            double area = x[l] * y[l];
            out[l] += damp[l] * area * area;
        }
    }
}
