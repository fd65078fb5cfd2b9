/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The engine of a sweep that simulates drops, by study/runner.h. */
#ifndef SF_STUDY_SWEEP_DROPS_H
#define SF_STUDY_SWEEP_DROPS_H

#include "study/sweep/campaign.h"
#include "study/sweep/runs.h"

#define SF_SWEEP_LABEL "drop" /* begins the names of the drops' folders */

enum {
    SF_SWEEP_PIECE = 32,       /* rows at a time, for each drop that runs side by side */
    SF_SWEEP_ELSEWHERE = 20000 /* rows at a time by another engine, a thousand jobs of 20, which waits for the
                                  slowest job of a piece */
};

/* The context of the engine is the runner, borrowed. */
sf_sweep_engine sf_sweep_drops(sf_runner *runner, int jobs);

/* The cost of the open runs of a plan: from the runs that are done, or else from the model of the first
 * row. */

typedef struct sf_sweep_cost {
    double seconds;    /* processor time of one run; NaN: not known, as the first row has no model */
    double bytes;      /* of its results */
    double work_bytes; /* that one run needs while it is at work */
    int64_t open;      /* runs */
    int64_t there;     /* of them at most so many have a drop's folder already */
    char basis[512];   /* where that comes from */
} sf_sweep_cost;

/* Estimates the cost of `open` rows, of which some may have a figure of earlier inputs. `folder`: that of
 * the results' folders ("DIR/runs"). Without a finished run the model of the first row is built in memory. */
sf_status sf_sweep_cost_estimate(const sf_runs *runs, int64_t open, const char *folder, sf_sweep_cost *cost,
                                 sf_error *err);

/* SF_ERR_INPUT if the file system of `folder` has too little room for all runs, and for `jobs` at work. */
sf_status sf_sweep_cost_check_disk(const sf_sweep_cost *cost, const char *folder, int jobs, sf_error *err);

/* `jobs` 0: on machines that are not known. */
void sf_sweep_cost_print(FILE *out, const sf_sweep_cost *cost, int jobs);

#endif
