/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs of a plan that are simulated once more with all fields, for their own report.html and view.html. */
#pragma once
#include "report/row.h"
#include "study/sweep/runs.h"

enum { SF_SWEEP_VIEWS = 50 };

typedef struct sf_sweep_view {
    int64_t row;
    char reason[160];
    char folder[64]; /* of its report, in DIR/views; "": there is none */
    bool has_view;
    char problem[512]; /* why it has none, or why its run failed; "": none */
} sf_sweep_view;

typedef struct sf_sweep_views {
    int count;
    sf_sweep_view view[SF_SWEEP_VIEWS];
} sf_sweep_views;

/* Chooses rows by `words`: "all", "worst", "limit" and numbers of runs, with commas between them. With `runs`
 * NULL the words are checked. SF_ERR_INPUT: one is none of these, or there are too many rows. */
sf_status sf_sweep_views_choose(const char *words, const sf_plan *plan, const sf_runs *runs,
                                sf_sweep_views *views, sf_error *err);

/* Makes their reports in `directory`/views, one after the other on this machine; drops that are there are
 * used again. The failure of a run is in its view. Errors: those of the folders; SF_INTERRUPTED. */
sf_status sf_sweep_views_make(const sf_plan *plan, const char *directory, int threads, sf_sweep_views *views,
                              sf_error *err);

/* Parts of report.html, which is in the directory, and of sweep.json. */
void sf_sweep_views_put(FILE *page, const sf_runs *runs, const sf_sweep_views *views);
void sf_sweep_views_json(sf_json *json, const sf_sweep_views *views);
