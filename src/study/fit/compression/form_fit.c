/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/form_fit.h"

#include "material/curve.h"
#include "study/fit/compression/point_model.h"
#include <gsl/gsl_errno.h>

enum { RISES = 400 };                  /* strains at which the curve must rise */
static const double RISE_END = 0.97;   /* of the pole */
static const double LEAST_RISE = 1e-5; /* of the largest stress, from one of them to the next */
/* The weights of a fall: of the searches from all starts, and of those that go on from the best. */
static const double FALL_WEIGHT[] = {100, 3e3, 1e5};
enum { FALL_WEIGHTS = sizeof FALL_WEIGHT / sizeof *FALL_WEIGHT };
static const double FAR = 1e3;          /* deviation where there is no stress */
static const double RIDGE = 1e-4;       /* holds what the tests do not determine near its median */
static const double POOR = 0.1;         /* rms over the largest stress */
static const double NO_FIT = 1;         /* the same */
static const double UNDETERMINED = 1;   /* relative standard error */
static const double AWAY = 1.5;         /* standard deviations of the prior, of the other starts */
static const double LEAST_RATIO = 0.05; /* part of the largest W above which f is compared */

/* ---- loading ---- */

typedef struct problem {
    const sf_compression_config *config;
    const sf_form_request *request;
    int points;      /* of loading, of all tests */
    double *strain;  /* [points] owned, with the next two behind it */
    double *stress;  /* [points] Pa, of the form */
    double *reduced; /* [points] deviations at the last evaluation */
    double fall_weight;
} problem;

/* ln of a parameter between the bounds of its table, from the real line. */
static double parameter_of(sf_foam_parameter p, double x) {
    const sf_parameter_info *about = sf_parameter_get(p);
    return exp(log(about->low) + log(about->high / about->low) * sf_logistic(x));
}

static double real_of(sf_foam_parameter p, double value) {
    const sf_parameter_info *about = sf_parameter_get(p);
    double part = log(value / about->low) / log(about->high / about->low);
    part = fmin(1 - 1e-6, fmax(1e-6, part));
    return log(part / (1 - part));
}

static void take_values(const problem *p, const gsl_vector *x, double *value) {
    memcpy(value, p->request->start, SF_PARAMETER_COUNT * sizeof *value);
    for (int k = 0; k < p->request->unknown_count; k++)
        value[p->request->unknown[k]] = parameter_of(p->request->unknown[k], gsl_vector_get(x, (size_t)k));
}

/* Returns the share that the factor of the rate (theory, eq. O4) adds to the curve, over its stress, at
 * point i of a test that began at rest: the rate is behind the low pass (eq. 22), rises in loading and
 * falls towards that of unloading, which is negative. */
static double rate_excess(const sf_form_request *r, const double *value, const sf_compression_test *t,
                          int i) {
    double time = r->form.base.rate_filter_time, strain = fmax(0, t->strain[i]), filtered = t->rate;
    bool unloads = i >= t->loading;
    if (time > 0)
        filtered *= -expm1(-(unloads ? t->largest_strain : strain) / (t->rate * time));
    if (unloads && !(time > 0))
        return 0;
    if (unloads)
        filtered += (filtered + t->rate) * expm1(-(t->largest_strain - strain) / (t->rate * time));
    double over = filtered / value[SF_PARAMETER_RATE_REFERENCE];
    return over > 1 ? value[SF_PARAMETER_RATE_FACTOR] * log10(over) : 0;
}

/* Deviations of a test's loading; returns their number. */
static int deviate_test(const problem *p, const double *value, const sf_compression_test *t,
                        const double *stress, double *out) {
    sf_compression_walk walk = {0};
    double modulus = value[SF_PARAMETER_ED];
    bool maxwell = p->request->rate & SF_FORM_RATE_MAXWELL;
    for (int i = 0; i < t->loading; i++) {
        double viscous = maxwell
                             ? modulus * sf_compression_maxwell(value[SF_PARAMETER_BETA1], t->rate,
                                                                t->largest_strain, t->strain[i], false, &walk)
                             : 0;
        double factor = 1 + rate_excess(p->request, value, t, i);
        double deviation = (factor * stress[i] + viscous - t->stress[i]) / t->largest_stress;
        out[i] = isfinite(deviation) ? fmin(FAR, fmax(-FAR, deviation)) : FAR;
    }
    return t->loading;
}

/* Returns by how much the curve falls, over the largest stress: it must rise to its pole. */
static double fall(const problem *p, const double *value) {
    const sf_curve_form *form = p->request->form.curve;
    double strain[RISES], stress[RISES], sum = 0, end = RISE_END * sf_curve_form_pole(form, value),
                                         size = p->config->test[0].largest_stress;
    for (int k = 0; k < RISES; k++)
        strain[k] = end * k / (RISES - 1);
    sf_curve_form_stresses(form, value, RISES, strain, stress);
    for (int k = 1; k < RISES; k++)
        sum += fmax(0, stress[k - 1] + LEAST_RISE * size - stress[k]);
    double part = p->fall_weight * sum / size;
    return isfinite(part) ? fmin(FAR, part) : FAR;
}

static int deviate(const gsl_vector *x, void *data, gsl_vector *out) {
    problem *p = data;
    const sf_form_request *r = p->request;
    double value[SF_PARAMETER_COUNT];
    size_t row = 0;
    take_values(p, x, value);
    sf_curve_form_stresses(r->form.curve, value, p->points, p->strain, p->stress);
    for (int k = 0, at = 0; k < p->config->test_count; k++)
        at += deviate_test(p, value, &p->config->test[k], &p->stress[at], &p->reduced[at]);
    for (int i = 0; i < p->points; i++)
        gsl_vector_set(out, row++, p->reduced[i]);
    gsl_vector_set(out, row++, fall(p, value));
    for (int k = 0; k < r->unknown_count; k++)
        gsl_vector_set(out, row++,
                       RIDGE * log(value[r->unknown[k]] / r->start[r->unknown[k]]) /
                           sf_foam_form_prior_sd(&r->form, r->unknown[k]));
    return GSL_SUCCESS;
}

static sf_status init_problem(const sf_compression_config *config, problem *p, sf_error *err) {
    *p = (problem){.config = config, .request = &config->form, .fall_weight = FALL_WEIGHT[0]};
    for (int k = 0; k < config->test_count; k++)
        p->points += config->test[k].loading;
    p->strain = sf_alloc(err, 3 * p->points, sizeof *p->strain, "form fit");
    SF_TRY(err->status);
    p->stress = p->strain + p->points;
    p->reduced = p->stress + p->points;
    for (int k = 0, at = 0; k < config->test_count; k++)
        for (int i = 0; i < config->test[k].loading; i++)
            p->strain[at++] = fmax(0, config->test[k].strain[i]);
    return err->status;
}

/* Start 0: the medians; then each unknown up and down from there. */
static bool put_start(void *data, int start, gsl_vector *x) {
    const sf_form_request *r = ((const problem *)data)->request;
    for (int k = 0; k < r->unknown_count; k++) {
        sf_foam_parameter p = r->unknown[k];
        double away = start == 2 * k + 1 ? AWAY : start == 2 * k + 2 ? -AWAY : 0;
        gsl_vector_set(x, (size_t)k,
                       real_of(p, r->start[p] * exp(away * sf_foam_form_prior_sd(&r->form, p))));
    }
    return start <= 2 * r->unknown_count;
}

static void take_errors(const problem *p, const gsl_vector *x, const gsl_matrix *covariance, double sum,
                        sf_form_fit *fit) {
    const sf_form_request *r = p->request;
    double correlation = fmin(0.98, sf_neighbour_correlation((size_t)p->points, p->reduced)),
           serial = correlation > 2 / sqrt(p->points) ? (1 + correlation) / (1 - correlation) : 1,
           variance = sum / fmax(1, p->points - r->unknown_count) * serial;
    for (int k = 0; k < r->unknown_count; k++) {
        const sf_parameter_info *about = sf_parameter_get(r->unknown[k]);
        double part = sf_logistic(gsl_vector_get(x, (size_t)k)),
               slope = log(about->high / about->low) * part * (1 - part);
        fit->at_bound[k] = sf_is_at_end(part);
        fit->error[k] = fit->at_bound[k]
                            ? NAN
                            : slope * sqrt(variance * gsl_matrix_get(covariance, (size_t)k, (size_t)k));
    }
}

static sf_status fit_loading(problem *p, sf_form_fit *fit, sf_error *err) {
    const char *form = p->request->form.curve->name;
    size_t size = (size_t)p->request->unknown_count, count = (size_t)p->points + 1 + size;
    SF_VECTOR *best = gsl_vector_alloc(size), *out = gsl_vector_alloc(count);
    SF_MATRIX *covariance = gsl_matrix_alloc(size, size);
    double least = sf_least_squares_from(put_start, deviate, p, count, best), sum = 0;
    for (int k = 0; k < FALL_WEIGHTS && isfinite(least); k++) {
        p->fall_weight = FALL_WEIGHT[k];
        least = sf_least_squares(deviate, p, count, best, covariance);
    }
    if (!isfinite(least))
        return SF_FAIL(err, SF_ERR_NUMERIC, "no search for the parameters of curve_form = \"%s\" converges",
                       form);
    take_values(p, best, fit->value);
    deviate(best, p, out);
    for (int i = 0; i < p->points; i++)
        sum += p->reduced[i] * p->reduced[i];
    fit->loading_rms = sqrt(sum / p->points);
    take_errors(p, best, covariance, least, fit);
    if (!(fit->loading_rms < NO_FIT))
        return SF_FAIL(err, SF_ERR_NUMERIC,
                       "the best curve of curve_form = \"%s\" deviates from the tests by more than their "
                       "largest stress (rms)",
                       form);
    return SF_OK;
}

static double factor_rms(const sf_unloading_points *u, const double value[3]) {
    double sum = 0;
    int count = 0;
    for (int k = 0; k < u->count; k++) {
        if (u->ratio[k] < LEAST_RATIO)
            continue;
        double factor = sf_unloading_factor(value[0], value[1], value[2], u->ratio[k]);
        sum += pow(factor - (u->measured[k] - u->viscous[k]) / u->loading[k], 2);
        count++;
    }
    return sqrt(sum / count);
}

static sf_form_unloading fit_unloading(sf_unloading_points *u, bool one) {
    u->one = one;
    sf_form_unloading out = {.fit = sf_unloading_search(u)};
    if (isfinite(out.fit.rms))
        out.factor_rms = factor_rms(u, out.fit.value);
    return out;
}

/* ---- the law along a test ---- */

/* Stress without rate (Pa) and W (J m-3) of the curve at a strain. */
static double loading_at(const sf_curve *curve, double strain, double *energy) {
    double stress, slope;
    sf_curve_evaluate(curve, fmax(0, strain), &stress, &slope, energy);
    return stress;
}

/* Maxwell branch and factor of the rate, beside the curve's `stress`. */
static double viscous_at(const sf_form_fit *fit, const sf_compression_test *t, int i, double stress,
                         sf_compression_walk *walk) {
    double viscous = rate_excess(&fit->config->form, fit->value, t, i) * stress;
    if (fit->config->form.rate & SF_FORM_RATE_MAXWELL)
        viscous += fit->value[SF_PARAMETER_ED] * sf_compression_maxwell(fit->value[SF_PARAMETER_BETA1],
                                                                        t->rate, t->largest_strain,
                                                                        t->strain[i], i >= t->loading, walk);
    return viscous;
}

static void list_unloading(const sf_form_fit *fit, const sf_curve *curve, sf_unloading_points *u) {
    for (int k = 0; k < fit->config->test_count; k++) {
        const sf_compression_test *t = &fit->config->test[k];
        sf_compression_walk walk = {0};
        double peak, energy;
        loading_at(curve, t->largest_strain, &peak);
        for (int i = 0; i < t->count; i++) {
            double stress = loading_at(curve, t->strain[i], &energy),
                   viscous = viscous_at(fit, t, i, stress, &walk);
            if (i < t->loading)
                continue;
            u->measured[u->count] = t->stress[i] / t->largest_stress;
            u->loading[u->count] = stress / t->largest_stress;
            u->viscous[u->count] = viscous / t->largest_stress;
            u->ratio[u->count++] = fmin(1, energy / peak);
        }
    }
}

static sf_status fit_all_unloading(sf_form_fit *fit, const sf_curve *curve, sf_error *err) {
    sf_unloading_points u = {.scale = 1, .starts = 4};
    unsigned long count = 0;
    for (int k = 0; k < fit->config->test_count; k++)
        count += (unsigned long)(fit->config->test[k].count - fit->config->test[k].loading);
    fit->has_unloading = count > 3;
    if (!fit->has_unloading)
        return SF_OK;
    SF_OWN(double, all, 4 * count, "unloading", err);
    u.measured = all;
    u.loading = u.measured + count;
    u.viscous = u.loading + count;
    u.ratio = u.viscous + count;
    list_unloading(fit, curve, &u);
    fit->unloading_of_one = fit_unloading(&u, true);
    fit->unloading = fit_unloading(&u, false);
    return isfinite(fit->unloading.fit.rms)
               ? SF_OK
               : SF_FAIL(err, SF_ERR_NUMERIC, "no search for HU, SHAPE and ALPHA converges");
}

/* Energy (J m-3) below points, by trapezoids; positive for ascending strain. */
static double area(const double *strain, const double *stress, int first, int last) {
    double sum = 0;
    for (int i = first + 1; i < last; i++)
        sum += 0.5 * (stress[i] + stress[i - 1]) * (strain[i] - strain[i - 1]);
    return sum;
}

/* Part of the energy of loading that unloading returns. */
static double returned(const sf_compression_test *t, const double *stress) {
    return -area(t->strain, stress, t->loading - 1, t->count) / area(t->strain, stress, 0, t->loading);
}

double sf_form_rms(const double *measured, double largest, const double *stress, int first, int last) {
    double sum = 0;
    for (int i = first; i < last; i++)
        sum += pow((stress[i] - measured[i]) / largest, 2);
    return last > first ? sqrt(sum / (last - first)) : NAN;
}

static sf_status follow_test(const sf_form_fit *fit, const sf_curve *curve, const sf_compression_test *t,
                             sf_form_test *out, sf_error *err) {
    const double *u = fit->unloading.fit.value;
    sf_compression_walk walk = {0};
    double peak, energy;
    bool back = fit->has_unloading && t->count > t->loading;
    free(out->stress);
    out->stress = sf_alloc(err, t->count, sizeof(double), "test");
    SF_TRY(err->status);
    loading_at(curve, t->largest_strain, &peak);
    for (int i = 0; i < t->count; i++) {
        double stress = loading_at(curve, t->strain[i], &energy),
               viscous = viscous_at(fit, t, i, stress, &walk);
        double by = i < t->loading       ? 1
                    : fit->has_unloading ? sf_unloading_factor(u[0], u[1], u[2], fmin(1, energy / peak))
                                         : NAN;
        out->stress[i] = by * stress + viscous;
    }
    out->loading_rms = sf_form_rms(t->stress, t->largest_stress, out->stress, 0, t->loading);
    out->unloading_rms = sf_form_rms(t->stress, t->largest_stress, out->stress, t->loading, t->count);
    out->returned_measured = back ? returned(t, t->stress) : NAN;
    out->returned_fitted = back ? returned(t, out->stress) : NAN;
    return SF_OK;
}

static sf_status follow_all(sf_form_fit *fit, const sf_curve *curve, sf_error *err) {
    const sf_compression_config *c = fit->config;
    for (int k = 0; k < c->test_count; k++)
        SF_TRY(follow_test(fit, curve, &c->test[k], &fit->test[k], err));
    for (int k = 0; k < c->predicted_count; k++)
        SF_TRY(follow_test(fit, curve, &c->predicted[k], &fit->predicted[k], err));
    return SF_OK;
}

sf_status sf_form_fit_follow(sf_form_fit *fit, sf_error *err) {
    SF_OWNED_BY(sf_curve_free) sf_curve curve = {0};
    SF_TRY(sf_curve_build(&fit->card, 0, &curve, err));
    return follow_all(fit, &curve, err);
}

/* The material, without its unloading. */
static sf_status make_card(sf_form_fit *fit, sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    if (sf_foam_form_card(&fit->config->form.form, fit->value, &fit->card, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "the tests lead to no foam of curve_form = \"%s\": %s",
                       fit->config->form.form.curve->name, inner.text);
    for (int k = 0; k < fit->config->test_count; k++)
        fit->card.informed_strain = fmax(fit->card.informed_strain, fit->config->test[k].largest_strain);
    return SF_OK;
}

static void take_hysteresis(sf_form_fit *fit) {
    if (!fit->has_unloading)
        return;
    fit->value[SF_PARAMETER_HU] = fit->card.hysteresis_hu = fit->unloading.fit.value[0];
    fit->value[SF_PARAMETER_SHAPE] = fit->card.hysteresis_shape = fit->unloading.fit.value[1];
    fit->value[SF_PARAMETER_ALPHA] = fit->card.hysteresis_alpha = fit->unloading.fit.value[2];
}

sf_status sf_form_fit_run(const sf_compression_config *config, sf_form_fit *fit, sf_error *err) {
    problem p;
    SF_OWNED_BY(sf_curve_free) sf_curve curve = {0};
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    *fit = (sf_form_fit){.config = config};
    if (init_problem(config, &p, err) == SF_OK && fit_loading(&p, fit, err) == SF_OK &&
        make_card(fit, err) == SF_OK && sf_curve_build(&fit->card, 0, &curve, err) == SF_OK &&
        fit_all_unloading(fit, &curve, err) == SF_OK && follow_all(fit, &curve, err) == SF_OK)
        take_hysteresis(fit);
    free(p.strain); /* and all behind it */
    gsl_set_error_handler(handler);
    if (err->status != SF_OK)
        sf_form_fit_free(fit);
    return err->status;
}

void sf_form_fit_free(sf_form_fit *fit) {
    for (int k = 0; k < SF_COMPRESSION_TESTS; k++)
        SF_FREE(fit->test[k].stress, fit->predicted[k].stress);
    for (int k = 0; k < SF_CYCLE_RECORDS; k++)
        free(fit->cycles[k].stress);
    sf_foam_card_free(&fit->card);
    *fit = (sf_form_fit){0};
}

bool sf_form_fit_determines(const sf_form_fit *fit, int unknown) {
    return fit->error[unknown] < UNDETERMINED; /* NaN: at its bound */
}

bool sf_form_fit_is_below_reference(const sf_form_fit *fit, const sf_compression_test *test) {
    return fit->config->form.rate & SF_FORM_RATE_FACTOR &&
           test->rate < fit->value[SF_PARAMETER_RATE_REFERENCE] * (1 - 1e-9);
}

bool sf_form_fit_is_poor(const sf_form_fit *fit) {
    for (int k = 0; k < fit->config->test_count; k++)
        if (fit->test[k].loading_rms > POOR || fit->test[k].unloading_rms > POOR)
            return true;
    return false;
}
