/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mixture of multivariate t-distributions: proposals of the chains, and what importance sampling draws
 * from. */
#ifndef SF_FIT_POSTERIOR_MIXTURE_H
#define SF_FIT_POSTERIOR_MIXTURE_H

#include "study/fit/posterior/target.h"
#include <gsl/gsl_rng.h>

enum { SF_MIXTURE_MOST = 4 }; /* parts */

typedef struct sf_mixture_part {
    double weight;
    double centre[SF_POSTERIOR_MOST];
    double factor[SF_POSTERIOR_MOST][SF_POSTERIOR_MOST]; /* L, scale matrix = L L^T */
    double log_norm;                                     /* of the density at the centre */
} sf_mixture_part;

typedef struct sf_mixture {
    int parameters, parts;
    double freedom; /* degrees of freedom of every part */
    sf_mixture_part part[SF_MIXTURE_MOST];
} sf_mixture;

/* One part with this centre [n] and scale matrix [n][n]. Errors: it is not positive definite. */
sf_status sf_mixture_single(int n, const double *centre, const double *scale, double freedom,
                            sf_mixture *mixture, sf_error *err);
/* Matched to `count` samples [count][n] by expectation and maximisation; the number of parts is the one
 * that, matched to the first half (let it be other chains), describes the second best. Errors: too few
 * samples, or they span no volume. */
sf_status sf_mixture_fit(int n, int count, const double *sample, double freedom, sf_mixture *mixture,
                         sf_error *err);
double sf_mixture_log_density(const sf_mixture *mixture, const double *u);
void sf_mixture_draw(const sf_mixture *mixture, gsl_rng *random, double *u);

#endif
