/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The statements of the report about the runs, figure by figure of the plan. */
#pragma once
#include "study/sweep/runs.h"

/* The response surface, the main effects and the probabilities of the runs of a sweep. */

enum { SF_QUADRATIC_NUMBERS = 16, SF_QUADRATIC_TERMS = 256 };

/* A response surface: a quadratic of numbers, with constants for the levels of words, by least squares. */
typedef struct sf_quadratic {
    int d;       /* numbers */
    int offsets; /* columns of 0 and 1 behind them */
    int terms;   /* 0: no surface, see `problem` */
    double centre[SF_QUADRATIC_NUMBERS],
        half[SF_QUADRATIC_NUMBERS];    /* z = (x - centre) / half is in -1 to 1 */
    bool curved[SF_QUADRATIC_NUMBERS]; /* three values or more: its square is a term */
    double c[SF_QUADRATIC_TERMS];      /* of 1, z_i, z_i^2, z_i z_j (i < j), offsets */
    double rms;                        /* of the residuals, with the degrees of freedom */
    double left_out_rms; /* of the errors at each row by the surface without its site, the rows of one x; NaN:
                            not determined */
    double q2;           /* 1 - that squared over the variance: 1 is perfect */
    char problem[160];   /* why there is none, or its error is not known; "": neither */
} sf_quadratic;

/* x [n][d + offsets], y [n]. `left_out` [n]: the prediction of each row by the surface without the rows of
 * its x; NULL: not asked for. A surface that the rows do not determine is no failure: see `problem`. */
sf_status sf_quadratic_fit(int d, int offsets, int64_t n, const double *x, const double *y,
                           sf_quadratic *surface, double *left_out, sf_error *err);
/* The value at x [d + offsets]. */
double sf_quadratic_at(const sf_quadratic *surface, const double *x);

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
    long long used, of; /* combinations of the other blocks of which all runs count, and all of them; 0: by the
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
sf_status sf_effect_measure(const sf_runs *runs, int factor, int figure, sf_effect *effect, sf_error *err);

/* Computes the effect of number `i` of the surface, between its least and its greatest value, averaged
 * over the rows x [n][d + offsets] that it was fitted to, which are as before when it returns. Changes
 * nothing where the surface has a problem or a Q2 below SF_EFFECT_Q2. */
void sf_effect_of_surface(const sf_quadratic *surface, int i, int64_t n, double *x, sf_effect *effect);

/* The probability that a figure stays below its limit, over what is uncertain in the plan, for each
 * combination of what is chosen. */

enum { SF_PROBABILITY_CELLS = 4096 };

/* The probability of one combination and one figure. A run that ended because the missile reached the
 * anvil is above every limit. Runs that failed otherwise, are not to be used or are left open as they are
 * expected to be so are unknown: mostly the hardest drops, so that a share of the others alone would be too
 * kind. The share and the low end of the interval count them as above, its high end as below. */
typedef struct sf_probability {
    long long below, above, unknown;
    long long within;   /* of a_max_g and hic: runs whose limit lies within the 95 % scatter of drops about them */
    double share;     /* `below` of all three; NaN: no run */
    double low, high; /* the 95 % interval of Clopper and Pearson */
} sf_probability;

typedef struct sf_probabilities {
    int64_t cells;        /* 0: nothing is uncertain, or there are too many combinations */
    int64_t open;         /* runs that are still to be made: not counted */
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

enum { SF_SURFACE_ROWS = 20000, SF_OFFSET_LEVELS = 12 };

/* The quadratic of one figure and the rows it is of. */
typedef struct sf_sweep_surface {
    sf_quadratic fit;
    int64_t rows;
    int64_t of;        /* rows that could be used; more than `rows`: every so many of them is */
    double *simulated; /* [rows] owned */
    double *left_out;  /* [rows] by the surface without the row; owned */
} sf_sweep_surface;

typedef struct sf_analysis {
    const sf_plan *plan; /* borrowed, like the next */
    const sf_runs *runs;
    long long done, failed, open;
    long long usable; /* done and not "do not use", or predicted */
    long long predicted;
    double widest[SF_SWEEP_FIGURES]; /* -, largest relative half of an interval of the predicted */
    long long unusable; /* of the done: "do not use" */
    long long remarks;  /* of the done: "valid with remarks" */
    sf_effect effect[SF_SWEEP_FIGURES][SF_SWEEP_FACTORS];
    sf_sweep_surface surface[SF_SWEEP_FIGURES];
    bool with_indices;
    sf_index index[SF_SWEEP_FIGURES][SF_SWEEP_FACTORS];
    long long index_samples[SF_SWEEP_FIGURES]; /* that are whole */
    sf_probabilities probability;
} sf_analysis;

/* Release with sf_analysis_free, also on failure. */
sf_status sf_analysis_make(const sf_runs *runs, sf_analysis *analysis, sf_error *err);
void sf_analysis_free(sf_analysis *analysis);

/* [count], from malloc: true for `most` of them at most, drawn with a fixed seed, as those at equal distances
 * may all have the same level of a factor. NULL on failure. */
bool *sf_analysis_pick(int64_t count, int64_t most, sf_error *err);

/* The names of the terms of a surface, in their order. */
void sf_analysis_term(const sf_analysis *a, const sf_quadratic *s, int term, char *text, size_t size);

/* The factors that are numbers and have more than one value, in the surface's order; returns how many. */
int sf_analysis_numbers(const sf_plan *plan, int list[SF_SWEEP_FACTORS]);
