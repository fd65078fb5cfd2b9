/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A campaign that simulates only the rows which it needs: every figure of the plan has a wish for its error,
 * and a row is predicted as soon as its 95 % intervals are within these wishes. It is predicted by Gaussian
 * processes (study/column.h) of the difference between the drops and their columns (below), or their
 * coarse drops.
 * Further processes watch whether the row's figures can be used and are defined: a row that may be near the
 * anvil, beyond its foam's data, in contact at the end of its run, giving back energy that it dissipated,
 * failing or without one of the figures is simulated; a row of which one of these is expected with 70 % at
 * least stays open. The intervals are widened until they hold rows that were predicted from others. */
#pragma once
#include "study/column.h"
#include "study/sweep/campaign.h"

typedef struct sf_sweep_adaptive sf_sweep_adaptive;

/* `drops`: the folder of the runs' folders; NULL: there are no results, and no columns. `jobs`: drops side by
 * side. `log`: NULL: silent. All borrowed. Release with sf_sweep_adaptive_free. NULL on failure. */
sf_sweep_adaptive *sf_sweep_adaptive_new(const sf_plan *plan, const char *drops, int jobs, FILE *log,
                                         sf_error *err);
void sf_sweep_adaptive_free(sf_sweep_adaptive *adaptive);

/* Takes the place of columns: the rows of the same plan by coarse drops, simulated or predicted within half
 * of the accuracy. `runs`: after their campaign, of which `coarse` was the chooser; both borrowed. A row
 * whose coarse figures cannot be used is not predicted. */
void sf_sweep_adaptive_correct(sf_sweep_adaptive *adaptive, const sf_sweep_adaptive *coarse,
                               const sf_runs *runs);

/* The chooser of a campaign; its context is `adaptive`, borrowed. */
sf_sweep_chooser sf_sweep_adaptive_chooser(sf_sweep_adaptive *adaptive);

/* Rows of the first round: simulated before anything is predicted. */
int64_t sf_sweep_adaptive_design(const sf_plan *plan);

/* Figures of the rows of a plan by columns (study/column.h) of 1.35 times the area below the missile, as the
 * foam beside it carries, too. Their pad is learnt from the finished drops. A Gaussian process then predicts
 * the difference of the drops from them. */

/* Figures that columns have, the time of contact, and the time from first contact to the end of the run. */
enum {
    SF_TREND_A_MAX,
    SF_TREND_HIC,
    SF_TREND_REBOUND,
    SF_TREND_STRAIN,
    SF_TREND_NARROWER, /* the first of four changes of the figures before, by columns of the area itself */
    SF_TREND_WIDER = 2 * SF_TREND_NARROWER,       /* and of four, by columns of 1.35^2 times the area */
    SF_TREND_INDENTATION = 3 * SF_TREND_NARROWER, /* the figures before this one are inputs of processes */
    SF_TREND_CONTACT,                             /* ms */
    SF_TREND_BEYOND, /* -, no logarithm: share of the work beyond the foam's data; 1: the columns collapse */
    SF_TREND_TIME,   /* ms; of every row whose case can be read */
    SF_TRENDS
};

typedef struct sf_sweep_trend {
    const sf_plan *plan;                    /* borrowed */
    sf_columns columns;                     /* of the finished drop on the thickest pad */
    int numbers, number[SF_SWEEP_FACTORS];  /* factors of the geometry that are numbers */
    double thickness[SF_SWEEP_FACTORS + 1]; /* m, and m per unit of each: the pad's thickness is linear */
    double step;                            /* m, height of a column; 0: all drops have one profile */
    double profile[SF_COLUMNS][SF_SWEEP_FACTORS + 1]; /* m2, and m2 per unit of each: areas of the columns */
    const char *problem;                              /* why there is no trend; NULL: there is one; static */
} sf_sweep_trend;

/* True if the first row is no drop of a missile on a pad of one material: then there is no trend. */
bool sf_sweep_is_beyond_columns(const sf_plan *plan);

/* Learns the missile's profile and the pad's thickness from the finished drops in the folder `drops`. No
 * trend, with its `problem`, if these are not known of rows that were not simulated: the thickness or the
 * areas of the missile below each height are not linear in the factors, or the pad has layers. */
sf_status sf_sweep_trend_learn(const sf_runs *runs, const char *drops, sf_sweep_trend *trend, sf_error *err);

/* The place of a figure among those of columns; -1: columns do not have it. */
int sf_sweep_trend_find(const char *figure);

/* Computes what columns expect of a row, [SF_TRENDS], natural logarithms but where their list says otherwise;
 * NaN where the foam of the columns collapses, or stays in contact. Without a trend 0, but for the time. */
sf_status sf_sweep_trend_at(const sf_sweep_trend *trend, int64_t row, double *expected, sf_error *err);
