/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The foam law of material/low_density_foam.c at a material point in uniaxial compression at a constant
 * nominal rate (lateral stretches 1), as a function of the parameters that compression tests identify. The
 * loading curve is a cubic spline whose coefficients ascend. What lies beyond it is the law's own: the
 * densification (material/curve.h), the factor of unloading and the Maxwell branch
 * (material/low_density_foam.h). DAMP is left out: it is negligible at the rates of these tests.
 *
 * A parameter vector holds for every curve the logarithms of the coefficients' increments, then the other
 * parameters mapped from their bounds to the real line. */
#pragma once
#include "study/fit/bspline.h"
#include "study/fit/compression/compression_config.h"

/* The points of all tests in one list, with the scatter of each: the input of the joint fit. */
typedef struct sf_compression_data {
    const sf_compression_config *config; /* borrowed */
    int count;
    int *test;       /* [count] index into config->test; points of a branch stand together, in order; owned */
    bool *unloading; /* [count] owned */
    double *strain;  /* [count] -, not below 0; owned, with the next three behind it */
    double *stress;  /* [count] Pa */
    double *smooth;  /* [count] Pa, by the smoothing spline of the branch */
    double *sigma;   /* [count] Pa, standard deviation of the stress */
    sf_scatter scatter;
    int intervals;  /* of the loading curves' splines up to the start, before joining */
    double start;   /* -, strain from which densification is fitted */
    double end;     /* -, largest strain of all tests */
    double largest; /* Pa, largest stress of all points */
} sf_compression_data;

/* Release with sf_compression_data_free, also on failure. */
sf_status sf_compression_data_init(const sf_compression_config *config, sf_compression_data *data,
                                   sf_error *err);
void sf_compression_data_free(sf_compression_data *data);

/* First point and number of points of a branch of a test. */
void sf_compression_branch(const sf_compression_data *data, int test, bool unloading, int *first, int *count);

typedef enum sf_rule { SF_H1_AUTO, SF_H1_FREE, SF_H2, SF_RULES } sf_rule; /* theory, "Densification" */

/* Parameters beside the curve: those of loading, then those of unloading, which only its points depend on. */
typedef enum sf_number {
    SF_NUMBER_LOG_RATE, /* -, factor 1 + c ln(rate/slowest rate) */
    SF_NUMBER_ED,       /* Pa */
    SF_NUMBER_BETA1,    /* s-1 */
    SF_NUMBER_EXPONENT, /* - */
    SF_NUMBER_LIMIT,    /* - */
    SF_NUMBER_HU,       /* - */
    SF_NUMBER_SHAPE,    /* - */
    SF_NUMBER_ALPHA,    /* - */
    SF_NUMBERS
} sf_number;

typedef struct sf_compression_form {
    sf_rate_model rate;
    sf_rule rule;
    bool alpha; /* ALPHA is fitted; else it is 1 */
} sf_compression_form;

/* A bounded parameter: logarithmic between positive bounds, else linear; high = INFINITY: not bounded. */
typedef struct sf_number_range {
    int index; /* in the parameter vector, -1: not fitted */
    bool logarithmic;
    double low, high;
    double fixed; /* value when not fitted */
} sf_number_range;

typedef struct sf_compression_model {
    const sf_compression_data *data; /* borrowed */
    sf_compression_form form;
    int curve_count;
    int parameter_count;
    int loading_count; /* the first of them; the rest is of unloading */
    sf_number_range range[SF_NUMBERS];
    sf_spline spline;                            /* on [0, data->start] */
    double *value_row;                           /* [data->count][spline.count] up to the start; owned */
    double *area_row;                            /* [data->count][spline.count], of unloading points; owned */
    double start_row[3][SF_SPLINE_COEFFICIENTS]; /* value, slope, integral at the start */
    double peak_row[SF_COMPRESSION_TESTS][2][SF_SPLINE_COEFFICIENTS]; /* value, integral at the turn */
} sf_compression_model;

/* Release with sf_compression_model_free, also on failure. */
sf_status sf_compression_model_init(const sf_compression_data *data, sf_compression_form form,
                                    sf_compression_model *model, sf_error *err);
void sf_compression_model_free(sf_compression_model *model);

/* Sets the start of a search; `decay` (0 to 1) places BETA1 within its bounds. */
void sf_compression_guess(const sf_compression_model *model, double decay, gsl_vector *parameters);

/* Stress (Pa) of every point of loading or of unloading; the others are left as they are. */
void sf_compression_predict(const sf_compression_model *model, const gsl_vector *parameters, bool unloading,
                            double *stress);

double sf_compression_number(const sf_compression_model *model, const gsl_vector *parameters,
                             sf_number number);
/* Exponent of the densification, also where A = 0 sets it. */
double sf_compression_exponent(const sf_compression_model *model, const gsl_vector *parameters);

/* Stress (Pa) of the loading curve at the rate of a test, at 0 <= strain <= data->end. Without the Maxwell
 * stress. */
double sf_compression_curve(const sf_compression_model *model, const gsl_vector *parameters, int test,
                            double strain);

/* A Maxwell branch of 1 Pa along a test; begins as zeros. */
typedef struct sf_compression_walk {
    double strain;  /* - */
    double held;    /* Pa, second Piola-Kirchhoff stress */
    bool unloading; /* the test has turned */
} sf_compression_walk;

/* Compressive nominal stress (Pa) of the branch at the next strain of a test that turns at `turn`. */
double sf_compression_maxwell(double decay_rate, double rate, double turn, double strain, bool unloading,
                              sf_compression_walk *walk);
