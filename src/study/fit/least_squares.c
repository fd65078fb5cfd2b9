/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/least_squares.h"

gsl_vector *sf_vector(size_t size, sf_error *err) {
    gsl_vector *vector = gsl_vector_calloc(size);
    if (!vector)
        SF_NO_MEMORY(err, "%zu numbers", size);
    return vector;
}

gsl_matrix *sf_matrix(size_t rows, size_t columns, sf_error *err) {
    gsl_matrix *matrix = gsl_matrix_calloc(rows, columns);
    if (!matrix)
        SF_NO_MEMORY(err, "a matrix of %zu by %zu", rows, columns);
    return matrix;
}
