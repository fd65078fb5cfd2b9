/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points in the unit cube, the same for the same seed on every machine. No coordinate is 0 or 1. */
#ifndef SF_SWEEP_SAMPLE_H
#define SF_SWEEP_SAMPLE_H

#include "base/error.h"
#include <stdint.h>

typedef enum sf_sampling {
    SF_SAMPLING_RANDOM, /* independent */
    SF_SAMPLING_LATIN,  /* Latin hypercube: one point in each of `count` strata of each coordinate */
    SF_SAMPLING_SOBOL,  /* the Sobol' sequence from its first point after 0 on; with another seed than 1 moved
                           by a random vector, modulo 1 */
    SF_SAMPLING_SALTELLI, /* for Sobol' indices, see below */
} sf_sampling;

#define SF_SAMPLING_WORDS "random|latin_hypercube|sobol|saltelli"

/* Coordinates that the Sobol' sequence of GSL has. */
enum { SF_SOBOL_DIMENSIONS = 40 };

/* Rows of `count` samples: `count`, or count (d + 2) of Saltelli. */
int64_t sf_sample_rows(sf_sampling method, int d, int64_t count);

/* u [sf_sample_rows][d]. Of Saltelli the rows are blocks of `count`: A, B, then for each coordinate i A with
 * its coordinate i from B; A and B are the halves of a Sobol' sequence of 2 d coordinates. SF_ERR_INPUT: the
 * sequence has not so many coordinates. */
sf_status sf_sample(sf_sampling method, int d, int64_t count, uint64_t seed, double *u, sf_error *err);

#endif
