/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A probability density of a few parameters, known up to a constant: what chains.h samples. Nothing in this
 * folder knows a foam. All logarithms are natural. */
#ifndef SF_FIT_POSTERIOR_TARGET_H
#define SF_FIT_POSTERIOR_TARGET_H

#include "base/error.h"
#include <stdbool.h>
#include <stdint.h>

enum { SF_POSTERIOR_MOST = 24, SF_RESPONSES_MOST = 256 }; /* parameters; responses of a density in two steps */

typedef struct sf_target {
    int parameters;
    /* Logarithm of the density at u [parameters]; -INFINITY or NaN: outside. Called by several threads at a
     * time. */
    double (*log_density)(const void *context, const double *u);
    const void *context;
    /* The density in two steps, of which the first costs much more; responses = 0: not told. */
    int responses; /* smooth functions of the first `shape` parameters */
    int shape;
    bool (*respond)(const void *context, const double *u, double *y); /* false: outside */
    double (*log_density_of)(const void *context, const double *u, const double *y);
    int quantities; /* followed beside the parameters, for example predictions; 0: none */
    /* Quantities of u; what is random in them follows from `seed`. NaN: no value. Called by several threads.
     */
    void (*observe)(const void *context, const double *u, uint64_t seed, double *quantity);
} sf_target;

/* The density at u, -INFINITY where it is NaN. */
static inline double sf_target_at(const sf_target *target, const double *u) {
    double value = target->log_density(target->context, u);
    return value == value ? value : -__builtin_inf();
}

/* A seed of its own for the `index`-th of several generators of one `seed`. */
static inline uint64_t sf_seed_of(uint64_t seed, uint64_t index) {
    uint64_t z = seed * 0x9e3779b97f4a7c15u + (index + 1) * 0xd1342543de82ef95u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

#endif
