/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "study/sweep/analysis.h"

/* Runs of a plan that are simulated once more with all fields, for their own report.html and view.html. */

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

/* sweep.json, report.html and the lines on the terminal. */

typedef struct sf_sweep_report {
    const sf_plan *plan;
    const sf_runs *runs;
    const sf_analysis *analysis;
    const char *command_line;
    const sf_sweep_views *views;
    const char *series; /* sf_sweep_series_text */
    int64_t coarse;     /* drops that were simulated; 0: the plan asks for none */
} sf_sweep_report;

sf_status sf_sweep_write_json(const sf_staging *output, const sf_sweep_report *report, sf_error *err);
/* After sf_sweep_plot, whose pictures the page takes in. */
sf_status sf_sweep_write_page(const sf_staging *output, const sf_sweep_report *report, sf_error *err);
void sf_sweep_print(FILE *out, const sf_sweep_report *report);

/* The factors, their number of values and the number of runs, and the first `rows` of them. */
void sf_sweep_print_table(FILE *out, const sf_plan *plan, int rows);

/* The pictures of a sweep, each a gnuplot script that holds its data. */

/* The pictures there may be, NULL at the end, and what each shows. */
typedef struct sf_sweep_picture {
    const char *name, *caption;
} sf_sweep_picture;
const sf_sweep_picture *sf_sweep_pictures(void);

/* Writes NAME.gp and NAME.png of each picture that the runs allow. `folder`: that of the results' folders
 * ("DIR/runs"). `warning`: as sf_chart_write. */
sf_status sf_sweep_plot(const sf_staging *output, const sf_analysis *analysis, const char *folder,
                        char *warning, size_t size, sf_error *err);
