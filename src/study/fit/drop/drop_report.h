/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The output of `softfall-fit drop`: report.html, fit.json, fit.png with its data, and the material file. */
#pragma once
#include "study/fit/drop/inference.h"
#include "study/setup.h"

/* Writes everything into the staging directory of the study; `fit` is that of the material, `average` the
 * posterior of all models (NULL: none); `warning` (size bytes) says why there is no picture, or is "". */
sf_status sf_drop_report_write(const sf_drop_fit *fit, const sf_drop_average *average, const sf_study *study,
                               char *warning, size_t size, sf_error *err);

/* The short form, for the terminal. */
void sf_drop_report_print(const sf_drop_fit *fit, FILE *file);

/* ---- internal: drop_files.c writes all but the page, fit.json and the text of the terminal ---- */

typedef struct sf_estimate_shown {
    const sf_parameter_info *about;
    const char *blank;       /* before its unit */
    double value, low, high; /* in its unit, 95 % */
    double per_unit;         /* SI */
    double shrinkage;        /* standard deviation after the data over the one before */
} sf_estimate_shown;

/* Returns the estimate of unknown number k. */
sf_estimate_shown sf_drop_estimate(const sf_drop_fit *fit, int k);
/* Half width of a 95 % interval in standard deviations: of the normal distribution, or of Student's t where
 * the scale of the data's errors is itself estimated. */
double sf_drop_half_width(const sf_drop_fit *fit);
/* A number of a drop, simulated, in its unit. */
double sf_drop_response(const sf_drop_fit *fit, int d, int kind);
/* True if the number of a drop is in the reports; one that is not measured may be asked for by other
 * drops. */
bool sf_drop_shows(const sf_drop_fit *fit, int d, int kind);
/* Root mean square of a measured curve's residuals, g; NaN without. */
double sf_drop_curve_rmse(const sf_drop_fit *fit, int d);
/* Strains between which nine tenths of the information lie. */
void sf_drop_informed_strains(const sf_drop_fit *fit, double *low, double *high);
/* Sum of the information of all strain bins. */
double sf_drop_information(const sf_drop_fit *fit);
/* Lines about the accelerometer's mount and high pass; none without them. */
void sf_drop_chain_print(FILE *file, const sf_drop_fit *fit);

/* A number of the accelerometer's chain, as it is shown. */
typedef struct sf_chain_shown {
    const char *name, *unit, *blank;
    double given, sd, value, low, high; /* 95 % */
} sf_chain_shown;
/* Fills `shown` with the numbers that the chain has; returns how many. */
int sf_drop_chain_list(const sf_drop_fit *fit, sf_chain_shown shown[SF_SIGNAL_CHAIN]);

/* fit-curve.csv, fit-drops.csv, fit.gp with fit.png, and the material file with its comments. */
sf_status sf_drop_files_write(const sf_drop_fit *fit, const sf_drop_average *average, const sf_study *study,
                              char *warning, size_t size, sf_error *err);

/* Runs `softfall-fit drop FIT.cfg -o DIR` and returns the exit code; argv[0] is the name of the program. */
int sf_fit_drop_main(int argc, char **argv);
