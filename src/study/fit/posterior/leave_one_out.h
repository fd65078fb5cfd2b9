/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_STUDY_FIT_POSTERIOR_LEAVE_ONE_OUT_H
#define SF_STUDY_FIT_POSTERIOR_LEAVE_ONE_OUT_H
#include <stdint.h>

#include "base/error.h"
#include "study/fit/posterior/chains.h"

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
#endif
