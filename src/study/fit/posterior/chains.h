/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Markov chain Monte Carlo. A step of a chain is, by chance, one of three Metropolis-Hastings steps:
 *
 *   - independence: the proposal is drawn from a mixture of t-distributions (mixture.h) matched to all
 * chains;
 *   - random walk: normal with the chains' covariance times 2.38^2 / n, or a hundredth of that;
 *   - delayed acceptance, where the target gives its responses: many steps of the first two kinds on the
 * density that an emulator of the responses gives (emulator.h), whose end is then accepted or rejected as a
 * whole by the target itself (Christen and Fox, J. Comput. Graph. Stat. 14, 2005, 795-810). So the chains are
 * those of the target, however good the emulator is.
 *
 * All are matched during burn-in, round by round, and fixed from then on; chains that do not reach the
 * criteria within a quarter of the most steps, and then within half of them, begin anew with what they
 * learnt. Chains start at draws of a t-distribution about the point and with the covariance that the caller
 * gives. Every chain has its own generator, and what chains share is computed between rounds in the chains'
 * order: the result has the same bits for any number of threads. */
#pragma once
#include "study/fit/posterior/mixture.h"

typedef struct sf_chains_options {
    int chains; /* >= 2 */
    uint64_t seed;
    int burn_in_rounds; /* >= 1 */
    int round;          /* steps of a chain in a round of burn-in, and between two looks at convergence */
    int most_steps;     /* of a chain, without burn-in */
    int most_kept;      /* of a chain: thinned to less than that */
    double rhat;        /* reached when every parameter and quantity is below it ... */
    double effective;   /* ... and above this effective size */
} sf_chains_options;

/* 4 chains, 4 rounds of 250 steps, at most 6000 steps and fewer than 1000 kept, R-hat 1.02, 400. */
sf_chains_options sf_chains_defaults(uint64_t seed);

typedef struct sf_chains {
    int parameters, quantities, chains;
    int kept;              /* states of each chain */
    int thinning;          /* steps from one to the next */
    double *sample;        /* [chains][kept][parameters]; owned, with the next four behind it */
    double *log_density;   /* [chains][kept] of the target */
    double *quantity;      /* [chains][kept][quantities] */
    double *rhat;          /* [parameters + quantities]; NaN: a quantity that no state has. A state
                              without it counts with the largest value of the others */
    double *effective;     /* [parameters + quantities] */
    double accepted;       /* share of the proposals after burn-in; a delayed step is one */
    long long evaluations; /* of the target */
    bool converged;
    sf_mixture proposal; /* the one that was fixed */
} sf_chains;

/* Samples until both criteria are reached, or to the limit (`converged` false). `covariance`
 * [parameters][parameters]. Release with sf_chains_free, also on failure. Errors: no start with a density. */
sf_status sf_chains_run(const sf_target *target, const double *start, const double *covariance,
                        const sf_chains_options *options, sf_chains *chains, sf_error *err);
void sf_chains_free(sf_chains *chains);

/* The agreement of several Markov chains (Gelman et al., Bayesian Data Analysis, 3rd ed., section 11.4-5).
 * `x` holds [chains][count] values; each chain is cut into halves. Split R-hat; INFINITY if the halves stand
 * still at different values, NaN for fewer than 4 values of a chain, 1 for a quantity that is constant. */
double sf_split_rhat(int chains, int count, const double *x);
/* Effective sample size, by Geyer's initial monotone sequence; 0 where R-hat is not finite. */
double sf_effective_size(int chains, int count, const double *x);
