/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of one Markov chain (chains.h says which there are), and what all chains share for them. */
#ifndef SF_FIT_POSTERIOR_WALK_H
#define SF_FIT_POSTERIOR_WALK_H

#include "study/fit/posterior/emulator.h"
#include "study/fit/posterior/mixture.h"

/* The common data of the steps of all chains; constant while they walk. */
typedef struct sf_walk {
    const sf_target *target;
    sf_mixture proposal, jump; /* of independence steps; its factor of random walks */
    sf_emulator emulator;      /* owned */
} sf_walk;

/* A state: its place, and log densities of the target and of the proposal there. */
typedef struct sf_state {
    double u[SF_POSTERIOR_MOST], density, proposal;
} sf_state;

typedef struct sf_walker {
    gsl_rng *random;
    sf_state at;
    double *path, *density; /* [steps][parameters] of the last walk, and their log densities */
    long long accepted, proposed, evaluations;
    int tried, room; /* evaluated states that are kept */
    double *tried_u, *tried_y, *tried_density;
} sf_walker;

/* A walker with room for walks of `round` steps, that keeps at most `most` evaluated states for
 * sf_walk_learn. Release with sf_walker_free, also on failure. */
sf_status sf_walker_init(const sf_target *target, int most, int round, uint64_t seed, sf_walker *walker,
                         sf_error *err);
void sf_walker_free(sf_walker *walker);
/* Puts it at a draw of the proposal, stretched to twice its scale, or at its centre; at.density is not finite
 * if neither has a density. */
void sf_walker_place(const sf_walk *walk, sf_walker *walker);
void sf_walker_walk(const sf_walk *walk, int steps, sf_walker *walker);
/* Fits the emulator to the states that the walkers [count] kept; none where they are too few. */
sf_status sf_walk_learn(sf_walk *walk, int count, const sf_walker *walker, sf_error *err);

#endif
