/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The joint fit of all tests: weighted least squares of compression_model.h (GSL, Levenberg-Marquardt), loading
 * first and then unloading given the loading, the
 * choice of rate dependence and densification by BIC, and the 95 % interval of every number. */
#pragma once
#include "study/fit/compression/compression_model.h"
#include "study/fit/form/form.h"

enum {
    SF_COMPRESSION_TABLE = 60,
    SF_COMPRESSION_PARAMETERS = SF_COMPRESSION_TESTS * SF_SPLINE_COEFFICIENTS + SF_NUMBERS
};

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

/* A function of the parameters, of a number or a test and a strain. */
typedef double sf_compression_quantity(const sf_compression_model *model, const gsl_vector *parameters,
                                       int which, double at);
/* Standard error of a quantity; moves the parameters and puts them back. */
double sf_compression_error(const sf_compression_fit *fit, sf_compression_quantity *quantity, int which,
                            double at);

/* Strain rate (1/s) of a loading curve, 0 of the only one for all rates; its temperature (K) where the tests
 * have one. */
double sf_compression_curve_rate(const sf_compression_fit *fit, int curve);

/* The foam card of the fit, whose curves have the temperature (K) in place of the rate where the tests have
 * one; released by the caller with sf_foam_card_free. */
sf_status sf_compression_card(const sf_compression_fit *fit, sf_foam_card *card, sf_error *err);

