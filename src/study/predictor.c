/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/column.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multimin.h>
#include <gsl/gsl_sort.h>

enum { MOST_FOR_LENGTHS = 250, STEPS = 60, LEAST_FOR_CALIBRATION = 20, FOLDS = 8 };
/* Normal prior of ln(length) and ln(nugget): it holds lengths that the points do not determine. The lengths
 * of drops over their columns are long; from short ones the search often ends in a worse maximum. */
static const double LENGTH_MEDIAN = 3, LENGTH_SD = 1.5, NUGGET_MEDIAN = 1e-6, NUGGET_SD = 3;
static const double LEAST_VARIANCE = 1e-20, LEAST_CALIBRATION = 0.25, SHARE = 0.95;

/* ---- correlation ---- */

/* Squared scaled differences of two points, by input, and their sum. */
static double differences(int inputs, const bool *word, const double *length, const double *p,
                          const double *q, double *part) {
    double sum = 0;
    for (int i = 0; i < inputs; i++) {
        double d = (word[i] ? p[i] != q[i] : p[i] - q[i]) / length[i];
        sum += part[i] = d * d;
    }
    return sum;
}

static double correlation(const sf_predictor *p, const double *a, const double *b) {
    double part[SF_PREDICTOR_INPUTS], s = sqrt(5 * differences(p->inputs, p->word, p->length, a, b, part));
    return (1 + s + s * s / 3) * exp(-s);
}

/* The lower triangle and the diagonal with the nugget. */
static void fill_correlation(const sf_predictor *p, int count, const double *x, gsl_matrix *k) {
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < i; j++)
            gsl_matrix_set(k, (size_t)i, (size_t)j,
                           correlation(p, x + (long)i * p->inputs, x + (long)j * p->inputs));
        gsl_matrix_set(k, (size_t)i, (size_t)i, 1 + p->nugget);
    }
}

/* Solves for the weights of `y` with the factored correlation: mean, K^-1 (y - mean), K^-1 1, variance. */
static double weigh(const gsl_matrix *factor, const gsl_vector *y, double *mean, gsl_vector *weight,
                    gsl_vector *ones, double *ones_sum) {
    double sum = 0, squares = 0;
    gsl_vector_set_all(ones, 1);
    gsl_linalg_cholesky_svx(factor, ones);
    *ones_sum = 0;
    for (size_t k = 0; k < y->size; k++)
        *ones_sum += gsl_vector_get(ones, k);
    gsl_blas_ddot(ones, y, &sum);
    *mean = sum / *ones_sum;
    gsl_vector_memcpy(weight, y);
    gsl_vector_add_constant(weight, -*mean);
    gsl_linalg_cholesky_svx(factor, weight);
    for (size_t k = 0; k < y->size; k++)
        squares += (gsl_vector_get(y, k) - *mean) * gsl_vector_get(weight, k);
    return fmax(LEAST_VARIANCE, squares / (double)(y->size - 1));
}

/* ---- lengths and nugget ---- */

/* The objective of the minimiser: the negative restricted log likelihood with the prior, of the logarithms of
 * the lengths and of the nugget. */
typedef struct likelihood {
    sf_predictor *p; /* lengths and nugget of the last evaluation */
    int count;
    const double *x;
    gsl_vector_view y, weight, ones;
    gsl_matrix_view k;
} likelihood;

static void take_logarithms(const gsl_vector *at, sf_predictor *p) {
    for (int i = 0; i < p->inputs; i++)
        p->length[i] = exp(gsl_vector_get(at, (size_t)i));
    p->nugget = exp(gsl_vector_get(at, (size_t)p->inputs));
}

static double prior(const gsl_vector *at, gsl_vector *gradient) {
    double sum = 0;
    for (size_t i = 0; i < at->size; i++) {
        bool nugget = i + 1 == at->size;
        double sd = nugget ? NUGGET_SD : LENGTH_SD,
               z = (gsl_vector_get(at, i) - log(nugget ? NUGGET_MEDIAN : LENGTH_MEDIAN)) / sd;
        sum += 0.5 * z * z;
        gsl_vector_set(gradient, i, z / sd);
    }
    return sum;
}

/* Adds half of the sum of M dK over all pairs, M = K^-1 - a a' / s2 - w w' / (1' w), where k holds K^-1. */
static void add_slopes(const likelihood *l, double variance, double ones_sum, gsl_vector *gradient) {
    const sf_predictor *p = l->p;
    const gsl_vector *weight = &l->weight.vector, *ones = &l->ones.vector;
    double slope[SF_PREDICTOR_INPUTS] = {0}, diagonal = 0, part[SF_PREDICTOR_INPUTS];
    for (int i = 0; i < l->count; i++)
        for (int j = 0; j <= i; j++) {
            double m = gsl_matrix_get(&l->k.matrix, (size_t)i, (size_t)j) -
                       gsl_vector_get(weight, (size_t)i) * gsl_vector_get(weight, (size_t)j) / variance -
                       gsl_vector_get(ones, (size_t)i) * gsl_vector_get(ones, (size_t)j) / ones_sum;
            if (i == j) {
                diagonal += m;
                continue;
            }
            double s = sqrt(5 * differences(p->inputs, p->word, p->length, l->x + (long)i * p->inputs,
                                            l->x + (long)j * p->inputs, part)),
                   factor = m * 5. / 3 * (1 + s) * exp(-s);
            for (int k = 0; k < p->inputs; k++)
                slope[k] += factor * part[k];
        }
    for (int k = 0; k < p->inputs; k++)
        *gsl_vector_ptr(gradient, (size_t)k) += slope[k];
    *gsl_vector_ptr(gradient, (size_t)p->inputs) += 0.5 * p->nugget * diagonal;
}

static void evaluate(const gsl_vector *at, void *context, double *value, gsl_vector *gradient) {
    likelihood *l = context;
    double mean, ones_sum, logarithms = 0;
    take_logarithms(at, l->p);
    *value = prior(at, gradient);
    gsl_matrix *k = &l->k.matrix;
    fill_correlation(l->p, l->count, l->x, k);
    if (gsl_linalg_cholesky_decomp1(k) != GSL_SUCCESS) {
        *value = GSL_NAN;
        return;
    }
    double variance = weigh(k, &l->y.vector, &mean, &l->weight.vector, &l->ones.vector, &ones_sum);
    for (size_t i = 0; i < k->size1; i++)
        logarithms += log(gsl_matrix_get(k, i, i));
    *value += 0.5 * (l->count - 1) * log(variance) + logarithms + 0.5 * log(ones_sum);
    gsl_linalg_cholesky_invert(k);
    add_slopes(l, variance, ones_sum, gradient);
}

static double evaluate_value(const gsl_vector *at, void *context) {
    double value;
    gsl_vector *gradient = gsl_vector_alloc(at->size);
    if (!gradient)
        return GSL_NAN;
    evaluate(at, context, &value, gradient);
    gsl_vector_free(gradient);
    return value;
}

static void evaluate_gradient(const gsl_vector *at, void *context, gsl_vector *gradient) {
    double value;
    evaluate(at, context, &value, gradient);
}

/* Descends from the medians; the last point is kept wherever it stops. */
static sf_status find_lengths(likelihood *l, sf_error *err) {
    size_t n = (size_t)l->p->inputs + 1;
    gsl_multimin_function_fdf objective = {evaluate_value, evaluate_gradient, evaluate, n, l};
    gsl_multimin_fdfminimizer *m = gsl_multimin_fdfminimizer_alloc(gsl_multimin_fdfminimizer_vector_bfgs2, n);
    gsl_vector *start = gsl_vector_alloc(n);
    if (m && start) {
        gsl_vector_set_all(start, log(LENGTH_MEDIAN));
        gsl_vector_set(start, n - 1, log(NUGGET_MEDIAN));
        gsl_multimin_fdfminimizer_set(m, &objective, start, 0.5, 0.1);
        for (int k = 0; k < STEPS && gsl_multimin_fdfminimizer_iterate(m) == GSL_SUCCESS; k++)
            if (gsl_multimin_test_gradient(m->gradient, 1e-2) == GSL_SUCCESS)
                break;
        take_logarithms(m->x, l->p);
    } else {
        SF_NO_MEMORY(err, "a predictor");
    }
    if (m)
        gsl_multimin_fdfminimizer_free(m);
    gsl_vector_free(start);
    return err->status;
}

/* Points of which the lengths are found: of many, those at equal distances in their order. */
static sf_status fit_lengths(sf_predictor *p, const double *y, sf_error *err) {
    size_t n = (size_t)(p->count < MOST_FOR_LENGTHS ? p->count : MOST_FOR_LENGTHS),
           inputs = (size_t)p->inputs;
    SF_OWNED double *x = sf_alloc(err, n, (inputs + n + 3) * sizeof *x, "a predictor");
    SF_TRY(err->status);
    double *part = x + n * inputs;
    for (size_t k = 0; k < n; k++) {
        size_t from = k * (size_t)p->count / n;
        memcpy(x + k * inputs, p->x + from * inputs, inputs * sizeof *x);
        part[k] = y[from];
    }
    likelihood l = {p,
                    (int)n,
                    x,
                    gsl_vector_view_array(part, n),
                    gsl_vector_view_array(part + n, n),
                    gsl_vector_view_array(part + 2 * n, n),
                    gsl_matrix_view_array(part + 3 * n, n, n)};
    return find_lengths(&l, err);
}

/* ---- fit ---- */

/* Sets the factor of the residuals of points left out over what the process expects of them: a function that
 * is smoother than Matern's has smaller ones. */
static sf_status calibrate(sf_predictor *p, sf_error *err) {
    size_t n = (size_t)p->count;
    p->calibration = 1;
    if (p->count < LEAST_FOR_CALIBRATION)
        return SF_OK;
    SF_OWNED double *z = sf_alloc(err, n, (n + 1) * sizeof *z, "a predictor");
    double squares = 0;
    SF_TRY(err->status);
    gsl_matrix_view inverse = gsl_matrix_view_array(z + n, n, n);
    gsl_matrix_memcpy(&inverse.matrix, &p->factor.matrix);
    gsl_linalg_cholesky_invert(&inverse.matrix);
    for (size_t i = 0; i < n; i++) {
        double w = gsl_vector_get(&p->ones.vector, i),
               own = gsl_matrix_get(&inverse.matrix, i, i) - w * w / p->ones_sum;
        z[i] = fabs(gsl_vector_get(&p->weight.vector, i)) / sqrt(own) / p->deviation;
        squares += z[i] * z[i];
    }
    gsl_sort(z, 1, n);
    p->calibration = fmax(LEAST_CALIBRATION, fmax(sqrt(squares / (double)n),
                                                  z[(size_t)(SHARE * (double)n)] / SF_PREDICTOR_SIDES));
    return SF_OK;
}

static sf_status solve(sf_predictor *p, const double *y, sf_error *err) {
    gsl_vector_const_view outputs = gsl_vector_const_view_array(y, (size_t)p->count);
    gsl_matrix *factor = &p->factor.matrix;
    fill_correlation(p, p->count, p->x, factor);
    while (gsl_linalg_cholesky_decomp1(factor) != GSL_SUCCESS) {
        if ((p->nugget *= 10) > 1)
            return SF_FAIL(err, SF_ERR_NUMERIC, "the correlation of %d points cannot be factored", p->count);
        fill_correlation(p, p->count, p->x, factor);
    }
    p->deviation =
        sqrt(weigh(factor, &outputs.vector, &p->mean, &p->weight.vector, &p->ones.vector, &p->ones_sum));
    return calibrate(p, err);
}

sf_status sf_predictor_fit(int inputs, const bool *word, int count, const double *x, const double *y,
                           sf_predictor *p, sf_error *err) {
    size_t n = (size_t)count, width = (size_t)inputs;
    *p = (sf_predictor){
        .inputs = inputs, .count = count, .x = sf_alloc(err, n, (width + n + 2) * sizeof *x, "a predictor")};
    SF_TRY(err->status);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    memcpy(p->word, word, width * sizeof *word);
    memcpy(p->x, x, n * width * sizeof *x);
    p->weight = gsl_vector_view_array(p->x + n * width, n);
    p->ones = gsl_vector_view_array(p->x + n * (width + 1), n);
    p->factor = gsl_matrix_view_array(p->x + n * (width + 2), n, n);
    if (fit_lengths(p, y, err) == SF_OK)
        solve(p, y, err);
    gsl_set_error_handler(handler);
    return err->status;
}

void sf_predictor_free(sf_predictor *p) {
    SF_CLEAR(p, p->x);
}

/* ---- predictions ---- */

/* Correlations with the points in `room`, then L^-1 of them; returns the variance over that of the process.
 */
static double project(const sf_predictor *p, const double *x, double *room, double *mean) {
    gsl_vector_view k = gsl_vector_view_array(room, (size_t)p->count);
    double sum = 0, ones = 0, squares = 0;
    for (int j = 0; j < p->count; j++) {
        room[j] = correlation(p, x, p->x + (long)j * p->inputs);
        sum += room[j] * gsl_vector_get(&p->weight.vector, (size_t)j);
        ones += room[j] * gsl_vector_get(&p->ones.vector, (size_t)j);
    }
    gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, &p->factor.matrix, &k.vector);
    for (int j = 0; j < p->count; j++)
        squares += room[j] * room[j];
    *mean = p->mean + sum;
    return fmax(0, 1 + p->nugget - squares + (1 - ones) * (1 - ones) / p->ones_sum);
}

void sf_predictor_at(const sf_predictor *p, const double *x, double *room, double *mean, double *deviation) {
    *deviation = p->calibration * p->deviation * sqrt(project(p, x, room, mean));
}
