/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A search for the least sum of squares (GSL, Levenberg-Marquardt with trust region, derivatives by
 * differences). */
#pragma once
#include "base/error.h"
#include <gsl/gsl_matrix.h>

/* Zeros; NULL without memory. */
gsl_vector *sf_vector(size_t size, sf_error *err);
gsl_matrix *sf_matrix(size_t rows, size_t columns, sf_error *err);

/* Deviations [count] at parameters; GSL_SUCCESS, or another code where there are none. */
typedef int sf_deviations(const gsl_vector *x, void *data, gsl_vector *out);

/* The sum of squares at the end, or infinity if there is none; `x` in and out. The covariance for a variance
 * of 1 into `covariance` unless it is NULL. GSL's error handler must be off. */
double sf_least_squares(sf_deviations *deviations, void *data, size_t count, gsl_vector *x,
                        gsl_matrix *covariance);

/* Correlation of neighbouring deviations, r: the variance of a mean of them grows by (1 + r)/(1 - r). */
double sf_neighbour_correlation(size_t count, const double *deviation);
