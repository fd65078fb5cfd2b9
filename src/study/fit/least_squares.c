/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/least_squares.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>

enum { TURNS = 200 };

gsl_vector *sf_vector(size_t size, sf_error *err) {
    gsl_vector *vector = gsl_vector_calloc(size);
    if (!vector)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for %zu numbers", size);
    return vector;
}

gsl_matrix *sf_matrix(size_t rows, size_t columns, sf_error *err) {
    gsl_matrix *matrix = gsl_matrix_calloc(rows, columns);
    if (!matrix)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a matrix of %zu by %zu", rows, columns);
    return matrix;
}

double sf_least_squares(sf_deviations *deviations, void *data, size_t count, gsl_vector *x,
                        gsl_matrix *covariance) {
    gsl_multifit_nlinear_fdf fdf = {.f = deviations, .n = count, .p = x->size, .params = data};
    gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
    gsl_multifit_nlinear_workspace *work =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, count, x->size);
    double sum = INFINITY;
    int info;
    if (work && gsl_multifit_nlinear_init(x, &fdf, work) == GSL_SUCCESS) {
        gsl_multifit_nlinear_driver(TURNS, 1e-10, 1e-10, 0, NULL, NULL, &info, work);
        sum = 0;
        for (size_t i = 0; i < count; i++)
            sum += pow(gsl_vector_get(gsl_multifit_nlinear_residual(work), i), 2);
        gsl_vector_memcpy(x, gsl_multifit_nlinear_position(work));
        if (covariance)
            gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(work), 1e-14, covariance);
    }
    gsl_multifit_nlinear_free(work);
    return isfinite(sum) ? sum : INFINITY;
}

double sf_neighbour_correlation(size_t count, const double *deviation) {
    double top = 0, bottom = 0;
    for (size_t i = 0; i < count; i++) {
        bottom += deviation[i] * deviation[i];
        top += i > 0 ? deviation[i] * deviation[i - 1] : 0;
    }
    return bottom > 0 ? top / bottom : 0;
}
