/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of the rows of a plan by columns (study/column.h), whose pad is learnt from the finished drops. A
 * Gaussian process then predicts the difference of the drops from them (study/sweep/adaptive.h). */
#ifndef SF_SWEEP_TREND_H
#define SF_SWEEP_TREND_H

#include "study/column.h"
#include "study/sweep/runs.h"

enum { SF_TRENDS = 3 }; /* figures that columns have */

typedef struct sf_sweep_trend {
    const sf_plan *plan;                    /* borrowed */
    sf_columns columns;                     /* of the first finished drop */
    int numbers, number[SF_SWEEP_FACTORS];  /* factors of the geometry that are numbers */
    double thickness[SF_SWEEP_FACTORS + 1]; /* m, and m per unit of each: the pad's thickness is linear */
    const char *problem;                    /* why there is no trend; NULL: there is one; static */
} sf_sweep_trend;

/* Learns the missile's profile and the pad's thickness from the finished drops in the folder `drops`. No
 * trend, with its `problem`, if these are not known of rows that were not simulated: drops differ in more of
 * the geometry than in a thickness that is linear in the factors, or the pad has layers. */
sf_status sf_sweep_trend_learn(const sf_runs *runs, const char *drops, sf_sweep_trend *trend, sf_error *err);

/* The place of a figure among those of columns; -1: columns do not have it. */
int sf_sweep_trend_find(const char *figure);

/* Natural logarithms of the figures that columns expect of a row, [SF_TRENDS]; NaN where the foam of the
 * columns collapses. */
sf_status sf_sweep_trend_at(const sf_sweep_trend *trend, int64_t row, double *expected, sf_error *err);

#endif
