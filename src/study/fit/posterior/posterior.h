/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "study/fit/posterior/mixture.h"

/* Markov chain Monte Carlo. A step of a chain is, by chance, one of three Metropolis-Hastings steps:
 *
 *   - independence: the proposal is drawn from a mixture of t-distributions (mixture.h) matched to all
 * chains;
 *   - random walk: normal with the chains' covariance times 2.38^2 / n, or a hundredth of that;
 *   - delayed acceptance, where the target gives its responses: many steps of the first two kinds on the
 * density that an emulator of the responses gives (mixture.h), whose end is then accepted or rejected as a
 * whole by the target itself (Christen and Fox, J. Comput. Graph. Stat. 14, 2005, 795-810). So the chains are
 * those of the target, however good the emulator is.
 *
 * All are matched during burn-in, round by round, and fixed from then on; chains that do not reach the
 * criteria within a quarter of the most steps, and then within half of them, begin anew with what they
 * learnt. Chains start at draws of a t-distribution about the point and with the covariance that the caller
 * gives. Every chain has its own generator, and what chains share is computed between rounds in the chains'
 * order: the result has the same bits for any number of threads. */

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

/* Normal data with two discrepancies of unknown size: the residual r of `data` values is
 *
 *     r = J delta + G x + e,   delta ~ N(0, tau^2 K),   x ~ N(0, kappa^2),   e ~ N(0, D),
 *
 * J the data's derivatives by a function at `bins` places, from which the truth differs by delta; G those by
 * `effects` independent errors x. Both are integrated in closed form: with their `latent` standard variables
 * z and the whitened derivatives H, one evaluation factorises 1 + S H^T H S, S the sizes, or 1 + H S S H^T
 * where the data are fewer than the variables. */

enum { SF_DISCREPANCY_MOST = 160 }; /* bins and effects together */

typedef struct sf_discrepancy {
    int data, bins, effects, latent; /* latent = bins + effects */
    double *root;                    /* [bins][bins] R, K = R R^T */
    double *base_root;               /* [data][data] Cholesky factor L of D */
    double *white;                   /* [data][latent] H = L^-1 (J R, G) */
    double *gram;                    /* [latent][latent] H^T H */
    double *spread[2];      /* [data][data] H H^T of delta and of x; NULL: more data than variables */
    double log_determinant; /* of D */
} sf_discrepancy;

typedef struct sf_discrepancy_size {
    double tau, kappa;
} sf_discrepancy_size;

/* K of a Gaussian process with squared exponential correlation: places [bins], correlation length in their
 * unit. */
void sf_kernel_fill(int bins, const double *place, double length, double *kernel);

/* J [data][bins], K [bins][bins], G [data][effects], D [data][data]; all are copied. `data` may be 0. Release
 * with sf_discrepancy_free, also on failure. Errors: D is not positive definite, too many effects. */
sf_status sf_discrepancy_build(int data, int bins, const double *jacobian, const double *kernel, int effects,
                               const double *effect, const double *base, sf_discrepancy *discrepancy,
                               sf_error *err);
void sf_discrepancy_free(sf_discrepancy *discrepancy);

/* Log density of residuals [data]. */
double sf_discrepancy_log_density(const sf_discrepancy *discrepancy, const double *residual,
                                  sf_discrepancy_size size);
/* delta [bins] and x [effects] drawn from their distribution given the residuals and the sizes. */
void sf_discrepancy_draw(const sf_discrepancy *discrepancy, const double *residual, sf_discrepancy_size size,
                         gsl_rng *random, double *delta, double *x);

/* tau = `scale` times the half-normal variable that the normal variable z stands for; 0.6745 `scale` at z =
 * 0. So a prior that is half-normal in tau is normal in z. */
double sf_half_normal(double z, double scale);

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
