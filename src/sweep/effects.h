/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Main effects: how far the mean of a figure moves between the values of one factor, over all runs. */
#ifndef SF_SWEEP_EFFECTS_H
#define SF_SWEEP_EFFECTS_H

#include "sweep/runs.h"

enum { SF_EFFECT_LEVELS = 12, SF_EFFECT_BINS = 5, SF_EFFECT_RUNS = 50 /* in a mean, fewer are scatter */ };

typedef struct sf_effect {
    double low, high;   /* smallest and greatest mean; of draws the means at 5 and 95 % of them; NaN: none, or
                           words whose means are scatter (sf_effect_is_scatter) */
    double first, last; /* of numbers: the means at the least and at the greatest value */
} sf_effect;

/* The values of a factor in groups: levels; of more than SF_EFFECT_LEVELS numbers SF_EFFECT_BINS parts with
 * equally many rows. Of numbers the groups ascend. */
typedef struct sf_groups {
    int64_t count;
    int64_t *of_row; /* [rows of the block] owned */
    double *middle;  /* [count] mean value of the group; owned */
} sf_groups;

sf_status sf_groups_make(const sf_plan *plan, int factor, sf_groups *groups, sf_error *err);
void sf_groups_free(sf_groups *groups);

/* mean [count] of the figure over the usable rows of each group; NaN: there is none. */
void sf_groups_mean(const sf_runs *runs, int factor, const sf_groups *groups, size_t figure, double *mean,
                    int64_t *number);

/* Is the range of the means mostly scatter of the other factors? So it is of draws of a posterior, or of more
 * than SF_EFFECT_LEVELS words, that a sample mixes with other factors: each of them has few runs. */
bool sf_effect_is_scatter(const sf_plan *plan, int factor);

sf_status sf_effect_measure(const sf_runs *runs, int factor, size_t figure, sf_effect *effect, sf_error *err);

#endif
