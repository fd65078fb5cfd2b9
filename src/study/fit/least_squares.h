/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A search for the least sum of squares (GSL, Levenberg-Marquardt with trust region, derivatives by
 * differences). */
#pragma once
#include "base/error.h"
#include <math.h>
#include <gsl/gsl_matrix.h>

/* Return zeros, or NULL without memory. */
gsl_vector *sf_vector(size_t size, sf_error *err);
gsl_matrix *sf_matrix(size_t rows, size_t columns, sf_error *err);

/* `SF_VECTOR *x = sf_vector(3, err)` is released at the end of its block; so is a matrix. */
#define SF_VECTOR SF_OWNED_BY(sf_release_vector) gsl_vector
#define SF_MATRIX SF_OWNED_BY(sf_release_matrix) gsl_matrix

static inline void sf_release_vector(gsl_vector **vector) {
    gsl_vector_free(*vector);
}

static inline void sf_release_matrix(gsl_matrix **matrix) {
    gsl_matrix_free(*matrix);
}

/* Deviations [count] at parameters; GSL_SUCCESS, or another code where there are none. */
typedef int sf_deviations(const gsl_vector *x, void *data, gsl_vector *out);

/* Minimises from `x`, into which it puts the end; returns the sum of squares there, or infinity if there is
 * none. Puts the covariance for a variance of 1 into `covariance` unless it is NULL. GSL's error handler must
 * be off. */
double sf_least_squares(sf_deviations *deviations, void *data, size_t count, gsl_vector *x,
                        gsl_matrix *covariance);

/* Fills `x` with start `number`, from 0 on, of a search; returns false if there is none. */
typedef bool sf_start(void *data, int number, gsl_vector *x);

/* Returns the least sum of the searches from all starts, and puts its place into `best`. */
double sf_least_squares_from(sf_start *start, sf_deviations *deviations, void *data, size_t count,
                             gsl_vector *best);

/* Maps the real line to 0..1. */
static inline double sf_logistic(double x) {
    return 1 / (1 + exp(-x));
}

/* True if a part of a range is at one of its ends. */
static inline bool sf_is_at_end(double part) {
    return part < 1e-3 || part > 1 - 1e-3;
}

/* Fitted HU, SHAPE and ALPHA of unloading, between their bounds. */
typedef struct sf_unloading_fit {
    double value[3];
    bool at_bound[3];
    double rms; /* -, of the stress, over the largest of its test; NaN: no search converges */
} sf_unloading_fit;

/* Data of the fit of unloading. */
typedef struct sf_unloading_points {
    int count;
    double *measured, *loading; /* [count] stress, and that of loading at the strain, in one unit */
    double *viscous;            /* [count] what the rate adds; NULL: nothing */
    double *ratio;              /* [count] W over its largest */
    double scale;               /* by which stresses are divided */
    bool one;                   /* ALPHA is 1 */
    int starts;                 /* of the search, at most 4 */
} sf_unloading_points;

/* Fits HU, SHAPE and ALPHA to the points by least squares. GSL's error handler must be off. */
sf_unloading_fit sf_unloading_search(sf_unloading_points *points);

/* Correlation of neighbouring deviations, r: the variance of a mean of them grows by (1 + r)/(1 - r). */
double sf_neighbour_correlation(size_t count, const double *deviation);
