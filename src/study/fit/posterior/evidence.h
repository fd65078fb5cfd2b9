/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The integral of a target's density by importance sampling, and weights of importance sampling in general.
 */
#ifndef SF_FIT_POSTERIOR_EVIDENCE_H
#define SF_FIT_POSTERIOR_EVIDENCE_H

#include "study/fit/posterior/mixture.h"

typedef struct sf_evidence {
    double log_value;
    double error;     /* standard error of log_value */
    double effective; /* draws that count: (sum w)^2 / sum w^2 */
    int draws;
    bool trusted; /* `effective` is at least 100 and a fiftieth of the draws */
} sf_evidence;

/* Estimates the evidence from `draws` draws of a mixture that resembles the target. The same bits for any
 * number of threads. */
sf_status sf_evidence_estimate(const sf_target *target, const sf_mixture *mixture, int draws, uint64_t seed,
                               sf_evidence *evidence, sf_error *err);

/* log of the mean of exp(log_weight). */
double sf_log_mean(int count, const double *log_weight);

/* Pareto-smoothed importance sampling (Vehtari, Simpson, Gelman, Yao, Gabry 2024): the largest weights are
 * replaced by the quantiles of the generalised Pareto distribution that fits them (Zhang and Stephens 2009).
 * Returns its shape k: above 0.7 the weights cannot be used; INFINITY where there are too few to tell. */
double sf_pareto_smooth(int count, double *log_weight, sf_error *err);

#endif
