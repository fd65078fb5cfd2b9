/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/emulator.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = SF_POSTERIOR_MOST, DEGREE = 4, POINTS_OF_A_TERM = 3 };
static const double REACH = 2;     /* of the squared distance of the farthest point */
static const double RIDGE = 1e-10; /* of the columns' squares */

/* (n + degree) over degree. */
static int terms_of(int n, int degree) {
    double terms = 1;
    for (int k = 1; k <= degree; k++)
        terms = terms * (n + k) / k;
    return terms > SF_EMULATOR_MOST_TERMS ? SF_EMULATOR_MOST_TERMS + 1 : (int)(terms + 0.5);
}

/* Each degree extends the one before by variables that are not before its last one. */
static void list_terms(sf_emulator *e, int degree) {
    int first = 0, last = 1;
    e->terms = 1;
    for (int d = 0; d < degree; d++) {
        for (int t = first; t < last; t++)
            for (int v = t == 0 ? 0 : e->variable[t]; v < e->parameters; v++) {
                e->parent[e->terms] = t;
                e->variable[e->terms++] = v;
            }
        first = last;
        last = e->terms;
    }
}

static double standardise(const sf_emulator *e, const double *u, double *z) {
    return sf_mixture_standardise(&e->frame, e->parameters, u, z);
}

static void fill_terms(const sf_emulator *e, const double *z, double *term) {
    term[0] = 1;
    for (int t = 1; t < e->terms; t++)
        term[t] = term[e->parent[t]] * z[e->variable[t]];
}

/* Centre and factor of the points; false: they span no volume. */
static bool find_frame(sf_emulator *e, int count, const double *u) {
    sf_mixture m;
    sf_error none = SF_ERROR_INIT;
    if (sf_mixture_about(e->parameters, count, u, 1, &m, &none) != SF_OK)
        return false;
    e->frame = m.part[0];
    return true;
}

/* Adds the points to the normal equations: lower triangle of `gram`, and `right` [responses][terms]. */
static void add_points(sf_emulator *e, int count, const double *u, const double *y, double *gram,
                       double *right) {
    double z[N], term[SF_EMULATOR_MOST_TERMS];
    int terms = e->terms, m = e->responses;
    for (int k = 0; k < count; k++) {
        e->most_distance = fmax(e->most_distance, standardise(e, &u[k * e->parameters], z));
        fill_terms(e, z, term);
        for (int i = 0; i < terms; i++)
            for (int j = 0; j <= i; j++)
                gram[i * terms + j] += term[i] * term[j];
        for (int r = 0; r < m; r++)
            for (int i = 0; i < terms; i++)
                right[r * terms + i] += term[i] * y[k * m + r];
    }
}

/* Solves them with columns scaled to one, and the ridge. */
static sf_status solve(sf_emulator *e, double *gram, double *right, sf_error *err) {
    size_t terms = (size_t)e->terms;
    double scale[SF_EMULATOR_MOST_TERMS];
    gsl_matrix_view a = gsl_matrix_view_array(gram, terms, terms);
    for (size_t i = 0; i < terms; i++)
        scale[i] = 1 / sqrt(gram[i * terms + i]);
    for (size_t i = 0; i < terms; i++)
        for (size_t j = 0; j <= i; j++)
            gram[i * terms + j] = gram[j * terms + i] =
                gram[i * terms + j] * scale[i] * scale[j] + (i == j ? RIDGE : 0);
    if (gsl_linalg_cholesky_decomp1(&a.matrix) != GSL_SUCCESS)
        return SF_FAIL(err, SF_ERR_NUMERIC, "the emulator's normal equations are singular");
    for (size_t r = 0; r < (size_t)e->responses; r++) {
        gsl_vector_view x = gsl_vector_view_array(&right[r * terms], terms);
        for (size_t i = 0; i < terms; i++)
            right[r * terms + i] *= scale[i];
        gsl_linalg_cholesky_svx(&a.matrix, &x.vector);
        for (size_t i = 0; i < terms; i++)
            e->coefficient[r * terms + i] = right[r * terms + i] * scale[i];
    }
    return SF_OK;
}

sf_status sf_emulator_fit(int parameters, int responses, int count, const double *u, const double *y,
                          sf_emulator *e, sf_error *err) {
    *e = (sf_emulator){.parameters = parameters, .responses = responses};
    int degree = DEGREE;
    while (degree > 1 && (terms_of(parameters, degree) > SF_EMULATOR_MOST_TERMS ||
                          POINTS_OF_A_TERM * terms_of(parameters, degree) > count))
        degree--;
    if (degree < 2 || !find_frame(e, count, u))
        return SF_OK;
    list_terms(e, degree);
    unsigned long terms = (unsigned long)e->terms, all = terms * (unsigned long)responses;
    double *gram = sf_alloc(err, terms * terms, sizeof *gram, "an emulator"),
           *right = sf_alloc(err, all, sizeof *right, "an emulator");
    e->coefficient = sf_alloc(err, all, sizeof(double), "an emulator");
    if (err->status == SF_OK) {
        sf_error singular = SF_ERROR_INIT;
        add_points(e, count, u, y, gram, right);
        if (solve(e, gram, right, &singular) != SF_OK)
            sf_emulator_free(e);
    }
    free(gram);
    free(right);
    return err->status;
}

bool sf_emulator_at(const sf_emulator *e, const double *u, double *y) {
    double z[N], term[SF_EMULATOR_MOST_TERMS];
    if (!(standardise(e, u, z) <= REACH * e->most_distance))
        return false;
    fill_terms(e, z, term);
    for (int r = 0; r < e->responses; r++) {
        const double *c = &e->coefficient[r * e->terms];
        y[r] = 0;
        for (int t = 0; t < e->terms; t++)
            y[r] += c[t] * term[t];
    }
    return true;
}

void sf_emulator_free(sf_emulator *e) {
    free(e->coefficient);
    *e = (sf_emulator){0};
}
