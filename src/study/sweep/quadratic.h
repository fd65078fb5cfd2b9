/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A response surface: a quadratic of numbers, with constants for the levels of words, by least squares. */
#ifndef SF_SWEEP_QUADRATIC_H
#define SF_SWEEP_QUADRATIC_H

#include "base/error.h"
#include <stdbool.h>
#include <stdint.h>

enum { SF_QUADRATIC_NUMBERS = 16, SF_QUADRATIC_TERMS = 256 };

typedef struct sf_quadratic {
    int d;       /* numbers */
    int offsets; /* columns of 0 and 1 behind them */
    int terms;   /* 0: no surface, see `problem` */
    double centre[SF_QUADRATIC_NUMBERS],
        half[SF_QUADRATIC_NUMBERS];    /* z = (x - centre) / half is in -1 to 1 */
    bool curved[SF_QUADRATIC_NUMBERS]; /* three values or more: its square is a term */
    double c[SF_QUADRATIC_TERMS];      /* of 1, z_i, z_i^2, z_i z_j (i < j), offsets */
    double rms;                        /* of the residuals, with the degrees of freedom */
    double left_out_rms; /* of the errors at each row by the surface without its site, the rows of one x; NaN:
                            not determined */
    double q2;           /* 1 - that squared over the variance: 1 is perfect */
    char problem[160];   /* why there is none, or its error is not known; "": neither */
} sf_quadratic;

/* x [n][d + offsets], y [n]. `left_out` [n]: the prediction of each row by the surface without the rows of
 * its x; NULL: not asked for. A surface that the rows do not determine is no failure: see `problem`. */
sf_status sf_quadratic_fit(int d, int offsets, int64_t n, const double *x, const double *y,
                           sf_quadratic *surface, double *left_out, sf_error *err);
/* The value at x [d + offsets]. */
double sf_quadratic_at(const sf_quadratic *surface, const double *x);

#endif
