/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <gsl/gsl_rng.h>
#include <stdint.h>

#include "base/error.h"

/* A probability density of a few parameters, known up to a constant: which posterior.h samples. Nothing in
 * this folder knows a foam. All logarithms are natural. */

enum {
    SF_POSTERIOR_MOST = 24,
    SF_RESPONSES_MOST = 256
}; /* parameters; responses of a density in two steps */

typedef struct sf_target {
    int parameters;
    /* Logarithm of the density at u [parameters]; -INFINITY or NaN: outside. `y`: what `respond` gives there;
     * NULL: not known yet. Called by several threads at a time. */
    double (*log_density)(const void *context, const double *u, const double *y);
    const void *context;
    /* The density in two steps, of which the first costs much more; responses = 0: not told. */
    int responses; /* smooth functions of the first `shape` parameters */
    int shape;
    bool (*respond)(const void *context, const double *u, double *y); /* false: outside */
    int quantities; /* followed beside the parameters, for example predictions; 0: none */
    /* Quantities of u; what is random in them follows from `seed`. NaN: none. Called by several threads. */
    void (*observe)(const void *context, const double *u, uint64_t seed, double *quantity);
} sf_target;

/* The density at u, -INFINITY where it is NaN. */
static inline double sf_target_at(const sf_target *target, const double *u) {
    double value = target->log_density(target->context, u, NULL);
    return value == value ? value : -__builtin_inf();
}

/* The generator of a seed; NULL without memory. `SF_RANDOM *r = sf_random(1, err)` is released at the end of
 * its block. */
gsl_rng *sf_random(uint64_t seed, sf_error *err);
#define SF_RANDOM SF_OWNED_BY(sf_release_random) gsl_rng
static inline void sf_release_random(gsl_rng **random) {
    gsl_rng_free(*random);
}

/* A seed of its own for the `index`-th of several generators of one `seed`. */
static inline uint64_t sf_seed_of(uint64_t seed, uint64_t index) {
    uint64_t z = seed * 0x9e3779b97f4a7c15u + (index + 1) * 0xd1342543de82ef95u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* A mixture of multivariate t-distributions: proposals of the chains, and what importance sampling draws
 * from. */

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

/* Mean [n] and covariance [n][n] of samples [count][n]. */
void sf_moments(int n, int count, const double *sample, double *mean, double *covariance);

/* One part with this centre [n] and scale matrix [n][n]. Errors: it is not positive definite. */
sf_status sf_mixture_single(int n, const double *centre, const double *scale, double freedom,
                            sf_mixture *mixture, sf_error *err);
/* The same from the moments of samples [count][n]. */
sf_status sf_mixture_about(int n, int count, const double *sample, double freedom, sf_mixture *mixture,
                           sf_error *err);
/* Matched to `count` samples [count][n] by expectation and maximisation; the number of parts is the one
 * that, matched to the first half (let it be other chains), describes the second best. Errors: too few
 * samples, or they span no volume. */
sf_status sf_mixture_fit(int n, int count, const double *sample, double freedom, sf_mixture *mixture,
                         sf_error *err);
double sf_mixture_log_density(const sf_mixture *mixture, const double *u);
void sf_mixture_draw(const sf_mixture *mixture, gsl_rng *random, double *u);

/* A polynomial through responses that cost much: where Markov chains look before they pay for the responses
 * themselves (posterior.h). It need not be exact for the chains to be. */
enum { SF_EMULATOR_MOST_TERMS = 600 };

typedef struct sf_emulator {
    int parameters, responses;
    int terms;             /* 0: no emulator */
    sf_mixture_part frame; /* of the points' mean and covariance: u = centre + L z */
    double most_distance;  /* |z|^2 of the farthest point */
    int parent[SF_EMULATOR_MOST_TERMS],
        variable[SF_EMULATOR_MOST_TERMS]; /* term = term[parent] z[variable] */
    double *coefficient;                  /* [responses][terms]; owned */
} sf_emulator;

/* Least squares on `count` points u [count][parameters] with y [count][responses]: of the degree (4, 3 or 2)
 * for which the points are three times the terms; without terms where they are too few even for that, or
 * span no volume. Release with sf_emulator_free, also on failure. */
sf_status sf_emulator_fit(int parameters, int responses, int count, const double *u, const double *y,
                          sf_emulator *emulator, sf_error *err);
/* y [responses] at u [parameters]. False: u is farther out than every point of the fit. */
bool sf_emulator_at(const sf_emulator *emulator, const double *u, double *y);
void sf_emulator_free(sf_emulator *emulator);
