/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A search for the least sum of squares (GSL, Levenberg-Marquardt with trust region, derivatives by
 * differences). */
#ifndef SF_STUDY_FIT_LEAST_SQUARES_H
#define SF_STUDY_FIT_LEAST_SQUARES_H

#include <gsl/gsl_matrix.h>

/* Deviations [count] at parameters; GSL_SUCCESS, or another code where there are none. */
typedef int sf_deviations(const gsl_vector *x, void *data, gsl_vector *out);

/* The sum of squares at the end, or infinity if there is none; `x` in and out. The covariance for a variance
 * of 1 into `covariance` unless it is NULL. GSL's error handler must be off. */
double sf_least_squares(sf_deviations *deviations, void *data, size_t count, gsl_vector *x,
                        gsl_matrix *covariance);

#endif
