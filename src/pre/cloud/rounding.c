/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/rounding.h"

#include "core/mat3.h"
#include "core/packed_gradient.h"
#include <stdbool.h>
#include <stdlib.h>

/* The last number of the takers shares bits with the first one behind them, an x: once the takers are
 * corrected in x, y and z, that may change, and x is corrected again. More passes are for the rare carry. */
enum { PASSES = 4 };

/* Of V^(2/3): losses below this do not count, and numbers go to their nearest. With it B depends little on
 * the last bits of the geometry, as one choice seldom reaches the next. */
static const double SMALL_LOSS = 3e-12;

typedef struct row {
    int64_t count;
    const int32_t *node; /* [count] */
    double volume;       /* m3 */
    double small_loss;   /* m2 */
    double *b;           /* [count][3] m-1, rounded in place */
    const double *position;
    double dual[3][3]; /* m-1, of the edges from the first taker to the others */
    int32_t *order;    /* [count] as packed */
    uint8_t *bytes;    /* packed */
} row;

/* What follows from a change at one entry: the entry itself, then the takers. */
typedef struct effect {
    int64_t node[1 + SF_TAKERS];
    double share[1 + SF_TAKERS];
} effect;

static bool is_negligible(double x) {
    return fabs(x) < 2 * SF_PACKED_LEAST;
}

/* From the first taker to entry k, m. */
static void find_arm(const row *r, int64_t k, double arm[3]) {
    for (int a = 0; a < 3; a++)
        arm[a] =
            r->position[3 * (int64_t)r->node[k] + a] - r->position[3 * (int64_t)r->node[r->order[0]] + a];
}

static void find_dual(row *r) {
    double edge[3][3];
    for (int t = 0; t < 3; t++)
        find_arm(r, r->order[t + 1], edge[t]);
    for (int t = 0; t < 3; t++)
        sf_cross3(edge[(t + 1) % 3], edge[(t + 2) % 3], r->dual[t]);
    double volume = sf_dot3(edge[0], r->dual[0]);
    for (int k = 0; k < 9; k++)
        r->dual[k / 3][k % 3] /= volume;
}

/* Changes of the takers that undo `sum` of B and `moment` of (X - X of the first) B, of one component. */
static void undo(const row *r, double sum, const double moment[3], double change[SF_TAKERS]) {
    change[0] = -sum;
    for (int t = 1; t < SF_TAKERS; t++) {
        change[t] = -sf_dot3(moment, r->dual[t - 1]);
        change[0] -= change[t];
    }
}

static void find_effect(const row *r, int64_t k, effect *e) {
    double arm[3];
    find_arm(r, k, arm);
    e->node[0] = r->node[k];
    e->share[0] = 1;
    undo(r, 1, arm, &e->share[1]);
    for (int t = 0; t < SF_TAKERS; t++)
        e->node[t + 1] = r->node[r->order[t]];
}

/* x up or down, whichever leaves the smaller sum of lost^2, small ones aside; `lost` [n] with stride 3. */
static double round_number(double x, const uint8_t *number, const row *r, const effect *e, double *lost) {
    double pair[2], slope = 0, curvature = 0;
    sf_packed_neighbours(x, number, pair);
    for (int t = 0; t <= SF_TAKERS; t++) {
        double loss = lost[3 * e->node[t]];
        if (fabs(loss) > r->small_loss)
            slope += e->share[t] * loss;
        curvature += e->share[t] * e->share[t] * r->volume;
    }
    double middle = 0.5 * ((pair[0] - x) + (pair[1] - x));
    double rounded = (slope + curvature * middle) * (pair[1] - pair[0]) > 0 ? pair[0] : pair[1];
    for (int t = 0; t <= SF_TAKERS; t++)
        lost[3 * e->node[t]] += e->share[t] * r->volume * (rounded - x);
    return rounded;
}

/* Packs the row with all but the takers rounded. */
static void round_others(const row *r, double *lost) {
    sf_pack_row(SF_TAKERS, r->order, r->b, r->bytes);
    for (int64_t p = SF_TAKERS; p < r->count; p++) {
        effect e;
        find_effect(r, r->order[p], &e);
        for (int c = 0; c < 3; c++) {
            double *x = &r->b[3 * r->order[p] + c];
            uint8_t *number = &r->bytes[sf_packed_place(p, c)];
            if (!is_negligible(*x))
                *x = round_number(*x, number, r, &e, &lost[c]);
            sf_packed_put(*x, number);
        }
    }
}

static void correct_takers(const row *r, int c) {
    double sum = 0, moment[3] = {0}, arm[3], change[SF_TAKERS];
    moment[c] = -1;
    for (int64_t k = 0; k < r->count; k++) {
        find_arm(r, k, arm);
        sum += r->b[3 * k + c];
        for (int a = 0; a < 3; a++)
            moment[a] += arm[a] * r->b[3 * k + c];
    }
    undo(r, sum, moment, change);
    for (int t = 0; t < SF_TAKERS; t++)
        r->b[3 * r->order[t] + c] += change[t];
}

/* Packs the row and takes what is packed of it; tells which components that changes. */
static void pack(const row *r, bool changed[3]) {
    sf_pack_row(r->count, r->order, r->b, r->bytes);
    for (int c = 0; c < 3; c++) {
        changed[c] = false;
        for (int64_t p = SF_TAKERS; p < r->count; p++) {
            double *x = &r->b[3 * r->order[p] + c];
            double packed = sf_packed_number(&r->bytes[sf_packed_place(p, c)]);
            if (is_negligible(*x) || *x == packed)
                continue;
            *x = packed;
            changed[c] = true;
        }
    }
}

/* `lost` [n][3], m2: sum of V (rounded - exact) over the rows so far. */
static void round_row(row *r, double *lost) {
    bool changed[3] = {true, true, true};
    find_dual(r);
    round_others(r, lost);
    for (int pass = 0; pass < PASSES && (changed[0] || changed[1] || changed[2]); pass++) {
        for (int c = 0; c < 3; c++)
            if (changed[c])
                correct_takers(r, c);
        pack(r, changed);
    }
}

sf_status sf_domains_round(const sf_mesh *mesh, sf_domains *d, sf_error *err) {
    int64_t n = mesh->node_count, most = 0;
    for (int64_t i = 0; i < n; i++)
        most = d->ptr[i + 1] - d->ptr[i] > most ? d->ptr[i + 1] - d->ptr[i] : most;
    row r = {.position = mesh->position,
             .order = sf_alloc(err, (unsigned long)most, sizeof *r.order, "rounding"),
             .bytes = sf_alloc(err, (unsigned long)sf_packed_start(1, most), 1, "rounding")};
    double *lost = sf_alloc(err, 3 * (unsigned long)n, sizeof *lost, "rounding");
    for (int64_t i = 0; i < n && err->status == SF_OK; i++) {
        r.count = d->ptr[i + 1] - d->ptr[i];
        r.node = &d->node[d->ptr[i]];
        r.b = &d->b[3 * d->ptr[i]];
        r.volume = d->volume[i];
        r.small_loss = SMALL_LOSS * cbrt(r.volume * r.volume);
        sf_packed_order(mesh->position, r.node, r.count, (int32_t)i, r.order);
        if (r.count > SF_TAKERS)
            round_row(&r, lost);
    }
    free(r.order);
    free(r.bytes);
    free(lost);
    return err->status;
}
