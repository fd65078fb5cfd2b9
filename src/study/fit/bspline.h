/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far measured stresses scatter, found without the foam law: each branch of each test is smoothed by a
 * spline of its own, whose number of knots generalised cross-validation chooses, and the deviations give the
 * standard deviation sqrt(a^2 + (b stress)^2) by maximum likelihood. So the law cannot hide its own misfit in
 * the scatter. */
#ifndef SF_FIT_SCATTER_H
#define SF_FIT_SCATTER_H

#include "base/error.h"
#include "study/fit/spline.h"

/* One branch: places ascending or descending, measured values; out: the smoothed values and the standard
 * deviation of each. Borrowed. */
typedef struct sf_scatter_branch {
    int count;
    const double *x, *y;
    double *smooth, *sigma;
} sf_scatter_branch;

typedef struct sf_scatter {
    double absolute; /* a, in the unit of y */
    double relative; /* b */
} sf_scatter;

enum { SF_SCATTER_FINEST = 40, SF_SCATTER_BRANCHES = 16 };

/* Smooths and estimates, at most SF_SCATTER_BRANCHES of them; SF_ERR_NUMERIC if a branch cannot be smoothed.
 */
sf_status sf_scatter_estimate(int branch_count, const sf_scatter_branch *branches, sf_scatter *scatter,
                              sf_error *err);

/* The number of intervals, of SF_GRADING_FOAM over each branch, with which splines smooth the branches best:
 * cross-validation with the sigmas that are there. Writes `smooth` anew. */
sf_status sf_scatter_intervals(int branch_count, const sf_scatter_branch *branches, int *intervals,
                               sf_error *err);

#endif
