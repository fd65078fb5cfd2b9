/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/space_mapping.h"

#include "study/fit/least_squares.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <string.h>

enum { FIT_STEPS = 60 };
static const double DIFFERENCE = 1e-3; /* of the scaled parameters, for Jacobians */

/* A minimisation leaves a bound by no more than a part of the first; a parameter that leaves its bound again
 * begins the second away from it. */
static const double BOUND = 1e-3, RELEASE = 0.05;
enum { BOUND_ROUNDS = 8 };

/* One minimisation. */
typedef struct minimisation {
    sf_mapping_model model;
    const double *sd;                     /* [responses] */
    const double *about;                  /* [parameters] point that holds the step back */
    double radius;                        /* its standard deviation; INFINITY: free */
    bool held[SF_MAPPING_MAX_PARAMETERS]; /* at its bound in `bound` */
    double bound[SF_MAPPING_MAX_PARAMETERS];
    double *y;    /* [responses] scratch */
    sf_error err; /* of the surrogate, inside GSL */
} minimisation;

double sf_mapping_inside(const sf_mapping_problem *p, int j, double u) {
    return p->low ? fmin(fmax(u, p->low[j]), p->high[j]) : u;
}

sf_status sf_mapping_evaluate(const sf_mapping_model *a, const double *u, double *y, sf_error *err) {
    const sf_mapping_problem *p = a->problem;
    if (!a->linear)
        SF_TRY(p->surrogate(p->context, u, y, err));
    for (int i = 0; i < p->responses; i++) {
        y[i] = a->offset[i] + (a->linear ? 0 : y[i]);
        for (int j = 0; j < p->parameters; j++)
            y[i] += a->matrix[i * p->parameters + j] * (u[j] - a->anchor[j]);
    }
    return SF_OK;
}

double sf_mapping_residual(const sf_mapping_problem *p, const double *sd, const double *y, int i) {
    double over = y[i] - p->measured[i];
    if (p->bound_sd && !isinf(p->bound_sd[i]))
        return fmax(0, over) / p->bound_sd[i];
    return isinf(sd[i]) ? 0 : over / sd[i];
}

/* Residuals: data, prior, and what holds the step back and within the bounds. */
static int residuals(const gsl_vector *x, void *data, gsl_vector *f) {
    minimisation *m = data;
    const sf_mapping_problem *p = m->model.problem;
    double u[SF_MAPPING_MAX_PARAMETERS];
    sf_error err = SF_ERROR_INIT;
    for (int j = 0; j < p->parameters; j++)
        u[j] = m->held[j] ? m->bound[j] : sf_mapping_inside(p, j, gsl_vector_get(x, (size_t)j));
    if (sf_mapping_evaluate(&m->model, u, m->y, &err) != SF_OK) {
        m->err = err;
        for (size_t k = 0; k < f->size; k++)
            gsl_vector_set(f, k, 1e6);
        return GSL_SUCCESS; /* a point where the surrogate fails is a bad point, not the end */
    }
    size_t row = 0;
    for (int i = 0; i < p->responses; i++)
        gsl_vector_set(f, row++, sf_mapping_residual(p, m->sd, m->y, i));
    for (int j = 0; j < p->parameters; j++)
        gsl_vector_set(f, row++, (u[j] - p->prior[j]) / p->prior_sd[j]);
    for (int j = 0; j < p->parameters; j++)
        gsl_vector_set(f, row++,
                       (isinf(m->radius) ? 0 : (u[j] - m->about[j]) / m->radius) +
                           (gsl_vector_get(x, (size_t)j) - u[j]) / BOUND);
    return GSL_SUCCESS;
}

/* Their Jacobian by central differences: absolute steps, as the parameters are logarithms. */
static int residual_jacobian(const gsl_vector *x, void *data, gsl_matrix *jacobian) {
    sf_error err = SF_ERROR_INIT;
    SF_VECTOR *at = sf_vector(x->size, &err), *high = sf_vector(jacobian->size1, &err),
              *low = sf_vector(jacobian->size1, &err);
    for (size_t j = 0; j < x->size && err.status == SF_OK; j++) {
        gsl_vector_memcpy(at, x);
        gsl_vector_set(at, j, gsl_vector_get(x, j) + DIFFERENCE);
        residuals(at, data, high);
        gsl_vector_set(at, j, gsl_vector_get(x, j) - DIFFERENCE);
        residuals(at, data, low);
        gsl_vector_sub(high, low);
        gsl_vector_scale(high, 1 / (2 * DIFFERENCE));
        gsl_matrix_set_col(jacobian, j, high);
    }
    return err.status == SF_OK ? GSL_SUCCESS : GSL_ENOMEM;
}

/* Minimises from `u`, which gets the minimum; what is held stays. */
static sf_status descend(minimisation *m, double *u, sf_error *err) {
    const sf_mapping_problem *p = m->model.problem;
    size_t n = (size_t)p->responses + 2 * (size_t)p->parameters;
    gsl_multifit_nlinear_parameters options = gsl_multifit_nlinear_default_parameters();
    gsl_multifit_nlinear_fdf fdf = {
        .f = residuals, .df = residual_jacobian, .n = n, .p = (size_t)p->parameters, .params = m};
    gsl_multifit_nlinear_workspace *w =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &options, n, (size_t)p->parameters);
    if (!w)
        SF_NO_MEMORY(err, "a least-squares problem of %zu residuals", n);
    if (err->status == SF_OK) {
        int info = 0;
        gsl_vector_const_view start = gsl_vector_const_view_array(u, (size_t)p->parameters);
        gsl_multifit_nlinear_init(&start.vector, &fdf, w);
        gsl_multifit_nlinear_driver(FIT_STEPS, 1e-7, 1e-10, 1e-10, NULL, NULL, &info, w);
        for (int j = 0; j < p->parameters; j++)
            u[j] = m->held[j] ? m->bound[j] : sf_mapping_inside(p, j, gsl_vector_get(w->x, (size_t)j));
        if (sf_mapping_evaluate(&m->model, u, m->y, err) != SF_OK && m->err.status != SF_OK)
            *err = m->err;
    }
    gsl_multifit_nlinear_free(w);
    return err->status;
}

/* Sum of the squared residuals. */
static double cost(minimisation *m, const double *u, gsl_vector *f) {
    double square;
    gsl_vector_const_view x = gsl_vector_const_view_array(u, (size_t)m->model.problem->parameters);
    residuals(&x.vector, m, f);
    gsl_blas_ddot(f, f, &square);
    return square;
}

/* Holds the parameters that have reached a bound, and lets those go that fall from it. Returns if any did. */
static bool change_held(minimisation *m, double *u, gsl_vector *f) {
    const sf_mapping_problem *p = m->model.problem;
    bool changed = false;
    for (int j = 0; j < p->parameters; j++) {
        bool low = u[j] <= p->low[j], high = u[j] >= p->high[j], held = m->held[j];
        double least = cost(m, u, f), at = u[j];
        if (!low && !high)
            continue;
        m->held[j] = false;
        u[j] += low ? DIFFERENCE : -DIFFERENCE;
        m->held[j] = !(cost(m, u, f) < least);
        m->bound[j] = at;
        u[j] = m->held[j] ? at : at + (low ? RELEASE : -RELEASE);
        changed |= m->held[j] != held;
    }
    return changed;
}

sf_status sf_mapping_minimise(const sf_mapping_model *model, const double *sd, const double *about,
                              double hold, double *u, sf_error *err) {
    const sf_mapping_problem *p = model->problem;
    SF_VECTOR *f = sf_vector((size_t)p->responses + 2 * (size_t)p->parameters, err);
    SF_OWNED double *y = sf_alloc(err, p->responses, sizeof *y, "responses");
    minimisation m = {
        .model = *model, .sd = sd, .about = about, .radius = hold, .y = y, .err = SF_ERROR_INIT};
    for (int round = 0; round < BOUND_ROUNDS && err->status == SF_OK; round++)
        if (descend(&m, u, err) == SF_OK && (!p->low || !change_held(&m, u, f)))
            break;
    return err->status;
}

sf_status sf_mapping_differentiate(const sf_mapping_model *a, double *jacobian, sf_error *err) {
    const sf_mapping_problem *p = a->problem;
    double u[SF_MAPPING_MAX_PARAMETERS];
    SF_OWN(double, plus, p->responses, "responses", err);
    SF_OWN(double, minus, p->responses, "responses", err);
    for (int j = 0; j < p->parameters; j++) {
        memcpy(u, a->anchor, (size_t)p->parameters * sizeof *u);
        u[j] = a->anchor[j] + DIFFERENCE;
        SF_TRY(sf_mapping_evaluate(a, u, plus, err));
        u[j] = a->anchor[j] - DIFFERENCE;
        SF_TRY(sf_mapping_evaluate(a, u, minus, err));
        for (int i = 0; i < p->responses; i++)
            jacobian[i * p->parameters + j] = (plus[i] - minus[i]) / (2 * DIFFERENCE);
    }
    return SF_OK;
}
