/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/posterior.h"

#include "study/fit/least_squares.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>
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
    SF_MATRIX *copy = sf_matrix((size_t)n, (size_t)n, err);
    SF_VECTOR *value = sf_vector((size_t)n, err);
    if (w && err->status == SF_OK) {
        gsl_matrix_view out = matrix(root, n, n);
        memcpy(copy->data, kernel, (size_t)(n * n) * sizeof *kernel);
        gsl_eigen_symmv(copy, value, &out.matrix, w);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                root[i * n + j] *= sqrt(fmax(0, gsl_vector_get(value, (size_t)j)));
    }
    gsl_eigen_symmv_free(w);
    return err->status;
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

/* H and H^T H. */
static sf_status whiten(sf_discrepancy *d, const double *jacobian, const double *effect, sf_error *err) {
    int p = d->latent;
    d->white = sf_alloc(err, (unsigned long)(d->data * p), sizeof(double), "a discrepancy");
    SF_TRY(err->status);
    for (int i = 0; i < d->data; i++) {
        double *row = &d->white[i * p];
        for (int k = 0; k < d->bins; k++)
            for (int b = 0; b < d->bins; b++)
                row[k] += jacobian[i * d->bins + b] * d->root[b * d->bins + k];
        memcpy(row + d->bins, &effect[i * d->effects], (size_t)d->effects * sizeof *row);
        for (int j = 0; j < i; j++)
            for (int k = 0; k < p; k++)
                row[k] -= d->base_root[i * d->data + j] * d->white[j * p + k];
        for (int k = 0; k < p; k++)
            row[k] /= d->base_root[i * d->data + i];
    }
    for (int i = 0; i < d->data; i++)
        for (int k = 0; k < p; k++)
            for (int l = 0; l < p; l++)
                d->gram[k * p + l] += d->white[i * p + k] * d->white[i * p + l];
    return SF_OK;
}

/* H H^T of delta and of x. */
static sf_status fill_spread(sf_discrepancy *d, sf_error *err) {
    for (int of = 0; of < 2; of++) {
        int first = of == 0 ? 0 : d->bins, last = of == 0 ? d->bins : d->latent;
        d->spread[of] = sf_alloc(err, (unsigned long)(d->data * d->data), sizeof(double), "a discrepancy");
        for (int i = 0; i < d->data && d->spread[of]; i++)
            for (int j = 0; j < d->data; j++)
                for (int k = first; k < last; k++)
                    d->spread[of][i * d->data + j] +=
                        d->white[i * d->latent + k] * d->white[j * d->latent + k];
    }
    return err->status;
}

sf_status sf_discrepancy_build(int data, int bins, const double *jacobian, const double *kernel, int effects,
                               const double *effect, const double *base, sf_discrepancy *d, sf_error *err) {
    *d = (sf_discrepancy){.data = data, .bins = bins, .effects = effects, .latent = bins + effects};
    if (d->latent > SF_DISCREPANCY_MOST)
        return SF_REFUSE(err, "%d errors of the responses" SF_AT_MOST("%d"), effects,
                         SF_DISCREPANCY_MOST - bins);
    d->root = sf_alloc(err, (unsigned long)(bins * bins), sizeof(double), "a discrepancy");
    d->gram = sf_alloc(err, (unsigned long)(d->latent * d->latent), sizeof(double), "a discrepancy");
    d->base_root = sf_alloc(err, (unsigned long)(data * data), sizeof(double), "a discrepancy");
    if (err->status != SF_OK || find_root(kernel, bins, d->root, err) != SF_OK || data == 0)
        return err->status;
    memcpy(d->base_root, base, (size_t)(data * data) * sizeof *base);
    SF_TRY(factorise(d, err));
    SF_TRY(whiten(d, jacobian, effect, err));
    return d->data < d->latent ? fill_spread(d, err) : err->status;
}

void sf_discrepancy_free(sf_discrepancy *d) {
    SF_CLEAR(d, d->root, d->base_root, d->white, d->gram, d->spread[0], d->spread[1]);
}

static double size_of(const sf_discrepancy *d, int latent, sf_discrepancy_size size) {
    return latent < d->bins ? size.tau : size.kappa;
}

/* The Cholesky factor C of 1 + S H^T H S, in the lower triangle; log of its determinant's square. */
static double factor(const sf_discrepancy *d, sf_discrepancy_size size, double *c) {
    int p = d->latent;
    double sum = 0;
    for (int i = 0; i < p; i++)
        for (int j = 0; j <= i; j++) {
            double a = (i == j) + size_of(d, i, size) * size_of(d, j, size) * d->gram[i * p + j];
            for (int k = 0; k < j; k++)
                a -= c[i * p + k] * c[j * p + k];
            c[i * p + j] = i == j ? sqrt(a) : a / c[j * p + j];
        }
    for (int i = 0; i < p; i++)
        sum += 2 * log(c[i * p + i]);
    return sum;
}

/* q = C^-1 S H^T L^-1 r; |L^-1 r|^2. */
static double project(const sf_discrepancy *d, const double *r, sf_discrepancy_size size, const double *c,
                      double *q) {
    int p = d->latent;
    double sum = 0;
    SF_OWNED double *w = malloc((size_t)d->data * sizeof *w);
    if (!w)
        return INFINITY;
    memset(q, 0, (size_t)p * sizeof *q);
    for (int i = 0; i < d->data; i++) {
        w[i] = r[i];
        for (int j = 0; j < i; j++)
            w[i] -= d->base_root[i * d->data + j] * w[j];
        w[i] /= d->base_root[i * d->data + i];
        sum += w[i] * w[i];
        for (int k = 0; k < p; k++)
            q[k] += d->white[i * p + k] * w[i];
    }
    for (int k = 0; k < p; k++) {
        q[k] *= size_of(d, k, size);
        for (int l = 0; l < k; l++)
            q[k] -= c[k * p + l] * q[l];
        q[k] /= c[k * p + k];
    }
    return sum;
}

/* With variables fewer than the data: of the variables' matrix. */
static double density_of_many(const sf_discrepancy *d, const double *residual, sf_discrepancy_size size) {
    double c[SF_DISCREPANCY_MOST * SF_DISCREPANCY_MOST], q[SF_DISCREPANCY_MOST];
    double sum = factor(d, size, c);
    sum += project(d, residual, size, c, q);
    for (int k = 0; k < d->latent; k++)
        sum -= q[k] * q[k];
    return sum;
}

/* Else of the whitened data's covariance, row by row of its Cholesky factor. */
static double density_of_few(const sf_discrepancy *d, const double *r, sf_discrepancy_size size) {
    int n = d->data;
    double c[SF_DISCREPANCY_MOST * SF_DISCREPANCY_MOST], w[SF_DISCREPANCY_MOST], q[SF_DISCREPANCY_MOST],
        sum = 0;
    for (int i = 0; i < n; i++) {
        w[i] = r[i];
        for (int j = 0; j < i; j++)
            w[i] -= d->base_root[i * n + j] * w[j];
        w[i] /= d->base_root[i * n + i];
        q[i] = w[i];
        for (int j = 0; j <= i; j++) {
            double a = (i == j) + size.tau * size.tau * d->spread[0][i * n + j] +
                       size.kappa * size.kappa * d->spread[1][i * n + j];
            for (int k = 0; k < j; k++)
                a -= c[i * n + k] * c[j * n + k];
            c[i * n + j] = i == j ? sqrt(a) : a / c[j * n + j];
            q[i] -= j < i ? c[i * n + j] * q[j] : 0;
        }
        q[i] /= c[i * n + i];
        sum += q[i] * q[i] + 2 * log(c[i * n + i]);
    }
    return sum;
}

double sf_discrepancy_log_density(const sf_discrepancy *d, const double *residual, sf_discrepancy_size size) {
    if (d->data == 0)
        return 0;
    double sum = d->data * log(2 * M_PI) + d->log_determinant;
    return -0.5 * (sum + (d->spread[0] ? density_of_few : density_of_many)(d, residual, size));
}

/* z ~ N(C^-T q, (C C^T)^-1), then delta = tau R z and x = kappa z. */
void sf_discrepancy_draw(const sf_discrepancy *d, const double *residual, sf_discrepancy_size size,
                         gsl_rng *random, double *delta, double *x) {
    double c[SF_DISCREPANCY_MOST * SF_DISCREPANCY_MOST], z[SF_DISCREPANCY_MOST] = {0};
    int p = d->latent;
    factor(d, size, c);
    if (d->data > 0)
        project(d, residual, size, c, z);
    for (int k = 0; k < p; k++)
        z[k] += gsl_ran_ugaussian(random);
    for (int k = p - 1; k >= 0; k--) {
        for (int l = k + 1; l < p; l++)
            z[k] -= c[l * p + k] * z[l];
        z[k] /= c[k * p + k];
    }
    for (int b = 0; b < d->bins; b++) {
        delta[b] = 0;
        for (int k = 0; k < d->bins; k++)
            delta[b] += size.tau * d->root[b * d->bins + k] * z[k];
    }
    for (int k = 0; k < d->effects; k++)
        x[k] = size.kappa * z[d->bins + k];
}
