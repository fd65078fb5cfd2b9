/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdint.h>

#include "base/error.h"
#include "study/fit/posterior/chains.h"

/* The integral of a target's density by importance sampling, and weights of importance sampling. */
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

/* Weights of models for averaging. */

/* Computes weights from the leave-one-out log predictive densities [models][groups] of groups of data: exp
 * of their sums, averaged over a Bayesian bootstrap of the groups ("pseudo-BMA+", Yao, Vehtari, Simpson,
 * Gelman 2018), so that a few groups do not decide more than they can. A model with a density that is not
 * finite gets none. */
sf_status sf_predictive_weights(int models, int groups, const double *log_density, uint64_t seed,
                                double *weight, sf_error *err);
/* exp(log_evidence) over their sum; a model without a finite one gets none. */
void sf_evidence_weights(int models, const double *log_evidence, double *weight);

/* Leave-one-out predictive densities of groups of data (all data of a drop are one group): log p(y_g | all
 * others), from the chains of the whole posterior by Pareto-smoothed importance weights; where these have no
 * variance (k > 0.5), from draws of a mixture wider than the posterior, the same for all groups; where too
 * few of these count, from chains of the posterior without the group. */

typedef struct sf_grouped {
    sf_target target; /* of all data */
    int groups;
    /* The target's log density at u; `conditional` [groups] gets log p(y_g | other groups, u). `y`: what the
     * target's respond gives there; NULL: not known yet. */
    double (*split)(const void *context, const double *u, const double *y, double *conditional);
} sf_grouped;

typedef struct sf_left_out {
    double log_density; /* log p(y_g | other groups) */
    double pareto_k;    /* of the importance weights */
    bool drawn;         /* by draws of a wider mixture */
    bool sampled;       /* by chains of its own */
    bool converged;     /* they did; true for weights that can be used */
} sf_left_out;

typedef struct sf_leave_options {
    int draws;                /* of the wider mixture; 0: none */
    double effective;         /* of them that must count */
    sf_chains_options chains; /* chains of their own, without quantities */
} sf_leave_options;

/* `out` [groups], from the samples of `chains`. */
sf_status sf_leave_one_out(const sf_grouped *grouped, const sf_chains *chains,
                           const sf_leave_options *options, sf_left_out *out, sf_error *err);
