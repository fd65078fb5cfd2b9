/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_STUDY_SWEEP_SAMPLE_H
#define SF_STUDY_SWEEP_SAMPLE_H
#include <stdint.h>

#include "base/error.h"

/* Points in the unit cube, the same for the same seed on every machine. No coordinate is 0 or 1. */

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

/* Sobol' indices of a sample of Saltelli: the share of the variance of a figure that one factor explains
 * alone (first order) and with all its interactions (total). */

#define SF_INDEX_SHARE 0.95
enum { SF_INDEX_LEAST = 8 };

typedef struct sf_index {
    double first, first_low, first_high; /* the 95 % interval of the bootstrap */
    double total, total_low, total_high;
} sf_index;

/* y [d + 2][n]: the blocks A, B, and A with each coordinate from B (study/sweep/sample.h). A sample of which
 * one value is NaN is left out in all blocks; `*used` receives the number of the others. index [d]: NaN where
 * fewer than SF_INDEX_LEAST or than SF_INDEX_SHARE are left (values that are missing for what they would be
 * leave no random part) or y does not vary. Saltelli's estimator of 2010 and Jansen's; percentiles of
 * bootstrap samples, the same for the same seed. */
sf_status sf_indices(int d, int64_t n, const double *y, uint64_t seed, sf_index *index, int64_t *used,
                     sf_error *err);
#endif
