/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A form of the loading curve (fit/form) fitted to compression tests: its parameters and those of the rate
 * from loading, by least squares of the deviations over each test's largest stress (every test and every
 * point counts alike: a form's own misfit is far above the scatter of a machine); then HU, SHAPE and ALPHA
 * from unloading. */
#pragma once
#include "study/fit/compression/compression_config.h"
#include "study/fit/least_squares.h"

/* The fit of unloading by a form. */
typedef struct sf_form_unloading {
    sf_unloading_fit fit;
    double factor_rms; /* -, of f = stress of unloading over that of loading by the form */
} sf_form_unloading;

/* A test against the law. NaN: it has no unloading. */
typedef struct sf_form_test {
    double loading_rms, unloading_rms;         /* -, over the test's largest stress */
    double returned_measured, returned_fitted; /* -, part of the energy of loading that unloading returns */
    double *stress;                            /* [count] Pa, of the law; owned */
} sf_form_test;

enum { SF_CYCLE_MEMORY = 3 };

/* The law along a record of cycles. */
typedef struct sf_cycle_result {
    double rms[2][SF_CYCLES];   /* -, of loading and of unloading of each cycle, over the largest stress */
    double *stress;             /* [count] Pa, of the law; NULL: there is no record; owned */
} sf_cycle_result;

typedef struct sf_form_fit {
    const sf_compression_config *config; /* borrowed */
    double value[SF_PARAMETER_COUNT];    /* SI */
    double error[SF_FORM_UNKNOWNS];      /* relative standard error of each unknown; NaN: at its bound */
    bool at_bound[SF_FORM_UNKNOWNS];
    double loading_rms; /* -, of all tests, over the largest stress of each */
    bool has_unloading;
    sf_form_unloading unloading_of_one; /* with ALPHA = 1 */
    sf_form_unloading unloading;        /* ALPHA too */
    sf_form_test test[SF_COMPRESSION_TESTS], predicted[SF_COMPRESSION_TESTS];
    double memory_width[SF_CYCLE_MEMORY]; /* by the records, half widths; see sf_cycle_parameter */
    sf_cycle_result cycles[SF_CYCLE_RECORDS];
    double set, set_width, set_time; /* -, -, s: see sf_cycle_fit_run; NaN: too few reloads */
    sf_foam_card card; /* the material; curves owned */
} sf_form_fit;

/* `config` is borrowed until sf_form_fit_free. SF_ERR_NUMERIC if no search converges, its curve is none, or
 * it deviates by more than the tests' largest stress. */
sf_status sf_form_fit_run(const sf_compression_config *config, sf_form_fit *fit, sf_error *err);
void sf_form_fit_free(sf_form_fit *fit);

/* Root mean square of the deviations of points `first` to `last` - 1, over the largest stress; NaN: none. */
double sf_form_rms(const double *measured, double largest, const double *stress, int first, int last);

/* Compares the tests with the present card and values once more. */
sf_status sf_form_fit_follow(sf_form_fit *fit, sf_error *err);

/* True if the standard error of an unknown, by its number, is below its own value. An unknown at a bound
 * has none. */
bool sf_form_fit_determines(const sf_form_fit *fit, int unknown);

/* True if the test is slower than the reference rate of the rate factor, below which the law has no effect
 * of the rate. */
bool sf_form_fit_is_below_reference(const sf_form_fit *fit, const sf_compression_test *test);

/* True if a deviation of the fitted tests exceeds a tenth of the largest stress. */
bool sf_form_fit_is_poor(const sf_form_fit *fit);

/* ---- cycle_fit.c ---- */

/* The law with memory along records of cycles: the form's unknowns, HU, SHAPE and ALPHA, reload and drift,
 * and recovery where a record has pauses, together by least squares over the fitted cycles of all records.
 * The half width of an interval of these three is two standard errors; NaN: no record tells it, and its value
 * is that without effect. */
static inline const sf_parameter_info *sf_cycle_parameter(int number) {
    return sf_parameter_get((sf_foam_parameter)(SF_PARAMETER_RELOAD + number));
}

/* Refines `fit`, whose values are the start, by the records of its configuration; fills memory_width and
 * cycles. `set` is the strain by which reloads take up 1 % of the largest stress later than the law, which
 * has no set in a test, over the largest strain before: the mean over all cycles but the first, with the half
 * width of its 95 % interval, and the mean time without load before. It is not written into the material. */
sf_status sf_cycle_fit_run(sf_form_fit *fit, sf_error *err);

/* Largest rms, over the largest stress, of loading (0) or unloading (1) of the cycles first .. last - 1. */
double sf_cycle_fit_worst(const sf_cycle_result *cycles, int unloading, int first, int last);
