/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors and matrices of GSL that are released at the end of their block. */
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
