/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/contact.h"

#include "base/mat3.h"
#include "solver/contact/ledger.h"
#include "solver/contact/solve.h"

enum { MAX_SWEEPS = 2000 };
static const double ENTRY_DEPTH =
    0.1; /* of the spacing: no free point gets deeper in one step through the surface */
static const double SWEEP_TOLERANCE = 1e-10; /* largest change of a force, relative to the largest force */
/* The same where sharp edges press, as their rows depend on those of the nodes, and the change beyond which
 * it is told that the sweeps did not settle. */
static const double SHARP_TOLERANCE = 1e-5, SHARP_UNSETTLED = 1e-3;

/* Verlet list with skin: the near points are those within NEAR spacings of the missile. The list is made anew
 * when half of that distance is used up, or when the rest is not more than twice the travel of one step. */
static const double NEAR = 2;

/* Subtracts the last step's travel from the skin of the Verlet list. When the rest is too small, lists all
 * points and returns true. */
static bool use_room(const sf_model *m, const sf_operators *op, sf_state *s) {
    double speed = op->rows.spread * s->fastest + sf_missile_fastest(m, &s->missile);
    s->contact_room -= s->dt_old * speed;
    if (s->step > 0 && s->contact_room > fmax(0.5 * NEAR * op->surface.spacing, 2 * s->dt * speed))
        return false;
    for (int64_t c = 0; c < sf_model_points(m); c++)
        s->contact_near[c] = (int32_t)c;
    s->contact_near_count = sf_model_points(m);
    return true;
}

/* Makes the list of near points from the points listed now. Those on the anvil always are, and those of faces
 * that sharp edges may press. */
static sf_status list_near(const sf_model *m, const sf_operators *op, const sf_sharp_place *at, sf_state *s,
                           sf_error *err) {
    int64_t count = 0, points = sf_model_points(m);
    uint8_t *used = NULL;
    s->contact_room = NEAR * op->surface.spacing;
    if (op->sharp.face_count > 0) {
        used = sf_workspace_take(&s->sharp.used, points, 1, "points in contact", err);
        SF_TRY(err->status);
        memset(used, 0, (size_t)points);
        SF_TRY(sf_sharp_list(&op->sharp, at, &s->contact_room, used, &s->sharp, err));
    }
    for (int64_t k = 0; k < s->contact_near_count; k++) {
        int64_t c = s->contact_near[k];
        if (sf_model_point_rests(m, c) || (used && used[c]) ||
            sf_missile_near(m, &s->missile, &op->surface, &s->contact_position[3 * c], s->contact_room))
            s->contact_near[count++] = (int32_t)c;
    }
    s->contact_near_count = count;
    return SF_OK;
}

/* Positions now and predicted without contact forces, by u_h. By all threads. */
static void predict_points(const sf_model *m, const sf_contact_rows *rows, sf_state *s, double dt_v) {
#pragma omp for schedule(static)
    for (int64_t near = 0; near < s->contact_near_count; near++) {
        int64_t c = s->contact_near[near], node = sf_model_point_node(m, c);
        double now[3] = {0}, step[3] = {0};
        for (int64_t k = rows->ptr[c]; k < rows->ptr[c + 1]; k++) {
            int64_t i = rows->node[k];
            double phi = rows->value[k], inverse = dt_v / m->mass[i];
            for (int r = 0; r < 3; r++) {
                now[r] += phi * s->d[3 * i + r];
                step[r] += phi * (s->v[3 * i + r] + inverse * (s->force[3 * i + r] - s->reaction[3 * i + r]));
            }
        }
        for (int r = 0; r < 3; r++) {
            double y = m->position[3 * node + r] + now[r];
            s->contact_motion[3 * c + r] = y - s->contact_position[3 * c + r];
            s->contact_position[3 * c + r] = y;
            s->contact_step[3 * c + r] = s->dt * step[r];
        }
    }
}

/* Work of a driven missile since the last step, at the point x: the forces' mean times its motion. If it
 * starts on the pad it catches the surface points up at once; of the work of that impulse (the force at t = 0
 * for half a step) they keep one half. */
static void book_drive(const sf_model *m, sf_state *s, const double x[3], const double mean[3],
                       const double old[3]) {
    s->ledger.external += sf_missile_work(m, &s->missile, x, mean);
    if (s->step == 1)
        s->ledger.contact += 0.25 * sf_missile_work(m, &s->missile, x, old);
}

static double friction_at(const sf_model *m, int64_t c) {
    return sf_model_point_rests(m, c) ? m->anvil.friction : m->missile.friction;
}

/* Displacement (m), in the last step, of what touches at point c. */
static void partner_motion(const sf_model *m, const sf_state *s, int64_t c, double out[3]) {
    if (sf_model_point_rests(m, c))
        memset(out, 0, 3 * sizeof *out);
    else
        sf_missile_motion_at(m, &s->missile, &s->contact_position[3 * c], out);
}

/* Work lost since the last step: the forces' mean times the relative motion, split at the normal. */
static void book_work(const sf_model *m, sf_state *s) {
    bool driven = sf_missile_is_driven(m);
    for (int64_t k = 0; k < s->contact_near_count; k++) {
        int64_t c = s->contact_near[k];
        bool rests = sf_model_point_rests(m, c);
        const double *q = &s->contact_force[3 * c], *old = &s->contact_old[3 * c];
        if (sf_dot3(q, q) == 0 && sf_dot3(old, old) == 0)
            continue;
        double mean[3], slip[3];
        partner_motion(m, s, c, slip);
        for (int r = 0; r < 3; r++) {
            mean[r] = 0.5 * (q[r] + old[r]);
            slip[r] = s->contact_motion[3 * c + r] - slip[r];
        }
        const double *n = friction_at(m, c) > 0 ? &s->contact_normal[3 * c] : NULL;
        double rubbed = sf_ledger_book(s, rests, mean, slip, n);
        s->rubbed_back -= fmax(0, -s->contact_rubbed[c]);
        s->contact_rubbed[c] += rubbed;
        s->rubbed_back += fmax(0, -s->contact_rubbed[c]);
        if (!rests && driven)
            book_drive(m, s, &s->contact_position[3 * c], mean, old);
    }
}

/* True if the point, free in the last step, is deep inside already: it then did not come through the
 * touching surface but round its rim, and pushing it out would throw it. */
static bool entered_from_behind(const sf_model *m, const sf_operators *op, const sf_state *s, int64_t c) {
    double gap, normal[3];
    return sf_dot3(&s->contact_force[3 * c], &s->contact_force[3 * c]) == 0 &&
           (!sf_missile_gap(m, &s->missile, &op->surface, &s->contact_position[3 * c], &gap, normal) ||
            gap < -ENTRY_DEPTH * m->spacing[m->contact_node[c]]);
}

/* Gap of point c now. False: no gap there. */
static bool find_gap(const sf_model *m, const sf_operators *op, const sf_state *s, int64_t c, double *gap) {
    double normal[3];
    const double *x = &s->contact_position[3 * c];
    if (!sf_model_point_rests(m, c))
        return sf_missile_gap(m, &s->missile, &op->surface, x, gap, normal);
    *gap = sf_anvil_gap(m, sf_model_point_node(m, c), x);
    return true;
}

/* Gap and normal at the end of the next step without contact forces. False: the point does not touch. */
static bool find_gap_ahead(const sf_model *m, const sf_operators *op, const sf_state *s,
                           const sf_missile_response *response, int64_t c, double *gap, double normal[3]) {
    const double *x = &s->contact_position[3 * c], *step = &s->contact_step[3 * c];
    if (!sf_model_point_rests(m, c))
        return sf_missile_gap_ahead(m, &s->missile, response, &op->surface, x, step, gap, normal) &&
               !(*gap < 0 && entered_from_behind(m, op, s, c));
    *gap = sf_anvil_gap(m, sf_model_point_node(m, c), x) + step[2];
    normal[0] = normal[1] = 0;
    normal[2] = 1;
    return true;
}

/* The force that a point begins with: the last step's magnitude, turned to the new normal. */
static void start_force(const sf_state *s, double friction, int64_t c) {
    const double *n = &s->contact_normal[3 * c], *old = &s->contact_old[3 * c];
    double p = fmax(0, sf_dot3(old, n));
    for (int r = 0; r < 3; r++)
        s->contact_force[3 * c + r] = friction > 0 && p > 0 ? old[r] : p * n[r];
}

/* Adds the pair of point c, whose gap ahead is that of the curved surface. */
static void add_pair(const sf_model *m, sf_state *s, sf_missile_response *response, int64_t c,
                     sf_contact_system *w) {
    const double *x = &s->contact_position[3 * c], *n = &s->contact_normal[3 * c];
    bool rests = sf_model_point_rests(m, c);
    double away[3] = {0};
    sf_contact_pair *q = &w->pair[w->count];
    *q = (sf_contact_pair){.node = c,
                           .parts = 1,
                           .part = {(int32_t)c},
                           .share = {1},
                           .friction = friction_at(m, c),
                           .force = &s->contact_force[3 * c],
                           .missile = rests ? NULL : response,
                           .place = {x[0], x[1], x[2]}};
    if (!rests)
        sf_missile_free_motion(response, x, away);
    for (int r = 0; r < 3; r++) {
        q->normal[r] = n[r];
        q->step[r] = s->contact_step[3 * c + r] - away[r];
    }
    q->gap = s->contact_gap[c] - sf_dot3(q->step, n);
    start_force(s, q->friction, c);
    sf_contact_add(w);
}

/* Gaps at the predicted positions; the pairs of the points that would be inside, with forces carried over.
 * Deepest present penetration. */
static void find_pairs(const sf_model *m, const sf_operators *op, sf_state *s, sf_missile_response *response,
                       sf_contact_system *w) {
    size_t bytes = 3 * (size_t)sf_model_points(m) * sizeof *s->contact_force;
    memcpy(s->contact_old, s->contact_force, bytes);
    s->penetration = 0;
    for (int64_t k = 0; k < s->contact_near_count; k++) {
        int64_t c = s->contact_near[k];
        double gap, normal[3];
        if (s->contact_gap[c] < 0 && find_gap(m, op, s, c, &gap))
            s->penetration = fmax(s->penetration, -gap);
        s->contact_gap[c] = INFINITY;
        bool touches = find_gap_ahead(m, op, s, response, c, &gap, normal);
        for (int r = 0; r < 3; r++)
            s->contact_force[3 * c + r] = 0;
        if (!touches)
            continue;
        s->contact_gap[c] = gap;
        memcpy(&s->contact_normal[3 * c], normal, sizeof normal);
        if (gap < 0)
            add_pair(m, s, response, c, w);
    }
}

/* Books the work of the forces of sharp edges over the last step as that of the points: half of it with the
 * forces before and half with these. No later step knows the pairs, so that the first half is found ahead,
 * with the motion that the solve predicts. What book_drive says of a driven missile holds here, too. */
static void book_sharp(const sf_model *m, sf_state *s, const sf_contact_system *w, int64_t points) {
    double *ahead = s->sharp.ahead, motion[3], away[3];
    s->ledger.contact += ahead[0];
    s->ledger.friction += ahead[1];
    s->ledger.external += ahead[2];
    memset(ahead, 0, 3 * sizeof *ahead);
    for (int64_t a = points; a < w->count; a++) {
        const sf_contact_pair *pair = &w->pair[a];
        const double *q = pair->force, *n = pair->friction > 0 ? pair->normal : NULL;
        const double half[3] = {0.5 * q[0], 0.5 * q[1], 0.5 * q[2]};
        sf_missile_motion_at(m, &s->missile, pair->place, away);
        sf_pair_relative(pair, s->contact_motion, motion);
        sf_sub3(motion, away, motion);
        sf_ledger_book(s, false, half, motion, n);
        sf_contact_motion(w, pair, motion);
        double lost = -sf_dot3(half, motion), normal = n ? -sf_dot3(half, n) * sf_dot3(motion, n) : lost;
        ahead[0] += normal;
        ahead[1] += lost - normal;
        if (!sf_missile_is_driven(m))
            continue;
        sf_missile_free_motion(pair->missile, pair->place, away);
        s->ledger.external += sf_missile_work(m, &s->missile, pair->place, half);
        ahead[2] += sf_dot3(half, away);
        ahead[0] += s->step == 0 ? 0.5 * sf_dot3(half, away) : 0;
    }
}

/* Sets the loads of all points, with the normal of an edge where a point has no force of its own. */
static void take_loads(const sf_model *m, sf_state *s, const sf_contact_system *w, int64_t points) {
    memcpy(s->contact_load, s->contact_force, 3 * (size_t)sf_model_points(m) * sizeof *s->contact_load);
    for (int64_t k = points; k < w->count; k++)
        for (int a = 0; a < w->pair[k].parts; a++) {
            const sf_contact_pair *pair = &w->pair[k];
            int64_t c = pair->part[a];
            for (int r = 0; r < 3; r++)
                s->contact_load[3 * c + r] += pair->share[a] * pair->force[r];
            if (sf_dot3(&s->contact_force[3 * c], &s->contact_force[3 * c]) == 0)
                memcpy(&s->contact_normal[3 * c], pair->normal, sizeof pair->normal);
        }
}

/* Forces of the pairs on coefficients, missile and anvil. */
static void store(const sf_model *m, sf_state *s, const sf_contact_system *w) {
    sf_missile_clear(&s->missile);
    s->contact_count = s->anvil_count = 0;
    memset(s->anvil_force, 0, sizeof s->anvil_force);
    for (int64_t a = 0; a < w->count; a++) {
        const sf_contact_pair *pair = &w->pair[a];
        const double *q = pair->force, back[3] = {-q[0], -q[1], -q[2]};
        if (!(sf_dot3(q, pair->normal) > 0))
            continue;
        sf_contact_apply(w, pair, s->force);
        s->contact_count += pair->missile != NULL;
        s->anvil_count += pair->missile == NULL;
        if (pair->missile)
            sf_missile_apply(m, &s->missile, pair->place, pair->normal, back);
        for (int r = 0; r < 3 && !pair->missile; r++)
            s->anvil_force[r] += q[r];
    }
    if (s->contact_count > 0)
        sf_missile_touch(m, &s->missile, s->time);
}

sf_status sf_contact_solve(const sf_model *m, const sf_operators *op, sf_state *s, sf_error *err) {
    double dt_v = 0.5 * (s->dt_old + s->dt);
    sf_missile_response response = sf_missile_predict(m, &s->missile, s->time, s->dt, s->dt_old);
    sf_contact_system w = {.rows = &op->rows,
                           .push = s->contact_push,
                           .shift = s->dt * dt_v,
                           .pair = sf_workspace_take(&s->contact_work.point,
                                                     sf_model_points(m) + sf_sharp_room(&op->sharp),
                                                     sizeof *w.pair, "pairs in contact", err),
                           .sweeps = MAX_SWEEPS,
                           .over = 1,
                           .tolerance = SWEEP_TOLERANCE,
                           .unsettled = SWEEP_TOLERANCE};
    const sf_sharp_place at = {m, &s->missile, &response, s->contact_position, s->contact_step};
    SF_TRY(err->status);
    sf_anvil_pull(&op->anvil, s->force);
    bool all = use_room(m, op, s);
    SF_BY_ALL_THREADS(s->contact_near_count > SF_FEW_POINTS, predict_points(m, &op->rows, s, dt_v));
    if (all)
        SF_TRY(list_near(m, op, &at, s, err));
    find_pairs(m, op, s, &response, &w);
    int64_t points = w.count;
    if (op->sharp.face_count > 0)
        SF_TRY(sf_sharp_add(&op->sharp, &at, s->dt, &s->sharp, &w, &s->penetration, err));
    if (w.count > points) {
        w.tolerance = SHARP_TOLERANCE;
        w.unsettled = SHARP_UNSETTLED;
    }
    s->contact_unsettled += !sf_contact_relax(&w);
    if (m->contact_face_count > 0) {
        book_sharp(m, s, &w, points);
        take_loads(m, s, &w, points);
    }
    sf_contact_clear(&w);
    book_work(m, s);
    store(m, s, &w);
    sf_missile_accelerate(m, &s->missile);
    return SF_OK;
}
