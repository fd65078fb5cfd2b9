/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/self_contact.h"

#include "base/mat3.h"
#include "solver/contact/candidates.h"
#include "solver/contact/ledger.h"
#include "solver/contact/solve.h"

enum { NOTHING = SF_SKIN_NOTHING, FIRST_PLANE = SF_SKIN_FIRST_PLANE };
/* The sweeps of a step at most, and those where centroids take part: rows that depend on those of nodes. */
enum { CANDIDATES = SF_SELF_CANDIDATES, MAX_SWEEPS = 1000, CENTROID_SWEEPS = 240 };
static const double OVER = 1.6;     /* over-relaxation of the latter */
static const double DEEPEST = 0.5;  /* of the spacing: no deeper does it go on */
static const double RETURN = 0.1;   /* m s-1: no faster is a depth taken back */
static const double OPPOSED = -0.5; /* largest cosine of the normals of a node and the face that it touches */
static const double EDGE = 0.05;    /* of a face, in its barycentric coordinates: it reaches so far beyond */
/* Largest change of a force, relative to the largest force, at which the sweeps end, and beyond which it is
 * told that they did not settle. */
static const double SWEEP_TOLERANCE = 1e-5, UNSETTLED = 1e-3;

/* ---- positions ---- */

/* Position, motion in the last step, and motion in the next one without these forces, of the nodes listed. */
static void move_nodes(const sf_model *m, const sf_skin *skin, sf_state *s, double dt_v, int64_t count,
                       const int32_t *list) {
#pragma omp parallel for if (count > SF_FEW_POINTS) default(none) shared(m, skin, s, dt_v, count, list)      \
    schedule(static)
    for (int64_t k = 0; k < count; k++) {
        int64_t p = list[k];
        double now[3] = {0}, last[3] = {0}, change[3] = {0};
        int members = sf_skin_members(skin, p);
        for (int of = 0; of < members; of++) {
            int64_t node = sf_skin_member(skin, p, of);
            for (int64_t e = skin->rows.ptr[node]; e < skin->rows.ptr[node + 1]; e++) {
                int64_t i = skin->rows.node[e];
                double phi = skin->rows.value[e] / members, inverse = phi * dt_v / m->mass[i];
                for (int r = 0; r < 3; r++) {
                    now[r] += phi * s->d[3 * i + r];
                    last[r] += phi * s->v[3 * i + r];
                    change[r] += inverse * (s->force[3 * i + r] - s->reaction[3 * i + r]) +
                                 phi * dt_v * s->contact_push[3 * i + r];
                }
            }
        }
        for (int r = 0; r < 3; r++) {
            s->self_position[3 * p + r] = skin->rest[3 * p + r] + now[r];
            s->self_motion[3 * p + r] = s->dt_old * last[r];
            s->self_step[3 * p + r] = s->dt * (last[r] + change[r]);
        }
    }
}

static void facet_normal(const sf_skin *skin, const sf_state *s, int64_t f, double normal[3]) {
    const int32_t *n = &skin->facet[3 * f];
    sf_triangle_normal(&s->self_position[3 * (int64_t)n[0]], &s->self_position[3 * (int64_t)n[1]],
                       &s->self_position[3 * (int64_t)n[2]], normal);
}

/* ---- gaps ---- */

static double *side_normal(const sf_skin *skin, const sf_state *s, int64_t f, int corner) {
    return &s->self_normal[3 * (int64_t)skin->side[3 * f + corner]];
}

/* Outward normals of the sides of the points that may touch, weighted by the areas of their facets; of a
 * centroid the mean of its nodes', which come before it. */
static void find_normals(const sf_skin *skin, sf_state *s) {
    for (int64_t k = 0; k < s->self_close_count; k++) {
        int64_t p = s->self_close[k];
        for (int64_t side = p; side >= 0; side = skin->next_side[side])
            memset(&s->self_normal[3 * side], 0, 3 * sizeof *s->self_normal);
        for (int64_t e = skin->ring_ptr[p]; e < skin->ring_ptr[p + 1]; e++) {
            int64_t f = skin->ring[e];
            double one[3];
            facet_normal(skin, s, f, one);
            for (int c = 0; c < 3; c++) {
                bool node = p < skin->nodes;
                double *of = side_normal(skin, s, f, c), *sum = node ? of : &s->self_normal[3 * p];
                for (int r = 0; r < 3 && (!node || skin->facet[3 * f + c] == p); r++)
                    sum[r] += node ? one[r] : of[r];
            }
        }
        for (int64_t side = p; side >= 0; side = skin->next_side[side]) {
            for (int r = 0; r < 3; r++) /* the other half lies beyond a symmetry plane */
                s->self_normal[3 * side + r] *= !((skin->held[p] >> r) & 1);
            sf_unit3(&s->self_normal[3 * side]);
        }
    }
}

/* The normal of point p as seen from a facet of the unit normal `facing`: that of its only side, or the mean
 * of its sides, each by how far it looks against the facet. False if none does. */
static bool normal_against(const sf_skin *skin, const sf_state *s, int64_t p, const double facing[3],
                           double out[3]) {
    memset(out, 0, 3 * sizeof *out);
    for (int64_t side = p; side >= 0; side = skin->next_side[side]) {
        const double *normal = &s->self_normal[3 * side];
        double against = OPPOSED - sf_dot3(normal, facing);
        for (int r = 0; r < 3 && against > 0; r++)
            out[r] += skin->next_side[p] < 0 ? normal[r] : against * normal[r];
    }
    if (skin->next_side[p] >= 0)
        sf_unit3(out);
    return sf_dot3(out, out) > 0;
}

/* The weights of a triangle's nodes `n` at a point of its plane, with its own `normal` of twice its area. */
static void weigh_point(const sf_state *s, const int32_t n[3], const double point[3], const double normal[3],
                        double weight[3]) {
    const double *x[3];
    sf_corners(s->self_position, n, x);
    sf_triangle_weights(x, point, normal, weight);
}

/* Takes the mean of both ways to cut a quadrangle into halves, of gap and weights. One way alone passes no
 * uniform pressure on between faces that do not match: no forces that press are in equilibrium with it. */
static void take_both_diagonals(const sf_skin *skin, const sf_state *s, sf_contact_pair *q) {
    int tip = skin->half[q->facet], next = (tip + 1) % 3, last = (tip + 2) % 3;
    const int32_t *n = &skin->facet[3 * q->facet];
    const double *x = &s->self_position[3 * q->node], *a = &s->self_position[3 * (int64_t)n[tip]];
    int32_t fourth = (int32_t)sf_skin_corner(skin, q->facet, 3);
    for (int side = 0; side < 2; side++) {
        const int32_t half[3] = {n[tip], side ? fourth : n[next], side ? n[last] : fourth};
        double own[3], point[3], weight[3], gap = 0;
        sf_triangle_normal(a, &s->self_position[3 * (int64_t)half[1]],
                           &s->self_position[3 * (int64_t)half[2]], own);
        double across = sf_dot3(q->normal, own);
        if (!(across > 0.5 * sqrt(sf_dot3(own, own)))) /* as in meet_facet */
            return;
        for (int r = 0; r < 3; r++)
            gap += (x[r] - a[r]) * own[r] / across;
        for (int r = 0; r < 3; r++)
            point[r] = x[r] - gap * q->normal[r];
        weigh_point(s, half, point, own, weight);
        if (side == 0 && weight[1] < 0)
            continue;
        for (int k = 0; k < 3; k++)
            q->weight[k] *= 0.5;
        q->weight[tip] += 0.5 * weight[0];
        q->weight[side ? 3 : next] += 0.5 * weight[1];
        q->weight[side ? last : 3] += 0.5 * weight[2];
        q->gap = 0.5 * (q->gap + gap);
        return;
    }
}

/* Lists the nodes of a pair and their shares. */
static void list_parts(const sf_skin *skin, sf_contact_pair *q) {
    int members = sf_skin_members(skin, q->node), corners = sf_skin_corners(skin, q->facet);
    q->parts = 0;
    for (int k = 0; k < members + corners; k++) {
        double share = k < members ? 1.0 / members : -q->weight[k - members];
        q->part[q->parts] = (int32_t)(k < members ? sf_skin_member(skin, q->node, k)
                                                  : sf_skin_corner(skin, q->facet, k - members));
        q->share[q->parts] = share;
        q->parts += share != 0;
    }
}

/* True if a centroid lies on that of a triangle: the nodes of the two carry its part. */
static bool matches(const sf_skin *skin, const sf_contact_pair *q) {
    static const double SLIGHTLY = 0.01;
    double off = fmax(fabs(q->weight[0] - 1.0 / 3), fabs(q->weight[1] - 1.0 / 3));
    return !skin->half[q->facet] && off < SLIGHTLY;
}

/* The pair of node and facet, if the node lies before or behind the facet and its own surface looks against
 * it. The normal is the mean of both surfaces: smooth over the facets, and the same seen from either side,
 * where facets that are tilted against each other would interlock; of a rigid facet it is that of the
 * support, and for a node of an edge, which has no normal of its own, that of the facet. The gap is along it,
 * so that the forces on node and facet lie on one line. */
static bool meet_facet(const sf_skin *skin, const sf_state *s, int64_t p, int64_t f, sf_contact_pair *out) {
    const int32_t *n = &skin->facet[3 * f];
    const double *x = &s->self_position[3 * p], *a = &s->self_position[3 * (int64_t)n[0]];
    double own[3], facing[3], against[3], arm[3], point[3];
    facet_normal(skin, s, f, own);
    double area = sqrt(sf_dot3(own, own));
    bool alone = skin->next_side[p] >= 0 || sf_skin_is_rigid(skin, p) || sf_skin_is_rigid(skin, n[0]);
    out->node = p;
    out->facet = f;
    out->weight[3] = 0;
    out->leans = false;
    out->missile = NULL;
    for (int r = 0; r < 3; r++)
        facing[r] = own[r] / area;
    if (!(area > 0) || !normal_against(skin, s, p, facing, against))
        return false;
    weigh_point(s, n, x, own, out->weight);
    for (int k = 0; k < 3; k++)
        if (out->weight[k] < -EDGE)
            return false;
    for (int r = 0; r < 3; r++) {
        arm[r] = x[r] - a[r];
        out->normal[r] = alone ? 0 : -against[r];
        for (int k = 0; k < 3; k++)
            out->normal[r] += out->weight[k] * side_normal(skin, s, f, k)[r];
    }
    for (int r = 0; r < 3; r++)
        out->normal[r] *= !((skin->held[p] >> r) & 1);
    sf_unit3(out->normal);
    double across = sf_dot3(out->normal, own);
    if (!(across > 0.5 * area))
        return false;
    out->gap = sf_dot3(arm, own) / across;
    for (int r = 0; r < 3; r++)
        point[r] = x[r] - out->gap * out->normal[r];
    weigh_point(s, n, point, own, out->weight);
    if (skin->half[f])
        take_both_diagonals(skin, s, out);
    sf_pair_drop_traces(out->weight);
    list_parts(skin, out);
    return p < skin->nodes || !matches(skin, out);
}

/* True if facet f is the last partner or meets it: the same contact goes on. */
static bool goes_on(const sf_skin *skin, int64_t last, int64_t f) {
    for (int a = 0; a < 3 && last >= 0; a++)
        for (int b = 0; b < 3; b++)
            if (skin->facet[3 * last + a] == skin->facet[3 * f + b])
                return true;
    return false;
}

/* False for a pair of the pad with itself that is only watched. */
static bool acts(const sf_skin *skin, int64_t p, int64_t f) {
    return !skin->watched || f < 0 || sf_skin_is_rigid(skin, p) || sf_skin_is_rigid(skin, skin->facet[3 * f]);
}

/* The partner that node p touches at the end of the step: of those that it may touch, the nearest. Without
 * one, `passed`: the pair that the node was in, if it has become deeper than DEEPEST; its node is -1
 * otherwise. */
static bool find_partner(const sf_skin *skin, const sf_state *s, int64_t p, sf_contact_pair *out,
                         sf_contact_pair *passed) {
    const int32_t *own = &s->self_candidate[CANDIDATES * p];
    double spacing = skin->size[p], best = INFINITY, back = -RETURN * s->dt, ahead[3];
    for (int k = 0; k < CANDIDATES && own[k] != NOTHING; k++) {
        sf_contact_pair q;
        bool on = goes_on(skin, s->self_partner[p], own[k]);
        double deepest = on ? DEEPEST : SF_CONTACT_ENTRY;
        if (!meet_facet(skin, s, p, own[k], &q) || fabs(q.gap) >= best)
            continue;
        if (on && q.gap < -deepest * spacing && q.gap > -2 * deepest * spacing)
            *passed = q;
        if (q.gap < -deepest * spacing)
            continue;
        sf_pair_relative(&q, s->self_step, ahead);
        if ((acts(skin, p, own[k]) ? fmax(q.gap, back) : q.gap) + sf_dot3(ahead, q.normal) >= 0)
            continue;
        best = fabs(q.gap);
        *out = q;
    }
    for (int k = 0; k < SF_SKIN_PLANES; k++) {
        if (!sf_skin_is_stopped(skin, p, k))
            continue;
        const sf_skin_plane *plane = &skin->plane[k];
        double height = sf_skin_height(skin, &s->self_position[3 * p], k);
        if (height + plane->side * s->self_step[3 * p + plane->axis] >= 0 || fabs(height) >= best)
            continue;
        *out = (sf_contact_pair){.node = p, .facet = FIRST_PLANE - k, .gap = height};
        out->normal[plane->axis] = plane->side;
        list_parts(skin, out);
        best = fabs(height);
    }
    if (best < INFINITY)
        passed->node = -1;
    return best < INFINITY;
}

/* ---- forces ---- */

/* Leans of a pair with friction; what is rigid takes any moment up. */
static void lean(const sf_skin *skin, const sf_state *s, sf_contact_pair *q) {
    if (q->facet >= 0 && q->friction > 0 && !sf_skin_is_rigid(skin, q->node) &&
        !sf_skin_is_rigid(skin, skin->facet[3 * q->facet]))
        sf_pair_lean(s, &skin->facet[3 * q->facet], q);
}

/* Books half of the work of the force on a pair over `motion` (m), that of the last or of the next step. */
static void book(sf_state *s, const sf_contact_pair *pair, const double motion[3]) {
    const double *q = pair->force, half[3] = {0.5 * q[0], 0.5 * q[1], 0.5 * q[2]};
    sf_ledger_book(s, pair->facet == FIRST_PLANE - SF_SKIN_ANVIL, half, motion,
                   pair->friction > 0 ? pair->normal : NULL);
}

/* The Coulomb coefficient of a pair; the mirror image moves along a symmetry plane as the pad does. */
static double friction_of(const sf_model *m, const sf_skin *skin, int64_t p, int64_t f) {
    if (f < FIRST_PLANE - SF_SKIN_ANVIL)
        return 0;
    int support = sf_skin_support(m, skin, p, f);
    if (support >= 0)
        return m->support_friction[support];
    for (int64_t k = 0; k < m->pair_count && f >= 0; k++) {
        const uint8_t *layer = &m->pair_layer[2 * k];
        int own = m->node_material[skin->node[sf_skin_member(skin, p, 0)]],
            other = m->node_material[skin->node[skin->facet[3 * f]]];
        if ((own < other ? own : other) == layer[0] && (own < other ? other : own) == layer[1])
            return m->pair_friction[k];
    }
    return m->skin_friction;
}

/* The pair of node p in the last step; normal and lean are those of the present: the work that they tell of
 * the last forces has an error of the order of their change. */
static sf_contact_pair last_pair(const sf_model *m, const sf_skin *skin, sf_state *s, int64_t p) {
    sf_contact_pair q = {.node = p, .facet = s->self_partner[p], .force = &s->self_force[3 * p]};
    q.friction = friction_of(m, skin, p, q.facet);
    memcpy(q.weight, &s->self_weight[4 * p], sizeof q.weight);
    list_parts(skin, &q);
    if (q.facet < 0) {
        q.normal[skin->plane[FIRST_PLANE - q.facet].axis] = 1;
    } else {
        facet_normal(skin, s, q.facet, q.normal);
        double apart[3];
        sf_unit3(q.normal);
        sf_pair_relative(&q, s->self_position, apart);
        q.gap = sf_dot3(apart, q.normal);
        lean(skin, s, &q);
    }
    return q;
}

/* Makes the next pair of the system one that acts. */
static void add_pair(sf_state *s, sf_contact_system *w) {
    sf_contact_pair *pair = &w->pair[w->count];
    s->self_penetration = fmax(s->self_penetration, -pair->gap);
    pair->gap = fmax(pair->gap, -RETURN * s->dt);
    sf_pair_relative(pair, s->self_step, pair->step);
    sf_contact_add(w);
}

/* Books the last step's pairs, finds those of this step, and carries their forces over. `passed`: a pair
 * whose node has passed through the facet; its node stays -1 if there is none. */
static void find_pairs(const sf_model *m, const sf_skin *skin, sf_state *s, sf_contact_system *w,
                       sf_contact_pair *passed) {
    s->self_penetration = 0;
    for (int64_t k = 0; k < s->self_close_count; k++) {
        int64_t p = s->self_close[k];
        double *q = &s->self_force[3 * p], motion[3];
        if (s->self_partner[p] != NOTHING) {
            const sf_contact_pair last = last_pair(m, skin, s, p);
            sf_pair_relative(&last, s->self_motion, motion);
            book(s, &last, motion);
        }
        sf_contact_pair *found = &w->pair[w->count];
        double old = sqrt(sf_dot3(q, q));
        sf_contact_pair gone = {.node = -1};
        bool touches = find_partner(skin, s, p, found, &gone);
        if (gone.node >= 0)
            *passed = gone;
        if (!touches) {
            s->self_partner[p] = NOTHING;
            memset(q, 0, 3 * sizeof *q);
            continue;
        }
        found->friction = friction_of(m, skin, p, found->facet);
        found->force = q;
        if (s->self_partner[p] != found->facet && found->friction == 0)
            for (int r = 0; r < 3; r++)
                q[r] = old * found->normal[r];
        s->self_partner[p] = (int32_t)found->facet;
        memcpy(&s->self_weight[4 * p], found->weight, sizeof found->weight);
        if (!acts(skin, p, found->facet))
            continue;
        lean(skin, s, found);
        add_pair(s, w);
        if (p >= skin->nodes) {
            w->over = OVER;
            w->sweeps = CENTROID_SWEEPS;
        }
    }
}

/* Adds the pairs of edges, whose forces begin at zero. */
static void find_edges(const sf_model *m, const sf_skin *skin, sf_state *s, double (*force)[3],
                       sf_contact_system *w) {
    int64_t count = sf_pair_edges(skin, s, RETURN * s->dt, &w->pair[w->count]);
    for (int64_t k = 0; k < count; k++) {
        sf_contact_pair *q = &w->pair[w->count];
        q->friction = friction_of(m, skin, q->node, q->facet);
        q->force = force[k];
        memset(q->force, 0, 3 * sizeof *q->force);
        const int32_t corner[3] = {q->part[0], q->part[1], q->part[q->share[3] < -0.5 ? 2 : 3]};
        if (q->friction > 0)
            sf_pair_lean(s, corner, q);
        add_pair(s, w);
    }
}

/* Accelerations by the last step's forces of missile and anvil into contact_push: a cover below the missile
 * would else meet the foam without the missile's load. All points are read, as the list of near points is
 * empty after a restart. */
static void push_from_outside(const sf_model *m, const sf_contact_rows *rows, sf_state *s) {
    const double *load = sf_state_load(m, s);
    for (int64_t c = 0; c < sf_model_points(m); c++) {
        const double *q = &load[3 * c];
        for (int64_t e = rows->ptr[c]; e < rows->ptr[c + 1] && sf_dot3(q, q) > 0; e++) {
            int64_t i = rows->node[e];
            for (int r = 0; r < 3; r++)
                s->contact_push[3 * i + r] += rows->by_mass[e] * q[r];
        }
    }
}

static sf_status fail_passed(const sf_model *m, const sf_skin *skin, const sf_state *s,
                             const sf_contact_pair *pair, sf_error *err) {
    int support = sf_skin_support(m, skin, pair->node, pair->facet);
    const double *x = &s->self_position[3 * pair->node], *rest = &skin->rest[3 * pair->node];
    char through[40] = "another face of the foam";
    if (support >= 0)
        snprintf(through, sizeof through, "support %d", support + 1);
    return SF_FAIL(
        err, SF_ERR_NUMERIC,
        "at t = %.6g s the foam has passed through %s by %.3g mm, at (%.4g, %.4g, %.4g) mm (undeformed "
        "(%.4g, %.4g, %.4g) mm): %s",
        s->time, through, -1e3 * pair->gap, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2], 1e3 * rest[0], 1e3 * rest[1],
        1e3 * rest[2],
        skin->watched && support < 0 ? "pad.self_contact = \"on\" keeps its faces apart"
                                     : "take a finer mesh there, or a smaller solver.step_safety");
}

/* Adds the force of a support's edge to what is outside of the pad. */
static void add_sharp_force(const sf_model *m, sf_state *s, const sf_contact_pair *pair) {
    double moment[3];
    sf_cross3(pair->place, pair->force, moment);
    for (int r = 0; r < 3; r++) {
        s->self_sharp_force[m->support_part[pair->facet - m->skin_count]][r] += pair->force[r];
        s->self_sharp_moment[r] += moment[r];
    }
}

sf_status sf_self_contact_solve(const sf_model *m, const sf_operators *op, sf_state *s, sf_error *err) {
    const sf_skin *skin = &op->skin;
    if (skin->count == 0)
        return SF_OK;
    double dt_v = 0.5 * (s->dt_old + s->dt);
    size_t bytes = 3 * (size_t)m->node_count * sizeof *s->contact_push;
    const sf_sharp_place at = {.model = m, .position = s->self_position, .step = s->self_step};
    push_from_outside(m, &op->rows, s);
    if (!sf_candidates_last(skin, s)) {
        for (int64_t p = 0; p < skin->count; p++)
            s->self_near[p] = (int32_t)p;
        move_nodes(m, skin, s, dt_v, skin->count, s->self_near);
        SF_TRY(sf_candidates_find(skin, &op->self_sharp, &at, s, err));
    } else {
        move_nodes(m, skin, s, dt_v, s->self_near_count, s->self_near);
    }
    memset(s->contact_push, 0, bytes);
    find_normals(skin, s);
    int64_t most = skin->count + skin->edge_count + sf_sharp_room(&op->self_sharp); /* pairs */
    double(*edge_force)[3] = sf_workspace_take(&s->contact_work.edge_force, skin->edge_count,
                                               sizeof *edge_force, "pairs in contact", err);
    sf_contact_pair passed = {.node = -1};
    sf_contact_system w = {
        .rows = &skin->rows,
        .push = s->contact_push,
        .shift = s->dt * dt_v,
        .pair = sf_workspace_take(&s->contact_work.pair, most, sizeof *w.pair, "pairs in contact", err),
        .sweeps = MAX_SWEEPS,
        .over = 1,
        .tolerance = SWEEP_TOLERANCE,
        .unsettled = UNSETTLED};
    SF_TRY(err->status);
    find_pairs(m, skin, s, &w, &passed);
    if (passed.node >= 0)
        fail_passed(m, skin, s, &passed, err);
    int64_t nodes = w.count;
    if (err->status == SF_OK)
        find_edges(m, skin, s, edge_force, &w);
    int64_t edges = w.count;
    if (err->status == SF_OK && op->self_sharp.face_count > 0)
        sf_sharp_add(&op->self_sharp, &at, s->dt, &s->self_sharp, &w, &s->self_penetration, err);
    if (w.count > edges) {
        w.over = OVER;
        w.sweeps = CENTROID_SWEEPS;
    }
    s->contact_unsettled += !sf_contact_relax(&w);
    memset(s->self_sharp_force, 0, sizeof s->self_sharp_force);
    memset(s->self_sharp_moment, 0, sizeof s->self_sharp_moment);
    for (int64_t a = 0; a < w.count; a++) {
        double motion[3];
        if (a >= edges)
            add_sharp_force(m, s, &w.pair[a]);
        sf_contact_apply(&w, &w.pair[a], s->force);
        sf_pair_relative(&w.pair[a], s->self_motion, motion);
        book(s, &w.pair[a], motion);
        if (a < nodes)
            continue;
        sf_contact_motion(&w, &w.pair[a], motion); /* no later step knows a pair of edges */
        book(s, &w.pair[a], motion);
    }
    sf_contact_clear(&w);
    return err->status;
}
