/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/solve.h"

#include "base/mat3.h"

/* Adds the row of the pair over the coefficients, times `q`, to `out`; value: of the rows. */
static void scatter(const sf_point_rows *rows, const double *value, const sf_contact_pair *pair,
                    const double q[3], double *out) {
    for (int k = 0; k < pair->parts; k++) {
        int64_t p = pair->part[k];
        double along = pair->leans ? sf_dot3(pair->lean[k], q) : 0, own[3];
        for (int r = 0; r < 3; r++)
            own[r] = pair->share[k] * q[r] + along * pair->normal[r];
        for (int64_t e = rows->ptr[p]; e < rows->ptr[p + 1]; e++)
            for (int r = 0; r < 3; r++)
                out[3 * (int64_t)rows->node[e] + r] += value[e] * own[r];
    }
}

/* The row of the pair times a field over the coefficients. */
static void gather(const sf_point_rows *rows, const sf_contact_pair *pair, const double *field,
                   double out[3]) {
    for (int r = 0; r < 3; r++)
        out[r] = 0;
    for (int k = 0; k < pair->parts; k++) {
        int64_t p = pair->part[k];
        double own[3] = {0};
        for (int64_t e = rows->ptr[p]; e < rows->ptr[p + 1]; e++)
            for (int r = 0; r < 3; r++)
                own[r] += rows->value[e] * field[3 * (int64_t)rows->node[e] + r];
        double along = pair->leans ? sf_dot3(own, pair->normal) : 0;
        for (int r = 0; r < 3; r++)
            out[r] += pair->share[k] * own[r] + (pair->leans ? pair->lean[k][r] * along : 0);
    }
}

/* Acceleration of the pair's point relative to what does not move by a unit force along x, which differs
 * little from those along y and z; kg-1. */
static double mobility_of(const sf_contact_system *w, const sf_contact_pair *pair) {
    static const double unit[3] = {1, 0, 0}, back[3] = {-1, 0, 0};
    double out[3];
    scatter(w->rows, w->rows->by_mass, pair, unit, w->push);
    gather(w->rows, pair, w->push, out);
    scatter(w->rows, w->rows->by_mass, pair, back, w->push);
    return out[0];
}

void sf_contact_add(sf_contact_system *w) {
    sf_contact_pair *pair = &w->pair[w->count++];
    double own = mobility_of(w, pair);
    pair->mobility = pair->looseness = w->shift * own;
    if (pair->missile) {
        pair->mobility = w->shift * (own + sf_missile_mobility(pair->missile, pair->place, pair->normal));
        pair->looseness = w->shift * (own + sf_missile_looseness(pair->missile, pair->place));
    }
}

void sf_contact_motion(const sf_contact_system *w, const sf_contact_pair *pair, double out[3]) {
    double recoil[3];
    gather(w->rows, pair, w->push, out);
    if (pair->missile) {
        sf_missile_recoil(pair->missile, pair->place, recoil);
        for (int r = 0; r < 3; r++)
            out[r] += recoil[r];
    }
    for (int r = 0; r < 3; r++)
        out[r] = pair->step[r] + w->shift * out[r];
}

static void load(const sf_contact_system *w, const sf_contact_pair *pair, const double force[3]) {
    scatter(w->rows, w->rows->by_mass, pair, force, w->push);
    if (pair->missile)
        sf_missile_load(pair->missile, pair->place, force);
}

/* One Gauss-Seidel update of the force of a pair; returns the size of its change. */
static double relax_pair(const sf_contact_system *w, double over, const sf_contact_pair *pair) {
    const double *n = pair->normal, friction = pair->friction;
    double *q = pair->force, moved[3], next[3], change[3], largest = 0, size = 0;
    sf_contact_motion(w, pair, moved);
    double across = sf_dot3(moved, n), old = sf_dot3(q, n),
           p = fmax(0, old - over * (pair->gap + across) / pair->mobility);
    for (int r = 0; r < 3; r++) {
        next[r] =
            friction > 0 && p > 0 ? q[r] - old * n[r] - (moved[r] - across * n[r]) / pair->looseness : 0;
        size += next[r] * next[r];
    }
    double bound = size > 0 ? fmin(1, friction * p / sqrt(size)) : 0;
    for (int r = 0; r < 3; r++) {
        next[r] = p * n[r] + bound * next[r];
        change[r] = next[r] - q[r];
        q[r] = next[r];
        largest = fmax(largest, fabs(change[r]));
    }
    if (largest > 0)
        load(w, pair, change);
    return largest;
}

bool sf_contact_relax(sf_contact_system *w, const sf_contact_sweeps *sweeps) {
    double change = 0, largest = 0;
    for (int64_t a = 0; a < w->count; a++)
        load(w, &w->pair[a], w->pair[a].force);
    for (int sweep = 0; sweep < sweeps->most; sweep++) {
        change = largest = 0;
        for (int64_t a = 0; a < w->count; a++) {
            const sf_contact_pair *pair = &w->pair[sweep % 2 ? w->count - 1 - a : a];
            change = fmax(change, relax_pair(w, sweeps->over, pair));
            largest = fmax(largest, sf_dot3(pair->force, pair->normal));
        }
        if (change <= sweeps->tolerance * largest)
            return true;
    }
    return change <= sweeps->unsettled * largest;
}

void sf_contact_apply(const sf_contact_system *w, const sf_contact_pair *pair, double *force) {
    scatter(w->rows, w->rows->value, pair, pair->force, force);
}

void sf_contact_clear(sf_contact_system *w) {
    for (int64_t a = 0; a < w->count; a++)
        for (int k = 0; k < w->pair[a].parts; k++) {
            int64_t p = w->pair[a].part[k];
            for (int64_t e = w->rows->ptr[p]; e < w->rows->ptr[p + 1]; e++)
                memset(&w->push[3 * (int64_t)w->rows->node[e]], 0, 3 * sizeof *w->push);
        }
}
