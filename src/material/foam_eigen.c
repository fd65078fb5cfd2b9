/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Batched symmetric eigenproblem. Cyclic Jacobi has no special case for repeated roots and converges
 * quadratically; without branches it vectorises over lanes, so that a point costs about as much as a closed
 * form. */
#include "material/foam.h"

#include <math.h>

enum { MAX_SWEEPS = 8 };

/* One rotation in the plane (p, q); r is the third index. The columns of v are given by their first row's
 * pointer: element (row, column) of v is v[3 * row + column]. With d = aqq - app, h = sqrt(d^2 + 4 apq^2) the
 * tangent of the angle is 2 apq / (d +- h), and the eigenvalues move by (h - |d|) / 2. */
static inline void rotate(double *restrict app, double *restrict aqq, double *restrict apq,
                          double *restrict arp, double *restrict arq, double v[9][SF_LANES], int p, int q) {
    double c[SF_LANES], s[SF_LANES];
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++) {
        double d = aqq[l] - app[l], o = 2 * apq[l], oo = o * o;
        double h = sqrt(d * d + oo), u = fabs(d) + h + 1e-150, r = 1 / sqrt(u * u + oo);
        double shift = copysign(0.5 * (h - fabs(d)), d);
        c[l] = u * r;
        s[l] = copysign(1, d) * o * r;
        app[l] -= shift;
        aqq[l] += shift;
        apq[l] = 0;
        double rp = arp[l], rq = arq[l];
        arp[l] = c[l] * rp - s[l] * rq;
        arq[l] = s[l] * rp + c[l] * rq;
    }
    for (int row = 0; row < 3; row++) {
        double *restrict vp = v[3 * row + p], *restrict vq = v[3 * row + q];
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            double a = vp[l], b = vq[l];
            vp[l] = c[l] * a - s[l] * b;
            vq[l] = s[l] * a + c[l] * b;
        }
    }
}

SF_KERNEL void sf_foam_eigen(double a[6][SF_LANES], double v[9][SF_LANES]) {
    for (int k = 0; k < 9; k++)
        for (int l = 0; l < SF_LANES; l++)
            v[k][l] = k % 4 == 0;
    for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
        int left = 0;
#pragma omp simd reduction(| : left)
        for (int l = 0; l < SF_LANES; l++) {
            double trace = a[0][l] + a[1][l] + a[2][l];
            double off = a[3][l] * a[3][l] + a[4][l] * a[4][l] + a[5][l] * a[5][l];
            left |= off > 1e-34 * trace * trace;
        }
        if (!left)
            break;
        rotate(a[0], a[1], a[3], a[5], a[4], v, 0, 1);
        rotate(a[0], a[2], a[5], a[3], a[4], v, 0, 2);
        rotate(a[1], a[2], a[4], a[3], a[5], v, 1, 2);
    }
}
