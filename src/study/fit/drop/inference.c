/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/inference.h"

#include "study/fit/least_squares.h"
#include "io/process.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

enum { PLACES = SF_DISCREPANCY_PLACES };
static const double PLACE_WIDTH = 0.05; /* of strain */
static const double LENGTH = 0.12;      /* of strain, correlation of delta */
static const double TAU_SCALE = 0.1;    /* of tau's half-normal prior */
static const double KAPPA_SCALE = 1;    /* of kappa's */
static const double RAISE = 0.02;       /* of ln stress, for J */

sf_inference_options sf_inference_defaults(uint64_t seed) {
    sf_inference_options o = {
        .chains = sf_chains_defaults(seed),
        .without = {.draws = 3000, .effective = 200, .chains = sf_chains_defaults(seed)},
        .evidence_draws = 2000,
        .leave_one_out = true};
    o.without.chains.burn_in_rounds = 3; /* a mean is wanted of these, not the tails */
    o.without.chains.round = 150;
    o.without.chains.most_steps = 1500;
    o.without.chains.rhat = 1.05;
    o.without.chains.effective = 150;
    return o;
}

sf_discrepancy_size sf_drop_inference_size(const sf_drop_inference *inference, const double *u) {
    int n = inference->parameters;
    return (sf_discrepancy_size){sf_half_normal(u[n - 2], TAU_SCALE), sf_half_normal(u[n - 1], KAPPA_SCALE)};
}

const char *sf_drop_inference_name(const sf_drop_inference *inference, int parameter) {
    int beyond = parameter - inference->fit->input->unknown_count;
    if (beyond >= 0)
        return beyond == 0 ? "tau" : "kappa";
    return sf_parameter_get(inference->fit->input->unknown[parameter])->name;
}

double sf_drop_inference_value(const sf_drop_inference *inference, int parameter, double u) {
    int beyond = parameter - inference->fit->input->unknown_count;
    return beyond < 0 ? exp(u) : sf_half_normal(u, beyond == 0 ? TAU_SCALE : KAPPA_SCALE);
}

static int responses_of(const sf_drop_fit *fit) {
    return fit->row[fit->input->drop_count];
}

/* ---- curves times exp(delta) ---- */

/* delta between the places, constant beyond them. */
static double delta_at(const double *delta, double strain) {
    double at = fmin(fmax(strain / PLACE_WIDTH, 0), PLACES - 1);
    int k = (int)fmin(at, PLACES - 2);
    return delta[k] + (at - k) * (delta[k + 1] - delta[k]);
}

/* Multiplies every curve of the card; where it would not rise, it rises by a ten thousandth a point. */
static void apply_delta(sf_foam_card *card, const double *delta) {
    for (int64_t c = 0; c < card->curve_count; c++)
        for (int64_t k = card->curve_ptr[c]; k < card->curve_ptr[c + 1]; k++) {
            card->curve_stress[k] *= exp(delta_at(delta, card->curve_strain[k]));
            if (k > card->curve_ptr[c])
                card->curve_stress[k] = fmax(card->curve_stress[k], 1.0001 * card->curve_stress[k - 1]);
        }
}

sf_status sf_drop_inference_card(const sf_drop_inference *in, const double *u, const double *delta,
                                 sf_foam_card *card, sf_error *err) {
    SF_TRY(sf_drop_fit_card(in->fit->input, u, card, err));
    if (sf_foam_card_resample(card, err) == SF_OK)
        apply_delta(card, delta);
    else
        sf_foam_card_free(card);
    return err->status;
}

/* ---- corrected surrogate ---- */

/* Corrected responses of drops `first` to `last` - 1 into y [responses], with the speeds as given; `delta`:
 * of the curve that it raises, or NULL. A foam that no card may hold fails, as no simulation could follow it.
 */
static sf_status respond(const sf_drop_inference *in, const double *u, const double *delta, int first,
                         int last, double *y, sf_error *err) {
    const sf_drop_fit *fit = in->fit;
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    SF_TRY(delta ? sf_drop_inference_card(in, u, delta, &card, err)
                 : sf_drop_fit_card(fit->input, u, &card, err));
    SF_TRY(sf_foam_check_shared(&card, err));
    SF_TRY(sf_drop_fit_respond(fit, first, last, &card, NULL, y, err));
    for (int k = fit->row[first]; k < fit->row[last]; k++)
        y[k] += in->offset[k];
    return SF_OK;
}

/* Measured less corrected surrogate [data]. False: the columns fail. */
static bool find_residual(const sf_drop_inference *in, const double *u, double *residual) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED double *y = sf_alloc(&err, (unsigned long)responses_of(in->fit), sizeof *y, "responses");
    if (y && respond(in, u, NULL, 0, in->fit->measured_drops, y, &err) == SF_OK)
        for (int i = 0; i < in->data; i++)
            residual[i] = in->fit->measured[in->data_row[i]] - y[in->data_row[i]];
    return err.status == SF_OK;
}

/* ---- preparation ---- */

static sf_status list_data(sf_drop_inference *in, sf_error *err) {
    const sf_drop_fit *fit = in->fit;
    in->data_row = sf_alloc(err, responses_of(fit), sizeof *in->data_row, "data");
    for (int k = 0; k < fit->row[fit->measured_drops] && err->status == SF_OK; k++)
        if (!isinf(fit->sd[k]))
            in->data_row[in->data++] = k;
    for (int d = fit->measured_drops; d < fit->input->drop_count; d++)
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (sf_drop_kind_get(kind)->always)
                in->quantity[in->quantities++] = (sf_drop_quantity){d, kind};
    return err->status;
}

/* Returns the mean offset of a number of the measured drops. */
static double mean_offset(const sf_drop_fit *fit, int kind) {
    double sum = 0;
    int count = 0;
    for (int d = 0; d < fit->measured_drops; d++)
        if (isfinite(fit->result.offset[fit->row[d] + kind])) {
            sum += fit->result.offset[fit->row[d] + kind];
            count++;
        }
    return count > 0 ? sum / count : 0;
}

/* Offset of the columns at the speeds as given: the fit's for what was measured at a known speed; from the
 * simulations with the result for other drops or, where the simulation or its columns failed, the mean of the
 * measured drops. */
static sf_status find_offset(sf_drop_inference *in, sf_error *err) {
    const sf_drop_fit *fit = in->fit;
    int n = responses_of(fit), measured = fit->row[fit->measured_drops];
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    in->offset = sf_alloc(err, n, sizeof(double), "responses");
    SF_TRY(err->status);
    SF_TRY(sf_drop_fit_card(fit->input, fit->result.u, &card, err));
    sf_drop_fit_respond(fit, fit->measured_drops, fit->input->drop_count, &card, NULL, in->offset, err);
    for (int k = 0; k < n; k++)
        in->offset[k] = k < measured ? fit->result.offset[k] : fit->y[k] - in->offset[k];
    SF_TRY(err->status);
    SF_OWNED double *given = sf_alloc(err, n, sizeof *given, "responses");
    for (int d = 0; d < fit->measured_drops && err->status == SF_OK && !fit->speeds_fitted; d++) {
        sf_error failure = SF_ERROR_INIT; /* the columns may collapse at this speed */
        if (fit->speed[d] >= 0 && sf_drop_fit_respond(fit, d, d + 1, &card, NULL, given, &failure) == SF_OK)
            for (int k = fit->row[d]; k < fit->row[d + 1]; k++)
                in->offset[k] = fit->y[k] - given[k];
    }
    for (int d = fit->measured_drops; d < fit->input->drop_count; d++)
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            if (*fit->simulated[d].failure || !isfinite(in->offset[fit->row[d] + kind]))
                in->offset[fit->row[d] + kind] = mean_offset(fit, kind);
    return err->status;
}

/* Responses of the columns with the maximum's curve, raised by RAISE at one place by `sign`. */
static sf_status respond_raised(const sf_drop_inference *in, int place, double sign, double *y,
                                sf_error *err) {
    double delta[PLACES] = {0};
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    delta[place] = sign * RAISE;
    SF_TRY(sf_drop_inference_card(in, in->fit->result.u, delta, &card, err));
    return sf_drop_fit_respond(in->fit, 0, in->fit->input->drop_count, &card, NULL, y, err);
}

/* The response that a quantity is. */
static int row_of(const sf_drop_inference *in, int q) {
    return in->fit->row[in->quantity[q].drop] + in->quantity[q].kind;
}

static sf_status find_jacobian(sf_drop_inference *in, sf_error *err) {
    unsigned long n = (unsigned long)responses_of(in->fit);
    in->jacobian = sf_alloc(err, n * PLACES, sizeof(double), "responses");
    SF_OWN(double, high, n *PLACES, "responses", err);
    SF_OWN(double, low, n *PLACES, "responses", err);
    sf_error failure[PLACES];
#pragma omp parallel for schedule(dynamic)
    for (int b = 0; b < PLACES; b++) {
        failure[b] = (sf_error)SF_ERROR_INIT;
        if (respond_raised(in, b, 1, &high[(unsigned long)b * n], &failure[b]) == SF_OK)
            respond_raised(in, b, -1, &low[(unsigned long)b * n], &failure[b]);
    }
    for (unsigned long b = 0; b < PLACES && err->status == SF_OK; b++) {
        *err = failure[b];
        for (unsigned long k = 0; k < n; k++) {
            double slope = (high[b * n + k] - low[b * n + k]) / (2 * RAISE);
            in->jacobian[k * PLACES + b] = isfinite(slope) ? slope : 0;
        }
        for (int q = 0; q < in->quantities; q++) {
            unsigned long k = (unsigned long)row_of(in, q);
            bool known = isfinite(high[b * n + k] - low[b * n + k]);
            in->steep = in->steep || (!known && in->fit->columns[in->quantity[q].drop].count > 0);
        }
    }
    return err->status;
}

/* Adds to the covariance what an unknown beside the foam's, of index `parameter` and this standard deviation,
 * does to the data by the corrected surrogate's derivatives. */
static void add_unknown(sf_drop_inference *in, int parameter, double sd) {
    const double *g = in->fit->result.corrected;
    size_t n = (size_t)in->data;
    for (size_t i = 0; i < n && parameter >= 0; i++)
        for (size_t j = 0; j < n; j++)
            in->base[i * n + j] += sd * sd * g[in->data_row[i] * in->fit->parameters + parameter] *
                                   g[in->data_row[j] * in->fit->parameters + parameter];
}

/* Covariance of the errors: their own, and those of the speeds and of the accelerometer's chain. */
static sf_status fill_base(sf_drop_inference *in, sf_error *err) {
    const sf_drop_fit *fit = in->fit;
    size_t n = (size_t)in->data;
    in->base = sf_alloc(err, n * n, sizeof(double), "covariances");
    SF_TRY(err->status);
    for (size_t i = 0; i < n; i++)
        in->base[i * n + i] = pow(fit->sd[in->data_row[i]], 2);
    for (int d = 0; d < fit->measured_drops; d++)
        add_unknown(in, fit->speed[d], fit->input->drop[d].speed_sd);
    for (int k = 0; k < SF_SIGNAL_CHAIN; k++)
        add_unknown(in, fit->chain[k], fit->input->chain_sd[k]);
    return SF_OK;
}

static bool is_of(const sf_drop_fit *fit, int row, int drop) {
    return drop >= 0 && row >= fit->row[drop] && row < fit->row[drop + 1];
}

/* Derivatives of a datum by the errors x: first those that all drops share, by number, then each drop's. */
static void fill_effects(const sf_drop_fit *fit, int row, double *effect) {
    for (int d = 0; d < fit->measured_drops; d++) {
        int kind = row - fit->row[d];
        if (kind < 0 || kind >= SF_FIT_SAMPLES)
            continue;
        effect[kind] = effect[(d + 1) * SF_FIT_SAMPLES + kind] = sf_drop_kind_get(kind)->model_sd;
    }
}

/* The discrepancy of the data that are not of one drop (-1: of all). */
static sf_status build_discrepancy(const sf_drop_inference *in, int left_out, sf_discrepancy *out,
                                   sf_error *err) {
    unsigned long n = (unsigned long)in->data;
    double place[PLACES], kernel[PLACES * PLACES];
    SF_OWNED int *which = sf_alloc(err, n, sizeof *which, "data");
    int effects = (in->fit->measured_drops + 1) * SF_FIT_SAMPLES;
    SF_OWNED double *jacobian = sf_alloc(err, n * PLACES, sizeof *jacobian, "responses"),
                    *base = sf_alloc(err, n * n, sizeof *base, "covariances"),
                    *effect = sf_alloc(err, n * (unsigned long)effects, sizeof *effect, "responses");
    for (int b = 0; b < PLACES; b++)
        place[b] = PLACE_WIDTH * b;
    sf_kernel_fill(PLACES, place, LENGTH, kernel);
    SF_TRY(err->status);
    int count = 0;
    for (int i = 0; i < in->data; i++)
        if (!is_of(in->fit, in->data_row[i], left_out))
            which[count++] = i;
    for (int i = 0; i < count; i++) {
        memcpy(&jacobian[i * PLACES], &in->jacobian[in->data_row[which[i]] * PLACES],
               PLACES * sizeof *jacobian);
        fill_effects(in->fit, in->data_row[which[i]], &effect[i * effects]);
        for (int j = 0; j < count; j++)
            base[i * count + j] = in->base[which[i] * in->data + which[j]];
    }
    return sf_discrepancy_build(count, PLACES, jacobian, kernel, effects, effect, base, out, err);
}

/* ln of what makes the cut priors integrate to one. */
static double prior_norm(const sf_fit_input *input) {
    double sum = -log(2 * M_PI);
    for (int k = 0; k < input->unknown_count; k++) {
        const sf_parameter_info *info = sf_parameter_get(input->unknown[k]);
        double sd = input->prior_sd[k], middle = log(input->prior[k]);
        sum -= log(sd * sqrt(2 * M_PI) *
                   (gsl_cdf_ugaussian_P((log(info->high) - middle) / sd) -
                    gsl_cdf_ugaussian_P((log(info->low) - middle) / sd)));
    }
    return sum;
}

static sf_status prepare(sf_drop_inference *in, bool leave_one_out, sf_error *err) {
    if (in->parameters > SF_POSTERIOR_MOST)
        return SF_REFUSE(err, "%d unknown parameters to be sampled" SF_AT_MOST("%d"),
                         in->fit->input->unknown_count, SF_POSTERIOR_MOST - 2);
    in->prior_norm = prior_norm(in->fit->input);
    SF_TRY(list_data(in, err));
    SF_TRY(find_offset(in, err));
    SF_TRY(find_jacobian(in, err));
    SF_TRY(fill_base(in, err));
    SF_TRY(build_discrepancy(in, -1, &in->all, err));
    for (int d = 0; d < in->fit->measured_drops && leave_one_out && err->status == SF_OK; d++)
        build_discrepancy(in, d, &in->without[d], err);
    return err->status;
}

/* ---- densities ---- */

/* Normal in the logarithms, cut at the bounds of the parameters (HU: 1). */
static double log_prior(const sf_drop_inference *in, const double *u) {
    const sf_fit_input *input = in->fit->input;
    const double *z = &u[input->unknown_count];
    double sum = in->prior_norm - 0.5 * (z[0] * z[0] + z[1] * z[1]);
    for (int k = 0; k < input->unknown_count; k++) {
        const sf_parameter_info *info = sf_parameter_get(input->unknown[k]);
        double away = (u[k] - log(input->prior[k])) / input->prior_sd[k];
        if (!(u[k] >= log(info->low) && u[k] <= log(info->high)))
            return -INFINITY;
        sum -= 0.5 * away * away;
    }
    return sum;
}

/* Log likelihood; `conditional` [measured drops]: log p(data of a drop | those of the others), or NULL;
 * `part` [data] for what is left. */
static double split_of(const sf_drop_inference *in, const double *u, const double *residual,
                       double *conditional, double *part) {
    sf_discrepancy_size size = sf_drop_inference_size(in, u);
    double likelihood = sf_discrepancy_log_density(&in->all, residual, size);
    for (int d = 0; conditional && d < in->fit->measured_drops; d++) {
        int count = 0;
        for (int i = 0; i < in->data; i++)
            if (!is_of(in->fit, in->data_row[i], d))
                part[count++] = residual[i];
        conditional[d] = likelihood - sf_discrepancy_log_density(&in->without[d], part, size);
    }
    return likelihood;
}

/* The responses of the target; once the program is stopped the chains rush to their end. */
static bool respond_residual(const void *context, const double *u, double *residual) {
    return !sf_process_stopped() && find_residual(context, u, residual);
}

static double split(const void *context, const double *u, const double *residual, double *conditional) {
    const sf_drop_inference *in = context;
    double sum = log_prior(in, u);
    SF_OWNED double *own = sf_alloc(SF_IGNORED, 2 * in->data, sizeof *own, "data");
    for (int d = 0; conditional && d < in->fit->measured_drops; d++)
        conditional[d] = 0;
    if (own && isfinite(sum) && (residual || respond_residual(in, u, own)))
        sum += split_of(in, u, residual ? residual : own, conditional, own + in->data);
    else
        sum = -INFINITY;
    return sum;
}

static double log_density(const void *context, const double *u, const double *residual) {
    return split(context, u, residual, NULL);
}

/* The shared errors are the first of x. */
static void fill_error(sf_discrepancy_size size, const double *x, sf_response_error *error) {
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
        error->given[kind] = true;
        error->shared[kind] = sf_drop_kind_get(kind)->model_sd * x[kind];
        error->own_sd[kind] = sf_drop_kind_get(kind)->model_sd * size.kappa;
    }
}

bool sf_drop_inference_draw(const sf_drop_inference *in, const double *u, uint64_t seed, double *delta,
                            sf_response_error *error, double *own) {
    double x[SF_DISCREPANCY_MOST];
    sf_discrepancy_size size = sf_drop_inference_size(in, u);
    SF_OWNED double *residual = sf_alloc(SF_IGNORED, in->data, sizeof *residual, "data");
    SF_RANDOM *random = gsl_rng_alloc(gsl_rng_taus2);
    if (!residual || !random || !find_residual(in, u, residual))
        return false;
    gsl_rng_set(random, (unsigned long)seed & 0xffffffffu);
    sf_discrepancy_draw(&in->all, residual, size, random, delta, x);
    fill_error(size, x, error);
    for (int d = in->fit->measured_drops; own && d < in->fit->input->drop_count; d++)
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            own[d * SF_FIT_SAMPLES + kind] =
                sf_drop_kind_get(kind)->model_sd * (x[kind] + size.kappa * gsl_ran_ugaussian(random));
    return true;
}

/* Logarithms of what is predicted, of the foam of this state with a delta drawn. */
static void observe(const void *context, const double *u, uint64_t seed, double *quantity) {
    const sf_drop_inference *in = context;
    const sf_drop_fit *fit = in->fit;
    double delta[PLACES], own[SF_FIT_MAX_DROPS * SF_FIT_SAMPLES];
    sf_response_error error;
    sf_error err = SF_ERROR_INIT;
    SF_OWNED double *y = sf_alloc(&err, responses_of(fit), sizeof *y, "responses");
    bool known = y && !sf_process_stopped() && sf_drop_inference_draw(in, u, seed, delta, &error, own) &&
                 respond(in, u, in->steep ? delta : NULL, fit->measured_drops, fit->input->drop_count, y,
                         &err) == SF_OK;
    for (int q = 0; q < in->quantities; q++) {
        int row = row_of(in, q);
        quantity[q] =
            known ? y[row] + own[in->quantity[q].drop * SF_FIT_SAMPLES + in->quantity[q].kind] : NAN;
        for (int b = 0; known && !in->steep && b < PLACES; b++)
            quantity[q] += in->jacobian[row * PLACES + b] * delta[b];
    }
}

/* Covariance of the fit's foam parameters, and that of the z before the data. */
static void fill_start(const sf_drop_inference *in, double *start, double *covariance) {
    int n = in->parameters, unknowns = in->fit->input->unknown_count;
    memset(covariance, 0, (size_t)(n * n) * sizeof *covariance);
    for (int i = 0; i < unknowns; i++) {
        start[i] = in->fit->result.u[i];
        for (int j = 0; j < unknowns; j++)
            covariance[i * n + j] = in->fit->result.covariance[i][j];
    }
    for (int i = unknowns; i < n; i++) {
        start[i] = 0;
        covariance[i * n + i] = 1;
    }
}

static sf_status estimate_evidence(sf_drop_inference *in, const sf_target *target,
                                   const sf_inference_options *options, sf_error *err) {
    static const double FREEDOM = 5;
    sf_mixture m;
    SF_TRY(sf_mixture_fit(in->parameters, in->chains.chains * in->chains.kept, in->chains.sample, FREEDOM, &m,
                          err));
    return sf_evidence_estimate(target, &m, options->evidence_draws, sf_seed_of(options->chains.seed, 900),
                                &in->evidence, err);
}

static sf_status sample(const sf_drop_fit *fit, const sf_inference_options *options, sf_drop_inference *in,
                        sf_error *err) {
    double start[SF_POSTERIOR_MOST], covariance[SF_POSTERIOR_MOST * SF_POSTERIOR_MOST];
    *in = (sf_drop_inference){.fit = fit, .parameters = fit->input->unknown_count + 2};
    bool left_out = options->leave_one_out && fit->measured_drops > 1;
    SF_TRY(prepare(in, left_out, err));
    const sf_grouped grouped = {.target = {.parameters = in->parameters,
                                           .log_density = log_density,
                                           .context = in,
                                           .responses = in->data <= SF_RESPONSES_MOST ? in->data : 0,
                                           .shape = fit->input->unknown_count,
                                           .respond = respond_residual,
                                           .quantities = in->quantities,
                                           .observe = observe},
                                .groups = fit->measured_drops,
                                .split = split};
    fill_start(in, start, covariance);
    if (sf_chains_run(&grouped.target, start, covariance, &options->chains, &in->chains, err) != SF_OK ||
        (options->evidence_draws > 0 && estimate_evidence(in, &grouped.target, options, err) != SF_OK))
        return err->status;
    if (left_out)
        sf_leave_one_out(&grouped, &in->chains, &options->without, in->left_out, err);
    return err->status;
}

sf_status sf_drop_infer(const sf_drop_fit *fit, const sf_inference_options *options, sf_drop_inference *in,
                        sf_error *err) {
    sample(fit, options, in, err);
    if (sf_process_stopped()) {
        *err = (sf_error)SF_ERROR_INIT;
        return sf_run_folder_interrupted(err);
    }
    return err->status;
}

void sf_drop_inference_free(sf_drop_inference *in) {
    sf_discrepancy_free(&in->all);
    for (int d = 0; d < SF_FIT_MAX_DROPS; d++)
        sf_discrepancy_free(&in->without[d]);
    sf_chains_free(&in->chains);
    SF_CLEAR(in, in->data_row, in->offset, in->jacobian, in->base);
}
