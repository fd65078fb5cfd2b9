/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weights of models for averaging. */
#ifndef SF_FIT_POSTERIOR_WEIGHTS_H
#define SF_FIT_POSTERIOR_WEIGHTS_H

#include "base/error.h"
#include <stdint.h>

/* From the leave-one-out log predictive densities [models][groups] of groups of data: exp of their sums,
 * averaged over a Bayesian bootstrap of the groups ("pseudo-BMA+", Yao, Vehtari, Simpson, Gelman 2018), so
 * that a few groups do not decide more than they can. A model with a density that is not finite gets none. */
sf_status sf_predictive_weights(int models, int groups, const double *log_density, uint64_t seed,
                                double *weight, sf_error *err);
/* exp(log_evidence) over their sum; a model without a finite one gets none. */
void sf_evidence_weights(int models, const double *log_evidence, double *weight);

#endif
