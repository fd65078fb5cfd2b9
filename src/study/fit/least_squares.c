/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/least_squares.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include "material/memory.h"

enum { TURNS = 200 };

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

double sf_least_squares_from(sf_start *start, sf_deviations *deviations, void *data, size_t count,
                             gsl_vector *best) {
    SF_VECTOR *x = gsl_vector_alloc(best->size);
    double least = INFINITY;
    for (int k = 0; start(data, k, x); k++) {
        double sum = sf_least_squares(deviations, data, count, x, NULL);
        if (sum < least) {
            least = sum;
            gsl_vector_memcpy(best, x);
        }
    }
    return least;
}

/* ---- unloading ---- */

static void take_unloading(const sf_unloading_points *p, const gsl_vector *x, double value[3]) {
    static const double least[3] = {1e-4, 0.05, 0.1}, range[3] = {1 - 1e-4, 20, 4.9};
    for (size_t k = 0; k < 3; k++)
        value[k] = k == 2 && p->one ? 1 : least[k] + range[k] * sf_logistic(gsl_vector_get(x, k));
}

static int deviate_unloading(const gsl_vector *x, void *data, gsl_vector *out) {
    const sf_unloading_points *p = data;
    double v[3];
    take_unloading(p, x, v);
    for (int k = 0; k < p->count; k++)
        gsl_vector_set(out, (size_t)k,
                       (sf_unloading_factor(v[0], v[1], v[2], p->ratio[k]) * p->loading[k] +
                        (p->viscous ? p->viscous[k] : 0) - p->measured[k]) /
                           p->scale);
    return GSL_SUCCESS;
}

static bool start_unloading(void *data, int number, gsl_vector *x) {
    static const double starts[][3] = {{-2, -3, -2}, {-3, -4, -3}, {-2, -1, -1.5}, {-5, -2, -3}};
    for (size_t k = 0; k < x->size; k++)
        gsl_vector_set(x, k, starts[number % 4][k]);
    return number < ((const sf_unloading_points *)data)->starts;
}

sf_unloading_fit sf_unloading_search(sf_unloading_points *p) {
    sf_unloading_fit out = {.rms = NAN};
    SF_VECTOR *x = gsl_vector_alloc(p->one ? 2 : 3);
    double least = sf_least_squares_from(start_unloading, deviate_unloading, p, (size_t)p->count, x);
    if (!isfinite(least))
        return out;
    take_unloading(p, x, out.value);
    for (size_t k = 0; k < x->size; k++)
        out.at_bound[k] = sf_is_at_end(sf_logistic(gsl_vector_get(x, k)));
    out.rms = sqrt(least / p->count);
    return out;
}

double sf_neighbour_correlation(size_t count, const double *deviation) {
    double top = 0, bottom = 0;
    for (size_t i = 0; i < count; i++) {
        bottom += deviation[i] * deviation[i];
        top += i > 0 ? deviation[i] * deviation[i - 1] : 0;
    }
    return bottom > 0 ? top / bottom : 0;
}
