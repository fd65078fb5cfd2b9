/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/contact.h"

#include "solver/contact/broad.h"
#include "solver/contact/ledger.h"
#include "solver/contact/shape_face.h"
#include "solver/contact/shapes.h"
#include "solver/contact/solve.h"

/* The end of the sweeps: of contact points, whose forces are the figure, and of the skin; without and with
 * rows that depend on others. */
static const sf_contact_sweeps CONTACT[] = {{2000, 1, 1e-10, 1e-10}, {2000, 1, 1e-5, 1e-3}},
                               SKIN[] = {{1000, 1, 1e-5, 1e-3}, {240, 1.6, 1e-5, 1e-3}};

/* ---- prepare ---- */

/* Position, motion in the last step, and motion in the next one without contact forces, of the points that
 * are near. By all threads. */
static void move_points(const sf_scene *c, double dt_v) {
    const sf_skin *skin = c->skin;
    const sf_state *s = c->state;
    const double *mass = c->model->mass;
#pragma omp for schedule(static)
    for (int64_t k = 0; k < c->at->near_count; k++) {
        int64_t p = c->at->near[k];
        double now[3] = {0}, last[3] = {0}, next[3] = {0};
        int members = sf_skin_members(skin, p);
        for (int of = 0; of < members; of++) {
            int64_t node = sf_skin_member(skin, p, of);
            for (int64_t e = skin->rows.ptr[node]; e < skin->rows.ptr[node + 1]; e++) {
                int64_t i = skin->rows.node[e];
                double phi = skin->rows.value[e] / members, inverse = dt_v / mass[i];
                for (int r = 0; r < 3; r++) {
                    now[r] += phi * s->d[3 * i + r];
                    last[r] += phi * s->v[3 * i + r];
                    next[r] +=
                        phi * (s->v[3 * i + r] + inverse * (s->force[3 * i + r] - s->reaction[3 * i + r]) +
                               dt_v * s->contact_push[3 * i + r]);
                }
            }
        }
        for (int r = 0; r < 3; r++) {
            c->at->position[3 * p + r] = skin->rest[3 * p + r] + now[r];
            c->at->motion[3 * p + r] = s->dt_old * last[r];
            c->at->step[3 * p + r] = s->dt * next[r];
        }
    }
}

static void measure_travel(sf_contact_points *at) {
    double square = 0;
    for (int64_t k = 0; k < at->near_count; k++) {
        const double *step = &at->step[3 * (int64_t)at->near[k]];
        square = sf_larger(sf_dot3(step, step), square);
    }
    at->travel = sqrt(square);
}

/* Accelerations by the last step's forces of missile and anvil into contact_push: a cover below the missile
 * would else meet the foam without the missile's load. All points are read, as the list of near points is
 * empty after a restart. */
static void push_from_outside(const sf_model *m, const sf_point_rows *rows, sf_state *s) {
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

/* ---- the partner of a point ---- */

/* The partner of a point in the last step. */
static int64_t last_partner(const sf_scene *c, int64_t p) {
    const double *force = &c->at->force[3 * p];
    if (!c->response)
        return c->at->partner[p];
    int body = sf_skin_touches(c->skin, p, SF_BODY_ANVIL) ? SF_BODY_ANVIL : SF_BODY_MISSILE;
    return sf_dot3(force, force) == 0 ? SF_NO_PARTNER : SF_FIRST_BODY - body;
}

/* A search for the partner of a point. */
typedef struct search {
    const sf_scene *scene;
    int64_t point, last; /* and its partner in the last step */
    double nearest;      /* m, distance of the pair that is the nearest so far */
    sf_contact_pair *out, *passed;
} search;

/* Takes the pair with a partner if it closes in the step and is nearer than those before. */
static void try_partner(search *t, int64_t partner) {
    const sf_scene *c = t->scene;
    const sf_shape *shape = partner < 0 ? c->body[SF_FIRST_BODY - partner].shape : &sf_shape_face;
    sf_contact_pair q;
    q.node = t->point;
    q.facet = partner;
    q.leans = false;
    q.missile = NULL;
    if (!shape->meet(c, t->point, partner, &q) || fabs(q.gap) >= t->nearest)
        return;
    /* The same contact goes on with a facet that is the last partner or meets it. */
    bool on = t->last == partner || sf_skin_facets_meet(c->skin, t->last, partner);
    double deepest = sf_shape_limit(shape, on, c->skin->size[t->point]), distance = fabs(q.gap);
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
    bool slowly = !c->response && sf_pair_acts(c, &q); /* a resting base takes back all of it */
    if (!sf_pair_closes(&q, slowly ? shape->back * c->state->dt : INFINITY))
        return;
    t->nearest = distance;
    *t->out = q;
}

/* Finds the partner that a point touches at the end of the step: of those that it may touch, the nearest.
 * Without one, `passed`: the pair that the point was in, if it has become deeper than it may; its node is -1
 * otherwise. */
static bool find_partner(const sf_scene *c, int64_t p, sf_contact_pair *out, sf_contact_pair *passed) {
    const int32_t *facet = c->response ? NULL : &c->at->candidate[SF_SELF_CANDIDATES * p];
    search t = {.scene = c,
                .point = p,
                .last = last_partner(c, p),
                .nearest = INFINITY,
                .out = out,
                .passed = passed};
    passed->node = -1;
    for (int k = 0; facet && k < SF_SELF_CANDIDATES && facet[k] != SF_NO_PARTNER; k++)
        try_partner(&t, facet[k]);
    for (int k = 0; k <= SF_BODY_MISSILE; k++)
        if (sf_skin_touches(c->skin, p, k))
            try_partner(&t, SF_FIRST_BODY - k);
    if (!(t.nearest < INFINITY))
        return false;
    passed->node = -1;
    out->body = sf_pair_body(c, p, out->facet);
    sf_pair_rub(c, out->body == SF_BODY_PAD ? &c->skin->facet[3 * out->facet] : NULL, out);
    return true;
}

/* ---- warm start ---- */

/* The pair of a point in the last step. Normal and lean of the skin are those of the present: the work that
 * they tell of the last forces has an error of the order of their change. */
static sf_contact_pair last_pair(const sf_scene *c, int64_t p, int64_t partner) {
    const double *x = &c->at->position[3 * p];
    sf_contact_pair q = {.node = p,
                         .facet = partner,
                         .body = sf_pair_body(c, p, partner),
                         .force = &c->at->force[3 * p],
                         .place = {x[0], x[1], x[2]}};
    q.missile = q.body == SF_BODY_MISSILE ? c->response : NULL;
    q.friction = sf_pair_friction(c, &q);
    if (partner >= 0)
        memcpy(q.weight, &c->at->weight[4 * p], sizeof q.weight);
    sf_pair_list_parts(c->skin, &q);
    if (c->response) {
        memcpy(q.normal, &c->at->normal[3 * p], sizeof q.normal);
    } else if (partner < 0) {
        sf_body_gap(&c->body[q.body], x, &q.gap, q.normal);
    } else {
        double apart[3];
        sf_face_normal(c->at->position, &c->skin->facet[3 * partner], q.normal);
        sf_unit3(q.normal);
        sf_pair_relative(&q, c->at->position, apart);
        q.depth = -sf_dot3(apart, q.normal);
        if (q.body == SF_BODY_PAD && q.friction > 0)
            sf_pair_lean(c, &c->skin->facet[3 * partner], &q);
    }
    return q;
}

/* Books the last step's pair of a point, finds that of this step, and carries its force over. `passed`:
 * becomes the pair whose node has passed through the facet. */
static void find_pair(const sf_scene *c, int64_t p, sf_contact_system *w, sf_contact_pair *passed) {
    sf_contact_points *at = c->at;
    sf_contact_pair *found = &w->pair[w->count], gone;
    double *q = &at->force[3 * p], old = sqrt(sf_dot3(q, q));
    int64_t last = last_partner(c, p);
    if (last != SF_NO_PARTNER) {
        const sf_contact_pair pair = last_pair(c, p, last);
        sf_ledger_book(c, &pair, c->state->step == 1);
    }
    bool touches = find_partner(c, p, found, &gone);
    if (gone.node >= 0)
        *passed = gone;
    if (!c->response)
        at->partner[p] = touches ? (int32_t)found->facet : SF_NO_PARTNER;
    if (!touches) {
        memset(q, 0, 3 * sizeof *q);
        return;
    }
    found->force = q;
    if (c->response) {
        memcpy(&at->normal[3 * p], found->normal, sizeof found->normal);
        sf_pair_warm(found, q);
    } else {
        memcpy(&at->weight[4 * p], found->weight, sizeof found->weight);
        for (int r = 0; r < 3 && last != found->facet && found->friction == 0; r++)
            q[r] = old * found->normal[r];
    }
    if (!sf_pair_acts(c, found)) { /* it may have had a force from another partner */
        memset(q, 0, 3 * sizeof *q);
        return;
    }
    sf_contact_add(w);
    w->is_dependent |= p >= c->skin->nodes; /* centroids */
}

static sf_status fail_passed(const sf_scene *c, const sf_contact_pair *pair, sf_error *err) {
    int support = sf_skin_support(c->model, c->skin, pair->node, pair->facet);
    const double *x = &c->at->position[3 * pair->node], *rest = &c->skin->rest[3 * pair->node];
    char through[40] = "another face of the foam";
    if (support >= 0)
        snprintf(through, sizeof through, "support %d", support + 1);
    return SF_FAIL(
        err, SF_ERR_NUMERIC,
        "at t = %.6g s the foam has passed through %s by %.3g mm, at (%.4g, %.4g, %.4g) mm (undeformed "
        "(%.4g, %.4g, %.4g) mm): %s",
        c->state->time, through, -1e3 * pair->gap, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2], 1e3 * rest[0],
        1e3 * rest[1], 1e3 * rest[2],
        c->skin->watched && support < 0 ? "pad.self_contact = \"on\" keeps its faces apart"
                                        : "take a finer mesh there, or a smaller solver.step_safety");
}

/* ---- store ---- */

/* Adds the force of a pair on the pad to what its body does to the pad. */
static void load_body(const sf_scene *c, const sf_contact_pair *pair) {
    sf_state *s = c->state;
    const double *q = pair->force, back[3] = {-q[0], -q[1], -q[2]};
    s->contact_count += pair->missile != NULL;
    s->anvil_count += c->response && !pair->missile;
    if (pair->missile)
        sf_missile_apply(c->model, &s->missile, pair->place, pair->normal, back);
    for (int k = 0; k < pair->parts && pair->body != SF_BODY_PAD && !pair->missile; k++) {
        const double share = pair->share[k], own[3] = {share * q[0], share * q[1], share * q[2]};
        if (!sf_skin_is_rigid(c->skin, pair->part[k]))
            sf_wrench_add(&s->of_body[pair->body], &c->at->position[3 * (int64_t)pair->part[k]], own);
    }
}

/* Adds the force of a pair to the loads of its contact points, with its normal where a point has no force of
 * its own. */
static void load_points(const sf_contact_pair *pair, sf_contact_points *at) {
    for (int a = 0; a < pair->parts; a++) {
        int64_t p = pair->part[a];
        for (int r = 0; r < 3; r++)
            at->load[3 * p + r] += pair->share[a] * pair->force[r];
        if (sf_dot3(&at->force[3 * p], &at->force[3 * p]) == 0)
            memcpy(&at->normal[3 * p], pair->normal, sizeof pair->normal);
    }
}

/* Forces of the pairs on coefficients and bodies, and their work; the first `points` are those of points, the
 * others of edges and corners. */
static void store(const sf_scene *c, const sf_contact_system *w, int64_t points) {
    bool loads = c->response && c->skin->faces > 0;
    if (loads)
        memset(c->at->load, 0, 3 * (size_t)c->skin->count * sizeof *c->at->load);
    for (int64_t a = 0; a < w->count; a++) {
        const sf_contact_pair *pair = &w->pair[a];
        c->at->depth = fmax(c->at->depth, pair->depth);
        if (!(sf_dot3(pair->force, pair->normal) > 0))
            continue;
        sf_contact_apply(w, pair, c->state->force);
        load_body(c, pair);
        if (loads)
            load_points(pair, c->at);
        sf_ledger_book(c, pair, false);
        if (a >= points)
            sf_ledger_book_ahead(c, w, pair);
    }
}

static sf_status solve(const sf_scene *c, sf_error *err) {
    sf_state *s = c->state;
    sf_contact_points *at = c->at;
    double dt_v = 0.5 * (s->dt_old + s->dt);
    bool due = sf_broad_is_due(c);
    SF_BY_ALL_THREADS(at->near_count > SF_FEW_POINTS, move_points(c, dt_v));
    if (due)
        SF_TRY(sf_broad_list(c, err));
    if (!c->response) {
        measure_travel(at);
        memset(s->contact_push, 0, 3 * (size_t)c->model->node_count * sizeof *s->contact_push);
        for (int k = 0; sf_shapes[k]; k++)
            if (sf_shapes[k]->turn)
                sf_shapes[k]->turn(c);
    }
    int64_t most = c->skin->count;
    for (int k = 0; sf_shapes[k]; k++)
        most += sf_shapes[k]->most ? sf_shapes[k]->most(c) : 0;
    sf_contact_pair passed = {.node = -1};
    sf_contact_system w = {.rows = &c->skin->rows, .push = s->contact_push, .shift = s->dt * dt_v};
    w.pair = sf_workspace_take(&at->work.pair, most, sizeof *w.pair, "pairs in contact", err);
    SF_TRY(err->status);
    at->depth = 0;
    for (int64_t k = 0; k < at->close_count; k++)
        find_pair(c, at->close[k], &w, &passed);
    if (passed.node >= 0)
        return fail_passed(c, &passed, err);
    int64_t points = w.count;
    for (int k = 0; sf_shapes[k]; k++)
        if (sf_shapes[k]->add)
            SF_TRY(sf_shapes[k]->add(c, &w, err));
    s->contact_unsettled += !sf_contact_relax(&w, &(c->response ? CONTACT : SKIN)[w.is_dependent]);
    store(c, &w, points);
    sf_contact_clear(&w);
    return SF_OK;
}

sf_status sf_contact_solve(const sf_model *m, const sf_operators *op, sf_state *s, sf_error *err) {
    sf_ledger_take_ahead(s);
    memset(s->of_body, 0, sizeof s->of_body);
    if (op->skin.count > 0) {
        push_from_outside(m, &op->contact.rows, s);
        SF_TRY(solve(&(sf_scene){m, op->body, &op->skin, &op->skin_sharp, s, &s->skin, NULL}, err));
    }
    sf_missile_response response = sf_missile_predict(m, &s->missile, s->time, s->dt, s->dt_old);
    sf_missile_clear(&s->missile);
    s->contact_count = s->anvil_count = 0;
    sf_weight_pull(&op->weight, s->force);
    SF_TRY(solve(&(sf_scene){m, op->body, &op->contact, &op->contact_sharp, s, &s->contact, &response}, err));
    if (s->contact_count > 0)
        sf_missile_touch(m, &s->missile, s->time);
    sf_missile_accelerate(m, &s->missile);
    s->penetration = fmax(s->contact.depth, s->skin.depth);
    return SF_OK;
}
