/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/posterior/discrepancy.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void sf_kernel_fill(int bins, const double *place, double length, double *kernel) {
    for (int i = 0; i < bins; i++)
        for (int j = 0; j < bins; j++)
            kernel[i * bins + j] = exp(-0.5 * pow((place[i] - place[j]) / length, 2));
}

double sf_half_normal(double z, double scale) {
    return scale * gsl_cdf_ugaussian_Qinv(0.5 * gsl_cdf_ugaussian_Q(z));
}

static gsl_matrix_view matrix(double *a, int rows, int columns) {
    return gsl_matrix_view_array(a, (size_t)rows, (size_t)columns);
}

/* K = R R^T by its eigenvectors, as K is almost singular. */
static sf_status find_root(const double *kernel, int n, double *root, sf_error *err) {
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc((size_t)n);
    gsl_matrix *copy = gsl_matrix_alloc((size_t)n, (size_t)n);
    gsl_vector *value = gsl_vector_alloc((size_t)n);
    if (w && copy && value) {
        gsl_matrix_view out = matrix(root, n, n);
        memcpy(copy->data, kernel, (size_t)(n * n) * sizeof *kernel);
        gsl_eigen_symmv(copy, value, &out.matrix, w);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                root[i * n + j] *= sqrt(fmax(0, gsl_vector_get(value, (size_t)j)));
    } else {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a discrepancy of %d places", n);
    }
    gsl_eigen_symmv_free(w);
    gsl_matrix_free(copy);
    gsl_vector_free(value);
    return err->status;
}

/* W and its values from L (D = L L^T) and G = J R: L^-1 G G^T L^-T = V diag(value) V^T, W = V^T L^-1. */
static sf_status diagonalise(sf_discrepancy *d, sf_error *err) {
    size_t n = (size_t)d->data, m = (size_t)d->bins;
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(n);
    gsl_matrix *g = gsl_matrix_alloc(n, m), *a = gsl_matrix_alloc(n, n), *v = gsl_matrix_alloc(n, n);
    if (w && g && a && v) {
        gsl_matrix_view j = matrix(d->jacobian, d->data, d->bins),
                        r = matrix(d->kernel_root, d->bins, d->bins),
                        l = matrix(d->base_root, d->data, d->data), out = matrix(d->whiten, d->data, d->data);
        gsl_vector_view value = gsl_vector_view_array(d->value, n);
        gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, &j.matrix, &r.matrix, 0, g);
        gsl_blas_dtrsm(CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, 1, &l.matrix, g);
        gsl_blas_dgemm(CblasNoTrans, CblasTrans, 1, g, g, 0, a);
        gsl_eigen_symmv(a, &value.vector, v, w);
        gsl_matrix_transpose_memcpy(&out.matrix, v);
        gsl_blas_dtrsm(CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, 1, &l.matrix, &out.matrix);
    } else {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the covariance of %d data", d->data);
    }
    gsl_eigen_symmv_free(w);
    gsl_matrix_free(g);
    gsl_matrix_free(a);
    gsl_matrix_free(v);
    return err->status;
}

static void *duplicate(const double *from, int count, sf_error *err) {
    double *to = sf_alloc(err, (unsigned long)count, sizeof *to, "a discrepancy");
    if (to)
        memcpy(to, from, (size_t)count * sizeof *to);
    return to;
}

/* D's factor; above the diagonal zero. */
static sf_status factorise(sf_discrepancy *d, sf_error *err) {
    gsl_matrix_view l = matrix(d->base_root, d->data, d->data);
    if (gsl_linalg_cholesky_decomp1(&l.matrix) != GSL_SUCCESS)
        return SF_FAIL(err, SF_ERR_NUMERIC, "the covariance of %d data is not positive definite", d->data);
    for (int i = 0; i < d->data; i++) {
        d->log_determinant += 2 * log(d->base_root[i * d->data + i]);
        for (int j = i + 1; j < d->data; j++)
            d->base_root[i * d->data + j] = 0;
    }
    return SF_OK;
}

sf_status sf_discrepancy_build(int data, int bins, const double *jacobian, const double *kernel,
                               const double *base, sf_discrepancy *d, sf_error *err) {
    *d = (sf_discrepancy){.data = data, .bins = bins};
    d->kernel = duplicate(kernel, bins * bins, err);
    d->kernel_root = sf_alloc(err, (unsigned long)(bins * bins), sizeof(double), "a discrepancy");
    if (err->status != SF_OK || find_root(d->kernel, bins, d->kernel_root, err) != SF_OK || data == 0)
        return err->status;
    d->jacobian = duplicate(jacobian, data * bins, err);
    d->base_root = duplicate(base, data * data, err);
    d->whiten = sf_alloc(err, (unsigned long)(data * data), sizeof(double), "a discrepancy");
    d->value = sf_alloc(err, (unsigned long)data, sizeof(double), "a discrepancy");
    if (err->status != SF_OK || factorise(d, err) != SF_OK)
        return err->status;
    return diagonalise(d, err);
}

void sf_discrepancy_free(sf_discrepancy *d) {
    free(d->jacobian);
    free(d->kernel);
    free(d->kernel_root);
    free(d->base_root);
    free(d->whiten);
    free(d->value);
    *d = (sf_discrepancy){0};
}

double sf_discrepancy_log_density(const sf_discrepancy *d, const double *residual, double tau) {
    double sum = d->log_determinant + d->data * log(2 * M_PI);
    for (int i = 0; i < d->data; i++) {
        double white = 0, variance = 1 + tau * tau * fmax(0, d->value[i]);
        for (int j = 0; j < d->data; j++)
            white += d->whiten[i * d->data + j] * residual[j];
        sum += white * white / variance + log(variance);
    }
    return -0.5 * sum;
}

/* c = (D + tau^2 J K J^T)^-1 r = W^T (1 + tau^2 value)^-1 W r. */
static void solve(const sf_discrepancy *d, const double *r, double tau, double *c) {
    memset(c, 0, (size_t)d->data * sizeof *c);
    for (int i = 0; i < d->data; i++) {
        const double *row = &d->whiten[i * d->data];
        double white = 0;
        for (int j = 0; j < d->data; j++)
            white += row[j] * r[j];
        white /= 1 + tau * tau * fmax(0, d->value[i]);
        for (int j = 0; j < d->data; j++)
            c[j] += row[j] * white;
    }
}

/* delta0 ~ N(0, tau^2 K). */
static void draw_prior(const sf_discrepancy *d, double tau, gsl_rng *random, double *delta) {
    memset(delta, 0, (size_t)d->bins * sizeof *delta);
    for (int j = 0; j < d->bins; j++) {
        double z = tau * gsl_ran_ugaussian(random);
        for (int i = 0; i < d->bins; i++)
            delta[i] += d->kernel_root[i * d->bins + j] * z;
    }
}

/* r - J delta0 - e0, e0 ~ N(0, D). */
static void draw_rest(const sf_discrepancy *d, const double *r, const double *delta, gsl_rng *random,
                      double *rest) {
    memcpy(rest, r, (size_t)d->data * sizeof *rest);
    for (int j = 0; j < d->data; j++) {
        double z = gsl_ran_ugaussian(random);
        for (int i = j; i < d->data; i++)
            rest[i] -= d->base_root[i * d->data + j] * z;
    }
    for (int i = 0; i < d->data; i++)
        for (int b = 0; b < d->bins; b++)
            rest[i] -= d->jacobian[i * d->bins + b] * delta[b];
}

void sf_discrepancy_draw(const sf_discrepancy *d, const double *residual, double tau, gsl_rng *random,
                         double *scratch, double *delta) {
    int n = d->data;
    double *rest = scratch, *c = scratch + n;
    draw_prior(d, tau, random, delta);
    if (n == 0)
        return;
    draw_rest(d, residual, delta, random, rest);
    solve(d, rest, tau, c);
    for (int i = 0; i < n; i++) /* conditioning by kriging: delta0 + tau^2 K J^T c */
        for (int k = 0; k < d->bins; k++) {
            double raise = tau * tau * d->jacobian[i * d->bins + k] * c[i];
            for (int b = 0; b < d->bins && raise != 0; b++)
                delta[b] += d->kernel[b * d->bins + k] * raise;
        }
}
