/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The joint fit of all tests: weighted least squares of point_model.h (GSL, Levenberg-Marquardt), loading
 * first and then unloading given the loading, the
 * choice of rate dependence and densification by BIC, and the 95 % interval of every number. */
#pragma once
#include "study/fit/compression/compression_kind.h"
#include "study/fit/compression/point_model.h"
#include <gsl/gsl_vector.h>

enum { SF_COMPRESSION_TABLE = 60 };

typedef enum sf_estimate_name {
    SF_ESTIMATE_E,        /* Pa */
    SF_ESTIMATE_HU,       /* - */
    SF_ESTIMATE_SHAPE,    /* - */
    SF_ESTIMATE_ALPHA,    /* - */
    SF_ESTIMATE_LOG_RATE, /* - */
    SF_ESTIMATE_ED,       /* Pa */
    SF_ESTIMATE_BETA1,    /* s-1 */
    SF_ESTIMATE_EXPONENT, /* - */
    SF_ESTIMATE_LIMIT,    /* - */
    SF_ESTIMATES
} sf_estimate_name;

/* A number with its standard error and interval; all NaN but the value if the number was not fitted. */
typedef struct sf_estimate {
    const char *name, *key, *unit; /* static storage; `key` in fit.json */
    bool present;                  /* the material has it */
    double value, error, low, high;
    const char *note; /* why it is to be taken with care, or "" ; static storage */
} sf_estimate;

/* A form that was tried. */
typedef struct sf_candidate {
    bool tried;
    int parameters;
    double chi2, bic;
} sf_candidate;

/* The misfit of one side of the tests. */
typedef struct sf_side {
    int points;
    double chi2;        /* sum of squares of deviation over sigma */
    double misfit;      /* chi2 over degrees of freedom, 1: nothing but scatter */
    double law_error;   /* over the largest stress: what was added to the scatter, as the law cannot follow */
    double factor;      /* of the variances: misfit, or where the law's error was added what is left of it */
    double correlation; /* of neighbouring deviations */
    double serial;      /* variance factor for it, 1 or more */
    double relative;    /* root mean square of the deviation over the stress (over a hundredth of the largest
                           where that is more) */
    double of_largest;  /* the same over the largest stress of the tests */
} sf_side;

typedef struct sf_compression_fit {
    sf_compression_data data;
    sf_compression_model model;
    gsl_vector *parameters; /* of the chosen form; owned */
    gsl_matrix *covariance; /* of the parameters, with the factors of both sides in it; owned */
    sf_side side[2];        /* loading; unloading, which is fitted given the loading; zeros without any */
    double chi2;            /* of both */
    double misfit;          /* of both, over the degrees of freedom */
    double quantile;        /* of Student's t for the confidence */
    double *stress;         /* [data.count] Pa, of the fit; owned */
    sf_candidate rate[SF_RATE_MODELS];
    sf_candidate rule[SF_RULES];
    sf_estimate estimate[SF_ESTIMATES];
    int table_count; /* points of the loading curves */
    double table_strain[SF_COMPRESSION_TABLE];
    int rate_count; /* loading curves: of the slowest test, or of each test */
    double table_stress[SF_COMPRESSION_TESTS][SF_COMPRESSION_TABLE]; /* Pa */
    double table_error[SF_COMPRESSION_TESTS][SF_COMPRESSION_TABLE];  /* Pa, standard error */
} sf_compression_fit;

/* Fits; `config` is borrowed until sf_compression_fit_free. SF_ERR_NUMERIC if no search converges. */
sf_status sf_compression_fit_run(const sf_compression_config *config, sf_compression_fit *fit, sf_error *err);
void sf_compression_fit_free(sf_compression_fit *fit);

/* Standard error of a quantity with this gradient [model.parameter_count] by the parameters. */
double sf_compression_error(const sf_compression_fit *fit, const double *gradient);

/* The foam card of the fit, whose curves have the temperature (K) in place of the rate where the tests have
 * one; released by the caller with sf_foam_card_free. */
sf_status sf_compression_card(const sf_compression_fit *fit, sf_foam_card *card, sf_error *err);

/* The result of the fit of tables: the fit, its card in the solver's own law, and how both stand against the
 * data. table_report.c makes the page of it. */

/* A test against the fit. */
typedef struct sf_table_test {
    sf_compression_test test; /* its arrays are the configuration's */
    const char *name;         /* the file without its folders; borrowed */
    int unloading;            /* points */
    double rms[2];            /* of deviation over sigma, loading and unloading; NaN: no such branch */
    double percent[2]; /* root mean square of deviation, % of the stress, counted as one hundredth of the
                          largest at least */
    double speed_up, difference[2], energy_error; /* of the simulated test */
} sf_table_test;

typedef struct sf_table_result {
    sf_compression_fit fit;
    sf_foam_card card;   /* of the fit; owned */
    double card_percent; /* largest difference of card and fit, counted as `percent` */
    int test_count;
    sf_table_test test[SF_COMPRESSION_TESTS];
    bool simulated;
} sf_table_result;

/* Rows of an sf_table_test: all, and those of the simulated test. */
sf_rows sf_table_test_rows(const sf_table_result *result);
extern const sf_rows sf_table_simulation_rows;

/* Phrases of the rate dependence and of sf_rule. */
const char *sf_table_rate_words(const sf_compression_fit *fit);
extern const char *const sf_table_rules[SF_RULES];

/* An estimate as a reader sees it. */
typedef struct sf_table_estimate {
    char value[64], error[64], interval[140];
} sf_table_estimate;
sf_table_estimate sf_table_estimate_of(const sf_estimate *estimate);
/* "rms deviation ...: how well a side is fitted. Returns `text`. */
const char *sf_table_misfit(const sf_side *side, char text[160]);

/* fit.gp, fit.png and report.html. */
sf_status sf_table_report_write(const struct sf_study *study, const sf_table_result *result, char *warning,
                                size_t size, sf_error *err);
