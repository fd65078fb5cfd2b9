/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/posterior.h"

#include "study/fit/least_squares.h"
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sort.h>

/* ---- importance sampling ---- */

/* Returns the log of the mean of the weights exp(x); `effective`: (sum w)^2 / sum w^2; NULL: not wanted. */
static double log_mean(int count, const double *x, double *effective) {
    double largest = -INFINITY, sum = 0, squares = 0;
    for (int k = 0; k < count; k++)
        largest = fmax(largest, x[k]);
    for (int k = 0; k < count && isfinite(largest); k++) {
        sum += exp(x[k] - largest);
        squares += exp(2 * (x[k] - largest));
    }
    if (effective)
        *effective = squares > 0 ? sum * sum / squares : 0;
    return isfinite(largest) ? largest + log(sum / count) : largest;
}

sf_status sf_evidence_estimate(const sf_target *target, const sf_mixture *mixture, int draws, uint64_t seed,
                               sf_evidence *e, sf_error *err) {
    int n = target->parameters;
    *e = (sf_evidence){.draws = draws};
    SF_OWNED double *u = sf_alloc(err, draws * n, sizeof *u, "draws"),
                    *weight = sf_alloc(err, draws, sizeof *weight, "draws");
    SF_RANDOM *random = sf_random(sf_seed_of(seed, 0), err);
    SF_TRY(err->status);
    for (int k = 0; k < draws; k++)
        sf_mixture_draw(mixture, random, &u[k * n]);
#pragma omp parallel for schedule(dynamic, 8)
    for (int k = 0; k < draws; k++)
        weight[k] = sf_target_at(target, &u[k * n]) - sf_mixture_log_density(mixture, &u[k * n]);
    e->log_value = log_mean(draws, weight, &e->effective);
    e->error = e->effective > 0 ? sqrt(fmax(0, 1 / e->effective - 1. / draws)) : INFINITY;
    e->trusted = e->effective >= 100 && e->effective >= draws / 50.;
    return err->status;
}

/* ---- Pareto smoothing ---- */

/* Shape and scale of a generalised Pareto distribution for ascending x [count] > 0: the mean of the profile
 * likelihood's b over a grid, with the weakly informative prior of the reference (k drawn to 0.5 by ten
 * observations). */
static double fit_tail(int count, const double *x, double *scale) {
    enum { MOST = 200 };
    int grid = 30 + (int)sqrt(count);
    double b[MOST], likelihood[MOST], largest = -INFINITY, sum = 0, mean = 0,
                                      quartile = x[(count + 2) / 4 - 1];
    grid = grid > MOST ? MOST : grid;
    for (int j = 0; j < grid; j++) {
        double k = 0;
        b[j] = 1 / x[count - 1] + (1 - sqrt(grid / (j + 0.5))) / (3 * quartile);
        for (int i = 0; i < count; i++)
            k += log1p(-b[j] * x[i]) / count;
        likelihood[j] = count * (log(-b[j] / k) - k - 1);
        largest = fmax(largest, likelihood[j]);
    }
    for (int j = 0; j < grid; j++) {
        double w = exp(likelihood[j] - largest);
        sum += w;
        mean += w * b[j];
    }
    double shape = 0;
    mean /= sum;
    for (int i = 0; i < count; i++)
        shape += log1p(-mean * x[i]) / count;
    *scale = -shape / mean;
    return (count * shape + 10 * 0.5) / (count + 10.);
}

double sf_pareto_smooth(int count, double *weight, sf_error *err) {
    enum { LEAST = 5 };
    int tail = (int)fmin(0.2 * count, 3 * sqrt(count));
    if (tail < LEAST)
        return INFINITY;
    SF_OWNED size_t *order = sf_alloc(err, count, sizeof *order, "weights");
    SF_OWNED double *x = sf_alloc(err, tail, sizeof *x, "weights");
    if (!order || !x)
        return INFINITY;
    gsl_sort_index(order, weight, 1, (size_t)count);
    double largest = weight[order[count - 1]], cut = exp(weight[order[count - tail - 1]] - largest), scale;
    for (int k = 0; k < tail; k++)
        x[k] = exp(weight[order[count - tail + k]] - largest) - cut;
    if (x[tail - 1] - x[0] < 1e-12)
        return -INFINITY;          /* all alike: nothing to smooth */
    for (int k = 0; k < tail; k++) /* ties with the cut */
        x[k] = fmax(x[k], 1e-15);
    double shape = fit_tail(tail, x, &scale);
    for (int k = 0; k < tail && isfinite(shape); k++) {
        double away = -log1p(-(k + 0.5) / tail), /* the quantile of an exponential distribution */
            by = fabs(shape) < 1e-9 ? scale * away : scale * expm1(shape * away) / shape;
        weight[order[count - tail + k]] = largest + fmin(0, log(cut + by));
    }
    return isfinite(shape) ? shape : INFINITY;
}

/* ---- weights of models ---- */

enum { BOOTSTRAPS = 4000 };

void sf_evidence_weights(int models, const double *value, double *weight) {
    double largest = -INFINITY, sum = 0;
    for (int m = 0; m < models; m++)
        largest = isfinite(value[m]) ? fmax(largest, value[m]) : largest;
    for (int m = 0; m < models; m++)
        sum += weight[m] = isfinite(value[m]) ? exp(value[m] - largest) : 0;
    for (int m = 0; m < models && sum > 0; m++)
        weight[m] /= sum;
}

sf_status sf_predictive_weights(int models, int groups, const double *log_density, uint64_t seed,
                                double *weight, sf_error *err) {
    SF_OWNED double *share = sf_alloc(err, 2 * (unsigned long)(groups + models), sizeof *share, "weights");
    SF_RANDOM *random = sf_random(sf_seed_of(seed, 77), err);
    SF_TRY(err->status);
    double *alpha = share + groups, *sum = alpha + groups, *part = sum + models;
    for (int g = 0; g < groups; g++)
        alpha[g] = 1;
    for (int m = 0; m < models; m++)
        weight[m] = 0;
    for (int b = 0; b < BOOTSTRAPS; b++) {
        gsl_ran_dirichlet(random, (size_t)groups, alpha, share);
        for (int m = 0; m < models; m++) {
            sum[m] = 0;
            for (int g = 0; g < groups; g++)
                sum[m] += groups * share[g] * log_density[m * groups + g];
        }
        sf_evidence_weights(models, sum, part);
        for (int m = 0; m < models; m++)
            weight[m] += part[m] / BOOTSTRAPS;
    }
    return SF_OK;
}

/* ---- groups of data left out ---- */

enum { MOST_GROUPS = 32 };
static const double USABLE = 0.5, WIDER = 2; /* of the variances, where the chains without a group start */

/* The target without one group. */
typedef struct without {
    const sf_grouped *grouped;
    int group;
} without;

static double density_without(const void *context, const double *u, const double *y) {
    const without *w = context;
    double conditional[MOST_GROUPS], all = w->grouped->split(w->grouped->target.context, u, y, conditional);
    return all - conditional[w->group];
}

static bool respond(const void *context, const double *u, double *y) {
    const sf_target *target = &((const without *)context)->grouped->target;
    return target->respond(target->context, u, y);
}

/* log p(y_g | others, u) of every sample: [samples][groups]. */
static double *split_all(const sf_grouped *g, const double *sample, int count, sf_error *err) {
    double *all = sf_alloc(err, count * g->groups, sizeof *all, "leave-one-out densities");
    if (all) {
#pragma omp parallel for schedule(dynamic, 8)
        for (int s = 0; s < count; s++)
            g->split(g->target.context, &sample[s * g->target.parameters], NULL, &all[s * g->groups]);
    }
    return all;
}

/* By weights 1 / p(y_g | others, u). */
static sf_status weigh(const double *all, int groups, int g, int count, sf_left_out *out, sf_error *err) {
    SF_OWN(double, weight, 2 * count, "weights", err);
    double *sum = weight + count;
    for (int s = 0; s < count; s++)
        weight[s] = -all[s * groups + g];
    out->pareto_k = sf_pareto_smooth(count, weight, err);
    out->converged = out->pareto_k < USABLE;
    for (int s = 0; s < count; s++)
        sum[s] = weight[s] + all[s * groups + g];
    out->log_density = log_mean(count, sum, NULL) - log_mean(count, weight, NULL);
    return err->status;
}

static sf_status sample(const sf_grouped *g, int group, const sf_chains *whole,
                        const sf_chains_options *options, sf_left_out *out, sf_error *err) {
    double mean[SF_POSTERIOR_MOST], covariance[SF_POSTERIOR_MOST * SF_POSTERIOR_MOST];
    const without context = {g, group};
    const sf_target target = {.parameters = g->target.parameters,
                              .log_density = density_without,
                              .context = &context,
                              .responses = g->target.responses,
                              .shape = g->target.shape,
                              .respond = respond};
    sf_chains_options own = *options;
    SF_OWNED_BY(sf_chains_free) sf_chains chains = {0};
    own.seed = sf_seed_of(options->seed, (uint64_t)(500 + group));
    sf_moments(whole->parameters, whole->chains * whole->kept, whole->sample, mean, covariance);
    for (int i = 0; i < whole->parameters * whole->parameters; i++)
        covariance[i] *= WIDER;
    SF_TRY(sf_chains_run(&target, mean, covariance, &own, &chains, err));
    int count = chains.chains * chains.kept;
    SF_OWNED double *all = split_all(g, chains.sample, count, err);
    SF_TRY(err->status);
    for (int s = 0; s < count; s++)
        all[s] = all[s * g->groups + group];
    out->log_density = log_mean(count, all, NULL);
    out->sampled = true;
    out->converged = chains.converged;
    return SF_OK;
}

/* ---- draws of a wider mixture ---- */

static const double STRETCH = 1.4; /* of the posterior's scale */

/* Draws with their weights: log density of the target over that of the mixture, and the conditionals. */
typedef struct wide {
    int count;
    double *weight, *conditional; /* [count], [count][groups] */
} wide;

static void free_wide(wide *w) {
    SF_FREE(w->weight, w->conditional);
}

static sf_status draw_wide(const sf_grouped *g, const sf_chains *chains, const sf_leave_options *options,
                           wide *w, sf_error *err) {
    static const double FREEDOM = 5;
    int n = chains->parameters, draws = options->draws;
    sf_mixture m;
    *w = (wide){.weight = sf_alloc(err, draws, sizeof(double), "draws"),
                .conditional = sf_alloc(err, draws * g->groups, sizeof(double), "draws")};
    SF_OWNED double *u = sf_alloc(err, draws * n, sizeof *u, "draws");
    SF_RANDOM *random = sf_random(sf_seed_of(options->chains.seed, 700), err);
    SF_TRY(err->status);
    SF_TRY(sf_mixture_fit(n, chains->chains * chains->kept, chains->sample, FREEDOM, &m, err));
    for (int p = 0; p < m.parts; p++) {
        for (int i = 0; i < n; i++)
            for (int j = 0; j <= i; j++)
                m.part[p].factor[i][j] *= STRETCH;
        m.part[p].log_norm -= n * log(STRETCH);
    }
    for (int k = 0; k < draws; k++)
        sf_mixture_draw(&m, random, &u[k * n]);
#pragma omp parallel for schedule(dynamic, 8)
    for (int k = 0; k < draws; k++) {
        double weight = g->split(g->target.context, &u[k * n], NULL, &w->conditional[k * g->groups]) -
                        sf_mixture_log_density(&m, &u[k * n]);
        w->weight[k] = isfinite(weight) ? weight : -INFINITY;
    }
    w->count = draws;
    return SF_OK;
}

/* Estimates log p(group | others) by the weights, and sets `out->drawn` if enough draws count. */
static sf_status take_wide(const wide *w, int groups, int group, double effective, sf_left_out *out,
                           sf_error *err) {
    SF_OWN(double, others, w->count, "draws", err);
    double size;
    for (int k = 0; k < w->count; k++)
        others[k] = isinf(w->weight[k]) ? -INFINITY : w->weight[k] - w->conditional[k * groups + group];
    double without_group = log_mean(w->count, others, &size);
    out->drawn = out->converged = w->count > 0 && size >= effective;
    if (out->drawn)
        out->log_density = log_mean(w->count, w->weight, NULL) - without_group;
    return SF_OK;
}

sf_status sf_leave_one_out(const sf_grouped *g, const sf_chains *chains, const sf_leave_options *options,
                           sf_left_out *out, sf_error *err) {
    int count = chains->chains * chains->kept;
    SF_OWNED_BY(free_wide) wide w = {0};
    if (g->groups > MOST_GROUPS)
        return SF_REFUSE(err, "%d groups of data to be left out one by one" SF_AT_MOST("%d"), g->groups,
                         MOST_GROUPS);
    SF_OWNED double *all = split_all(g, chains->sample, count, err);
    for (int k = 0; k < g->groups && err->status == SF_OK; k++) {
        out[k] = (sf_left_out){.converged = false};
        if (weigh(all, g->groups, k, count, &out[k], err) != SF_OK || out[k].converged)
            continue;
        if (options->draws > 0 && w.count == 0 && draw_wide(g, chains, options, &w, err) != SF_OK)
            break;
        if (take_wide(&w, g->groups, k, options->effective, &out[k], err) == SF_OK && !out[k].drawn)
            sample(g, k, chains, &options->chains, &out[k], err);
    }
    return err->status;
}
