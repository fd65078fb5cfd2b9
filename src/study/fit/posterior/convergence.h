/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The agreement of several Markov chains (Gelman et al., Bayesian Data Analysis, 3rd ed., section 11.4-5).
 * `x` holds [chains][count] values; each chain is cut into halves. */
#ifndef SF_FIT_POSTERIOR_CONVERGENCE_H
#define SF_FIT_POSTERIOR_CONVERGENCE_H

/* Split R-hat; INFINITY if the halves stand still at different values, NaN for fewer than 4 values of a
 * chain, 1 for a quantity that is constant. */
double sf_split_rhat(int chains, int count, const double *x);
/* Effective sample size, by Geyer's initial monotone sequence; 0 where R-hat is not finite. */
double sf_effective_size(int chains, int count, const double *x);

#endif
