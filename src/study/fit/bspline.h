/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <gsl/gsl_bspline.h>

#include "base/error.h"

/* Cubic B-splines (GSL) with their slopes and exact integrals as rows over the coefficients, and the places
 * of their knots: denser at both ends, where a foam's curve bends most, and nowhere closer than the data. */

enum { SF_SPLINE_ORDER = 4, SF_SPLINE_BREAKS = 64, SF_SPLINE_COEFFICIENTS = SF_SPLINE_BREAKS + 2 };

typedef struct sf_spline {
    int count;                      /* coefficients */
    gsl_bspline_workspace *base;    /* order 4 */
    gsl_bspline_workspace *primary; /* order 5 on the same breaks: the integrals */
    gsl_vector *higher;             /* [count + 1] scratch */
    gsl_matrix *slope;              /* [count][2] scratch */
} sf_spline;

/* A set of data places, ascending or descending. */
typedef struct sf_spline_data {
    const double *x;
    int count;
} sf_spline_data;

/* The change of the widths of intervals with the place. */
typedef enum sf_spline_grading {
    SF_GRADING_ENDS, /* widths at the ends a twelfth of those in the middle: for a branch of any shape */
    SF_GRADING_FOAM, /* in proportion to the distances from rest and from full compression, on which the
                        loading curve of a foam depends */
} sf_spline_grading;

/* Places `intervals` intervals over [low, high] and joins those that hold fewer than two points of any of the
 * sets. Returns the number of breaks, at least 2. */
int sf_spline_place(sf_spline_grading grading, int intervals, double low, double high, int set_count,
                    const sf_spline_data *sets, double breaks[SF_SPLINE_BREAKS]);

/* Place in [low, high] of a part 0..1 of the intervals. */
double sf_spline_grade(sf_spline_grading grading, double low, double high, double part);

/* Part of the intervals over [0, high] that lie below `strain`, SF_GRADING_FOAM. */
double sf_spline_part(double high, double strain);

/* Release with sf_spline_free, also on failure. */
sf_status sf_spline_init(sf_spline *spline, int break_count, const double *breaks, sf_error *err);
void sf_spline_free(sf_spline *spline);

/* Rows [count] whose product with the coefficients is the value, the slope, the integral from the first break
 * to x; x within the breaks. */
void sf_spline_value(sf_spline *spline, double x, double *row);
void sf_spline_slope(sf_spline *spline, double x, double *row);
void sf_spline_integral(sf_spline *spline, double x, double *row);

/* Abscissa of coefficient j: the spline with c_j = g(x_j) follows g. */
double sf_spline_abscissa(const sf_spline *spline, int j);

/* The scatter of measured stresses, found without the foam law: each branch of each test is smoothed by a
 * spline of its own, whose number of knots generalised cross-validation chooses, and the deviations give
 * the standard deviation sqrt(a^2 + (b stress)^2) by maximum likelihood. So the law cannot hide its own
 * misfit in the scatter. */

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

/* Smooths and estimates, at most SF_SCATTER_BRANCHES of them; SF_ERR_NUMERIC if one cannot be smoothed. GSL's
 * error handler must be off. */
sf_status sf_scatter_estimate(int branch_count, const sf_scatter_branch *branches, sf_scatter *scatter,
                              sf_error *err);

/* The number of intervals, of SF_GRADING_FOAM over each branch, with which splines smooth the branches best:
 * cross-validation with the sigmas that are there. Writes `smooth` anew. */
sf_status sf_scatter_intervals(int branch_count, const sf_scatter_branch *branches, int *intervals,
                               sf_error *err);
