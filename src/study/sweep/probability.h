/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The probability that a figure stays below its limit, over what is uncertain in the plan, for each
 * combination of what is chosen. */
#ifndef SF_SWEEP_PROBABILITY_H
#define SF_SWEEP_PROBABILITY_H

#include "study/sweep/runs.h"

enum { SF_PROBABILITY_CELLS = 4096 };

/* Of one combination and one figure. A run that ended because the missile reached the anvil is above every
 * limit. Runs that failed otherwise or are not to be used are unknown: mostly the hardest drops, so that a
 * share of the others alone would be too kind. The share and the low end of the interval count them as above,
 * its high end as below. */
typedef struct sf_probability {
    int64_t below, above, unknown;
    double share;     /* `below` of all three; NaN: no run */
    double low, high; /* the 95 % interval of Clopper and Pearson */
} sf_probability;

typedef struct sf_probabilities {
    int64_t cells;        /* 0: nothing is uncertain, or there are too many combinations */
    int64_t open;         /* runs that are not done yet: not counted */
    sf_probability *cell; /* [figures of the plan][cells]; owned */
    int64_t *row;         /* [cells] a row of that combination; owned */
} sf_probabilities;

/* Is every factor of the block a choice, not an unknown? */
bool sf_block_is_chosen(const sf_plan *plan, int block);

sf_status sf_probabilities_count(const sf_runs *runs, sf_probabilities *p, sf_error *err);
void sf_probabilities_free(sf_probabilities *p);
/* Share and interval from the counts, of which `independent` are independent of each other: the interval is
 * that of so many runs of the same shares. */
void sf_probability_judge(sf_probability *p, double independent);

#endif
