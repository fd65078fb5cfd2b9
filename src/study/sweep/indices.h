/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sobol' indices of a sample of Saltelli: the share of the variance of a figure that one factor explains
 * alone (first order) and with all its interactions (total). */
#ifndef SF_SWEEP_INDICES_H
#define SF_SWEEP_INDICES_H

#include "base/error.h"
#include <stdint.h>

#define SF_INDEX_SHARE 0.95
enum { SF_INDEX_LEAST = 8 };

typedef struct sf_index {
    double first, first_low, first_high; /* the 95 % interval of the bootstrap */
    double total, total_low, total_high;
} sf_index;

/* y [d + 2][n]: the blocks A, B, and A with each coordinate from B (study/sweep/sample.h). A sample of which one
 * value is NaN is left out in all blocks; `*used` receives the number of the others. index [d]: NaN where
 * fewer than SF_INDEX_LEAST or than SF_INDEX_SHARE are left (values that are missing for what they would be
 * leave no random part) or y does not vary. Saltelli's estimator of 2010 and Jansen's; percentiles of
 * bootstrap samples, the same for the same seed. */
sf_status sf_indices(int d, int64_t n, const double *y, uint64_t seed, sf_index *index, int64_t *used,
                     sf_error *err);

#endif
