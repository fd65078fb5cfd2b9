/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/inference.h"

#include "study/fit/least_squares.h"
#include "study/material_file.h"
#include "material/low_density_foam.h"
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sort.h>

/* Streams of random numbers: of the draws, of which each has its own from here on; of the scatter. */
enum { FIRST_SEED = 5000, SCATTER_SEED = 4000 };

static int states_of(const sf_drop_inference *in) {
    return in->chains.chains * in->chains.kept;
}

sf_status sf_drop_average_build(int models, const sf_drop_inference *const *model, uint64_t seed,
                                sf_drop_average *a, sf_error *err) {
    double evidence[SF_FIT_MAX_MODELS], density[SF_FIT_MAX_MODELS * SF_FIT_MAX_DROPS];
    int drops = model[0]->fit->measured_drops;
    *a = (sf_drop_average){.models = models, .seed = seed, .by_evidence = drops < 2};
    for (int m = 0; m < models; m++) {
        a->model[m] = model[m];
        evidence[m] = model[m]->evidence.log_value;
        a->predictive[m] = a->by_evidence ? NAN : 0;
        for (int d = 0; d < drops && !a->by_evidence; d++)
            a->predictive[m] += density[m * drops + d] = model[m]->left_out[d].log_density;
    }
    sf_evidence_weights(models, evidence, a->evidence_weight);
    if (a->by_evidence)
        memcpy(a->weight, a->evidence_weight, sizeof a->weight);
    else if (sf_predictive_weights(models, drops, density, seed, a->weight, err) != SF_OK)
        return err->status;
    double sum = 0;
    for (int m = 0; m < models; m++)
        sum += a->weight[m];
    return sum > 0 ? SF_OK
                   : SF_FAIL(err, SF_ERR_NUMERIC, "no model has a finite %s: there is nothing to average",
                             a->by_evidence ? "evidence" : "leave-one-out predictive density");
}

int sf_drop_average_best(const sf_drop_average *a) {
    int best = 0;
    for (int m = 1; m < a->models; m++)
        best = a->weight[m] > a->weight[best] ? m : best;
    return best;
}

bool sf_drop_average_reached(const sf_drop_average *a) {
    bool reached = true;
    for (int m = 0; m < a->models; m++) {
        const sf_drop_inference *in = a->model[m];
        reached = reached && in->chains.converged && (!a->by_evidence || in->evidence.trusted);
        for (int d = 0; d < in->fit->measured_drops && !a->by_evidence; d++)
            reached = reached && in->left_out[d].converged;
    }
    return reached;
}

/* ---- quantiles ---- */

typedef struct weighted {
    double *value, *weight; /* [most] */
    int count;
} weighted;

/* Without: its simulation failed before the pad was touched. */
static bool has_columns(const sf_drop_inference *in, int drop) {
    return in->fit->columns[drop].count > 0;
}

bool sf_drop_average_has_columns(const sf_drop_average *a, int quantity) {
    for (int m = 0; m < a->models; m++)
        if (a->weight[m] > 0 && !has_columns(a->model[m], a->model[m]->quantity[quantity].drop))
            return false;
    return true;
}

/* A state without a value, as its foam collapses, counts as infinite if `above_all`, else not at all. Each
 * value is moved by a normal one of this standard deviation. */
static void add_states(const sf_drop_inference *in, const double *column, int width, double weight,
                       bool above_all, double sd, const gsl_rng *random, weighted *w) {
    int states = states_of(in);
    for (int s = 0; s < states; s++) {
        double value = column[s * width];
        if (!isfinite(value) && !above_all)
            continue;
        double moved = value + (sd > 0 ? sd * gsl_ran_ugaussian(random) : 0);
        w->value[w->count] = isfinite(value) ? moved : INFINITY;
        w->weight[w->count++] = weight / states;
    }
}

static sf_status take_quantiles(weighted *w, int count, const double *probability, double *value,
                                sf_error *err) {
    SF_OWN(size_t, order, w->count, "samples", err);
    double all = 0;
    gsl_sort_index(order, w->value, 1, (size_t)w->count);
    for (int s = 0; s < w->count; s++)
        all += w->weight[s];
    for (int q = 0; q < count; q++) {
        double sum = 0;
        int s = 0;
        value[q] = NAN;
        while (s < w->count && sum < probability[q] * all)
            sum += w->weight[order[s++]];
        if (w->count > 0)
            value[q] = w->value[order[s > 0 ? s - 1 : 0]];
    }
    return SF_OK;
}

sf_status sf_drop_average_quantiles(const sf_drop_average *a, int model, int quantity, int count,
                                    const double *probability, double *value, sf_error *err) {
    int most = 0;
    const sf_drop_quantity *q = &a->model[0]->quantity[quantity];
    bool above_all = sf_drop_kind_get(q->kind)->above_all, known = true;
    for (int m = 0; m < a->models; m++)
        most += states_of(a->model[m]);
    SF_OWN(double, room, 2 * most, "samples", err);
    weighted w = {.value = room, .weight = room + most};
    SF_RANDOM *random = gsl_rng_alloc(gsl_rng_taus2);
    if (!random)
        SF_NO_MEMORY(err, "random numbers");
    SF_TRY(err->status);
    gsl_rng_set(random, (unsigned long)sf_seed_of(a->seed, SCATTER_SEED) & 0xffffffffu);
    for (int m = 0; m < a->models; m++) {
        const sf_drop_inference *in = a->model[m];
        double sd = model == SF_SINGLE_DROP ? sf_drop_fit_scatter(in->fit, q->drop, q->kind) : 0;
        if (model < 0 ? a->weight[m] > 0 : m == model)
            add_states(in, &in->chains.quantity[quantity], in->quantities, model < 0 ? a->weight[m] : 1,
                       above_all && has_columns(in, q->drop), sd, random, &w);
        known = known && !(a->weight[m] > 0 && isnan(sd));
    }
    w.count = known ? w.count : 0;
    SF_TRY(take_quantiles(&w, count, probability, value, err));
    for (int k = 0; k < count; k++)
        value[k] = exp(value[k]);
    return SF_OK;
}

double sf_drop_average_missing(const sf_drop_average *a, int quantity) {
    double sum = 0;
    for (int m = 0; m < a->models; m++) {
        const sf_drop_inference *in = a->model[m];
        int states = states_of(in), without = 0;
        for (int s = 0; s < states; s++)
            without += !isfinite(in->chains.quantity[s * in->quantities + quantity]);
        sum += a->weight[m] * without / states;
    }
    return sum;
}

sf_status sf_drop_parameter_quantiles(const sf_drop_inference *in, int parameter, int count,
                                      const double *probability, double *value, sf_error *err) {
    SF_OWN(double, room, 2 * states_of(in), "samples", err);
    weighted w = {.value = room, .weight = room + states_of(in)};
    add_states(in, &in->chains.sample[parameter], in->parameters, 1, false, 0, NULL, &w);
    return take_quantiles(&w, count, probability, value, err);
}

/* Equal steps through the cumulated weights; within a model, equal steps through its states. */
void sf_drop_average_draw(const sf_drop_average *a, sf_posterior_draw draw[SF_POSTERIOR_DRAWS]) {
    int number[SF_FIT_MAX_MODELS] = {0}, used[SF_FIT_MAX_MODELS] = {0}, m = 0;
    double sum = a->weight[0];
    for (int k = 0; k < SF_POSTERIOR_DRAWS; k++) {
        while (m < a->models - 1 && (k + 0.5) / SF_POSTERIOR_DRAWS > sum)
            sum += a->weight[++m];
        draw[k].model = m;
        number[m]++;
    }
    for (int k = 0; k < SF_POSTERIOR_DRAWS; k++) {
        m = draw[k].model;
        draw[k].state = (int)((used[m]++ + 0.5) * states_of(a->model[m]) / number[m]);
    }
}

sf_status sf_drop_average_discrepancy(const sf_drop_average *a, int k, const sf_posterior_draw *draw,
                                      double *delta, sf_response_error *error, sf_error *err) {
    const sf_drop_inference *in = a->model[draw->model];
    const double *u = &in->chains.sample[draw->state * in->parameters];
    if (!sf_drop_inference_draw(in, u, sf_seed_of(a->seed, (uint64_t)(FIRST_SEED + k)), delta, error, NULL))
        return SF_FAIL(err, SF_ERR_NUMERIC, "draw %d of the posterior: the foam of the columns collapsed",
                       k + 1);
    return SF_OK;
}

static sf_status write_draw(const sf_drop_average *a, int k, const sf_posterior_draw *draw,
                            const char *folder, sf_error *err) {
    const sf_drop_inference *in = a->model[draw->model];
    const double *u = &in->chains.sample[draw->state * in->parameters];
    double delta[SF_DISCREPANCY_PLACES];
    char name[32], title[160];
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    sf_response_error error;
    SF_TRY(sf_drop_average_discrepancy(a, k, draw, delta, &error, err));
    SF_TRY(sf_drop_inference_card(in, u, delta, &card, err));
    card.informed_strain = 0; /* that of the start says nothing about a draw */
    snprintf(name, sizeof name, "draw-%03d", k + 1);
    snprintf(title, sizeof title, "Draw %d of %d of a posterior of softfall-fit drop, equally likely.", k + 1,
             SF_POSTERIOR_DRAWS);
    const sf_material material = sf_foam_material(&card);
    const sf_material_text text = {.title = title,
                                   .provenance = "With the discrepancy from the form of the curve.\n",
                                   .response_error = &error};
    return sf_material_write(folder, name, &material, &text, err);
}

/* The first draw comes last: without it the folder is no posterior for those who read it, and the draws that
 * an interruption leaves, which stand model by model, are not taken for the whole. */
sf_status sf_drop_average_write(const sf_drop_average *a, const char *folder, sf_error *err) {
    sf_posterior_draw draw[SF_POSTERIOR_DRAWS];
    sf_drop_average_draw(a, draw);
    for (int k = SF_POSTERIOR_DRAWS - 1; k >= 0 && err->status == SF_OK; k--)
        write_draw(a, k, &draw[k], folder, err);
    return err->status;
}
