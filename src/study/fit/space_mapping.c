/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/space_mapping.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIT_STEPS = 60 };
static const double DIFFERENCE = 1e-3; /* of the scaled parameters, for Jacobians */

/* The corrected surrogate, anchored at a simulated point. */
typedef struct anchor {
    const sf_mapping_problem *problem;
    const double *u;      /* [parameters] */
    const double *offset; /* [responses] */
    const double *matrix; /* [responses][parameters] */
} anchor;

/* Steps below it, in standard deviations, teach nothing about derivatives: the simulation's own noise would.
 */
static const double LEAST_UPDATE = 0.3;

/* One minimisation. */
typedef struct minimisation {
    anchor anchor;
    const double *sd;    /* [responses] */
    const double *about; /* [parameters] point that holds the step back */
    double radius;       /* its standard deviation; INFINITY: free */
    double *y;           /* [responses] scratch */
    sf_error err;        /* of the surrogate, inside GSL */
} minimisation;

static sf_status evaluate(const anchor *a, const double *u, double *y, sf_error *err) {
    const sf_mapping_problem *p = a->problem;
    if (p->surrogate(p->context, u, y, err) != SF_OK)
        return err->status;
    for (int i = 0; i < p->responses; i++) {
        y[i] += a->offset[i];
        for (int j = 0; j < p->parameters; j++)
            y[i] += a->matrix[i * p->parameters + j] * (u[j] - a->u[j]);
    }
    return SF_OK;
}

/* Residuals: data, prior, and what holds the step back. */
static int residuals(const gsl_vector *x, void *data, gsl_vector *f) {
    minimisation *m = data;
    const sf_mapping_problem *p = m->anchor.problem;
    sf_error err = SF_ERROR_INIT;
    if (evaluate(&m->anchor, x->data, m->y, &err) != SF_OK) {
        m->err = err;
        for (size_t k = 0; k < f->size; k++)
            gsl_vector_set(f, k, 1e6);
        return GSL_SUCCESS; /* a point where the surrogate fails is a bad point, not the end */
    }
    size_t row = 0;
    for (int i = 0; i < p->responses; i++)
        gsl_vector_set(f, row++, isinf(m->sd[i]) ? 0 : (m->y[i] - p->measured[i]) / m->sd[i]);
    for (int j = 0; j < p->parameters; j++)
        gsl_vector_set(f, row++, (gsl_vector_get(x, (size_t)j) - p->prior[j]) / p->prior_sd[j]);
    for (int j = 0; j < p->parameters; j++)
        gsl_vector_set(f, row++,
                       isinf(m->radius) ? 0 : (gsl_vector_get(x, (size_t)j) - m->about[j]) / m->radius);
    return GSL_SUCCESS;
}

/* Their Jacobian by central differences: absolute steps, as the parameters are logarithms. */
static int residual_jacobian(const gsl_vector *x, void *data, gsl_matrix *jacobian) {
    gsl_vector *at = gsl_vector_alloc(x->size), *high = gsl_vector_alloc(jacobian->size1),
               *low = gsl_vector_alloc(jacobian->size1);
    int status = at && high && low ? GSL_SUCCESS : GSL_ENOMEM;
    for (size_t j = 0; j < x->size && status == GSL_SUCCESS; j++) {
        gsl_vector_memcpy(at, x);
        gsl_vector_set(at, j, gsl_vector_get(x, j) + DIFFERENCE);
        residuals(at, data, high);
        gsl_vector_set(at, j, gsl_vector_get(x, j) - DIFFERENCE);
        residuals(at, data, low);
        gsl_vector_sub(high, low);
        gsl_vector_scale(high, 1 / (2 * DIFFERENCE));
        gsl_matrix_set_col(jacobian, j, high);
    }
    gsl_vector_free(at);
    gsl_vector_free(high);
    gsl_vector_free(low);
    return status;
}

/* Minimises from `u`, which gets the minimum. */
static sf_status minimise(minimisation *m, double *u, sf_error *err) {
    const sf_mapping_problem *p = m->anchor.problem;
    size_t n = (size_t)p->responses + 2 * (size_t)p->parameters;
    gsl_multifit_nlinear_parameters options = gsl_multifit_nlinear_default_parameters();
    gsl_multifit_nlinear_fdf fdf = {
        .f = residuals, .df = residual_jacobian, .n = n, .p = (size_t)p->parameters, .params = m};
    gsl_multifit_nlinear_workspace *w =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &options, n, (size_t)p->parameters);
    m->y = sf_alloc(err, (unsigned long)p->responses, sizeof *m->y, "responses");
    if (!w)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a least-squares problem of %zu residuals", n);
    if (err->status == SF_OK) {
        int info = 0;
        gsl_vector_const_view start = gsl_vector_const_view_array(u, (size_t)p->parameters);
        gsl_multifit_nlinear_init(&start.vector, &fdf, w);
        gsl_multifit_nlinear_driver(FIT_STEPS, 1e-7, 1e-10, 1e-10, NULL, NULL, &info, w);
        memcpy(u, w->x->data, (size_t)p->parameters * sizeof *u);
        if (evaluate(&m->anchor, u, m->y, err) != SF_OK && m->err.status != SF_OK)
            *err = m->err;
    }
    gsl_multifit_nlinear_free(w);
    free(m->y);
    return err->status;
}

/* Jacobian [responses][parameters] of the corrected surrogate by central differences. */
static sf_status differentiate(const anchor *a, double *jacobian, sf_error *err) {
    const sf_mapping_problem *p = a->problem;
    double u[SF_MAPPING_MAX_PARAMETERS];
    size_t n = (size_t)p->responses;
    double *plus = sf_alloc(err, n, sizeof *plus, "responses"),
           *minus = sf_alloc(err, n, sizeof *minus, "responses");
    for (int j = 0; j < p->parameters && err->status == SF_OK; j++) {
        memcpy(u, a->u, (size_t)p->parameters * sizeof *u);
        u[j] = a->u[j] + DIFFERENCE;
        if (evaluate(a, u, plus, err) != SF_OK)
            break;
        u[j] = a->u[j] - DIFFERENCE;
        if (evaluate(a, u, minus, err) != SF_OK)
            break;
        for (int i = 0; i < p->responses; i++)
            jacobian[i * p->parameters + j] = (plus[i] - minus[i]) / (2 * DIFFERENCE);
    }
    free(plus);
    free(minus);
    return err->status;
}

/* c = (a / scale^2 + prior)^-1; positive definite by the prior. */
static void invert_information(const sf_mapping_problem *p, const gsl_matrix *a, double scale,
                               gsl_matrix *c) {
    gsl_matrix_memcpy(c, a);
    gsl_matrix_scale(c, 1 / (scale * scale));
    for (int j = 0; j < p->parameters; j++)
        *gsl_matrix_ptr(c, (size_t)j, (size_t)j) += 1 / (p->prior_sd[j] * p->prior_sd[j]);
    gsl_linalg_cholesky_decomp1(c);
    gsl_linalg_cholesky_invert(c);
}

/* a = J^T J over the data, their number. */
static int collect_information(const sf_mapping_problem *p, const double *jacobian, gsl_matrix *a) {
    int data = 0, n = p->parameters;
    for (int i = 0; i < p->responses; i++) {
        if (isinf(p->sd[i]))
            continue;
        data++;
        const double *row = &jacobian[i * n];
        for (int j = 0; j < n; j++)
            for (int k = 0; k < n; k++)
                *gsl_matrix_ptr(a, (size_t)j, (size_t)k) += row[j] * row[k] / (p->sd[i] * p->sd[i]);
    }
    return data;
}

/* True if the residuals contradict the stated standard deviations (chi-squared, 5 %). */
static bool is_misfit(const sf_mapping_result *r) {
    return r->freedom > 0.5 && gsl_cdf_chisq_Q(r->misfit, r->freedom) < 0.05;
}

/* Covariance with the stated standard deviations of the data, or with those times the scale that the misfit
 * shows; degrees of freedom: data less trace(J C J^T). */
static sf_status estimate(const sf_mapping_problem *p, bool scaled, sf_mapping_result *r, sf_error *err) {
    size_t n = (size_t)p->parameters;
    gsl_matrix *a = gsl_matrix_calloc(n, n), *c = gsl_matrix_calloc(n, n);
    if (a && c) {
        double effective = 0;
        int data = collect_information(p, r->corrected, a);
        invert_information(p, a, 1, c);
        for (size_t j = 0; j < n; j++)
            for (size_t k = 0; k < n; k++)
                effective += gsl_matrix_get(a, j, k) * gsl_matrix_get(c, k, j);
        r->freedom = data - effective;
        r->scale = scaled && is_misfit(r) ? sqrt(r->misfit / r->freedom) : 1;
        invert_information(p, a, r->scale, c);
        for (size_t j = 0; j < n; j++)
            for (size_t k = 0; k < n; k++)
                r->covariance[j][k] = gsl_matrix_get(c, j, k);
    } else {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a covariance");
    }
    gsl_matrix_free(a);
    gsl_matrix_free(c);
    return err->status;
}

static double misfit_of(const sf_mapping_problem *p, const double *y) {
    double sum = 0;
    for (int i = 0; i < p->responses; i++)
        sum += isinf(p->sd[i]) ? 0 : pow((y[i] - p->measured[i]) / p->sd[i], 2);
    return sum;
}

static double prior_of(const sf_mapping_problem *p, const double *u) {
    double sum = 0;
    for (int j = 0; j < p->parameters; j++)
        sum += pow((u[j] - p->prior[j]) / p->prior_sd[j], 2);
    return sum;
}

/* A simulated point with the surrogate's value there. */
typedef struct point {
    double u[SF_MAPPING_MAX_PARAMETERS];
    double *y, *offset; /* [responses]; owned */
    double misfit, objective;
} point;

static sf_status simulate(const sf_mapping_problem *p, int iteration, point *at, sf_error *err) {
    if (p->simulate(p->context, at->u, at->y, err) != SF_OK ||
        p->surrogate(p->context, at->u, at->offset, err) != SF_OK)
        return err->status;
    for (int i = 0; i < p->responses; i++)
        at->offset[i] = at->y[i] - at->offset[i];
    at->misfit = misfit_of(p, at->y);
    at->objective = at->misfit + prior_of(p, at->u);
    if (p->progress)
        p->progress(p->context, iteration, at->u, at->y, at->objective);
    return SF_OK;
}

/* Broyden's update: M gives the change of the offset from `from` to `to`. */
static void update_matrix(const sf_mapping_problem *p, const point *from, const point *to, double *matrix) {
    double square = 0;
    for (int j = 0; j < p->parameters; j++)
        square += pow(to->u[j] - from->u[j], 2);
    for (int i = 0; i < p->responses && square > 0; i++) {
        double *row = &matrix[i * p->parameters], rest = to->offset[i] - from->offset[i];
        for (int j = 0; j < p->parameters; j++)
            rest -= row[j] * (to->u[j] - from->u[j]);
        for (int j = 0; j < p->parameters; j++)
            row[j] += rest * (to->u[j] - from->u[j]) / square;
    }
}

static void swap_points(point *a, point *b) {
    point c = *a;
    *a = *b;
    *b = c;
}

/* Largest step in standard deviations, with the curvature of the anchor's Jacobian. */
static sf_status measure_step(const sf_mapping_problem *p, sf_mapping_result *r, const point *best,
                              const double *next, double *step, sf_error *err) {
    anchor a = {p, best->u, best->offset, r->matrix};
    r->misfit = best->misfit;
    if (differentiate(&a, r->corrected, err) != SF_OK || estimate(p, false, r, err) != SF_OK)
        return err->status;
    *step = 0;
    for (int j = 0; j < p->parameters; j++)
        *step = fmax(*step, fabs(next[j] - best->u[j]) / sqrt(r->covariance[j][j]));
    return SF_OK;
}

/* The minimum of the corrected surrogate at `best`, held back by `radius`. */
static sf_status propose(const sf_mapping_problem *p, const sf_mapping_result *r, const point *best,
                         double radius, double *next, sf_error *err) {
    minimisation m = {.anchor = {p, best->u, best->offset, r->matrix},
                      .sd = p->sd,
                      .about = best->u,
                      .radius = radius,
                      .err = SF_ERROR_INIT};
    memcpy(next, best->u, (size_t)p->parameters * sizeof *next);
    return minimise(&m, next, err);
}

enum { WIDE_STARTS = 8 };

/* The same without a simulation behind it, from `best` and from places of a Halton sequence over the prior:
 * the lowest of their minima. */
static sf_status propose_widely(const sf_mapping_problem *p, const sf_mapping_result *r, const point *best,
                                double *next, sf_error *err) {
    double place[SF_MAPPING_MAX_PARAMETERS], lowest = INFINITY;
    double *y = sf_alloc(err, (unsigned long)p->responses, sizeof *y, "responses");
    gsl_qrng *places = gsl_qrng_alloc(gsl_qrng_halton, (unsigned)p->parameters);
    const anchor a = {p, best->u, best->offset, r->matrix};
    if (!places)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the starts of a search");
    for (int k = 0; k <= WIDE_STARTS && err->status == SF_OK; k++) {
        point from = *best;
        sf_error failure = SF_ERROR_INIT;
        if (k > 0)
            gsl_qrng_get(places, place);
        for (int j = 0; j < p->parameters && k > 0; j++)
            from.u[j] = p->prior[j] + p->prior_sd[j] * gsl_cdf_ugaussian_Pinv(place[j]);
        minimisation m = {
            .anchor = a, .sd = p->sd, .about = best->u, .radius = INFINITY, .err = SF_ERROR_INIT};
        if (minimise(&m, from.u, &failure) != SF_OK || evaluate(&a, from.u, y, &failure) != SF_OK) {
            if (failure.status == SF_ERR_MEMORY)
                *err = failure;
            continue; /* the law cannot be there */
        }
        double objective = misfit_of(p, y) + prior_of(p, from.u);
        if (objective < lowest) {
            lowest = objective;
            memcpy(next, from.u, (size_t)p->parameters * sizeof *next);
        }
    }
    if (isinf(lowest))
        memcpy(next, best->u, (size_t)p->parameters * sizeof *next);
    gsl_qrng_free(places);
    free(y);
    return err->status;
}

/* Finds by how much the objective falls from `best` to the trial, by the corrected surrogate; its y is
 * overwritten. */
static sf_status predict_gain(const sf_mapping_problem *p, const sf_mapping_result *r, const point *best,
                              point *trial, double *gain, sf_error *err) {
    anchor a = {p, best->u, best->offset, r->matrix};
    if (evaluate(&a, trial->u, trial->y, err) == SF_OK)
        *gain = best->objective - misfit_of(p, trial->y) - prior_of(p, trial->u);
    return err->status;
}

/* Simulates the trial point; a drop that fails numerically there is a point of infinite objective. */
static sf_status try_point(const sf_mapping_problem *p, int iteration, point *trial, sf_error *err) {
    sf_error failure = SF_ERROR_INIT;
    if (simulate(p, iteration, trial, &failure) == SF_OK)
        return SF_OK;
    if (failure.status != SF_ERR_NUMERIC)
        *err = failure;
    trial->objective = INFINITY;
    return err->status;
}

static double distance(const sf_mapping_problem *p, const point *a, const point *b) {
    double largest = 0;
    for (int j = 0; j < p->parameters; j++)
        largest = fmax(largest, fabs(a->u[j] - b->u[j]));
    return largest;
}

/* The end: the free step is short, or would gain nothing that counts, or two steps in a row changed nothing
 * that counts. A matrix that began as another problem's can make the step short in every parameter although
 * the objective would fall along correlated ones: the step must then gain little, too. */
static bool is_settled(const sf_mapping_problem *p, double step, double gain, int idle) {
    bool is_short = step < p->tolerance && (!p->first_matrix || gain < 2 * p->tolerance);
    return is_short || gain < p->tolerance * p->tolerance || idle >= 2;
}

/* The first simulation, at the minimum with the given offset or at the start; there too if it fails. */
static sf_status begin(const sf_mapping_problem *p, const sf_mapping_result *r, point *best, sf_error *err) {
    double next[SF_MAPPING_MAX_PARAMETERS];
    size_t size = (size_t)p->parameters * sizeof *next;
    sf_error failure = SF_ERROR_INIT;
    memcpy(best->u, p->start, size);
    if (!p->first_offset)
        return simulate(p, 0, best, err);
    if (p->first_point)
        memcpy(best->u, p->first_point, size);
    for (int i = 0; i < p->responses; i++)
        best->offset[i] = isfinite(p->first_offset[i]) ? p->first_offset[i] : 0;
    if (propose(p, r, best, INFINITY, next, &failure) == SF_OK) {
        memcpy(best->u, next, size);
        if (simulate(p, 0, best, &failure) == SF_OK)
            return SF_OK;
    }
    if (failure.status != SF_ERR_NUMERIC)
        return SF_FAIL(err, failure.status, "%s", failure.text);
    memcpy(best->u, p->start, size);
    return simulate(p, 0, best, err);
}

static sf_status iterate(const sf_mapping_problem *p, sf_mapping_result *r, point *best, point *trial,
                         sf_error *err) {
    double radius = INFINITY, step = 0, gain = 0;
    int idle = 0; /* steps in a row, taken or not, that changed the objective by nothing that counts */
    if (begin(p, r, best, err) != SF_OK)
        return err->status;
    for (r->iterations = 1;; r->iterations++) {
        bool widely = p->exact && r->iterations == 1;
        if ((widely ? propose_widely(p, r, best, trial->u, err)
                    : propose(p, r, best, INFINITY, trial->u, err)) != SF_OK ||
            measure_step(p, r, best, trial->u, &step, err) != SF_OK ||
            predict_gain(p, r, best, trial, &gain, err) != SF_OK)
            return err->status;
        r->gain = gain;
        r->converged = is_settled(p, step, gain, idle);
        if (r->converged || r->iterations == p->max_iterations)
            return estimate(p, true, r, err);
        if ((!isinf(radius) && propose(p, r, best, radius, trial->u, err) != SF_OK) ||
            measure_step(p, r, best, trial->u, &step, err) != SF_OK ||
            try_point(p, r->iterations, trial, err) != SF_OK)
            return err->status;
        if (isfinite(trial->objective) && step > LEAST_UPDATE)
            update_matrix(p, best, trial, r->matrix);
        idle = fabs(best->objective - trial->objective) < 2 * p->tolerance ? idle + 1 : 0;
        if (trial->objective < best->objective) {
            swap_points(best, trial);
            radius *= 2;
        } else {
            radius = fmin(radius, distance(p, trial, best)) / 2;
        }
    }
}

sf_status sf_mapping_solve(const sf_mapping_problem *p, sf_mapping_result *r, sf_error *err) {
    unsigned long n = (unsigned long)p->responses, entries = n * (unsigned long)p->parameters;
    *r = (sf_mapping_result){0};
    r->corrected = sf_alloc(err, entries, sizeof(double), "Jacobian");
    r->matrix = sf_alloc(err, entries, sizeof(double), "Broyden matrix");
    point best = {.y = sf_alloc(err, n, sizeof(double), "responses"),
                  .offset = sf_alloc(err, n, sizeof(double), "responses")};
    point trial = {.y = sf_alloc(err, n, sizeof(double), "responses"),
                   .offset = sf_alloc(err, n, sizeof(double), "responses")};
    for (unsigned long k = 0; err->status == SF_OK && p->first_matrix && k < entries; k++)
        r->matrix[k] = isfinite(p->first_matrix[k]) ? p->first_matrix[k] : 0;
    if (err->status == SF_OK)
        iterate(p, r, &best, &trial, err);
    memcpy(r->u, best.u, sizeof r->u);
    r->y = best.y;
    r->offset = best.offset;
    r->misfit = best.misfit;
    r->objective = best.objective;
    free(trial.y);
    free(trial.offset);
    return err->status;
}

void sf_mapping_free(sf_mapping_result *r) {
    free(r->y);
    free(r->corrected);
    free(r->offset);
    free(r->matrix);
    *r = (sf_mapping_result){0};
}

sf_status sf_mapping_refit(const sf_mapping_problem *p, const sf_mapping_result *r, const double *sd,
                           double *u, double *y, sf_error *err) {
    minimisation m = {.anchor = {p, r->u, r->offset, r->matrix},
                      .sd = sd,
                      .about = r->u,
                      .radius = INFINITY,
                      .err = SF_ERROR_INIT};
    memcpy(u, r->u, (size_t)p->parameters * sizeof *u);
    if (minimise(&m, u, err) != SF_OK)
        return err->status;
    return evaluate(&m.anchor, u, y, err);
}
