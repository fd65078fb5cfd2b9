/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Gaussian process that predicts one output of a study where it was not computed: ordinary kriging
 * (Rasmussen and Williams 2006, chapters 2 and 5). The correlation of two points is Matern's of smoothness
 * 5/2,
 *
 *     c(r) = (1 + s + s^2 / 3) exp(-s),   s = sqrt(5) r,   r^2 = sum_i (d_i / l_i)^2,
 *
 * where d_i is the difference of two numbers, or 0 for equal and 1 for different words. A nugget holds the
 * scatter of meshes. Lengths and nugget maximise the restricted likelihood under a weak prior. The same bits
 * for any number of threads. */
#pragma once
#include "base/error.h"
#include <gsl/gsl_matrix.h>

enum { SF_PREDICTOR_INPUTS = 20 };
#define SF_PREDICTOR_SIDES 1.959963984540054 /* standard deviations on each side of a 95 % interval */

typedef struct sf_predictor {
    int inputs, count;
    bool word[SF_PREDICTOR_INPUTS];
    double length[SF_PREDICTOR_INPUTS]; /* in units of the inputs; of a word, in differences */
    double nugget;                      /* -, variance of the scatter over that of the process */
    double mean, deviation;             /* of the process, in units of the output */
    double calibration; /* -, factor of all standard deviations, from the residuals of points left out: the
                           larger of their root mean square and of their 95 % quantile, over what the process
                           expects */
    double *x;          /* [count][inputs], and behind them the next three; owned */
    gsl_matrix_view factor; /* [count][count] lower Cholesky factor of the correlation K */
    gsl_vector_view weight; /* [count] K^-1 (y - mean) */
    gsl_vector_view ones;   /* [count] K^-1 1 */
    double ones_sum;        /* 1' K^-1 1 */
} sf_predictor;

/* Fits to y [count] at x [count][inputs]; numbers are scaled to about 0 to 1 by the caller. At least two
 * points. Release with sf_predictor_free, also on failure. Errors: SF_ERR_NUMERIC, the correlation cannot be
 * factored; memory. */
sf_status sf_predictor_fit(int inputs, const bool *word, int count, const double *x, const double *y,
                           sf_predictor *predictor, sf_error *err);
void sf_predictor_free(sf_predictor *predictor);

/* Predicts at x [inputs]. `room` [count] is overwritten. `deviation` is that of a value that would be
 * computed, with its scatter. */
void sf_predictor_at(const sf_predictor *predictor, const double *x, double *room, double *mean,
                     double *deviation);

/* Chooses up to `most` of `candidates` points x [candidates][inputs] to be computed next: again and again the
 * one whose standard deviation over `wish` (of its own) is largest, given those that were chosen before it,
 * while it exceeds one. `chosen` [most] receives their places; returns how many, -1 without memory. */
int sf_predictor_choose(const sf_predictor *predictor, int candidates, const double *x, const double *wish,
                        int most, int *chosen);
