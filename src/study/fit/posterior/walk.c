/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/walk.h"

#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = SF_POSTERIOR_MOST, START_TRIES = 50, DELAYED_STEPS = 100 };
static const double START_STRETCH = 2, INDEPENDENT = 0.6, SHORT = 0.3, DELAYED = 0.8, FLATTENED = 0.85;
static const double FAR = 40; /* of the log density below the best, where the emulator need not know it */

/* ---- steps ---- */

static void propose_jump(const sf_walk *w, gsl_rng *random, const double *from, double *u) {
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
static double evaluate(const sf_walk *w, sf_walker *c, const double *u) {
    const sf_target *t = w->target;
    double y[SF_RESPONSES_MOST];
    c->evaluations++;
    if (t->responses == 0)
        return sf_target_at(t, u);
    if (!t->respond(t->context, u, y))
        return -INFINITY;
    double density = t->log_density_of(t->context, u, y);
    if (isfinite(density) && c->tried < c->room) {
        memcpy(&c->tried_u[c->tried * t->shape], u, (size_t)t->shape * sizeof *u);
        memcpy(&c->tried_y[c->tried * t->responses], y, (size_t)t->responses * sizeof *y);
        c->tried_density[c->tried++] = density;
    }
    return density == density ? density : -INFINITY;
}

/* The same by the emulator, flattened: its tails, where it knows little, are to be heavier than the target's.
 */
static double emulate(const sf_walk *w, sf_walker *c, const double *u) {
    double y[SF_RESPONSES_MOST];
    (void)c;
    if (!sf_emulator_at(&w->emulator, u, y))
        return -INFINITY;
    double density = FLATTENED * w->target->log_density_of(w->target->context, u, y);
    return density == density ? density : -INFINITY;
}

/* One step of independence or random walk on a density. True: accepted. */
static bool step(const sf_walk *w, sf_walker *c, sf_state *at,
                 double (*density)(const sf_walk *, sf_walker *, const double *)) {
    sf_state to;
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
static bool delayed_step(const sf_walk *w, sf_walker *c, sf_state *at) {
    sf_state to = *at;
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

void sf_walker_walk(const sf_walk *w, int steps, sf_walker *c) {
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

/* ---- start ---- */

void sf_walker_place(const sf_walk *w, sf_walker *c) {
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

/* The states of all walkers that are not far below the best: u [][shape], y [][responses]; their number. */
static int gather(const sf_walk *w, int count, const sf_walker *walker, double *u, double *y) {
    size_t n = (size_t)w->target->shape, m = (size_t)w->target->responses, all = 0;
    double best = -INFINITY;
    for (int c = 0; c < count; c++)
        for (int k = 0; k < walker[c].tried; k++)
            best = fmax(best, walker[c].tried_density[k]);
    for (int c = 0; c < count; c++)
        for (size_t k = 0; k < (size_t)walker[c].tried; k++)
            if (walker[c].tried_density[k] > best - FAR) {
                memcpy(&u[all * n], &walker[c].tried_u[k * n], n * sizeof *u);
                memcpy(&y[all * m], &walker[c].tried_y[k * m], m * sizeof *y);
                all++;
            }
    return (int)all;
}

sf_status sf_walk_learn(sf_walk *w, int count, const sf_walker *walker, sf_error *err) {
    unsigned long n = (unsigned long)w->target->shape, m = (unsigned long)w->target->responses, all = 0;
    if (m == 0)
        return SF_OK;
    for (int c = 0; c < count; c++)
        all += (unsigned long)walker[c].tried;
    double *u = sf_alloc(err, all * n, sizeof *u, "states"), *y = sf_alloc(err, all * m, sizeof *y, "states");
    if (err->status == SF_OK) {
        int near = gather(w, count, walker, u, y);
        sf_emulator_free(&w->emulator);
        sf_emulator_fit((int)n, (int)m, near, u, y, &w->emulator, err);
    }
    free(u);
    free(y);
    return err->status;
}

/* ---- memory ---- */

sf_status sf_walker_init(const sf_target *target, int most, int round, uint64_t seed, sf_walker *c,
                         sf_error *err) {
    unsigned long n = (unsigned long)target->parameters, steps = (unsigned long)round;
    *c = (sf_walker){.room = target->responses > 0 ? most : 0};
    unsigned long room = (unsigned long)c->room;
    c->path = sf_alloc(err, steps * n, sizeof(double), "Markov chains");
    c->density = sf_alloc(err, steps, sizeof(double), "Markov chains");
    c->tried_u = sf_alloc(err, room * (unsigned long)target->shape, sizeof(double), "Markov chains");
    c->tried_y = sf_alloc(err, room * (unsigned long)target->responses, sizeof(double), "Markov chains");
    c->tried_density = sf_alloc(err, room, sizeof(double), "Markov chains");
    c->random = gsl_rng_alloc(gsl_rng_mt19937);
    if (!c->random)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a random generator");
    gsl_rng_set(c->random, (unsigned long)seed & 0xffffffffu);
    return err->status;
}

void sf_walker_free(sf_walker *c) {
    if (c->random)
        gsl_rng_free(c->random);
    free(c->path);
    free(c->density);
    free(c->tried_u);
    free(c->tried_y);
    free(c->tried_density);
    *c = (sf_walker){0};
}
