/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/quadratic.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double TOLERANCE = 1e-9; /* of singular values: what is below is not determined */

static int count_terms(const sf_quadratic *s) {
    int terms = 1 + s->d + s->d * (s->d - 1) / 2 + s->offsets;
    for (int i = 0; i < s->d; i++)
        terms += s->curved[i];
    return terms;
}

/* The terms at x. */
static void put_terms(const sf_quadratic *s, const double *x, double *term) {
    double z[SF_QUADRATIC_NUMBERS];
    int t = 0;
    term[t++] = 1;
    for (int i = 0; i < s->d; i++)
        term[t++] = z[i] = (x[i] - s->centre[i]) / s->half[i];
    for (int i = 0; i < s->d; i++)
        if (s->curved[i])
            term[t++] = z[i] * z[i];
    for (int i = 0; i < s->d; i++)
        for (int j = i + 1; j < s->d; j++)
            term[t++] = z[i] * z[j];
    for (int k = 0; k < s->offsets; k++)
        term[t++] = x[s->d + k];
}

/* Range of a number, and whether it has three values. */
static void measure(sf_quadratic *s, int i, int64_t n, const double *x) {
    int stride = s->d + s->offsets;
    double low = x[i], high = x[i];
    for (int64_t k = 0; k < n; k++) {
        low = fmin(low, x[k * stride + i]);
        high = fmax(high, x[k * stride + i]);
    }
    s->centre[i] = 0.5 * (low + high);
    s->half[i] = high > low ? 0.5 * (high - low) : 1;
    for (int64_t k = 0; k < n; k++)
        s->curved[i] |=
            fabs(fabs(x[k * stride + i] - s->centre[i]) - s->half[i]) > 1e-6 * s->half[i] && high > low;
}

typedef struct fit {
    gsl_matrix *terms, *covariance;
    gsl_vector *y, *weight, *c;
    gsl_multifit_linear_workspace *work;
} fit;

static bool fit_begin(fit *f, int64_t n, int terms) {
    size_t rows = (size_t)n, columns = (size_t)terms;
    *f = (fit){gsl_matrix_alloc(rows, columns), gsl_matrix_alloc(columns, columns),
               gsl_vector_alloc(rows),          gsl_vector_alloc(rows),
               gsl_vector_alloc(columns),       gsl_multifit_linear_alloc(rows, columns)};
    return f->terms && f->covariance && f->y && f->weight && f->c && f->work;
}

static void fit_end(fit *f) {
    gsl_matrix_free(f->terms);
    gsl_matrix_free(f->covariance);
    gsl_vector_free(f->y);
    gsl_vector_free(f->weight);
    gsl_vector_free(f->c);
    if (f->work)
        gsl_multifit_linear_free(f->work);
}

/* The leverage of a row, by (X^T X)^-1. */
static double leverage(const fit *f, size_t row, gsl_vector *scratch) {
    double h = 0;
    const gsl_vector_const_view x = gsl_matrix_const_row(f->terms, row);
    gsl_blas_dgemv(CblasNoTrans, 1, f->covariance, &x.vector, 0, scratch);
    gsl_blas_ddot(&x.vector, scratch, &h);
    return h;
}

static double residual(const fit *f, size_t row) {
    double value = 0;
    const gsl_vector_const_view x = gsl_matrix_const_row(f->terms, row);
    gsl_blas_ddot(&x.vector, f->c, &value);
    return gsl_vector_get(f->y, row) - value;
}

static int compare_rows(const void *p, const void *q, void *context) {
    const fit *f = context;
    size_t j = *(const size_t *)p, k = *(const size_t *)q;
    const double *a = gsl_matrix_const_ptr(f->terms, j, 0), *b = gsl_matrix_const_ptr(f->terms, k, 0);
    for (size_t t = 0; t < f->terms->size2; t++)
        if (a[t] != b[t])
            return a[t] > b[t] ? 1 : -1;
    return (j > k) - (j < k);
}

static bool is_same_site(const fit *f, size_t j, size_t k) {
    const size_t bytes = f->terms->size2 * sizeof(double);
    return memcmp(gsl_matrix_const_ptr(f->terms, j, 0), gsl_matrix_const_ptr(f->terms, k, 0), bytes) == 0;
}

/* Errors of the surface without each site: the rows of one place in the factors that it has, as runs with
 * other draws of the foam, would otherwise tell of each other. Of m rows with leverage h and the sum S of
 * their residuals r the error is r + h S / (1 - m h). `order` [n]. */
static void judge(sf_quadratic *s, const fit *f, size_t n, size_t *order, double *left_out,
                  gsl_vector *scratch) {
    double squares = 0, press = 0, mean = 0, spread = 0;
    for (size_t k = 0; k < n; k++) {
        order[k] = k;
        mean += gsl_vector_get(f->y, k) / (double)n;
    }
    qsort_r(order, n, sizeof *order, compare_rows, (void *)f);
    for (size_t first = 0, end; first < n; first = end) {
        double sum = 0, h = leverage(f, order[first], scratch);
        for (end = first; end < n && is_same_site(f, order[first], order[end]); end++)
            sum += residual(f, order[end]);
        double rest = 1 - (double)(end - first) * h;
        for (size_t i = first; i < end; i++) {
            double r = residual(f, order[i]), y = gsl_vector_get(f->y, order[i]),
                   error = rest > 1e-9 ? r + h * sum / rest : NAN;
            squares += r * r;
            press += error * error;
            spread += (y - mean) * (y - mean);
            if (left_out)
                left_out[order[i]] = y - error;
        }
    }
    s->rms = sqrt(squares / (double)(n - (size_t)s->terms));
    s->left_out_rms = sqrt(press / (double)n);
    if (isnan(s->left_out_rms))
        snprintf(
            s->problem, sizeof s->problem,
            "without one place in the factors the terms are not determined: its error at runs left out is "
            "not known");
    s->q2 = spread > 0 ? 1 - press / spread : NAN;
}

static void solve(sf_quadratic *s, fit *f, int64_t n, const double *x, const double *y, size_t *order,
                  double *left_out, gsl_vector *scratch) {
    double chisq = 0;
    size_t rank = 0;
    for (size_t k = 0; k < (size_t)n; k++) {
        put_terms(s, x + k * (size_t)(s->d + s->offsets), gsl_matrix_ptr(f->terms, k, 0));
        gsl_vector_set(f->y, k, y[k]);
        gsl_vector_set(f->weight, k, 1);
    }
    int failed = gsl_multifit_wlinear_tsvd(f->terms, f->weight, f->y, TOLERANCE, f->c, f->covariance, &chisq,
                                           &rank, f->work);
    if (failed || rank < (size_t)s->terms) {
        snprintf(s->problem, sizeof s->problem,
                 "the rows do not determine all terms: two factors vary together, or values are missing");
        s->terms = 0;
        return;
    }
    for (int t = 0; t < s->terms; t++)
        s->c[t] = gsl_vector_get(f->c, (size_t)t);
    judge(s, f, (size_t)n, order, left_out, scratch);
}

sf_status sf_quadratic_fit(int d, int offsets, int64_t n, const double *x, const double *y, sf_quadratic *s,
                           double *left_out, sf_error *err) {
    *s = (sf_quadratic){.d = d, .offsets = offsets, .rms = NAN, .left_out_rms = NAN, .q2 = NAN};
    for (int i = 0; i < d && n > 0; i++)
        measure(s, i, n, x);
    int terms = count_terms(s);
    if (d == 0 || terms > SF_QUADRATIC_TERMS || n < terms + 2) {
        snprintf(s->problem, sizeof s->problem,
                 d == 0 ? "no factor is a number with more than one value"
                        : "%d terms need at least %d runs, there are %lld",
                 terms, terms + 2, (long long)n);
        return SF_OK;
    }
    fit f;
    gsl_vector *scratch = gsl_vector_alloc((size_t)terms);
    size_t *order = sf_alloc(err, (unsigned long)n, sizeof *order, "the response surface");
    s->terms = terms;
    if (fit_begin(&f, n, terms) && scratch && order)
        solve(s, &f, n, x, y, order, left_out, scratch);
    else if (err->status == SF_OK)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the response surface");
    fit_end(&f);
    free(order);
    gsl_vector_free(scratch);
    return err->status;
}

double sf_quadratic_at(const sf_quadratic *s, const double *x) {
    double term[SF_QUADRATIC_TERMS], value = 0;
    put_terms(s, x, term);
    for (int t = 0; t < s->terms; t++)
        value += s->c[t] * term[t];
    return value;
}
