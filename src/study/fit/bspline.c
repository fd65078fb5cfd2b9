/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/bspline.h"

#include "study/fit/least_squares.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multimin.h>
#include <gsl/gsl_statistics_double.h>

static const double STRENGTH = 0.85; /* width at the ends over width in the middle: (1 - .) / (1 + .) */
static const double FOOT = 0.02;     /* strain over which a foam leaves its linear range */
static const double DENSE = 3; /* intervals per e-fold of the room left, to those per e-fold of the strain */

/* Intervals up to a strain, but for a factor. */
static double foam_number(double strain) {
    double x = fmax(0, strain);
    return log1p(x / FOOT) - DENSE * log1p(-x);
}

static double foam_place(double low, double high, double part) {
    double from = foam_number(low), goal = from + part * (foam_number(high) - from), a = low, b = high;
    for (int k = 0; k < 50; k++) {
        double middle = 0.5 * (a + b);
        *(foam_number(middle) < goal ? &a : &b) = middle;
    }
    return 0.5 * (a + b);
}

double sf_spline_grade(sf_spline_grading grading, double low, double high, double part) {
    if (grading != SF_GRADING_FOAM)
        return low + (high - low) * (part - STRENGTH * sin(2 * M_PI * part) / (2 * M_PI));
    if (part <= 0)
        return low;
    return part >= 1 ? high : foam_place(low, high, part);
}

double sf_spline_part(double high, double strain) {
    return foam_number(strain) / foam_number(high);
}

static bool enough(double low, double high, int set_count, const sf_spline_data *sets) {
    for (int k = 0; k < set_count; k++) {
        int inside = 0;
        for (int i = 0; i < sets[k].count; i++)
            inside += sets[k].x[i] >= low && sets[k].x[i] < high;
        if (inside < 2)
            return false;
    }
    return true;
}

int sf_spline_place(sf_spline_grading grading, int intervals, double low, double high, int set_count,
                    const sf_spline_data *sets, double breaks[SF_SPLINE_BREAKS]) {
    int count = 1;
    breaks[0] = low;
    for (int k = 1; k < intervals && count < SF_SPLINE_BREAKS - 1; k++) {
        double place = sf_spline_grade(grading, low, high, (double)k / intervals);
        if (enough(breaks[count - 1], place, set_count, sets))
            breaks[count++] = place;
    }
    while (count > 1 && !enough(breaks[count - 1], high, set_count, sets))
        count--;
    breaks[count++] = high;
    return count;
}

sf_status sf_spline_init(sf_spline *spline, int break_count, const double *breaks, sf_error *err) {
    *spline = (sf_spline){.count = break_count + SF_SPLINE_ORDER - 2};
    size_t n = (size_t)spline->count, b = (size_t)break_count;
    spline->base = gsl_bspline_alloc(SF_SPLINE_ORDER, b);
    spline->primary = gsl_bspline_alloc(SF_SPLINE_ORDER + 1, b);
    spline->higher = gsl_vector_alloc(n + 1);
    spline->slope = gsl_matrix_alloc(n, 2);
    if (!spline->base || !spline->primary || !spline->higher || !spline->slope)
        return SF_NO_MEMORY(err, "a spline of %d coefficients", spline->count);
    gsl_vector_const_view places = gsl_vector_const_view_array(breaks, b);
    gsl_bspline_knots(&places.vector, spline->base);
    gsl_bspline_knots(&places.vector, spline->primary);
    return SF_OK;
}

void sf_spline_free(sf_spline *spline) {
    if (spline->base) /* from GSL 2.8 on, gsl_bspline_free takes no NULL */
        gsl_bspline_free(spline->base);
    if (spline->primary)
        gsl_bspline_free(spline->primary);
    gsl_vector_free(spline->higher);
    gsl_matrix_free(spline->slope);
    *spline = (sf_spline){0};
}

void sf_spline_value(sf_spline *spline, double x, double *row) {
    gsl_vector_view out = gsl_vector_view_array(row, (size_t)spline->count);
    gsl_bspline_eval(x, &out.vector, spline->base);
}

void sf_spline_slope(sf_spline *spline, double x, double *row) {
    gsl_bspline_deriv_eval(x, 1, spline->slope, spline->base);
    for (int j = 0; j < spline->count; j++)
        row[j] = gsl_matrix_get(spline->slope, (size_t)j, 1);
}

/* The integral of B_j is (t_{j+4} - t_j)/4 times the sum of the splines of order 5 after the j-th (de Boor, A
 * practical guide to splines, chapter X). */
void sf_spline_integral(sf_spline *spline, double x, double *row) {
    const gsl_vector *t = spline->base->knots;
    double sum = 0;
    gsl_bspline_eval(x, spline->higher, spline->primary);
    for (int j = spline->count - 1; j >= 0; j--) {
        sum += gsl_vector_get(spline->higher, (size_t)j + 1);
        row[j] = sum * (gsl_vector_get(t, (size_t)j + SF_SPLINE_ORDER) - gsl_vector_get(t, (size_t)j)) /
                 SF_SPLINE_ORDER;
    }
}

double sf_spline_abscissa(const sf_spline *spline, int j) {
    return gsl_bspline_greville_abscissa((size_t)j, spline->base);
}

/* Intervals that are tried, coarse to fine. */
static const int TRIED[] = {3, 4, 5, 6, 8, 10, 12, 14, 17, 20, 24, 28, 34, SF_SCATTER_FINEST};
enum { TRIALS = sizeof TRIED / sizeof TRIED[0], ROUNDS = 3 };

/* Weighted least squares of one branch. `weighted` is the sum of squares of deviation over sigma, `parameters`
 * the number of coefficients. */
typedef struct smoothing {
    double weighted;
    int parameters;
} smoothing;

static sf_status solve(const sf_scatter_branch *b, sf_spline *spline, smoothing *out, sf_error *err) {
    size_t n = (size_t)spline->count, points = (size_t)b->count;
    SF_MATRIX *rows = sf_matrix(points, n, err), *normal = sf_matrix(n, n, err);
    SF_VECTOR *over = sf_vector(points, err), *right = sf_vector(n, err);
    SF_TRY(err->status);
    for (size_t i = 0; i < points; i++) {
        sf_spline_value(spline, b->x[i], gsl_matrix_ptr(rows, i, 0));
        gsl_vector_view row = gsl_matrix_row(rows, i);
        gsl_vector_scale(&row.vector, 1 / b->sigma[i]);
        gsl_vector_set(over, i, b->y[i] / b->sigma[i]);
    }
    gsl_blas_dsyrk(CblasLower, CblasTrans, 1, rows, 0, normal);
    gsl_blas_dgemv(CblasTrans, 1, rows, over, 0, right);
    gsl_vector_view diagonal = gsl_matrix_diagonal(normal);
    gsl_vector_add_constant(&diagonal.vector, 1e-12 * gsl_vector_max(&diagonal.vector)); /* without data */
    if (gsl_linalg_cholesky_decomp1(normal) != GSL_SUCCESS)
        return SF_FAIL(err, SF_ERR_NUMERIC, "a branch of %d points cannot be smoothed", b->count);
    gsl_linalg_cholesky_svx(normal, right);
    gsl_blas_dgemv(CblasNoTrans, -1, rows, right, 1, over); /* deviations over sigma */
    *out = (smoothing){pow(gsl_blas_dnrm2(over), 2), spline->count};
    for (size_t i = 0; i < points; i++)
        b->smooth[i] = b->y[i] - b->sigma[i] * gsl_vector_get(over, i);
    return SF_OK;
}

static sf_status smooth(const sf_scatter_branch *b, sf_spline_grading grading, int intervals, smoothing *out,
                        sf_error *err) {
    double breaks[SF_SPLINE_BREAKS], low, high;
    const sf_spline_data data = {b->x, b->count};
    SF_OWNED_BY(sf_spline_free) sf_spline spline = {0};
    gsl_stats_minmax(&low, &high, b->x, 1, (size_t)b->count);
    int count = sf_spline_place(grading, intervals, low, high, 1, &data, breaks);
    SF_TRY(sf_spline_init(&spline, count, breaks, err));
    return solve(b, &spline, out, err);
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
    double from[2] = {log(1e-3 * size), log(5e-3)}, by[2] = {1, 1};
    gsl_vector_view start = gsl_vector_view_array(from, 2), step = gsl_vector_view_array(by, 2);
    gsl_multimin_fminimizer *m = gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, 2);
    if (!m) {
        SF_NO_MEMORY(err, "the scatter");
    } else {
        gsl_multimin_fminimizer_set(m, &f, &start.vector, &step.vector);
        for (int k = 0; k < 200 && gsl_multimin_fminimizer_size(m) > 1e-3; k++)
            if (gsl_multimin_fminimizer_iterate(m) != GSL_SUCCESS)
                break;
        /* data without scatter: not below what a file's digits hold */
        scatter->absolute = fmax(exp(gsl_vector_get(m->x, 0)), 1e-7 * size);
        scatter->relative = fmax(exp(gsl_vector_get(m->x, 1)), 1e-7);
    }
    gsl_multimin_fminimizer_free(m);
    return err->status;
}

/* Deviations of the smoothed branches count for the coefficients that were spent on them. */
static sf_status set_inflation(likelihood *l, int intervals, sf_error *err) {
    for (int k = 0; k < l->count; k++) {
        smoothing s;
        SF_TRY(smooth(&l->branches[k], SF_GRADING_ENDS, intervals, &s, err));
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
    for (int k = 0; k < branch_count; k++)
        for (int i = 0; i < branches[k].count; i++)
            size = fmax(size, fabs(branches[k].y[i]));
    for (int k = 0; k < branch_count; k++) /* a first guess: one part in a hundred */
        for (int i = 0; i < branches[k].count; i++)
            branches[k].sigma[i] = hypot(1e-3 * size, 0.01 * branches[k].y[i]);
    for (int round = 0; round < ROUNDS && err->status == SF_OK; round++) {
        if (choose_intervals(branch_count, branches, SF_GRADING_ENDS, &intervals, err) == SF_OK &&
            set_inflation(&l, intervals, err) == SF_OK && minimise(&l, size, scatter, err) == SF_OK)
            for (int k = 0; k < branch_count; k++)
                for (int i = 0; i < branches[k].count; i++)
                    branches[k].sigma[i] =
                        hypot(scatter->absolute, scatter->relative * branches[k].smooth[i]);
    }
    return err->status;
}

sf_status sf_scatter_intervals(int branch_count, const sf_scatter_branch *branches, int *intervals,
                               sf_error *err) {
    return choose_intervals(branch_count, branches, SF_GRADING_FOAM, intervals, err);
}
