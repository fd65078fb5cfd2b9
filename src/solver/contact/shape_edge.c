/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape_edge.h"

#include "solver/contact/solve.h"

static const double CROSSING = 0.2; /* least sine of the angle between two edges */
static const double BEYOND = 0.01;  /* of an edge: it goes on beyond its ends, so that where two edges of a
                                       notch meet both act */
static const double SLOPE = 0.01; /* least sine by which the faces at an edge fall away from the other edge */

static void subtract(const sf_contact_points *at, int32_t a, int32_t b, double out[3]) {
    sf_sub3(&at->position[3 * (int64_t)a], &at->position[3 * (int64_t)b], out);
}

/* 1 or -1 if both faces at an edge fall away from the plane through it, against n or -n; 0 otherwise. */
static int falls_away(const sf_contact_points *at, const int32_t edge[4], const double n[3]) {
    int side = 0;
    for (int k = 2; k < 4; k++) {
        double arm[3];
        sf_skin_third(at->position, edge, k, arm);
        double slope = sf_dot3(arm, n), least = SLOPE * sqrt(sf_dot3(arm, arm));
        side += (slope < -least) - (slope > least);
    }
    return side / 2;
}

/* An edge that leaves a symmetry plane in which the other lies goes on as its mirror image: there it is along
 * the normal of the plane, and begins in it. */
static void straighten(const sf_skin *skin, const int32_t in[4], int32_t edge[4], double along[3]) {
    for (int r = 0; r < 2; r++) {
        bool there = (skin->held[in[0]] & skin->held[in[1]]) >> r & 1, first = skin->held[edge[0]] >> r & 1;
        if (!there || !(first || skin->held[edge[1]] >> r & 1))
            continue;
        int32_t begin = edge[!first];
        int sense = first ? 1 : -1;
        edge[1] = edge[first];
        edge[0] = begin;
        for (int k = 0; k < 3; k++)
            along[k] *= k == r ? sense : 0;
    }
}

/* The nodes of an edge, the lower number first, and its direction. */
static void take_edge(const sf_scene *c, int64_t line, int32_t edge[4], double along[3]) {
    const int32_t *from = &c->skin->line[4 * line];
    bool rises = from[0] < from[1];
    edge[0] = from[!rises];
    edge[1] = from[rises];
    memcpy(&edge[2], &from[2], 2 * sizeof *edge);
    subtract(c->at, edge[1], edge[0], along);
}

/* The pair of two edges that cross. */
static bool meet_edge(const sf_scene *c, int64_t one, int64_t other, sf_contact_pair *out) {
    const sf_skin *skin = c->skin;
    int32_t a[4], b[4];
    double u[3], v[3], between[3], n[3], place[2];
    take_edge(c, one, a, u);
    take_edge(c, other, b, v);
    straighten(skin, a, b, v);
    straighten(skin, b, a, u);
    subtract(c->at, b[0], a[0], between);
    if (!sf_pair_cross(u, v, between, CROSSING, n, place))
        return false;
    double at = place[0], there = place[1];
    int side = falls_away(c->at, b, n);
    if (fabs(at - 0.5) > 0.5 + BEYOND || fabs(there - 0.5) > 0.5 + BEYOND || side == 0 ||
        falls_away(c->at, a, n) != -side)
        return false;
    *out = (sf_contact_pair){.node = a[at > 0.5],
                             .facet = skin->ring[skin->ring_ptr[b[0]]],
                             .body = SF_BODY_PAD,
                             .gap = -side * sf_dot3(between, n),
                             .depth = side * sf_dot3(between, n),
                             .parts = 4,
                             .part = {a[0], a[1], b[0], b[1]},
                             .share = {1 - at, at, there - 1, -there},
                             .normal = {side * n[0], side * n[1], side * n[2]}};
    return true;
}

/* Adds the pairs of sharp edge `one` with those at the candidates of its node `node`; `force` is room for
 * those of all edges, whose pairs begin at `first`. */
static void add_at(const sf_scene *c, int64_t one, int64_t node, double (*force)[3], int64_t first,
                   sf_contact_system *w) {
    const sf_skin *skin = c->skin;
    const int32_t *near = &c->at->candidate[SF_SELF_CANDIDATES * node];
    for (int k = 0; k < 3 * SF_SELF_CANDIDATES && near[k / 3] >= 0 && w->count - first < skin->sharp_count;
         k++) {
        sf_contact_pair *q = &w->pair[w->count];
        int64_t other = skin->line_of[3 * (int64_t)near[k / 3] + k % 3];
        if (other <= one || other >= skin->sharp_count || !meet_edge(c, one, other, q) || q->node != node ||
            q->depth > sf_shape_limit(&sf_shape_edge, false, skin->size[node]))
            continue;
        sf_pair_relative(q, c->at->step, q->step);
        if (!sf_pair_closes(q, sf_shape_edge.back * c->state->dt))
            continue;
        sf_pair_rub(c, (const int32_t[3]){q->part[0], q->part[1], q->part[q->share[3] < -0.5 ? 2 : 3]}, q);
        q->force = memset(force[w->count - first], 0, sizeof *force);
        sf_contact_add(w);
    }
}

static int64_t most(const sf_scene *c) {
    return c->skin->sharp_count;
}

static sf_status add(const sf_scene *c, sf_contact_system *w, sf_error *err) {
    const sf_skin *skin = c->skin;
    int64_t first = w->count;
    double(*force)[3] =
        sf_workspace_take(&c->at->work.edge_force, skin->sharp_count, sizeof *force, "edges in contact", err);
    SF_TRY(err->status);
    for (int64_t e = 0; e < skin->sharp_count; e++) {
        int32_t a = skin->line[4 * e], b = skin->line[4 * e + 1];
        add_at(c, e, a < b ? a : b, force, first, w);
        add_at(c, e, a < b ? b : a, force, first, w);
    }
    return SF_OK;
}

const sf_shape sf_shape_edge = {.add = add, .most = most, .entry = 0.1, .back = 0.1};
