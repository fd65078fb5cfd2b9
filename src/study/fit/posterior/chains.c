/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/chains.h"

#include "study/fit/posterior/convergence.h"
#include "study/fit/posterior/walk.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = SF_POSTERIOR_MOST };
static const double FREEDOM = 8;

sf_chains_options sf_chains_defaults(uint64_t seed) {
    return (sf_chains_options){.chains = 4,
                               .seed = seed,
                               .burn_in_rounds = 4,
                               .round = 250,
                               .most_steps = 6000,
                               .most_kept = 1000,
                               .rhat = 1.02,
                               .effective = 400};
}

typedef struct work {
    const sf_target *target;
    const sf_chains_options *options;
    sf_walk walk;
    sf_walker *walker;
    sf_chains *out;
    int room;       /* states that `sample` of each chain has room for */
    double *column; /* [chains][kept] of one quantity */
} work;

/* ---- burn-in ---- */

static void walk_all(const work *w) {
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < w->options->chains; k++)
        sf_walker_walk(&w->walk, w->options->round, &w->walker[k]);
}

static sf_status place_all(const work *w, sf_error *err) {
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < w->options->chains; k++)
        sf_walker_place(&w->walk, &w->walker[k]);
    for (int k = 0; k < w->options->chains; k++)
        if (!isfinite(w->walker[k].at.density))
            return SF_FAIL(err, SF_ERR_NUMERIC, "no start of a Markov chain has a probability density");
    return SF_OK;
}

/* The proposals from the round's states of all chains; unchanged where they span no volume. */
static sf_status match(work *w, sf_error *err) {
    int n = w->target->parameters, round = w->options->round, count = w->options->chains * round;
    double *all = sf_alloc(err, (unsigned long)(count * n), sizeof *all, "samples");
    double mean[N] = {0}, covariance[N * N] = {0};
    sf_mixture proposal, jump;
    sf_error none = SF_ERROR_INIT;
    if (!all)
        return err->status;
    for (int c = 0; c < w->options->chains; c++)
        memcpy(&all[c * round * n], w->walker[c].path, (size_t)(round * n) * sizeof *all);
    for (int k = 0; k < count; k++)
        for (int i = 0; i < n; i++)
            mean[i] += all[k * n + i] / count;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                covariance[i * n + j] += (all[k * n + i] - mean[i]) * (all[k * n + j] - mean[j]) / count;
    if (sf_mixture_single(n, mean, covariance, FREEDOM, &jump, &none) == SF_OK &&
        sf_mixture_fit(n, count, all, FREEDOM, &proposal, &none) == SF_OK) {
        w->walk.jump = jump;
        w->walk.proposal = proposal;
    }
    free(all);
    return err->status;
}

/* Rounds whose states teach proposals and emulator. */
static sf_status burn_in(work *w, int rounds, sf_error *err) {
    for (int k = 0; k < rounds; k++) {
        walk_all(w);
        if (match(w, err) != SF_OK || sf_walk_learn(&w->walk, w->options->chains, w->walker, err) != SF_OK)
            return err->status;
    }
    for (int c = 0; c < w->options->chains; c++)
        w->walker[c].accepted = w->walker[c].proposed = 0;
    w->out->proposal = w->walk.proposal;
    return SF_OK;
}

/* ---- what is kept ---- */

/* Every second state only. */
static void thin(work *w) {
    sf_chains *r = w->out;
    size_t n = (size_t)r->parameters, q = (size_t)r->quantities;
    for (int c = 0; c < r->chains; c++)
        for (int k = 0; k < r->kept / 2; k++) {
            size_t to = (size_t)(c * w->room + k), from = (size_t)(c * w->room + 2 * k + 1);
            memmove(&r->sample[to * n], &r->sample[from * n], n * sizeof(double));
            if (q > 0)
                memmove(&r->quantity[to * q], &r->quantity[from * q], q * sizeof(double));
            r->log_density[to] = r->log_density[from];
        }
    r->kept /= 2;
    r->thinning *= 2;
}

static const double UNKNOWN = -1e300; /* begins quantities that were not observed yet */

/* Adds the round's states. */
static void keep(work *w, int steps_before) {
    sf_chains *r = w->out;
    int n = r->parameters;
    for (int k = 0; k < w->options->round; k++) {
        if ((steps_before + k + 1) % r->thinning != 0)
            continue;
        for (int c = 0; c < r->chains; c++) {
            int to = c * w->room + r->kept;
            memcpy(&r->sample[to * n], &w->walker[c].path[k * n], (size_t)n * sizeof(double));
            r->log_density[to] = w->walker[c].density[k];
            if (r->quantities > 0)
                r->quantity[to * r->quantities] = UNKNOWN;
        }
        r->kept++;
    }
    while (r->kept >= w->options->most_kept)
        thin(w);
}

static void observe(work *w) {
    sf_chains *r = w->out;
#pragma omp parallel for schedule(dynamic, 8)
    for (int s = 0; s < r->chains * r->kept; s++) {
        int at = s / r->kept * w->room + s % r->kept;
        double *q = &r->quantity[at * r->quantities];
        if (q[0] == UNKNOWN)
            w->target->observe(w->target->context, &r->sample[at * r->parameters],
                               sf_seed_of(w->options->seed, (uint64_t)r->thinning * 1000000 + (uint64_t)at),
                               q);
    }
}

/* States without a value take the largest one that others have; false: there is none. With NaN there is no
 * R-hat, with infinity no variance; without these states nobody would see chains that differ in how often
 * there is no value. So the diagnostics are those of the values cut at their largest, which see both. Of
 * peaks, which are missing where they are above all others, this keeps the order; of a number without an
 * order it stands for "none".
 */
static bool fill_missing(double *x, int count) {
    double largest = -INFINITY;
    for (int k = 0; k < count; k++)
        if (isfinite(x[k]))
            largest = fmax(largest, x[k]);
    for (int k = 0; k < count; k++)
        if (!isfinite(x[k]))
            x[k] = largest;
    return isfinite(largest);
}

/* Diagnostics of one column of `values` [chains][room][width]. */
static bool judge(work *w, const double *values, int width, int column, int which) {
    sf_chains *r = w->out;
    for (int c = 0; c < r->chains; c++)
        for (int k = 0; k < r->kept; k++)
            w->column[c * r->kept + k] = values[(c * w->room + k) * width + column];
    if (!fill_missing(w->column, r->chains * r->kept)) {
        r->rhat[which] = r->effective[which] = NAN;
        return true;
    }
    r->rhat[which] = sf_split_rhat(r->chains, r->kept, w->column);
    r->effective[which] = sf_effective_size(r->chains, r->kept, w->column);
    return r->rhat[which] < w->options->rhat && r->effective[which] > w->options->effective;
}

static bool is_reached(work *w, bool last) {
    sf_chains *r = w->out;
    bool reached = true;
    for (int i = 0; i < r->parameters; i++)
        reached = judge(w, r->sample, r->parameters, i, i) && reached;
    if (r->quantities == 0 || (!reached && !last))
        return reached;
    observe(w);
    for (int i = 0; i < r->quantities; i++)
        reached = judge(w, r->quantity, r->quantities, i, r->parameters + i) && reached;
    return reached;
}

/* Samples until the criteria are reached; what was sampled in the first quarter, and then in the first half,
 * of the most steps was burn-in if it does not reach them. */
static sf_status sample(work *w, sf_error *err) {
    sf_chains *r = w->out;
    int round = w->options->round, rounds = w->options->most_steps / round, since = 0;
    for (int k = 1; k <= rounds && !r->converged && err->status == SF_OK; k++) {
        walk_all(w);
        keep(w, since);
        since += round;
        r->converged = is_reached(w, k == rounds);
        if (!r->converged && k < rounds && (k == rounds / 4 || k == rounds / 2)) {
            burn_in(w, 1, err);
            r->kept = since = 0;
            r->thinning = 1;
        }
    }
    return err->status;
}

/* ---- the whole ---- */

/* [chains][room] becomes [chains][kept]. */
static void pack(const work *w) {
    sf_chains *r = w->out;
    size_t n = (size_t)r->parameters, q = (size_t)r->quantities, kept = (size_t)r->kept;
    for (size_t c = 1; c < (size_t)r->chains; c++) {
        size_t from = c * (size_t)w->room, to = c * kept;
        memmove(&r->sample[to * n], &r->sample[from * n], kept * n * sizeof(double));
        memmove(&r->log_density[to], &r->log_density[from], kept * sizeof(double));
        if (q > 0)
            memmove(&r->quantity[to * q], &r->quantity[from * q], kept * q * sizeof(double));
    }
}

static sf_status allocate(work *w, sf_error *err) {
    sf_chains *r = w->out;
    const sf_chains_options *o = w->options;
    unsigned long n = (unsigned long)r->parameters, q = (unsigned long)r->quantities,
                  chains = (unsigned long)r->chains;
    w->room = o->most_kept + o->round;
    unsigned long all = chains * (unsigned long)w->room;
    w->walker = sf_alloc(err, chains, sizeof *w->walker, "Markov chains");
    w->column = sf_alloc(err, all, sizeof(double), "Markov chains");
    r->sample = sf_alloc(err, all * n, sizeof(double), "Markov chains");
    r->log_density = sf_alloc(err, all, sizeof(double), "Markov chains");
    r->quantity = sf_alloc(err, all * q, sizeof(double), "Markov chains");
    r->rhat = sf_alloc(err, n + q, sizeof(double), "Markov chains");
    r->effective = sf_alloc(err, n + q, sizeof(double), "Markov chains");
    for (int c = 0; c < r->chains && err->status == SF_OK; c++)
        sf_walker_init(w->target, o->burn_in_rounds * o->round + o->most_steps, o->round,
                       sf_seed_of(o->seed, (uint64_t)c), &w->walker[c], err);
    return err->status;
}

static void release(work *w) {
    for (int c = 0; w->walker && c < w->options->chains; c++)
        sf_walker_free(&w->walker[c]);
    sf_emulator_free(&w->walk.emulator);
    free(w->walker);
    free(w->column);
}

sf_status sf_chains_run(const sf_target *target, const double *start, const double *covariance,
                        const sf_chains_options *options, sf_chains *r, sf_error *err) {
    *r = (sf_chains){.parameters = target->parameters,
                     .quantities = target->quantities,
                     .chains = options->chains,
                     .thinning = 1};
    work w = {.target = target, .options = options, .out = r, .walk = {.target = target}};
    if (sf_mixture_single(target->parameters, start, covariance, FREEDOM, &w.walk.proposal, err) != SF_OK)
        return err->status;
    w.walk.jump = w.walk.proposal;
    if (allocate(&w, err) == SF_OK && place_all(&w, err) == SF_OK &&
        burn_in(&w, options->burn_in_rounds, err) == SF_OK && sample(&w, err) == SF_OK) {
        long long accepted = 0, proposed = 0;
        pack(&w);
        for (int c = 0; c < r->chains; c++) {
            accepted += w.walker[c].accepted;
            proposed += w.walker[c].proposed;
            r->evaluations += w.walker[c].evaluations;
        }
        r->accepted = (double)accepted / (double)proposed;
    }
    release(&w);
    return err->status;
}

void sf_chains_free(sf_chains *r) {
    free(r->sample);
    free(r->log_density);
    free(r->quantity);
    free(r->rhat);
    free(r->effective);
    *r = (sf_chains){0};
}
