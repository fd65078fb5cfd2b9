/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The statements of the report about the runs, figure by figure of the plan. */
#ifndef SF_SWEEP_ANALYSIS_H
#define SF_SWEEP_ANALYSIS_H

#include "study/sweep/effects.h"
#include "study/sweep/sample.h"
#include "study/sweep/quadratic.h"

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
    size_t figure[SF_SWEEP_FIGURES]; /* their places in the list of figures */
    int64_t done, failed, open;
    int64_t usable; /* done and not "do not use", or predicted */
    int64_t predicted;
    double widest[SF_SWEEP_FIGURES]; /* -, largest relative half of an interval of the predicted */
    int64_t unusable; /* of the done: "do not use" */
    int64_t remarks;  /* of the done: "valid with remarks" */
    sf_effect effect[SF_SWEEP_FIGURES][SF_SWEEP_FACTORS];
    sf_sweep_surface surface[SF_SWEEP_FIGURES];
    bool with_indices;
    sf_index index[SF_SWEEP_FIGURES][SF_SWEEP_FACTORS];
    int64_t index_samples[SF_SWEEP_FIGURES]; /* that are whole */
    sf_probabilities probability;
} sf_analysis;

/* Release with sf_analysis_free, also on failure. */
sf_status sf_analysis_make(const sf_runs *runs, sf_analysis *analysis, sf_error *err);
void sf_analysis_free(sf_analysis *analysis);

/* The figure of a row if it can be used, else NaN. */
double sf_analysis_value(const sf_analysis *a, int figure, int64_t row);

/* [count], from malloc: true for `most` of them at most, drawn with a fixed seed, as those at equal distances
 * may all have the same level of a factor. NULL on failure. */
bool *sf_analysis_pick(int64_t count, int64_t most, sf_error *err);

/* The names of the terms of a surface, in their order. */
void sf_analysis_term(const sf_analysis *a, const sf_quadratic *s, int term, char *text, size_t size);

/* The factors that are numbers and have more than one value, in the order of the surface; returns how many.
 */
int sf_analysis_numbers(const sf_plan *plan, int list[SF_SWEEP_FACTORS]);

#endif
