/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep.json, report.html and the lines on the terminal. */
#pragma once
#include "io/staging.h"
#include "study/sweep/analysis.h"
#include "study/sweep/views.h"
#include <stdio.h>

typedef struct sf_sweep_report {
    const sf_plan *plan;
    const sf_runs *runs;
    const sf_analysis *analysis;
    const char *command_line;
    const sf_sweep_views *views;
    const char *series; /* sf_sweep_series_text */
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
