/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_STUDY_FIT_DROP_DROP_REPORT_PARTS_H
#define SF_STUDY_FIT_DROP_DROP_REPORT_PARTS_H
#include "io/staging.h"
#include "report/html.h"
#include "report/row.h"
#include "study/fit/drop/average.h"
#include "study/fit/drop/drop_fit.h"

/* The parts of the output of `softfall-fit drop`, one file for what is reported: each writes its share of
 * report.html, fit.json, the text for the terminal and the data of the picture. */

/* ---- numbers that every form shows: report_numbers.c ---- */

typedef struct sf_estimate_shown {
    const sf_parameter_info *about;
    double value, low, high; /* SI, 95 % */
    double prior;            /* SI */
    double shrinkage;        /* standard deviation after the data over the one before */
} sf_estimate_shown;

/* Half width of a 95 % interval in standard deviations: of the normal distribution, or of Student's t where
 * the scale of the data's errors is itself estimated. */
double sf_report_half_width(const sf_drop_fit *fit);
/* Returns the estimate of unknown number k. */
sf_estimate_shown sf_report_estimate(const sf_drop_fit *fit, int k);
/* A number of a drop, simulated, in its unit; the standard deviation of its logarithm by the parameters. */
double sf_report_response(const sf_drop_fit *fit, int d, int which);
double sf_report_response_sd(const sf_drop_fit *fit, int d, int which);
/* True if the number of a drop is in the reports; one that is not measured may be asked for by other
 * drops. */
bool sf_report_shows(const sf_drop_fit *fit, int d, int kind);
/* "a_max (g)" into `text`, which is returned. */
const char *sf_report_heading(int kind, char *text, size_t size);
/* Root mean square of a measured curve's residuals, g; NaN without. */
double sf_report_curve_rmse(const sf_drop_fit *fit, int d);
/* Strains between which nine tenths of the information lie. */
void sf_report_informed_strains(const sf_drop_fit *fit, double *low, double *high);
/* A cell "+1.2 %": the response, a logarithm, against what was measured. */
void sf_report_put_difference(sf_html_table *table, double scaled, double measured);

/* ---- measured drops, their speeds, and predictions: report_drops.c ---- */

void sf_report_drops_html(FILE *page, const sf_drop_fit *fit);
void sf_report_speeds_html(FILE *page, const sf_drop_fit *fit);
/* Write what the accelerometer's mount and high pass are taken to do; nothing without them. */
void sf_report_chain_html(FILE *page, const sf_drop_fit *fit);
void sf_report_chain_print(FILE *f, const sf_drop_fit *fit);
void sf_report_predictions_html(FILE *page, const sf_drop_fit *fit);
void sf_report_drops_json(sf_json *json, const sf_drop_fit *fit);
void sf_report_drops_print(FILE *file, const sf_drop_fit *fit);
/* fit-drops.csv */
sf_status sf_report_drops_csv(const sf_drop_fit *fit, const sf_staging *output, sf_error *err);

/* ---- compression tests and cushion curves: report_joint.c ---- */

void sf_report_joint_html(FILE *page, const sf_drop_fit *fit);
void sf_report_joint_json(sf_json *json, const sf_drop_fit *fit);
void sf_report_joint_print(FILE *file, const sf_drop_fit *fit);

/* ---- parameters: report_parameters.c ---- */

void sf_report_parameters_html(FILE *page, const sf_drop_fit *fit);
void sf_report_sensitivities_html(FILE *page, const sf_drop_fit *fit);
void sf_report_parameters_json(sf_json *json, const sf_drop_fit *fit);
void sf_report_parameters_print(FILE *file, const sf_drop_fit *fit);

/* ---- the curve and which strains the drops see: report_curve.c ---- */

void sf_report_curve_html(FILE *page, const sf_drop_fit *fit);
/* fit-curve.csv */
sf_status sf_report_curve_csv(const sf_drop_fit *fit, const sf_staging *output, sf_error *err);

/* ---- files: report_material.c, report_picture.c ---- */

/* The material file with its comments; `average`: NULL without a posterior. */
sf_status sf_report_material(const sf_drop_fit *fit, const sf_drop_average *average, const char *input_path,
                             const sf_staging *output, sf_error *err);
/* fit.gp and fit.png; `warning` (size bytes) says why there is no picture, or is "". */
sf_status sf_report_picture(const sf_drop_fit *fit, const sf_staging *output, char *warning, size_t size,
                            sf_error *err);
#endif
