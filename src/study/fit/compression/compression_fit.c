/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_fit.h"

#include "study/fit/least_squares.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_multifit_nlinear.h>

static const char AT_BOUND[] = "at the bound of the search: not identified by these tests";
enum { ITERATIONS = 150, MAXWELL_STARTS = 4 };
static const double STEP_TOLERANCE = 1e-7, GRADIENT_TOLERANCE = 1e-9;
static const double DIFFERENCE = 6e-6; /* of derivatives, by the parameter */
static const double RANK_TOLERANCE = 1e-7; /* columns of the Jacobian below it do not bear on the data */

/* ---- one search ---- */

/* One side of the tests: loading with its parameters, or unloading with its own, given the loading. A law of
 * unloading that does not fit so cannot bend the loading curve. */
typedef struct problem {
    const sf_compression_model *model;
    bool unloading;
    gsl_vector *all;     /* every parameter */
    gsl_vector_view own; /* those of the side, which are searched */
    double *stress;      /* scratch */
} problem;

static size_t first_of(const sf_compression_model *model, bool unloading) {
    return unloading ? (size_t)model->loading_count : 0;
}

static size_t count_of(const sf_compression_model *model, bool unloading) {
    return (size_t)(unloading ? model->parameter_count - model->loading_count : model->loading_count);
}

static int points_of(const sf_compression_data *d, bool unloading) {
    int count = 0;
    for (int i = 0; i < d->count; i++)
        count += d->unloading[i] == unloading;
    return count;
}

static int deviations(const gsl_vector *x, void *context, gsl_vector *out) {
    problem *p = context;
    const sf_compression_data *d = p->model->data;
    gsl_vector_memcpy(&p->own.vector, x);
    sf_compression_predict(p->model, p->all, p->unloading, p->stress);
    for (int i = 0, k = 0; i < d->count; i++)
        if (d->unloading[i] == p->unloading)
            gsl_vector_set(out, (size_t)k++, (p->stress[i] - d->stress[i]) / d->sigma[i]);
    return GSL_SUCCESS;
}

/* Searches the side's parameters from those in `x`, into which the minimum goes; returns chi2, INFINITY if
 * the search fails. `covariance` [side's parameters] may be NULL. */
static double search(const sf_compression_model *model, bool unloading, gsl_vector *x, gsl_matrix *covariance,
                     sf_error *err) {
    size_t n = (size_t)points_of(model->data, unloading), p = count_of(model, unloading);
    SF_OWNED double *stress = sf_alloc(err, model->data->count, sizeof *stress, "stresses");
    problem context = {model, unloading, x, gsl_vector_subvector(x, first_of(model, unloading), p), stress};
    gsl_multifit_nlinear_fdf fdf = {.f = deviations, .n = n, .p = p, .params = &context};
    gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
    how.solver = gsl_multifit_nlinear_solver_cholesky;
    how.scale =
        gsl_multifit_nlinear_scale_levenberg; /* parameters are logarithms: a flat one stays where it is */
    how.fdtype = GSL_MULTIFIT_NLINEAR_CTRDIFF;
    how.h_df = DIFFERENCE;
    gsl_multifit_nlinear_workspace *w =
        n > p ? gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, n, p) : NULL;
    SF_VECTOR *start = sf_vector(p, err);
    double chi2 = INFINITY;
    int info;
    if (n > p && !w)
        SF_NO_MEMORY(err, "a fit of %zu parameters to %zu points", p, n);
    if (w && err->status == SF_OK) {
        gsl_vector_memcpy(start, &context.own.vector);
        if (gsl_multifit_nlinear_init(start, &fdf, w) == GSL_SUCCESS) {
            gsl_multifit_nlinear_driver(ITERATIONS, STEP_TOLERANCE, GRADIENT_TOLERANCE, 0, NULL, NULL, &info,
                                        w);
            chi2 = pow(gsl_blas_dnrm2(gsl_multifit_nlinear_residual(w)), 2);
            gsl_vector_memcpy(&context.own.vector, isfinite(chi2) ? gsl_multifit_nlinear_position(w) : start);
            if (covariance)
                gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(w), RANK_TOLERANCE, covariance);
        }
    }
    gsl_multifit_nlinear_free(w);
    return isfinite(chi2) ? chi2 : INFINITY;
}

/* Searches the loading from the guess; the Maxwell branch from several decay rates, of which the best is gone
 * on with. `best` has the guess of unloading. */
static sf_status search_loading(const sf_compression_model *model, gsl_vector *best, double *chi2,
                                sf_error *err) {
    int starts = model->form.rate == SF_RATE_MAXWELL ? MAXWELL_STARTS : 1;
    SF_VECTOR *x = sf_vector((size_t)model->parameter_count, err);
    *chi2 = INFINITY;
    for (int k = 0; k < starts && err->status == SF_OK; k++) {
        sf_compression_guess(model, (k + 1.0) / (starts + 1), x);
        double value = search(model, false, x, NULL, err);
        if (value < *chi2 || k == 0) {
            *chi2 = value;
            gsl_vector_memcpy(best, x);
        }
    }
    return err->status;
}

/* ---- choice ---- */

static sf_status try_form(const sf_compression_data *data, sf_compression_form form, sf_candidate *candidate,
                          sf_error *err) {
    SF_OWNED_BY(sf_compression_model_free) sf_compression_model model = {0};
    SF_TRY(sf_compression_model_init(data, form, &model, err));
    SF_VECTOR *x = sf_vector((size_t)model.parameter_count, err);
    double n = points_of(data, false);
    if (err->status == SF_OK && search_loading(&model, x, &candidate->chi2, err) == SF_OK)
        *candidate = (sf_candidate){true, model.loading_count, candidate->chi2,
                                    n * log(candidate->chi2 / n) + model.loading_count * log(n)};
    return err->status;
}

/* First the rate dependence, with the prescribed densification or the free exponent of H1; then, unless it is
 * prescribed, the densification. A = 0 is fitted for the report, but not chosen: with one parameter less it
 * would win wherever the data do not determine A, with intervals that are too narrow. */
static sf_status choose(sf_compression_fit *fit, sf_compression_form *form, sf_error *err) {
    static const sf_rule prescribed[] = {[SF_RULE_AUTO] = SF_H1_FREE,
                                         [SF_RULE_H1] = SF_H1_FREE,
                                         [SF_RULE_H1_AUTOMATIC] = SF_H1_AUTO,
                                         [SF_RULE_H2] = SF_H2};
    const sf_compression_config *c = fit->data.config;
    *form =
        (sf_compression_form){c->test_count == 1 ? SF_RATE_NONE : c->rate_model, prescribed[c->rule], false};
    if (form->rate == SF_RATE_AUTO) {
        for (int k = 0; k < SF_RATE_MODELS; k++)
            SF_TRY(try_form(&fit->data, (sf_compression_form){(sf_rate_model)k, form->rule, false},
                            &fit->rate[k], err));
        form->rate = SF_RATE_NONE; /* all were tried */
        for (int k = 1; k < SF_RATE_MODELS; k++)
            form->rate = fit->rate[k].bic < fit->rate[form->rate].bic ? (sf_rate_model)k : form->rate;
    }
    if (c->rule != SF_RULE_AUTO)
        return SF_OK;
    for (int k = 0; k < SF_RULES; k++)
        SF_TRY(
            try_form(&fit->data, (sf_compression_form){form->rate, (sf_rule)k, false}, &fit->rule[k], err));
    form->rule = fit->rule[SF_H2].bic < fit->rule[SF_H1_FREE].bic ? SF_H2 : SF_H1_FREE;
    return SF_OK;
}

/* ---- estimates with their intervals ---- */

/* Correlation of neighbouring deviations of a branch. Independent ones have 0 +- 1/sqrt(count). */
static double neighbour_correlation(const sf_compression_fit *fit, bool unloading) {
    const sf_compression_data *d = &fit->data;
    double product = 0, square = 0;
    for (int i = 0; i < d->count; i++) {
        double r = (d->stress[i] - fit->stress[i]) / d->sigma[i];
        if (d->unloading[i] != unloading)
            continue;
        square += r * r;
        if (i > 0 && d->test[i] == d->test[i - 1] && d->unloading[i] == d->unloading[i - 1])
            product += r * (d->stress[i - 1] - fit->stress[i - 1]) / d->sigma[i - 1];
    }
    return square > 0 ? product / square : 0;
}

double sf_compression_error(const sf_compression_fit *fit, sf_compression_quantity *quantity, int which,
                            double at) {
    size_t p = fit->parameters->size;
    double gradient[SF_COMPRESSION_PARAMETERS], variance = 0;
    for (size_t i = 0; i < p; i++) {
        double value = gsl_vector_get(fit->parameters, i), h = DIFFERENCE * fmax(1, fabs(value)), side[2];
        for (int k = 0; k < 2; k++) {
            gsl_vector_set(fit->parameters, i, value + (k ? h : -h));
            side[k] = quantity(&fit->model, fit->parameters, which, at);
        }
        gsl_vector_set(fit->parameters, i, value);
        gradient[i] = (side[1] - side[0]) / (2 * h);
    }
    for (size_t i = 0; i < p; i++)
        for (size_t j = 0; j < p; j++)
            variance += gradient[i] * gradient[j] * gsl_matrix_get(fit->covariance, i, j);
    return sqrt(fmax(0, variance));
}

static double number_of(const sf_compression_model *model, const gsl_vector *x, int which, double at) {
    return (void)at, sf_compression_number(model, x, (sf_number)which);
}

static double exponent_of(const sf_compression_model *model, const gsl_vector *x, int which, double at) {
    return (void)which, (void)at, sf_compression_exponent(model, x);
}

/* Interval of value +- t error, or of its logarithm for a number that has no zero. */
static void set_interval(const sf_compression_fit *fit, bool logarithmic, double low, double high,
                         sf_estimate *e) {
    double width = fit->quantile * e->error;
    if (logarithmic) {
        e->low = e->value * exp(-width / e->value);
        e->high = e->value * exp(width / e->value);
    } else {
        e->low = e->value - width;
        e->high = e->value + width;
    }
    e->low = fmax(e->low, low);
    e->high = fmin(e->high, high);
}

static void estimate_number(const sf_compression_fit *fit, sf_number number, bool logarithmic,
                            sf_estimate *e) {
    const sf_number_range *r = &fit->model.range[number];
    e->present = r->index >= 0;
    e->value = sf_compression_number(&fit->model, fit->parameters, number);
    if (!e->present)
        return;
    double part = r->logarithmic ? log(e->value / r->low) / log(r->high / r->low)
                                 : (e->value - r->low) / (r->high - r->low);
    e->error = sf_compression_error(fit, number_of, (int)number, 0);
    bool at_bound = isfinite(r->high) && (part < 1e-4 || part > 1 - 1e-4);
    if (at_bound || !(e->error > 0)) {
        e->note = at_bound ? AT_BOUND : "not identified by these tests";
        e->error = NAN;
    }
    bool hu = number == SF_NUMBER_HU, bounded = hu || number == SF_NUMBER_LIMIT;
    double least = hu ? 0 : r->low;
    if (isfinite(e->error))
        set_interval(fit, logarithmic, bounded ? least : -INFINITY, bounded ? 1 : INFINITY, e);
    if (isfinite(e->error) && hu && e->low <= 0)
        e->note = "not distinguishable from zero by these tests";
}

static void estimate_exponent(const sf_compression_fit *fit, sf_estimate *e) {
    e->present = true;
    e->value = sf_compression_exponent(&fit->model, fit->parameters);
    e->error = sf_compression_error(fit, exponent_of, 0, 0);
    set_interval(fit, true, 0, INFINITY, e);
    bool follows = fit->model.form.rule == SF_H1_AUTO;
    if (!follows && (!(e->error > 0) || e->value > 59.9 || e->value < 0.0501)) {
        e->note = AT_BOUND;
        e->error = e->low = e->high = NAN;
    } else if (e->value < 1)
        e->note =
            "below 1: beyond the tests the foam takes little energy up to full compression; do not use it "
            "for strains beyond theirs";
    else if (follows)
        e->note = "follows from value and slope where densification starts (A = 0)";
}

/* Slope of the line through the loading of one test, the slowest, below the strain E_range. Its variance is
 * that of the scatter: the curve's own bend within the range is no uncertainty of the slope. */
static void estimate_modulus(const sf_compression_fit *fit, sf_estimate *e) {
    const sf_compression_data *d = &fit->data;
    double weight[4096], c0, c00, c01, c11, chi2;
    int first, count, used = 0;
    sf_compression_branch(d, d->config->middle, false, &first, &count);
    for (; used < count && used < 4096 && d->strain[first + used] <= d->config->modulus_range; used++)
        weight[used] = 1 / (d->sigma[first + used] * d->sigma[first + used]);
    gsl_fit_wlinear(&d->strain[first], 1, weight, 1, &d->stress[first], 1, (size_t)used, &c0, &e->value, &c00,
                    &c01, &c11, &chi2);
    e->present = true;
    e->error = sqrt(c11 * fit->side[0].serial);
    set_interval(fit, false, -INFINITY, INFINITY, e);
    if (!(e->low > 0))
        e->note = "not distinguishable from zero by these tests";
}

static void estimate_all(sf_compression_fit *fit) {
    static const struct {
        const char *name, *key, *unit;
        int number; /* sf_number; -1: found otherwise */
        bool logarithmic;
    } table[SF_ESTIMATES] = {
        [SF_ESTIMATE_E] = {"E", "E_Pa", "Pa", -1, false},
        [SF_ESTIMATE_HU] = {"HU", "HU", "", SF_NUMBER_HU, false},
        [SF_ESTIMATE_SHAPE] = {"SHAPE", "SHAPE", "", SF_NUMBER_SHAPE, true},
        [SF_ESTIMATE_ALPHA] = {"ALPHA", "ALPHA", "", SF_NUMBER_ALPHA, true},
        [SF_ESTIMATE_LOG_RATE] = {"c (log rate)", "log_rate_c", "", SF_NUMBER_LOG_RATE, false},
        [SF_ESTIMATE_ED] = {"ED", "ED_Pa", "Pa", SF_NUMBER_ED, true},
        [SF_ESTIMATE_BETA1] = {"BETA1", "BETA1_1_s", "1/s", SF_NUMBER_BETA1, true},
        [SF_ESTIMATE_EXPONENT] = {"exponent", "exponent", "", -1, false},
        [SF_ESTIMATE_LIMIT] = {"limit", "limit", "", SF_NUMBER_LIMIT, false},
    };
    for (int k = 0; k < SF_ESTIMATES; k++) {
        fit->estimate[k] =
            (sf_estimate){table[k].name, table[k].key, table[k].unit, false, NAN, NAN, NAN, NAN, ""};
        if (table[k].number >= 0)
            estimate_number(fit, (sf_number)table[k].number, table[k].logarithmic, &fit->estimate[k]);
    }
    estimate_modulus(fit, &fit->estimate[SF_ESTIMATE_E]);
    for (int k = SF_ESTIMATE_HU; k <= SF_ESTIMATE_SHAPE; k++)
        if (!fit->estimate[k].present) {
            fit->estimate[k].present = true;
            fit->estimate[k].note = "not measured: no test unloads; 1 means no hysteresis";
        }
    estimate_exponent(fit, &fit->estimate[SF_ESTIMATE_EXPONENT]);
}

/* Strains of the table, graded as the knots, and three close together where densification starts, from whose
 * slope the solver joins it. */
static void place_table(sf_compression_fit *fit) {
    enum { GRADED = SF_COMPRESSION_TABLE - 3 };
    static const double BESIDE = 2e-4, CLEAR = 3e-3;
    const double start = fit->data.start, end = fit->data.end;
    bool placed = false;
    fit->table_count = 0;
    for (int k = 0; k < GRADED; k++) {
        double strain = sf_spline_grade(SF_GRADING_FOAM, 0, end, k / (GRADED - 1.0));
        for (int side = -1; side <= 1 && !placed && strain > start - CLEAR; side++)
            fit->table_strain[fit->table_count++] = start + side * BESIDE;
        placed = placed || strain > start - CLEAR;
        if (fabs(strain - start) > CLEAR)
            fit->table_strain[fit->table_count++] = strain;
    }
}

static void fill_table(sf_compression_fit *fit) {
    sf_rate_model rate = fit->model.form.rate;
    fit->rate_count = rate == SF_RATE_LOG || rate == SF_RATE_CURVES ? fit->data.config->test_count : 1;
    place_table(fit);
    for (int r = 0; r < fit->rate_count; r++)
        for (int k = 0; k < fit->table_count; k++) {
            double strain = fit->table_strain[k];
            fit->table_stress[r][k] = sf_compression_curve(&fit->model, fit->parameters, r, strain);
            fit->table_error[r][k] = sf_compression_error(fit, sf_compression_curve, r, strain);
        }
}

/* Root mean square of the deviations of a side, over the stress and over the largest stress of all tests. */
static void measure_side(const sf_compression_fit *fit, bool unloading, sf_side *side) {
    const sf_compression_data *d = &fit->data;
    double relative = 0, absolute = 0, largest = d->largest;
    for (int i = 0; i < d->count; i++) {
        double off = fit->stress[i] - d->stress[i];
        if (d->unloading[i] != unloading)
            continue;
        relative += pow(off / fmax(d->stress[i], 0.01 * largest), 2);
        absolute += pow(off / largest, 2);
    }
    side->relative = sqrt(relative / side->points);
    side->of_largest = sqrt(absolute / side->points);
}

/* Searches the unloading from what stands in `x` and from other places: its minimum is not the only one. */
static double search_unloading(const sf_compression_model *model, gsl_vector *x, sf_error *err) {
    static const double starts[][3] = {
        {-2, -1, 0}, {-4, -2, -1}, {0, 0, -1.5}, {-5, 1, 1}}; /* on the real line */
    size_t first = first_of(model, true), count = count_of(model, true);
    SF_VECTOR *trial = sf_vector(x->size, err);
    double best = search(model, true, x, NULL, err);
    for (size_t s = 0; s < sizeof starts / sizeof *starts && err->status == SF_OK; s++) {
        gsl_vector_memcpy(trial, x);
        for (size_t k = 0; k < count; k++)
            gsl_vector_set(trial, first + k, starts[s][k]);
        double chi2 = search(model, true, trial, NULL, err);
        if (chi2 < best) {
            best = chi2;
            gsl_vector_memcpy(x, trial);
        }
    }
    return best;
}

/* Unloading with ALPHA, from what was found without it: taken if the points ask for it (BIC). */
static sf_status try_alpha(sf_compression_fit *fit, sf_error *err) {
    SF_OWNED_BY(sf_compression_model_free) sf_compression_model model = {0};
    const sf_compression_form form = {fit->model.form.rate, fit->model.form.rule, true};
    double n = points_of(&fit->data, true);
    if (fit->model.form.alpha)
        return SF_OK;
    SF_TRY(sf_compression_model_init(&fit->data, form, &model, err));
    SF_VECTOR *x = sf_vector((size_t)model.parameter_count, err);
    if (err->status == SF_OK) {
        sf_compression_guess(&model, 0.5, x);
        for (size_t k = 0; k < fit->parameters->size; k++) /* ALPHA is the last */
            gsl_vector_set(x, k, gsl_vector_get(fit->parameters, k));
        double chi2 = search_unloading(&model, x, err);
        if (n * log(chi2 / fit->side[1].chi2) + log(n) < 0) {
            sf_compression_model old = fit->model;
            gsl_vector *without = fit->parameters;
            fit->side[1].chi2 = chi2;
            fit->model = model;
            fit->parameters = x;
            model = old;
            x = without;
        }
    }
    return err->status;
}

/* Derivatives of the deviations of unloading by all parameters: [points][parameters]. */
static sf_status differentiate(sf_compression_fit *fit, gsl_matrix *out, sf_error *err) {
    const sf_compression_data *d = &fit->data;
    SF_OWN(double, side, 2 * d->count, "stresses", err);
    for (size_t j = 0; j < out->size2; j++) {
        double value = gsl_vector_get(fit->parameters, j), h = DIFFERENCE * fmax(1, fabs(value));
        for (int k = 0; k < 2; k++) {
            gsl_vector_set(fit->parameters, j, value + (k ? h : -h));
            sf_compression_predict(&fit->model, fit->parameters, true, &side[k * d->count]);
        }
        gsl_vector_set(fit->parameters, j, value);
        for (int i = 0, row = 0; i < d->count; i++)
            if (d->unloading[i])
                gsl_matrix_set(out, (size_t)row++, j, (side[d->count + i] - side[i]) / (2 * h * d->sigma[i]));
    }
    return SF_OK;
}

/* The unloading was found for the loading's parameters, whose uncertainty it inherits: with J1 and J2 the
 * derivatives of its deviations by both, x2 moves by G = -(J2'J2)^-1 J2'J1 for a unit of x1. */
static sf_status join_covariances(sf_compression_fit *fit, const gsl_matrix *unloading, sf_error *err) {
    const size_t p1 = count_of(&fit->model, false), p2 = count_of(&fit->model, true),
                 n = (size_t)points_of(&fit->data, true);
    SF_MATRIX *change = sf_matrix(n, p1 + p2, err), *cross = sf_matrix(p2, p1, err), *g = sf_matrix(p2, p1, err);
    gsl_matrix_view c11 = gsl_matrix_submatrix(fit->covariance, 0, 0, p1, p1),
                    c21 = gsl_matrix_submatrix(fit->covariance, p1, 0, p2, p1),
                    c12 = gsl_matrix_submatrix(fit->covariance, 0, p1, p1, p2),
                    c22 = gsl_matrix_submatrix(fit->covariance, p1, p1, p2, p2);
    SF_TRY(err->status);
    SF_TRY(differentiate(fit, change, err));
    gsl_matrix_view j1 = gsl_matrix_submatrix(change, 0, 0, n, p1),
                    j2 = gsl_matrix_submatrix(change, 0, p1, n, p2);
    gsl_blas_dgemm(CblasTrans, CblasNoTrans, 1, &j2.matrix, &j1.matrix, 0, cross);
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, -1, unloading, cross, 0, g);
    gsl_matrix_memcpy(&c22.matrix, unloading);
    gsl_matrix_scale(&c22.matrix, fit->side[1].factor * fit->side[1].serial);
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, g, &c11.matrix, 0, &c21.matrix);
    gsl_blas_dgemm(CblasNoTrans, CblasTrans, 1, &c21.matrix, g, 1, &c22.matrix);
    gsl_matrix_transpose_memcpy(&c12.matrix, &c21.matrix);
    return err->status;
}

/* Both sides again with their covariances, at the minimum. */
static sf_status find_errors(sf_compression_fit *fit, sf_error *err) {
    const size_t p[2] = {count_of(&fit->model, false), count_of(&fit->model, true)};
    SF_MATRIX *loading = sf_matrix(p[0], p[0], err), *unloading = p[1] > 0 ? sf_matrix(p[1], p[1], err) : NULL;
    fit->covariance = sf_matrix(p[0] + p[1], p[0] + p[1], err);
    for (int k = 0; k < (p[1] > 0 ? 2 : 1) && err->status == SF_OK; k++) {
        sf_side *side = &fit->side[k];
        side->points = points_of(&fit->data, k == 1);
        side->chi2 = search(&fit->model, k == 1, fit->parameters, k ? unloading : loading, err);
        side->factor = side->chi2 / ((double)side->points - (double)p[k]);
        side->misfit = fmax(side->misfit, side->factor);
    }
    for (int k = 0; k < 2; k++) {
        /* deviations that hang together count for fewer points: (1 + r)/(1 - r) for the variance of a mean */
        sf_side *side = &fit->side[k];
        sf_compression_predict(&fit->model, fit->parameters, k == 1, fit->stress);
        side->correlation = neighbour_correlation(fit, k == 1);
        double r = fmin(0.98, side->correlation);
        side->serial = r > 2 / sqrt(side->points) ? (1 + r) / (1 - r) : 1;
    }
    SF_TRY(err->status);
    gsl_matrix_view c11 = gsl_matrix_submatrix(fit->covariance, 0, 0, p[0], p[0]);
    gsl_matrix_memcpy(&c11.matrix, loading);
    gsl_matrix_scale(&c11.matrix, fit->side[0].factor * fit->side[0].serial);
    return p[1] > 0 ? join_covariances(fit, unloading, err) : SF_OK;
}

/* If the law misses the unloading by far more than the scatter, the scatter is not what tells how much a
 * point means: the points of small stress would decide. The law's error, a constant part of the largest
 * stress, is added to it. */
static sf_status weigh_by_law(sf_compression_fit *fit, sf_error *err) {
    static const double FAR = 4;
    const sf_compression_data *d = &fit->data;
    sf_side *side = &fit->side[1];
    side->points = points_of(d, true);
    side->misfit = side->chi2 / ((double)side->points - (double)count_of(&fit->model, true));
    if (!(side->misfit > FAR))
        return SF_OK;
    sf_compression_predict(&fit->model, fit->parameters, true, fit->stress);
    measure_side(fit, true, side);
    side->law_error = side->of_largest;
    for (int i = 0; i < d->count; i++)
        if (d->unloading[i])
            d->sigma[i] = hypot(d->sigma[i], side->law_error * d->largest);
    side->chi2 = search_unloading(&fit->model, fit->parameters, err);
    return err->status == SF_OK && isfinite(side->chi2) ? try_alpha(fit, err) : err->status;
}

static sf_status finish(sf_compression_fit *fit, sf_error *err) {
    const sf_compression_config *c = fit->data.config;
    fit->parameters = sf_vector((size_t)fit->model.parameter_count, err);
    fit->stress = sf_alloc(err, fit->data.count, sizeof *fit->stress, "fitted stresses");
    SF_TRY(err->status);
    bool unloads = count_of(&fit->model, true) > 0;
    SF_TRY(search_loading(&fit->model, fit->parameters, &fit->side[0].chi2, err));
    if (isfinite(fit->side[0].chi2) && unloads) {
        fit->side[1].chi2 = search_unloading(&fit->model, fit->parameters, err);
        if (err->status == SF_OK && isfinite(fit->side[1].chi2)) {
            SF_TRY(try_alpha(fit, err));
            SF_TRY(weigh_by_law(fit, err));
        }
    }
    if (err->status == SF_OK && isfinite(fit->side[0].chi2) && isfinite(fit->side[1].chi2))
        SF_TRY(find_errors(fit, err));
    double left = fit->data.count - fit->model.parameter_count;
    if (err->status != SF_OK || !(fit->side[0].misfit > 0) || (unloads && !(fit->side[1].misfit > 0)) ||
        !isfinite(fit->side[0].chi2 + fit->side[1].chi2))
        return SF_FAIL(err, SF_ERR_NUMERIC,
                       "the fit of %d parameters to %d points did not converge; fewer forms can be asked for "
                       "with rate_model and densification",
                       fit->model.parameter_count, fit->data.count);
    fit->chi2 = fit->side[0].chi2 + fit->side[1].chi2;
    fit->misfit = fit->chi2 / left;
    for (int k = 0; k < (unloads ? 2 : 1); k++)
        measure_side(fit, k == 1, &fit->side[k]);
    if (!unloads)
        fit->side[1].misfit = fit->side[1].of_largest = NAN;
    fit->quantile = gsl_cdf_tdist_Pinv(0.5 + 0.5 * c->confidence, left / fit->side[0].serial);
    estimate_all(fit);
    fill_table(fit);
    return SF_OK;
}

sf_status sf_compression_fit_run(const sf_compression_config *config, sf_compression_fit *fit,
                                 sf_error *err) {
    sf_compression_form form;
    *fit = (sf_compression_fit){0};
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    if (sf_compression_data_init(config, &fit->data, err) == SF_OK && choose(fit, &form, err) == SF_OK &&
        sf_compression_model_init(&fit->data, form, &fit->model, err) == SF_OK)
        finish(fit, err);
    gsl_set_error_handler(handler);
    if (err->status != SF_OK)
        sf_compression_fit_free(fit);
    return err->status;
}

void sf_compression_fit_free(sf_compression_fit *fit) {
    gsl_vector_free(fit->parameters);
    gsl_matrix_free(fit->covariance);
    sf_compression_model_free(&fit->model);
    sf_compression_data_free(&fit->data);
    SF_CLEAR(fit, fit->stress);
}

double sf_compression_curve_rate(const sf_compression_fit *fit, int curve) {
    const sf_compression_test *test = &fit->data.config->test[curve];
    if (fit->data.config->thermal)
        return test->temperature;
    return fit->rate_count > 1 ? test->rate : 0;
}

sf_status sf_compression_card(const sf_compression_fit *fit, sf_foam_card *card, sf_error *err) {
    const sf_compression_config *c = fit->data.config;
    const sf_estimate *e = fit->estimate;
    bool maxwell = e[SF_ESTIMATE_ED].present;
    /* curves of their own each have an exponent of their own where A = 0: the solver finds them (0) */
    bool own = fit->model.form.rule == SF_H1_AUTO && fit->model.form.rate == SF_RATE_CURVES;
    *card = (sf_foam_card){
        .shared.density = c->density,
        .modulus = e[SF_ESTIMATE_E].value,
        .shared.hysteresis_hu = e[SF_ESTIMATE_HU].value,
        .shared.hysteresis_shape = e[SF_ESTIMATE_SHAPE].value,
        .shared.hysteresis_alpha = e[SF_ESTIMATE_ALPHA].present ? e[SF_ESTIMATE_ALPHA].value : 1,
        .shared.damp = c->damp,
        .shared.maxwell_modulus = maxwell ? e[SF_ESTIMATE_ED].value : 0,
        .shared.maxwell_rate = maxwell ? e[SF_ESTIMATE_BETA1].value : 5000,
        .shared.rate_filter_time = 1e-4,
        .tension_cutoff = 1e30,
        .densification_rule = e[SF_ESTIMATE_LIMIT].present && e[SF_ESTIMATE_LIMIT].value < 1
                                  ? SF_DENSIFICATION_H2
                                  : SF_DENSIFICATION_H1,
        .densification_start = fit->data.start,
        .densification_limit = e[SF_ESTIMATE_LIMIT].present ? e[SF_ESTIMATE_LIMIT].value : 1,
        .densification_exponent = own ? 0 : e[SF_ESTIMATE_EXPONENT].value};
    card->shared.informed_strain = fit->data.end;
    for (int k = 0; k < c->test_count && c->thermal; k++) /* a drop has the curve of one or two of them */
        card->shared.informed_strain = fmin(card->shared.informed_strain, c->test[k].largest_strain);
    int count = fit->table_count;
    SF_TRY(sf_form_curves_alloc(fit->rate_count, (int64_t)fit->rate_count * count, &card->curves, err));
    for (int r = 0; r < fit->rate_count; r++) {
        card->curves.curve_rate[r] = sf_compression_curve_rate(fit, r);
        memcpy(&card->curves.curve_strain[r * count], fit->table_strain, (size_t)count * sizeof(double));
        memcpy(&card->curves.curve_stress[r * count], fit->table_stress[r], (size_t)count * sizeof(double));
    }
    return SF_OK;
}
