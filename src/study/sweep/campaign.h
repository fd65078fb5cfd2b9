/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the open rows of a plan in pieces, and keeps runs.csv up to date, so that a campaign that was
 * interrupted or killed resumes. */
#pragma once
#include "study/sweep/runs.h"

/* Runs `count` rows: each becomes done or failed in `runs`, or stays open. `fresh` receives the number of
 * those that had to be simulated. Errors: those that end the campaign; SF_INTERRUPTED. */
typedef struct sf_sweep_engine {
    sf_status (*run)(void *context, sf_runs *runs, int count, const int64_t *row, int *fresh, sf_error *err);
    void *context;
    int piece; /* rows at a time */
    /* True if the results of a row that is done still come from its inputs as they are now, those that
     * only its geometry knows of, too. NULL: this is not checked. */
    bool (*is_current)(void *context, const sf_runs *runs, int64_t row);
} sf_sweep_engine;

/* Chooses which open rows are run, and says what the others are. */
typedef struct sf_sweep_chooser {
    /* The next rows, `most` at the most; 0: no more are needed, or a failure. */
    int (*next)(void *context, const sf_runs *runs, int most, int64_t *row, sf_error *err);
    /* Fills in rows that were not run, when the others are done. */
    sf_status (*finish)(void *context, sf_runs *runs, sf_error *err);
    void *context;
} sf_sweep_chooser;

typedef struct sf_sweep_campaign {
    const sf_plan *plan;
    const char *folder; /* of the output; it exists */
    uint64_t inputs;    /* hash of the contents of all inputs */
    /* Computes that hash of the present inputs, before each writing of the table; NULL: the inputs stay as
     * they are. */
    sf_status (*look)(const sf_plan *plan, uint64_t *hash, sf_error *err);
    const char *drops; /* folder of the runs' folders: a row whose results have gone from there is open;
                          NULL: not looked at */
    const char *const
        *report; /* names of the files in `folder` that are made of the table, ends with NULL: they
                    are removed when the table turns to other inputs or another plan; NULL: none */
    const sf_sweep_chooser *chooser; /* NULL: all rows are run, in order */
    bool retry;  /* failed rows are done again */
    bool force;  /* another plan in the folder gives way */
    FILE *log;   /* NULL: silent */
} sf_sweep_campaign;

/* Checks that the folder is that of a campaign, and of this plan. SF_ERR_INPUT if it is of another plan,
 * without force. `*known`: it is of this one. Writes nothing. */
sf_status sf_sweep_campaign_check(const sf_sweep_campaign *c, bool *known, sf_error *err);

/* Takes over what runs.csv holds, does the rest and writes runs.csv, also when it ends early. `runs` is
 * created by sf_runs_create. SF_ERR_IO: the inputs have changed meanwhile; all rows are open then. */
sf_status sf_sweep_campaign_run(const sf_sweep_campaign *c, const sf_sweep_engine *engine, sf_runs *runs,
                                sf_error *err);

/* Reads the rows that are done, for a look without a run. `*open`: rows that a campaign looks at, which are
 * all of them if the inputs have changed since, and those that failed if they are done again. */
sf_status sf_sweep_campaign_status(const sf_sweep_campaign *c, sf_runs *runs, int64_t *open, sf_error *err);

/* The engine of a sweep that simulates drops, by study/runner.h. */

#define SF_SWEEP_LABEL "drop" /* begins the names of the drops' folders */

enum {
    SF_SWEEP_PIECE = 32,       /* rows at a time, for each drop that runs side by side */
    SF_SWEEP_ELSEWHERE = 20000 /* rows at a time by another engine, a thousand jobs of 20, which waits for the
                                  slowest job of a piece */
};

/* The context of the engine is the runner, borrowed. */
sf_sweep_engine sf_sweep_drops(sf_runner *runner, int jobs);

/* Writes by what the rows are judged, where they are series of drops (sf_run_counted_text); else "". Returns
 * true for series. */
bool sf_sweep_series_text(const sf_plan *plan, char *text, size_t size);

/* Writes drops.csv: each drop of the rows that are done, with its figures. `folder`: as below. */
sf_status sf_sweep_write_drops(const sf_staging *output, const sf_runs *runs, const char *folder,
                               sf_error *err);

/* The cost of the open runs of a plan: from the runs that are done, or else from the model of the first
 * row. */

typedef struct sf_sweep_cost {
    double seconds;    /* processor time of one run; NaN: not known, as the first row has no model */
    double bytes;      /* of its results */
    double work_bytes; /* that one run needs while it is at work */
    long long open;    /* runs */
    long long there;   /* of them at most so many have a drop's folder already */
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
