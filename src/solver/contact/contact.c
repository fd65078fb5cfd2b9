/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/contact.h"

#include "base/mat3.h"

enum { MAX_SWEEPS = 500 };
static const double ENTRY_DEPTH =
    0.1; /* of the spacing: no free point gets deeper in one step through the surface */
static const double SWEEP_TOLERANCE = 1e-10; /* largest change of a force, relative to the largest force */

/* The partners of the pad in contact. */
enum { MISSILE, ANVIL, PARTNERS };

/* Constants of one solve, and the responses of missile and anvil. That of the anvil is a missile's of
 * infinite mass at rest: zero. */
typedef struct contact_solve {
    double shift; /* s2, dt times the distance of the half steps */
    double friction[PARTNERS];
    sf_missile_response response[PARTNERS];
} contact_solve;

static int partner(const sf_model *m, int64_t c) {
    return sf_model_point_rests(m, c) ? ANVIL : MISSILE;
}

/* Verlet list with skin: the near points are those within NEAR spacings of the missile. The list is made anew
 * when half of that distance is used up, or when the rest is not more than twice the travel of one step. */
static const double NEAR = 2;

/* Subtracts the last step's travel from the skin of the Verlet list. When the rest is too small, lists all
 * points and returns true. */
static bool use_room(const sf_model *m, const sf_operators *op, sf_state *s) {
    double speed = op->gram.spread * s->fastest + sf_missile_fastest(m, &s->missile);
    s->contact_room -= s->dt_old * speed;
    if (s->step > 0 && s->contact_room > fmax(0.5 * NEAR * op->gram.spacing, 2 * s->dt * speed))
        return false;
    for (int64_t c = 0; c < sf_model_points(m); c++)
        s->contact_near[c] = (int32_t)c;
    s->contact_near_count = sf_model_points(m);
    return true;
}

/* Makes the list of near points from the points listed now. Those on the anvil always are. */
static void list_near(const sf_model *m, const sf_operators *op, sf_state *s) {
    int64_t count = 0;
    s->contact_room = NEAR * op->gram.spacing;
    for (int64_t k = 0; k < s->contact_near_count; k++) {
        int64_t c = s->contact_near[k];
        if (sf_model_point_rests(m, c) ||
            sf_missile_near(m, &s->missile, &op->surface, &s->contact_position[3 * c], s->contact_room))
            s->contact_near[count++] = (int32_t)c;
    }
    s->contact_near_count = count;
}

/* Positions now and predicted without contact forces, by u_h. */
static void predict_points(const sf_model *m, const sf_contact_rows *rows, sf_state *s, double dt_v) {
#pragma omp parallel for if (s->contact_near_count > SF_FEW_POINTS) default(none) shared(m, rows, s, dt_v)   \
    schedule(static)
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

/* Displacement (m), in the last step, of what touches at point c. */
static void partner_motion(const sf_model *m, const sf_state *s, int64_t c, double out[3]) {
    if (sf_model_point_rests(m, c))
        memset(out, 0, 3 * sizeof *out);
    else
        sf_missile_motion_at(m, &s->missile, &s->contact_position[3 * c], out);
}

/* Work lost since the last step: the forces' mean times the relative motion, split at the normal. */
static void book_work(const sf_model *m, sf_state *s, const contact_solve *w) {
    bool driven = sf_missile_is_driven(m);
    for (int64_t k = 0; k < s->contact_near_count; k++) {
        int64_t c = s->contact_near[k];
        const double *q = &s->contact_force[3 * c], *old = &s->contact_old[3 * c],
                     *n = &s->contact_normal[3 * c], *x = &s->contact_position[3 * c];
        if (sf_dot3(q, q) == 0 && sf_dot3(old, old) == 0)
            continue;
        double mean[3], slip[3];
        partner_motion(m, s, c, slip);
        for (int r = 0; r < 3; r++) {
            mean[r] = 0.5 * (q[r] + old[r]);
            slip[r] -= s->contact_motion[3 * c + r];
        }
        double lost = sf_dot3(mean, slip);
        double normal = w->friction[partner(m, c)] > 0 ? sf_dot3(mean, n) * sf_dot3(slip, n) : lost;
        s->ledger.contact += normal;
        s->ledger.friction += lost - normal;
        s->rubbed_back -= fmax(0, -s->contact_rubbed[c]);
        s->contact_rubbed[c] += lost - normal;
        s->rubbed_back += fmax(0, -s->contact_rubbed[c]);
        if (sf_model_point_rests(m, c))
            s->ledger.anvil += lost;
        else if (driven)
            book_drive(m, s, x, mean, old);
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
                           const contact_solve *w, int64_t c, double *gap, double normal[3]) {
    const double *x = &s->contact_position[3 * c], *step = &s->contact_step[3 * c];
    if (!sf_model_point_rests(m, c))
        return sf_missile_gap_ahead(m, &s->missile, &w->response[MISSILE], &op->surface, x, step, gap,
                                    normal) &&
               !(*gap < 0 && entered_from_behind(m, op, s, c));
    *gap = sf_anvil_gap(m, sf_model_point_node(m, c), x) + step[2];
    normal[0] = normal[1] = 0;
    normal[2] = 1;
    return true;
}

/* Gaps at the predicted positions; the list of points that would be inside. Deepest present penetration. */
static int64_t find_active(const sf_model *m, const sf_operators *op, sf_state *s, const contact_solve *w) {
    int64_t active = 0;
    s->penetration = 0;
    for (int64_t k = 0; k < s->contact_near_count; k++) {
        int64_t c = s->contact_near[k];
        double gap, normal[3];
        if (s->contact_gap[c] < 0 && find_gap(m, op, s, c, &gap))
            s->penetration = fmax(s->penetration, -gap);
        s->contact_gap[c] = INFINITY;
        if (!find_gap_ahead(m, op, s, w, c, &gap, normal))
            continue;
        s->contact_gap[c] = gap;
        memcpy(&s->contact_normal[3 * c], normal, sizeof normal);
        if (gap < 0)
            s->contact_active[active++] = (int32_t)c;
    }
    return active;
}

/* Forces carried over: last step's magnitude for active points, turned to the new normal; zero for the
 * others. */
static void start_forces(const sf_model *m, sf_state *s, int64_t active, contact_solve *w) {
    size_t bytes = 3 * (size_t)sf_model_points(m) * sizeof *s->contact_force;
    memcpy(s->contact_old, s->contact_force, bytes);
    memset(s->contact_force, 0, bytes);
    for (int64_t a = 0; a < active; a++) {
        int64_t c = s->contact_active[a];
        const double *n = &s->contact_normal[3 * c], *old = &s->contact_old[3 * c];
        double p = fmax(0, sf_dot3(old, n));
        for (int r = 0; r < 3; r++)
            s->contact_force[3 * c + r] = w->friction[partner(m, c)] > 0 && p > 0 ? old[r] : p * n[r];
        sf_missile_load(&w->response[partner(m, c)], &s->contact_position[3 * c], &s->contact_force[3 * c]);
    }
}

/* One Gauss-Seidel update of the force of point c; returns the size of its change. */
static double relax_point(const sf_model *m, const sf_contact_gram *gram, sf_state *s, contact_solve *w,
                          int64_t c) {
    const double *n = &s->contact_normal[3 * c], *x = &s->contact_position[3 * c];
    double *q = &s->contact_force[3 * c], moved[3] = {0}, recoil[3], old[3], tangential[3];
    double friction = w->friction[partner(m, c)];
    sf_missile_response *response = &w->response[partner(m, c)];
    for (int64_t k = gram->ptr[c]; k < gram->ptr[c + 1]; k++)
        for (int r = 0; r < 3; r++)
            moved[r] += gram->value[k] * s->contact_force[3 * (int64_t)gram->index[k] + r];
    sf_missile_recoil(response, x, recoil);
    for (int r = 0; r < 3; r++) /* relative displacement that the forces cause */
        moved[r] = w->shift * (moved[r] + recoil[r]);
    memcpy(old, q, sizeof old);
    double mobility = w->shift * (gram->diagonal[c] + sf_missile_mobility(response, x, n));
    double p_old = sf_dot3(old, n), p = fmax(0, p_old - (s->contact_gap[c] + sf_dot3(moved, n)) / mobility);
    for (int r = 0; r < 3; r++)
        tangential[r] = 0;
    if (friction > 0 && p > 0) {
        double slip[3], away[3], size = 0;
        sf_missile_free_motion(response, x, away);
        for (int r = 0; r < 3; r++)
            slip[r] = s->contact_step[3 * c + r] - away[r] + moved[r];
        double across = sf_dot3(slip, n),
               stuck = w->shift * (gram->diagonal[c] + sf_missile_looseness(response, x));
        for (int r = 0; r < 3; r++) {
            tangential[r] = old[r] - p_old * n[r] - (slip[r] - across * n[r]) / stuck;
            size += tangential[r] * tangential[r];
        }
        double bound = friction * p / sqrt(size);
        for (int r = 0; r < 3 && bound < 1; r++)
            tangential[r] *= bound;
    }
    double change = 0;
    for (int r = 0; r < 3; r++) {
        q[r] = p * n[r] + tangential[r];
        change = fmax(change, fabs(q[r] - old[r]));
    }
    sf_missile_reload(response, x, old, q);
    return change;
}

static void relax(const sf_model *m, const sf_operators *op, sf_state *s, int64_t active, contact_solve *w) {
    for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
        double change = 0, largest = 0;
        for (int64_t a = 0; a < active; a++) {
            int64_t c = sweep % 2 ? s->contact_active[active - 1 - a] : s->contact_active[a];
            change = fmax(change, relax_point(m, &op->gram, s, w, c));
            largest = fmax(largest, sf_dot3(&s->contact_force[3 * c], &s->contact_normal[3 * c]));
        }
        if (change <= SWEEP_TOLERANCE * largest)
            return;
    }
    s->contact_unsettled++;
}

/* The force of point c on missile or anvil. */
static void apply_to_partner(const sf_model *m, sf_state *s, int64_t c) {
    const double *q = &s->contact_force[3 * c], back[3] = {-q[0], -q[1], -q[2]};
    if (!sf_model_point_rests(m, c)) {
        s->contact_count++;
        sf_missile_apply(m, &s->missile, &s->contact_position[3 * c], &s->contact_normal[3 * c], back);
        return;
    }
    s->anvil_count++;
    for (int r = 0; r < 3; r++)
        s->anvil_force[r] += q[r];
}

/* Phi^T q to the coefficients' forces; resultants to missile and anvil. */
static void apply_forces(const sf_model *m, const sf_contact_rows *rows, sf_state *s, int64_t active) {
    sf_missile_clear(&s->missile);
    s->contact_count = s->anvil_count = 0;
    memset(s->anvil_force, 0, sizeof s->anvil_force);
    for (int64_t a = 0; a < active; a++) {
        int64_t c = s->contact_active[a];
        const double *q = &s->contact_force[3 * c], *n = &s->contact_normal[3 * c];
        if (!(sf_dot3(q, n) > 0))
            continue;
        apply_to_partner(m, s, c);
        for (int64_t k = rows->ptr[c]; k < rows->ptr[c + 1]; k++)
            for (int r = 0; r < 3; r++)
                s->force[3 * (int64_t)rows->node[k] + r] += rows->value[k] * q[r];
    }
    if (s->contact_count > 0)
        sf_missile_touch(m, &s->missile, s->time);
}

void sf_contact_solve(const sf_model *m, const sf_operators *op, sf_state *s) {
    double dt_v = 0.5 * (s->dt_old + s->dt);
    contact_solve w = {.shift = s->dt * dt_v, .friction = {m->missile.friction, m->anvil.friction}};
    w.response[MISSILE] = sf_missile_predict(m, &s->missile, s->time, s->dt, s->dt_old);
    w.response[ANVIL].direction = m->missile.direction;
    sf_anvil_pull(&op->anvil, s->force);
    bool all = use_room(m, op, s);
    predict_points(m, &op->rows, s, dt_v);
    if (all)
        list_near(m, op, s);
    int64_t active = find_active(m, op, s, &w);
    start_forces(m, s, active, &w);
    relax(m, op, s, active, &w);
    book_work(m, s, &w);
    apply_forces(m, &op->rows, s, active);
    sf_missile_accelerate(m, &s->missile);
}
