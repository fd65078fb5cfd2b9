/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/pairs.h"

#include "base/mat3.h"

static const double DEEPEST = 0.1;  /* of the spacing: deeper edges lie on the far sides of a thin part */
static const double CROSSING = 0.2; /* least sine of the angle between two edges */
static const double BEYOND = 0.01;  /* of an edge: it goes on beyond its ends, so that where two edges of a
                                       notch meet both act */
static const double SLOPE = 0.01; /* least sine by which the faces at an edge fall away from the other edge */

void sf_pair_relative(const sf_contact_pair *q, const double *field, double out[3]) {
    memset(out, 0, 3 * sizeof *out);
    for (int k = 0; k < q->parts; k++) {
        const double *own = &field[3 * (int64_t)q->part[k]];
        double along = q->leans ? sf_dot3(own, q->normal) : 0;
        for (int r = 0; r < 3; r++)
            out[r] += q->share[k] * own[r] + (q->leans ? q->lean[k][r] * along : 0);
    }
}

void sf_pair_drop_traces(double weight[4]) {
    static const double TRACE = 1e-12;
    int largest = weight[1] > weight[0] ? 1 : 0;
    double rest = 1;
    for (int k = 2; k < 4; k++)
        largest = weight[k] > weight[largest] ? k : largest;
    for (int k = 1; k < 4; k++) {
        double *own = &weight[(largest + k) % 4];
        *own = fabs(*own) < TRACE ? 0 : *own;
        rest -= *own;
    }
    weight[largest] = rest;
}

static void subtract(const sf_state *s, int32_t a, int32_t b, double out[3]) {
    sf_sub3(&s->self_position[3 * (int64_t)a], &s->self_position[3 * (int64_t)b], out);
}

/* The lean of the pair's node `node`, which becomes a part if it is none yet. */
static void set_lean(sf_contact_pair *q, int32_t node, const double lean[3]) {
    int k = 0;
    while (k < q->parts && q->part[k] != node)
        k++;
    if (k == q->parts) {
        q->part[q->parts++] = node;
        q->share[k] = 0;
    }
    memcpy(q->lean[k], lean, sizeof q->lean[k]);
}

/* The lean of a node is gap times the gradient of its share, as a weight of the triangle n, less the part
 * that answers forces along the normal. */
void sf_pair_lean(const sf_state *s, const int32_t n[3], sf_contact_pair *q) {
    double side[3][3], own[3], lean[3];
    for (int k = 0; k < 3; k++)
        subtract(s, n[(k + 2) % 3], n[(k + 1) % 3], side[k]);
    sf_cross3(side[0], side[1], own);
    double square = sf_dot3(own, own), across = sf_dot3(own, q->normal);
    q->leans = true;
    memset(q->lean, 0, sizeof q->lean);
    for (int k = 0; k < 3 && square > 0; k++) {
        sf_cross3(own, side[k], lean);
        double back = sf_dot3(lean, q->normal) / across;
        for (int r = 0; r < 3; r++)
            lean[r] = q->gap / square * (lean[r] - back * own[r]);
        set_lean(q, n[k], lean);
    }
}

/* 1 or -1 if both faces at an edge fall away from the plane through it, against n or -n; 0 otherwise. */
static int falls_away(const sf_state *s, const int32_t edge[4], const double n[3]) {
    int side = 0;
    for (int k = 2; k < 4; k++) {
        double arm[3];
        subtract(s, edge[k] < 0 ? edge[2] : edge[k], edge[0], arm);
        if (edge[k] < 0)
            arm[-1 - edge[k]] *= -1;
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

bool sf_pair_cross(const double u[3], const double v[3], const double between[3], double least, double n[3],
                   double place[2]) {
    double moment[3];
    sf_cross3(u, v, n);
    double square = sf_dot3(n, n);
    if (!(square > least * least * sf_dot3(u, u) * sf_dot3(v, v)))
        return false;
    sf_cross3(between, v, moment);
    place[0] = sf_dot3(moment, n) / square;
    sf_cross3(between, u, moment);
    place[1] = sf_dot3(moment, n) / square;
    sf_unit3(n);
    return true;
}

/* The pair of two edges that cross. */
static bool meet_edge(const sf_skin *skin, const sf_state *s, int64_t one, int64_t other,
                      sf_contact_pair *out) {
    int32_t a[4], c[4];
    double u[3], v[3], between[3], n[3], place[2];
    memcpy(a, &skin->edge[4 * one], sizeof a);
    memcpy(c, &skin->edge[4 * other], sizeof c);
    subtract(s, a[1], a[0], u);
    subtract(s, c[1], c[0], v);
    straighten(skin, a, c, v);
    straighten(skin, c, a, u);
    subtract(s, c[0], a[0], between);
    if (!sf_pair_cross(u, v, between, CROSSING, n, place))
        return false;
    double at = place[0], there = place[1];
    int side = falls_away(s, c, n);
    if (fabs(at - 0.5) > 0.5 + BEYOND || fabs(there - 0.5) > 0.5 + BEYOND || side == 0 ||
        falls_away(s, a, n) != -side)
        return false;
    *out = (sf_contact_pair){.node = a[at > 0.5],
                             .facet = skin->ring[skin->ring_ptr[c[0]]],
                             .gap = -side * sf_dot3(between, n),
                             .parts = 4,
                             .part = {a[0], a[1], c[0], c[1]},
                             .share = {1 - at, at, there - 1, -there},
                             .normal = {side * n[0], side * n[1], side * n[2]}};
    return true;
}

int64_t sf_pair_edges(const sf_skin *skin, const sf_state *s, double back, sf_contact_pair *pair) {
    int64_t count = 0;
    for (int64_t e = 0; e < 2 * skin->edge_count; e++) {
        int64_t node = skin->edge[4 * (e / 2) + e % 2];
        const int32_t *near = &s->self_candidate[SF_SELF_CANDIDATES * node];
        for (int k = 0; k < 3 * SF_SELF_CANDIDATES && near[k / 3] >= 0 && count < skin->edge_count; k++) {
            sf_contact_pair q;
            double ahead[3];
            int64_t other = skin->edge_of[3 * (int64_t)near[k / 3] + k % 3];
            if (other <= e / 2 || !meet_edge(skin, s, e / 2, other, &q) || q.node != node ||
                q.gap < -DEEPEST * skin->size[node])
                continue;
            sf_pair_relative(&q, s->self_step, ahead);
            if (fmax(q.gap, -back) + sf_dot3(ahead, q.normal) < 0)
                pair[count++] = q;
        }
    }
    return count;
}
