/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_STUDY_SWEEP_EFFECTS_H
#define SF_STUDY_SWEEP_EFFECTS_H
#include "study/sweep/quadratic.h"
#include "study/sweep/runs.h"

/* Main effects: how far the mean of a figure moves between the values of one factor, all else equal. Runs
 * that do not count (failed, not to be used) are mostly the hardest drops of some values: so the means are
 * over those combinations of the other blocks of which all runs count. A plan of one block has no
 * combinations: its means are over all runs that count. Numbers that a sample mixes with other factors never
 * stand beside each other all else equal: their effect is that of the response surface, if that is good. */

enum { SF_EFFECT_LEVELS = 12, SF_EFFECT_BINS = 5, SF_EFFECT_RUNS = 50 /* in a mean, fewer are scatter */ };
#define SF_EFFECT_Q2 0.8 /* of a surface, at least */

typedef struct sf_effect {
    double low, high;   /* smallest and greatest mean; of draws the means at 5 and 95 % of them; NaN: none */
    double first, last; /* of numbers: the means at the least and at the greatest value */
    int64_t used, of; /* combinations of the other blocks of which all runs count, and all of them; 0: by the
                         surface, or a plan of one block */
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

/* True if the range of the means is mostly scatter of the other factors: as that of draws of a posterior,
 * or of more than SF_EFFECT_LEVELS words, that a sample mixes with other factors, so that each of them has
 * few runs. */
bool sf_effect_is_scatter(const sf_plan *plan, int factor);

/* True if the factor is a number that a sample mixes with others: its effect is by the surface. */
bool sf_effect_is_by_surface(const sf_plan *plan, int factor);

/* By means; NaN of a factor of one of these two kinds. */
sf_status sf_effect_measure(const sf_runs *runs, int factor, size_t figure, sf_effect *effect, sf_error *err);

/* Computes the effect of number `i` of the surface, between its least and its greatest value, averaged
 * over the rows x [n][d + offsets] that it was fitted to, which are as before when it returns. Changes
 * nothing where the surface has a problem or a Q2 below SF_EFFECT_Q2. */
void sf_effect_of_surface(const sf_quadratic *surface, int i, int64_t n, double *x, sf_effect *effect);

/* The probability that a figure stays below its limit, over what is uncertain in the plan, for each
 * combination of what is chosen. */

enum { SF_PROBABILITY_CELLS = 4096 };

/* The probability of one combination and one figure. A run that ended because the missile reached the
 * anvil is above every limit. Runs that failed otherwise or are not to be used are unknown: mostly the
 * hardest drops, so that a share of the others alone would be too kind. The share and the low end of the
 * interval count them as above, its high end as below. */
typedef struct sf_probability {
    int64_t below, above, unknown;
    int64_t
        within;   /* of a_max_g and hic: runs whose limit lies within the 95 % scatter of drops about them */
    double share; /* `below` of all three; NaN: no run */
    double low, high; /* the 95 % interval of Clopper and Pearson */
} sf_probability;

typedef struct sf_probabilities {
    int64_t cells;        /* 0: nothing is uncertain, or there are too many combinations */
    int64_t open;         /* runs that are not done yet: not counted */
    sf_probability *cell; /* [figures of the plan][cells]; owned */
    int64_t *row;         /* [cells] a row of that combination; owned */
} sf_probabilities;

/* True if every factor of the block is a choice, not an unknown. */
bool sf_block_is_chosen(const sf_plan *plan, int block);

sf_status sf_probabilities_count(const sf_runs *runs, sf_probabilities *p, sf_error *err);
void sf_probabilities_free(sf_probabilities *p);
/* Share and interval from the counts, of which `independent` are independent of each other: the interval is
 * that of so many runs of the same shares. */
void sf_probability_judge(sf_probability *p, double independent);
#endif
