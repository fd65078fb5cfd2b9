/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Output of softfall-cfh: cfh.json, cfh.csv, cfh_band.csv, cfh_draws.csv, report.html, and the lines on the
 * terminal. */
#pragma once
#include "study/cfh/spread.h"

typedef struct sf_cfh_report {
    const char *case_path;
    const char *material;               /* file, NULL: the case's own */
    const char *case_text, *parameters; /* of the case, as in sf_case */
    const char *command_line;
    const char *rig_path;  /* NULL: free fall */
    const char *posterior; /* folder of the draws, NULL: none */
    const sf_cfh_plan *plan;
    const sf_cfh_rig *rig;
    const sf_cfh_points *points;
    const sf_cfh_result *result;
    sf_cfh_step ending;
    double mass; /* kg */
    char counted[SF_RUNNER_COUNTED]; /* sf_run_counted_text: by what a height is judged */
    const sf_cfh_foams *foams;
    const sf_cfh_spread *spread;        /* NULL: no interval of the foam is known */
    char no_interval[SF_CFH_NOTE_SIZE]; /* with `posterior`: why there is none; "": there is one */
} sf_cfh_report;

enum { SF_CFH_VERDICT_SIZE = 2 * SF_CFH_NOTE_SIZE + 400 };

/* ---- texts and files of data (cfh_report.c) ---- */

extern const char sf_cfh_caution[]; /* a sentence that stands in every output */

/* The critical fall height in a sentence or two. */
void sf_cfh_verdict_text(const sf_cfh_report *report, char *text, size_t size);
/* The same on the rig; "" without a rig or a height. */
void sf_cfh_rig_text(const sf_cfh_report *report, char *text, size_t size);
/* "1.52 to 1.85 m", or a bound, of which the end of the heights looked at. Returns `text`. */
const char *sf_cfh_interval_text(const sf_cfh_interval *interval, char *text, size_t size);
/* Writes the sentences of a warning, or "": draws that have no crossing of their own or one beyond the
 * simulated heights, checks that failed, a material of the case that is none of the draws'. */
void sf_cfh_draws_text(const sf_cfh_spread *spread, char *text, size_t size);
/* Returns a sentence if the draws state no errors of the responses, else "". Static storage. */
const char *sf_cfh_response_text(const sf_cfh_spread *spread);
/* "crossed", "not reached", ...; static storage. */
const char *sf_cfh_side_word(const sf_cfh_crossing *crossing);

/* Returns "", "above " or "below ", the side of `*height` (m) on which the critical height lies; NULL: it is
 * not determined. */
const char *sf_cfh_bound(const sf_cfh_report *report, double *height);

/* Tables of cfh.json and report.html: a row for each simulated point, and for each simulated draw. */
typedef struct sf_cfh_point_row {
    sf_cfh_point p;
    double residual[SF_CFH_CRITERIA]; /* ln(value / fit); NaN: not in the fit */
    double fit[SF_CFH_CRITERIA];      /* g, 1; NaN: not in the fit */
    double rig_height;                /* m */
    const char *grade, *verdict;      /* that of the run; and "failed" */
} sf_cfh_point_row;
sf_rows sf_cfh_point_rows(const sf_cfh_report *report);
sf_records sf_cfh_point_records(const sf_cfh_report *report, sf_cfh_point_row list[SF_CFH_MAX_POINTS]);
sf_rows sf_cfh_check_rows(void);

/* The members `name`_low_m, `name`_median_m, `name`_high_m and `name`_open ("no", "above", "below", "both");
 * all null with `interval` NULL. An interval wholly beyond the heights looked at has the end of these as its
 * low or high. */
void sf_cfh_put_interval_json(sf_json *json, const char *name, const sf_cfh_interval *interval);
sf_status sf_cfh_write_json(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
sf_status sf_cfh_write_csv(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
/* cfh_band.csv, cfh_draws.csv and cfh_curves.csv, if there is an interval. */
sf_status sf_cfh_write_draws(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
void sf_cfh_print(FILE *out, const sf_cfh_report *report);

/* ---- the picture and the page (cfh_page.c) ---- */

/* cfh.gp and cfh.png: a_max and HIC over the drop height with limits, points, fits and crossings. `warning`
 * (size bytes) says why there is no picture, or is "". */
sf_status sf_cfh_plot(const sf_staging *output, const sf_cfh_report *report, char *warning, size_t size,
                      sf_error *err);
/* report.html, after sf_cfh_plot, whose picture it takes in. */
sf_status sf_cfh_write_page(const sf_staging *output, const sf_cfh_report *report, sf_error *err);
