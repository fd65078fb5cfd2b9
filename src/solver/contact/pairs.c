/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/pairs.h"

static const double EDGE_DEEPEST = 0.1; /* of the spacing: deeper edges lie on the far sides of a thin part */
static const double CROSSING = 0.2;     /* least sine of the angle between two edges */
static const double BEYOND = 0.01; /* of an edge: it goes on beyond its ends, so that where two edges of a
                                      notch meet both act */
static const double SLOPE = 0.01; /* least sine by which the faces at an edge fall away from the other edge */

static void subtract(const sf_contact_points *at, int32_t a, int32_t b, double out[3]) {
    sf_sub3(&at->position[3 * (int64_t)a], &at->position[3 * (int64_t)b], out);
}

int64_t sf_pair_last(const sf_scene *c, int64_t p) {
    const double *force = &c->at->force[3 * p];
    if (!c->response)
        return c->at->partner[p];
    return sf_dot3(force, force) == 0 ? SF_NO_PARTNER : SF_FIRST_BODY - sf_skin_body(c->skin, p);
}

/* True if a facet is the last partner or meets it: the same contact goes on. */
static bool goes_on(const sf_skin *skin, int64_t last, int64_t partner) {
    bool on = last == partner;
    for (int a = 0; a < 3 && last >= 0 && partner >= 0; a++)
        for (int b = 0; b < 3; b++)
            on = on || skin->facet[3 * last + a] == skin->facet[3 * partner + b];
    return on;
}

/* A search for the partner of a point. */
typedef struct search {
    const sf_scene *scene;
    int64_t point, last; /* and its partner in the last step */
    double nearest;      /* m, distance of the pair that is the nearest so far */
    double back;         /* m, part of its gap that the step takes back */
    sf_contact_pair *out, *passed;
} search;

/* Takes the pair with a partner if it closes in the step and is nearer than those before. */
static void try_partner(search *t, const sf_shape *shape, int64_t partner) {
    const sf_scene *c = t->scene;
    sf_contact_pair q;
    q.node = t->point;
    q.facet = partner;
    q.leans = false;
    q.missile = NULL;
    if (!shape->meet(c, t->point, partner, &q) || fabs(q.gap) >= t->nearest)
        return;
    bool on = goes_on(c->skin, t->last, partner);
    double deepest = (on ? shape->deepest : shape->entry) * c->skin->size[t->point];
    q.depth = q.missile ? q.depth : -q.gap;
    if (on && q.depth > deepest && q.depth < 2 * deepest)
        *t->passed = q;
    if (q.depth > deepest)
        return;
    if (partner < 0) {
        memset(q.weight, 0, sizeof q.weight);
        sf_pair_list_parts(c->skin, &q);
    }
    if (!q.missile)
        sf_pair_relative(&q, c->at->step, q.step);
    bool slowly = !c->response && sf_pair_acts(c, &q); /* missile and resting base take back all of it */
    double back = slowly ? fmax(q.gap, -shape->back * c->state->dt) : q.gap;
    if (back + sf_dot3(q.step, q.normal) >= 0)
        return;
    t->nearest = fabs(q.gap);
    t->back = back;
    *t->out = q;
}

/* Completes a pair that is taken, of whose gap the step takes `back` (m); corner: nodes for its leans, or
 * NULL. */
static void complete(const sf_scene *c, double back, const int32_t *corner, sf_contact_pair *q) {
    q->friction = sf_pair_friction(c, q);
    if (q->friction > 0 && corner) {
        sf_pair_lean(c, corner, q);
        sf_pair_relative(q, c->at->step, q->step);
    }
    q->gap = back;
}

bool sf_pair_find(const sf_scene *c, int64_t p, sf_contact_pair *out, sf_contact_pair *passed) {
    const sf_skin *skin = c->skin;
    const sf_body *body = c->body;
    search t = {.scene = c,
                .point = p,
                .last = sf_pair_last(c, p),
                .nearest = INFINITY,
                .out = out,
                .passed = passed};
    passed->node = -1;
    if (c->response) {
        int own = sf_skin_body(skin, p);
        try_partner(&t, own == SF_BODY_MISSILE ? body[own].shape : &sf_shape_plane, SF_FIRST_BODY - own);
    } else {
        const int32_t *facet = &c->at->candidate[SF_SELF_CANDIDATES * p];
        for (int k = 0; k < SF_SELF_CANDIDATES && facet[k] != SF_NO_PARTNER; k++)
            try_partner(&t, &sf_shape_face, facet[k]);
        for (int k = 0; k < SF_BODY_MISSILE; k++)
            if (body[k].shape && sf_skin_is_stopped(skin, p, k))
                try_partner(&t, body[k].shape, SF_FIRST_BODY - k);
    }
    if (!(t.nearest < INFINITY))
        return false;
    passed->node = -1;
    out->body = sf_pair_body(c, p, out->facet);
    complete(c, t.back, out->body == SF_BODY_PAD ? &skin->facet[3 * out->facet] : NULL, out);
    return true;
}

/* ---- edges of the pad ---- */

/* 1 or -1 if both faces at an edge fall away from the plane through it, against n or -n; 0 otherwise. */
static int falls_away(const sf_contact_points *at, const int32_t edge[4], const double n[3]) {
    int side = 0;
    for (int k = 2; k < 4; k++) {
        double arm[3];
        sf_skin_third(at->position, edge, k, arm);
        double slope = sf_dot3(arm, n), least = SLOPE * sqrt(sf_dot3(arm, arm));
        side += slope < -least ? 1 : slope > least ? -1 : 0;
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
        edge[1] = edge[first];
        edge[0] = begin;
        for (int k = 0; k < 3; k++)
            along[k] *= k != r ? 0 : first ? 1 : -1;
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
                             .parts = 4,
                             .part = {a[0], a[1], b[0], b[1]},
                             .share = {1 - at, at, there - 1, -there},
                             .normal = {side * n[0], side * n[1], side * n[2]}};
    return true;
}

/* Adds the pairs of sharp edge `one` with those at the candidates of its node `node`. */
static int64_t add_edges(const sf_scene *c, int64_t one, int64_t node, sf_contact_pair *pair, int64_t count) {
    const sf_skin *skin = c->skin;
    const int32_t *near = &c->at->candidate[SF_SELF_CANDIDATES * node];
    for (int k = 0; k < 3 * SF_SELF_CANDIDATES && near[k / 3] >= 0 && count < skin->sharp_count; k++) {
        sf_contact_pair *q = &pair[count];
        int64_t other = skin->line_of[3 * (int64_t)near[k / 3] + k % 3];
        if (other <= one || !skin->is_sharp[other] || !meet_edge(c, one, other, q) || q->node != node ||
            q->gap < -EDGE_DEEPEST * skin->size[node])
            continue;
        q->depth = -q->gap;
        sf_pair_relative(q, c->at->step, q->step);
        const int32_t corner[3] = {q->part[0], q->part[1], q->part[q->share[3] < -0.5 ? 2 : 3]};
        double gap = fmax(q->gap, -sf_shape_face.back * c->state->dt);
        if (gap + sf_dot3(q->step, q->normal) >= 0)
            continue;
        complete(c, gap, corner, q);
        count++;
    }
    return count;
}

int64_t sf_pair_edges(const sf_scene *c, sf_contact_pair *pair) {
    const sf_skin *skin = c->skin;
    int64_t count = 0;
    for (int64_t e = 0; e < skin->line_count && skin->sharp_count > 0; e++) {
        int32_t a = skin->line[4 * e], b = skin->line[4 * e + 1];
        if (!skin->is_sharp[e])
            continue;
        count = add_edges(c, e, a < b ? a : b, pair, count);
        count = add_edges(c, e, a < b ? b : a, pair, count);
    }
    return count;
}
