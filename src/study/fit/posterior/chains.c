/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/posterior.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <string.h>

enum { N = SF_POSTERIOR_MOST, START_TRIES = 50, DELAYED_STEPS = 100 };
static const double FREEDOM = 8;
static const double START_STRETCH = 2, INDEPENDENT = 0.6, SHORT = 0.3, DELAYED = 0.8, FLATTENED = 0.85;
static const double FAR = 40; /* of the log density below the best, where the emulator need not know it */

/* The common data of the steps of all chains; constant while they walk. */
typedef struct walk {
    const sf_target *target;
    sf_mixture proposal, jump; /* of independence steps; its factor of random walks */
    sf_emulator emulator;      /* owned */
} walk;

/* A state: its place, and log densities of the target and of the proposal there. */
typedef struct state {
    double u[SF_POSTERIOR_MOST], density, proposal;
} state;

typedef struct walker {
    gsl_rng *random;
    state at;
    double *path, *density; /* [steps][parameters] of the last walk, and their log densities; owned, with
                               all arrays in the block of the first */
    long long accepted, proposed, evaluations;
    int tried, room; /* evaluated states that are kept */
    double *tried_u, *tried_y, *tried_density;
} walker;

/* ---- steps ---- */

static void propose_jump(const walk *w, gsl_rng *random, const double *from, double *u) {
    int n = w->target->parameters;
    double z[N], scale = 2.38 / sqrt(n);
    if (gsl_rng_uniform(random) < SHORT)
        scale *= 0.1;
    for (int i = 0; i < n; i++)
        z[i] = gsl_ran_ugaussian(random);
    for (int i = 0; i < n; i++) {
        u[i] = from[i];
        for (int j = 0; j <= i; j++)
            u[i] += scale * w->jump.part[0].factor[i][j] * z[j];
    }
}

/* The target's log density; its responses are noted for the emulator. */
static double evaluate(const walk *w, walker *c, const double *u) {
    const sf_target *t = w->target;
    double y[SF_RESPONSES_MOST];
    c->evaluations++;
    if (t->responses == 0)
        return sf_target_at(t, u);
    if (!t->respond(t->context, u, y))
        return -INFINITY;
    double density = t->log_density(t->context, u, y);
    if (isfinite(density) && c->tried < c->room) {
        memcpy(&c->tried_u[c->tried * t->shape], u, (size_t)t->shape * sizeof *u);
        memcpy(&c->tried_y[c->tried * t->responses], y, (size_t)t->responses * sizeof *y);
        c->tried_density[c->tried++] = density;
    }
    return density == density ? density : -INFINITY;
}

/* The same by the emulator, flattened: its tails, where it knows little, shall be heavier than the target's.
 */
static double emulate(const walk *w, walker *c, const double *u) {
    double y[SF_RESPONSES_MOST];
    (void)c;
    if (!sf_emulator_at(&w->emulator, u, y))
        return -INFINITY;
    double density = FLATTENED * w->target->log_density(w->target->context, u, y);
    return density == density ? density : -INFINITY;
}

/* One step of independence or random walk on a density. True: accepted. */
static bool step(const walk *w, walker *c, state *at,
                 double (*density)(const walk *, walker *, const double *)) {
    state to;
    bool independent = gsl_rng_uniform(c->random) < INDEPENDENT;
    if (independent)
        sf_mixture_draw(&w->proposal, c->random, to.u);
    else
        propose_jump(w, c->random, at->u, to.u);
    to.density = density(w, c, to.u);
    to.proposal = sf_mixture_log_density(&w->proposal, to.u);
    double ratio = to.density - at->density + (independent ? at->proposal - to.proposal : 0);
    if (!(log(gsl_rng_uniform_pos(c->random)) < ratio))
        return false;
    *at = to;
    return true;
}

/* Many steps on the emulator, whose end the target accepts or rejects. No step is made where the emulator
 * does not reach, and none ends there. */
static bool delayed_step(const walk *w, walker *c, state *at) {
    state to = *at;
    double start = emulate(w, c, at->u);
    bool moved = false;
    to.density = start;
    for (int k = 0; k < DELAYED_STEPS && isfinite(start); k++)
        moved = step(w, c, &to, emulate) || moved;
    if (!moved)
        return false;
    double density = evaluate(w, c, to.u), ratio = density - at->density + start - to.density;
    if (!(log(gsl_rng_uniform_pos(c->random)) < ratio))
        return false;
    to.density = density;
    *at = to;
    return true;
}

/* Takes a number of steps; the states after them stand in `path` and `density`. */
static void walk_on(const walk *w, int steps, walker *c) {
    int n = w->target->parameters;
    c->at.proposal = sf_mixture_log_density(&w->proposal, c->at.u); /* it may have changed */
    for (int k = 0; k < steps; k++) {
        bool delayed = w->emulator.terms > 0 && gsl_rng_uniform(c->random) < DELAYED;
        c->proposed++;
        c->accepted += delayed ? delayed_step(w, c, &c->at) : step(w, c, &c->at, evaluate);
        memcpy(&c->path[k * n], c->at.u, (size_t)n * sizeof *c->at.u);
        c->density[k] = c->at.density;
    }
}

/* Puts the walker at a draw of the proposal, stretched, or at its centre; at.density is not finite if neither
 * has a density. */
static void place(const walk *w, walker *c) {
    sf_mixture wide = w->proposal;
    for (int i = 0; i < wide.parameters; i++)
        for (int j = 0; j <= i; j++)
            wide.part[0].factor[i][j] *= START_STRETCH;
    for (int k = 0; k < START_TRIES; k++) {
        sf_mixture_draw(&wide, c->random, c->at.u);
        c->at.density = evaluate(w, c, c->at.u);
        if (isfinite(c->at.density))
            return;
    }
    memcpy(c->at.u, w->proposal.part[0].centre, (size_t)w->target->parameters * sizeof *c->at.u);
    c->at.density = evaluate(w, c, c->at.u);
}

/* ---- emulator ---- */

/* Fits the emulator to the states that the walkers kept and that are not far below the best; none where they
 * are too few. */
static sf_status learn(walk *w, int count, const walker *list, sf_error *err) {
    size_t n = (size_t)w->target->shape, m = (size_t)w->target->responses, all = 0;
    double best = -INFINITY;
    int near = 0;
    if (m == 0)
        return SF_OK;
    for (int c = 0; c < count; c++)
        for (int k = 0; k < list[c].tried; k++, all++)
            best = fmax(best, list[c].tried_density[k]);
    SF_OWN(double, u, all *n, "states", err);
    SF_OWN(double, y, all *m, "states", err);
    for (int c = 0; c < count; c++)
        for (size_t k = 0; k < (size_t)list[c].tried; k++)
            if (list[c].tried_density[k] > best - FAR) {
                memcpy(&u[(size_t)near * n], &list[c].tried_u[k * n], n * sizeof *u);
                memcpy(&y[(size_t)near++ * m], &list[c].tried_y[k * m], m * sizeof *y);
            }
    sf_emulator_free(&w->emulator);
    return sf_emulator_fit((int)n, (int)m, near, u, y, &w->emulator, err);
}

/* A walker with room for walks of `round` steps, that keeps at most `most` evaluated states to learn from. */
static sf_status init_walker(const sf_target *target, int most, int round, uint64_t seed, walker *c,
                             sf_error *err) {
    unsigned long n = (unsigned long)target->parameters, steps = (unsigned long)round;
    *c = (walker){.room = target->responses > 0 ? most : 0};
    unsigned long room = (unsigned long)c->room, shape = (unsigned long)target->shape,
                  responses = (unsigned long)target->responses;
    c->random = sf_random(seed, err);
    c->path =
        sf_alloc(err, steps * (n + 1) + room * (shape + responses + 1), sizeof(double), "Markov chains");
    SF_TRY(err->status);
    c->density = c->path + steps * n;
    c->tried_u = c->density + steps;
    c->tried_y = c->tried_u + room * shape;
    c->tried_density = c->tried_y + room * responses;
    return err->status;
}

/* ---- agreement of the chains ---- */

/* The halves as chains of their own: value `k` of half `h`. */
typedef struct halves {
    int chains, count, stride;
    const double *x;
} halves;

static halves split(int chains, int count, const double *x) {
    return (halves){.chains = 2 * chains, .count = count / 2, .stride = count, .x = x};
}

static const double *half(const halves *s, int h) {
    return &s->x[h / 2 * s->stride + (h % 2 ? s->stride - s->count : 0)];
}

static double mean(const double *x, int count) {
    double sum = 0;
    for (int k = 0; k < count; k++)
        sum += x[k];
    return sum / count;
}

/* Autocovariance at a lag, divided by the whole number. */
static double autocovariance(const double *x, int count, int lag) {
    double about = mean(x, count), sum = 0;
    for (int k = 0; k + lag < count; k++)
        sum += (x[k] - about) * (x[k + lag] - about);
    return sum / count;
}

/* Variance within the halves, and the estimate of the whole variance. */
static void variances(const halves *s, double *within, double *whole) {
    double about = 0, between = 0;
    *within = 0;
    for (int h = 0; h < s->chains; h++)
        about += mean(half(s, h), s->count) / s->chains;
    for (int h = 0; h < s->chains; h++) {
        double m = mean(half(s, h), s->count);
        between += (m - about) * (m - about) / (s->chains - 1);
        *within += autocovariance(half(s, h), s->count, 0) * s->count / (s->count - 1) / s->chains;
    }
    *whole = *within * (s->count - 1) / s->count + between;
}

double sf_split_rhat(int chains, int count, const double *x) {
    halves s = split(chains, count, x);
    double within, whole;
    if (s.count < 2)
        return NAN;
    variances(&s, &within, &whole);
    if (within == 0)
        return whole == 0 ? 1 : INFINITY;
    return sqrt(whole / within);
}

/* Correlation at a lag over all halves. */
static double correlation(const halves *s, double within, double whole, int lag) {
    double sum = 0;
    for (int h = 0; h < s->chains; h++)
        sum += autocovariance(half(s, h), s->count, lag) * s->count / (s->count - 1) / s->chains;
    return 1 - (within - sum) / whole;
}

double sf_effective_size(int chains, int count, const double *x) {
    halves s = split(chains, count, x);
    double within, whole, all = (double)s.chains * s.count, last = INFINITY, sum = 0;
    if (!isfinite(sf_split_rhat(chains, count, x)))
        return 0;
    variances(&s, &within, &whole);
    if (within == 0)
        return all;
    for (int lag = 0; lag + 1 < s.count; lag += 2) {
        double pair =
            (lag == 0 ? 1 : correlation(&s, within, whole, lag)) + correlation(&s, within, whole, lag + 1);
        if (!(pair > 0))
            break;
        last = fmin(last, pair);
        sum += 2 * last;
    }
    return fmin(all / fmax(sum - 1, 1e-3), all * log10(all));
}

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
    walk walk;
    walker *walker;
    sf_chains *out;
    int room;       /* states that `sample` of each chain has room for */
    double *column; /* [chains][kept] of one quantity */
} work;

/* ---- burn-in ---- */

static void walk_all(const work *w) {
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < w->options->chains; k++)
        walk_on(&w->walk, w->options->round, &w->walker[k]);
}

static sf_status place_all(const work *w, sf_error *err) {
#pragma omp parallel for schedule(dynamic)
    for (int k = 0; k < w->options->chains; k++)
        place(&w->walk, &w->walker[k]);
    for (int k = 0; k < w->options->chains; k++)
        if (!isfinite(w->walker[k].at.density))
            return SF_FAIL(err, SF_ERR_NUMERIC, "no start of a Markov chain has a probability density");
    return SF_OK;
}

/* The proposals from the round's states of all chains; unchanged where they span no volume. */
static sf_status match(work *w, sf_error *err) {
    int n = w->target->parameters, round = w->options->round, count = w->options->chains * round;
    SF_OWN(double, all, count *n, "samples", err);
    sf_mixture proposal, jump;
    sf_error none = SF_ERROR_INIT;
    for (int c = 0; c < w->options->chains; c++)
        memcpy(&all[c * round * n], w->walker[c].path, (size_t)(round * n) * sizeof *all);
    if (sf_mixture_about(n, count, all, FREEDOM, &jump, &none) == SF_OK &&
        sf_mixture_fit(n, count, all, FREEDOM, &proposal, &none) == SF_OK) {
        w->walk.jump = jump;
        w->walk.proposal = proposal;
    }
    return err->status;
}

/* Rounds whose states teach proposals and emulator. */
static sf_status burn_in(work *w, int rounds, sf_error *err) {
    for (int k = 0; k < rounds; k++) {
        walk_all(w);
        SF_TRY(match(w, err));
        SF_TRY(learn(&w->walk, w->options->chains, w->walker, err));
    }
    for (int c = 0; c < w->options->chains; c++)
        w->walker[c].accepted = w->walker[c].proposed = 0;
    w->out->proposal = w->walk.proposal;
    return SF_OK;
}

/* ---- what is kept ---- */

/* One state becomes another. */
static void move_state(sf_chains *r, int from, int to) {
    size_t n = (size_t)r->parameters, q = (size_t)r->quantities;
    memmove(&r->sample[(size_t)to * n], &r->sample[(size_t)from * n], n * sizeof(double));
    memmove(&r->quantity[(size_t)to * q], &r->quantity[(size_t)from * q], q * sizeof(double));
    r->log_density[to] = r->log_density[from];
}

/* Every second state only. */
static void thin(work *w) {
    sf_chains *r = w->out;
    for (int c = 0; c < r->chains; c++)
        for (int k = 0; k < r->kept / 2; k++)
            move_state(r, c * w->room + 2 * k + 1, c * w->room + k);
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

static sf_status allocate(work *w, sf_error *err) {
    sf_chains *r = w->out;
    const sf_chains_options *o = w->options;
    unsigned long n = (unsigned long)r->parameters, q = (unsigned long)r->quantities,
                  chains = (unsigned long)r->chains;
    w->room = o->most_kept + o->round;
    unsigned long all = chains * (unsigned long)w->room;
    SF_TRY(SF_ALLOC_ALL(err, "Markov chains", SF_ROOM(w->walker, chains), SF_ROOM(w->column, all),
                        SF_ROOM(r->sample, (all + 2) * (n + q) + all)));
    r->quantity = r->sample + all * n;
    r->log_density = r->quantity + all * q;
    r->rhat = r->log_density + all;
    r->effective = r->rhat + n + q;
    for (int c = 0; c < r->chains && err->status == SF_OK; c++)
        init_walker(w->target, o->burn_in_rounds * o->round + o->most_steps, o->round,
                    sf_seed_of(o->seed, (uint64_t)c), &w->walker[c], err);
    return err->status;
}

static void release(work *w) {
    for (int c = 0; w->walker && c < w->options->chains; c++) {
        gsl_rng_free(w->walker[c].random);
        free(w->walker[c].path); /* and all behind it */
    }
    sf_emulator_free(&w->walk.emulator);
    SF_FREE(w->walker, w->column);
}

sf_status sf_chains_run(const sf_target *target, const double *start, const double *covariance,
                        const sf_chains_options *options, sf_chains *r, sf_error *err) {
    *r = (sf_chains){.parameters = target->parameters,
                     .quantities = target->quantities,
                     .chains = options->chains,
                     .thinning = 1};
    work w = {.target = target, .options = options, .out = r, .walk = {.target = target}};
    SF_TRY(sf_mixture_single(target->parameters, start, covariance, FREEDOM, &w.walk.proposal, err));
    w.walk.jump = w.walk.proposal;
    if (allocate(&w, err) == SF_OK && place_all(&w, err) == SF_OK &&
        burn_in(&w, options->burn_in_rounds, err) == SF_OK && sample(&w, err) == SF_OK) {
        long long accepted = 0, proposed = 0;
        for (int s = r->kept; s < r->chains * r->kept; s++) /* [chains][room] becomes [chains][kept] */
            move_state(r, s / r->kept * w.room + s % r->kept, s);
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
    SF_CLEAR(r, r->sample); /* and all behind it */
}
