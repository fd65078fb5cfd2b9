/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/form_fit.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "material/low_density_foam.h"
#include "study/fit/least_squares.h"

enum { HYSTERESIS = 3, MEMORY = SF_CYCLE_MEMORY, MOST = SF_FORM_UNKNOWNS + HYSTERESIS + MEMORY };
static const double FAR = 10; /* deviation where the values make no foam */

const char *sf_cycle_fit_name(int number) {
    static const char *const names[MEMORY] = {"reload", "drift", "recovery"};
    return names[number];
}

/* Bounds of HU, SHAPE, ALPHA, reload, drift and recovery; their logarithm is searched. */
static const double LEAST[HYSTERESIS + MEMORY] = {1e-4, 0.05, 0.1, 1e-3, 1e-4, 1e-4},
                                       LARGEST[HYSTERESIS + MEMORY] = {0.999, 20, 5, 1, 10, 1};

typedef struct problem {
    const sf_form_fit *fit;
    const sf_cycle_record *record;
    int memory;     /* unknowns of MEMORY: those that the record can tell come first */
    double *stress; /* [count] Pa, of the law at the last evaluation */
} problem;

static double bounded(double low, double high, double x) {
    return low * pow(high / low, 1 / (1 + exp(-x)));
}

static double unbounded(double low, double high, double value) {
    double part = fmin(0.999, fmax(0.001, log(value / low) / log(high / low)));
    return log(part / (1 - part));
}

static void take(const problem *p, const gsl_vector *x, double *value, double own[HYSTERESIS + MEMORY]) {
    const sf_form_request *r = &p->fit->config->form;
    memcpy(value, p->fit->value, SF_PARAMETER_COUNT * sizeof *value);
    for (int k = 0; k < r->unknown_count; k++) {
        const sf_parameter_info *about = sf_parameter_get(r->unknown[k]);
        value[r->unknown[k]] = bounded(about->low, about->high, gsl_vector_get(x, (size_t)k));
    }
    for (int k = 0; k < HYSTERESIS + MEMORY; k++)
        own[k] = k < HYSTERESIS + p->memory
                     ? bounded(LEAST[k], LARGEST[k], gsl_vector_get(x, (size_t)(r->unknown_count + k)))
                     : 0;
}

static void put_hysteresis(const double own[HYSTERESIS + MEMORY], sf_foam_card *card) {
    card->hysteresis_hu = own[0];
    card->hysteresis_shape = own[1];
    card->hysteresis_alpha = own[2];
    card->memory = (sf_memory){own[3], own[4], own[5], 1, 0};
}

/* Stress (Pa) of the card along the record up to point `end`. */
static sf_status follow(const sf_cycle_record *r, const sf_foam_card *card, int end, double *stress,
                        sf_error *err) {
    const sf_material material = sf_foam_material(card);
    double rows[SF_LAW_HISTORY][SF_LANES] = {{0}};
    sf_material_law law;
    sf_uniaxial point = {0};
    SF_TRY(sf_material_law_build(&material, &law, err));
    for (int i = 0; i < end; i++) {
        double pause = sf_cycle_record_pause(r, i);
        if (pause > 0) { /* without load */
            law.law->uniaxial(law.numbers, 1, 0, &point);
            for (int k = 0; k < SF_LAW_HISTORY; k++)
                rows[k][0] = point.history[k];
            law.law->rest(law.numbers, pause, rows);
            for (int k = 0; k < SF_LAW_HISTORY; k++)
                point.history[k] = rows[k][0];
        }
        double step = i > 0 ? r->time[i] - r->time[i - 1] : 1;
        stress[i] = law.law->uniaxial(law.numbers, step, r->strain[i], &point);
    }
    sf_material_law_free(&law);
    return SF_OK;
}

static int deviate(const gsl_vector *x, void *data, gsl_vector *out) {
    const problem *p = data;
    double value[SF_PARAMETER_COUNT], own[HYSTERESIS + MEMORY];
    sf_foam_card card = {0};
    sf_error err = SF_ERROR_INIT;
    int end = (int)out->size;
    take(p, x, value, own);
    bool made = sf_foam_form_card(&p->fit->config->form.form, value, &card, &err) == SF_OK;
    put_hysteresis(own, &card);
    made = made && follow(p->record, &card, end, p->stress, &err) == SF_OK;
    for (int i = 0; i < end; i++) {
        double d = made ? (p->stress[i] - p->record->stress[i]) / p->record->largest_stress : FAR;
        gsl_vector_set(out, (size_t)i, isfinite(d) ? fmin(FAR, fmax(-FAR, d)) : FAR);
    }
    sf_foam_card_free(&card);
    return GSL_SUCCESS;
}

static void put_start(const problem *p, gsl_vector *x) {
    static const double memory[MEMORY] = {0.4, 0.2, 0.1};
    const sf_form_request *r = &p->fit->config->form;
    for (int k = 0; k < r->unknown_count; k++) {
        const sf_parameter_info *about = sf_parameter_get(r->unknown[k]);
        gsl_vector_set(x, (size_t)k, unbounded(about->low, about->high, p->fit->value[r->unknown[k]]));
    }
    for (int k = 0; k < HYSTERESIS + p->memory; k++)
        gsl_vector_set(x, (size_t)(r->unknown_count + k),
                       unbounded(LEAST[k], LARGEST[k],
                                 k < HYSTERESIS ? p->fit->unloading.value[k] : memory[k - HYSTERESIS]));
}

/* The half widths, from the slope of each bounded value. */
static void take_errors(const problem *p, const gsl_vector *x, const gsl_matrix *covariance, double variance,
                        const double own[HYSTERESIS + MEMORY], sf_form_fit *fit) {
    int first = p->fit->config->form.unknown_count;
    for (int k = 0; k < first + HYSTERESIS + p->memory; k++) {
        double part = 1 / (1 + exp(-gsl_vector_get(x, (size_t)k))),
               error = part * (1 - part) * sqrt(variance * gsl_matrix_get(covariance, (size_t)k, (size_t)k));
        int of_law = k - first;
        if (of_law < 0) {
            const sf_parameter_info *about = sf_parameter_get(p->fit->config->form.unknown[k]);
            fit->error[k] = log(about->high / about->low) * error;
            fit->at_bound[k] = part < 1e-3 || part > 1 - 1e-3;
            continue;
        }
        bool at_bound = part < 1e-3 || part > 1 - 1e-3;
        if (of_law < HYSTERESIS)
            fit->unloading.at_bound[of_law] = at_bound;
        else
            fit->cycles.width[of_law - HYSTERESIS] =
                at_bound ? NAN : 2 * own[of_law] * log(LARGEST[of_law] / LEAST[of_law]) * error;
    }
}

static sf_status conclude(const problem *p, const double *value, const double own[HYSTERESIS + MEMORY],
                          sf_form_fit *fit, sf_error *err) {
    sf_cycle_result *c = &fit->cycles;
    const sf_cycle_record *r = p->record;
    double informed = fit->card.informed_strain;
    sf_foam_card_free(&fit->card);
    SF_TRY(sf_foam_form_card(&fit->config->form.form, value, &fit->card, err));
    put_hysteresis(own, &fit->card);
    fit->card.informed_strain = informed;
    memcpy(fit->value, value, sizeof fit->value);
    memcpy(fit->unloading.value, own, sizeof fit->unloading.value);
    fit->value[SF_PARAMETER_HU] = own[0];
    fit->value[SF_PARAMETER_SHAPE] = own[1];
    fit->value[SF_PARAMETER_ALPHA] = own[2];
    memcpy(c->value, own + HYSTERESIS, sizeof c->value);
    c->stress = sf_alloc(err, (unsigned long)r->count, sizeof *c->stress, "cycles");
    if (err->status != SF_OK || follow(r, &fit->card, r->count, c->stress, err) != SF_OK)
        return err->status;
    for (int k = 0; k < 2 * r->cycles; k++)
        c->rms[k % 2][k / 2] =
            sf_form_rms(r->stress, r->largest_stress, c->stress, r->turn[k], r->turn[k + 1] + 1);
    fit->loading_rms = c->rms[0][0];
    fit->unloading.rms = c->rms[1][0];
    fit->unloading.factor_rms = NAN; /* of the first cycle alone */
    return sf_form_fit_follow(fit, err);
}

sf_status sf_cycle_fit_run(sf_form_fit *fit, sf_error *err) {
    const sf_cycle_record *r = &fit->config->cycles;
    problem p = {.fit = fit, .record = r, .memory = r->fitted < 3 ? 1 : r->pauses > 0 ? 3 : 2};
    if (r->count == 0)
        return SF_OK;
    if (!fit->has_unloading)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: a test without unloading has no memory", r->path);
    p.stress = sf_alloc(err, (unsigned long)r->count, sizeof *p.stress, "cycles");
    SF_TRY(err->status);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    size_t size = (size_t)(fit->config->form.unknown_count + HYSTERESIS + p.memory),
           count = (size_t)r->turn[2 * r->fitted] + 1;
    gsl_vector *x = gsl_vector_alloc(size), *out = gsl_vector_alloc(count);
    gsl_matrix *covariance = gsl_matrix_calloc(size, size);
    double value[SF_PARAMETER_COUNT], own[HYSTERESIS + MEMORY];
    put_start(&p, x);
    double sum = sf_least_squares(deviate, &p, count, x, covariance);
    if (isfinite(sum)) {
        take(&p, x, value, own);
        deviate(x, &p, out);
        for (int k = 0; k < MEMORY; k++)
            fit->cycles.width[k] = NAN;
        double r1 = fmin(0.98, fmax(0, sf_neighbour_correlation(count, out->data)));
        take_errors(&p, x, covariance, sum / (double)(count - size) * ((1 + r1) / (1 - r1)), own, fit);
        conclude(&p, value, own, fit, err);
    } else {
        SF_FAIL(err, SF_ERR_NUMERIC, "no search for the memory in %s converges", r->path);
    }
    free(p.stress);
    gsl_vector_free(x);
    gsl_vector_free(out);
    gsl_matrix_free(covariance);
    gsl_set_error_handler(handler);
    return err->status;
}

double sf_cycle_fit_worst(const sf_form_fit *fit, int unloading, int first, int last) {
    double worst = 0;
    for (int k = first; k < last; k++)
        worst = fmax(worst, fit->cycles.rms[unloading][k]);
    return worst;
}
