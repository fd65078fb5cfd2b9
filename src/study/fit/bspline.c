/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/bspline.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multimin.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>

/* Intervals that are tried, coarse to fine. */
static const int TRIED[] = {3, 4, 5, 6, 8, 10, 12, 14, 17, 20, 24, 28, 34, SF_SCATTER_FINEST};
enum { TRIALS = sizeof TRIED / sizeof TRIED[0], ROUNDS = 3 };

/* Weighted least squares of one branch: normal equations, which are banded and small. `weighted` is the sum
 * of squares of deviation over sigma, `parameters` the number of coefficients. */
typedef struct smoothing {
    double weighted;
    int parameters;
} smoothing;

static sf_status accumulate(const sf_scatter_branch *b, sf_spline *spline, gsl_matrix *normal,
                            gsl_vector *right) {
    double row[SF_SPLINE_COEFFICIENTS], trace = 0;
    size_t n = normal->size1;
    gsl_matrix_set_zero(normal);
    gsl_vector_set_zero(right);
    for (int i = 0; i < b->count; i++) {
        double weight = 1 / (b->sigma[i] * b->sigma[i]);
        sf_spline_value(spline, b->x[i], row);
        for (size_t j = 0; j < n; j++) {
            if (row[j] == 0)
                continue;
            *gsl_vector_ptr(right, j) += weight * row[j] * b->y[i];
            for (size_t k = 0; k <= j; k++)
                *gsl_matrix_ptr(normal, j, k) += weight * row[j] * row[k];
        }
    }
    for (size_t j = 0; j < n; j++)
        trace = fmax(trace, gsl_matrix_get(normal, j, j));
    for (size_t j = 0; j < n; j++) /* keeps a coefficient without data from making the matrix singular */
        *gsl_matrix_ptr(normal, j, j) += 1e-12 * trace;
    return gsl_linalg_cholesky_decomp1(normal) == GSL_SUCCESS ? SF_OK : SF_ERR_NUMERIC;
}

static sf_status solve(const sf_scatter_branch *b, sf_spline *spline, smoothing *out, sf_error *err) {
    size_t n = (size_t)spline->count;
    double row[SF_SPLINE_COEFFICIENTS];
    gsl_matrix *normal = gsl_matrix_alloc(n, n);
    gsl_vector *right = gsl_vector_alloc(n);
    if (!normal || !right)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for smoothing a test");
    else if (accumulate(b, spline, normal, right) != SF_OK)
        SF_FAIL(err, SF_ERR_NUMERIC, "a branch of %d points cannot be smoothed", b->count);
    else
        gsl_linalg_cholesky_svx(normal, right);
    *out = (smoothing){.parameters = spline->count};
    for (int i = 0; i < b->count && err->status == SF_OK; i++) {
        sf_spline_value(spline, b->x[i], row);
        b->smooth[i] = 0;
        for (size_t j = 0; j < n; j++)
            b->smooth[i] += row[j] * gsl_vector_get(right, j);
        double deviation = (b->y[i] - b->smooth[i]) / b->sigma[i];
        out->weighted += deviation * deviation;
    }
    gsl_matrix_free(normal);
    gsl_vector_free(right);
    return err->status;
}

static sf_status smooth(const sf_scatter_branch *b, sf_spline_grading grading, int intervals, smoothing *out,
                        sf_error *err) {
    double breaks[SF_SPLINE_BREAKS], low, high;
    const sf_spline_data data = {b->x, b->count};
    sf_spline spline;
    gsl_stats_minmax(&low, &high, b->x, 1, (size_t)b->count);
    int count = sf_spline_place(grading, intervals, low, high, 1, &data, breaks);
    if (sf_spline_init(&spline, count, breaks, err) != SF_OK)
        return err->status;
    solve(b, &spline, out, err);
    sf_spline_free(&spline);
    return err->status;
}

/* Smooths all branches; returns the score of generalised cross-validation, INFINITY if a branch has too few
 * points for so many knots. */
static double smooth_all(int count, const sf_scatter_branch *branches, sf_spline_grading grading,
                         int intervals, sf_error *err) {
    double score = 0;
    for (int k = 0; k < count; k++) {
        smoothing s;
        if (smooth(&branches[k], grading, intervals, &s, err) != SF_OK)
            return INFINITY;
        double n = branches[k].count, left = 1 - s.parameters / n;
        score += left > 0.3 ? s.weighted / (left * left) : INFINITY;
    }
    return score;
}

static sf_status choose_intervals(int count, const sf_scatter_branch *branches, sf_spline_grading grading,
                                  int *best, sf_error *err) {
    double lowest = INFINITY;
    *best = TRIED[0];
    for (int k = 0; k < TRIALS && err->status == SF_OK; k++) {
        double score = smooth_all(count, branches, grading, TRIED[k], err);
        if (score < lowest) {
            lowest = score;
            *best = TRIED[k];
        }
    }
    if (err->status == SF_OK)
        smooth_all(count, branches, grading, *best, err);
    return err->status;
}

/* ---- the two numbers of the scatter ---- */

typedef struct likelihood {
    int count;
    const sf_scatter_branch *branches;
    double inflate[SF_SCATTER_BRANCHES]; /* per branch: points over points less coefficients */
} likelihood;

/* -2 ln(likelihood) over (ln a, ln b). */
static double deviance(const gsl_vector *x, void *context) {
    const likelihood *l = context;
    double a2 = exp(2 * gsl_vector_get(x, 0)), b2 = exp(2 * gsl_vector_get(x, 1)), sum = 0;
    for (int k = 0; k < l->count; k++) {
        const sf_scatter_branch *b = &l->branches[k];
        for (int i = 0; i < b->count; i++) {
            double variance = a2 + b2 * b->smooth[i] * b->smooth[i], d = b->y[i] - b->smooth[i];
            sum += log(variance) + l->inflate[k] * d * d / variance;
        }
    }
    return sum;
}

static sf_status minimise(likelihood *l, double size, sf_scatter *scatter, sf_error *err) {
    gsl_multimin_function f = {.f = deviance, .n = 2, .params = l};
    gsl_vector *start = gsl_vector_alloc(2), *step = gsl_vector_alloc(2);
    gsl_multimin_fminimizer *m = gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, 2);
    if (!start || !step || !m) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the scatter");
    } else {
        gsl_vector_set(start, 0, log(1e-3 * size));
        gsl_vector_set(start, 1, log(5e-3));
        gsl_vector_set_all(step, 1);
        gsl_multimin_fminimizer_set(m, &f, start, step);
        for (int k = 0; k < 200 && gsl_multimin_fminimizer_size(m) > 1e-3; k++)
            if (gsl_multimin_fminimizer_iterate(m) != GSL_SUCCESS)
                break;
        /* data without scatter: not below what a file's digits hold */
        scatter->absolute = fmax(exp(gsl_vector_get(m->x, 0)), 1e-7 * size);
        scatter->relative = fmax(exp(gsl_vector_get(m->x, 1)), 1e-7);
    }
    gsl_vector_free(start);
    gsl_vector_free(step);
    gsl_multimin_fminimizer_free(m);
    return err->status;
}

static void set_sigma(int count, const sf_scatter_branch *branches, const sf_scatter *s) {
    for (int k = 0; k < count; k++)
        for (int i = 0; i < branches[k].count; i++)
            branches[k].sigma[i] = hypot(s->absolute, s->relative * branches[k].smooth[i]);
}

/* Deviations of the smoothed branches count for the coefficients that were spent on them. */
static sf_status set_inflation(likelihood *l, int intervals, sf_error *err) {
    for (int k = 0; k < l->count; k++) {
        smoothing s;
        if (smooth(&l->branches[k], SF_GRADING_ENDS, intervals, &s, err) != SF_OK)
            return err->status;
        double n = l->branches[k].count;
        l->inflate[k] = n / fmax(1, n - s.parameters);
    }
    return SF_OK;
}

sf_status sf_scatter_estimate(int branch_count, const sf_scatter_branch *branches, sf_scatter *scatter,
                              sf_error *err) {
    likelihood l = {.count = branch_count, .branches = branches};
    double size = 0;
    int intervals;
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    for (int k = 0; k < branch_count; k++)
        for (int i = 0; i < branches[k].count; i++)
            size = fmax(size, fabs(branches[k].y[i]));
    for (int k = 0; k < branch_count; k++) /* a first guess: one part in a hundred */
        for (int i = 0; i < branches[k].count; i++)
            branches[k].sigma[i] = hypot(1e-3 * size, 0.01 * branches[k].y[i]);
    for (int round = 0; round < ROUNDS && err->status == SF_OK; round++) {
        if (choose_intervals(branch_count, branches, SF_GRADING_ENDS, &intervals, err) == SF_OK &&
            set_inflation(&l, intervals, err) == SF_OK && minimise(&l, size, scatter, err) == SF_OK)
            set_sigma(branch_count, branches, scatter);
    }
    gsl_set_error_handler(handler);
    return err->status;
}

sf_status sf_scatter_intervals(int branch_count, const sf_scatter_branch *branches, int *intervals,
                               sf_error *err) {
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    choose_intervals(branch_count, branches, SF_GRADING_FOAM, intervals, err);
    gsl_set_error_handler(handler);
    return err->status;
}
