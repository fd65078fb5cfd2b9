/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/pair.h"

void sf_pair_relative(const sf_contact_pair *q, const double *field, double out[3]) {
    memset(out, 0, 3 * sizeof *out);
    for (int k = 0; k < q->parts; k++) {
        const double *own = &field[3 * (int64_t)q->part[k]];
        double along = q->leans ? sf_dot3(own, q->normal) : 0;
        for (int r = 0; r < 3; r++)
            out[r] += q->share[k] * own[r] + (q->leans ? q->lean[k][r] * along : 0);
    }
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

/* The lean of a node is the gap times the gradient of its share, as a weight of the triangle n, less the part
 * that answers forces along the normal. */
void sf_pair_lean(const sf_scene *c, const int32_t n[3], sf_contact_pair *q) {
    const double *x = c->at->position;
    double side[3][3], own[3], lean[3];
    for (int k = 0; k < 3; k++)
        sf_sub3(&x[3 * (int64_t)n[(k + 2) % 3]], &x[3 * (int64_t)n[(k + 1) % 3]], side[k]);
    sf_cross3(side[0], side[1], own);
    double square = sf_dot3(own, own), across = sf_dot3(own, q->normal);
    q->leans = true;
    memset(q->lean, 0, sizeof q->lean);
    for (int k = 0; k < 3 && square > 0; k++) {
        sf_cross3(own, side[k], lean);
        double back = sf_dot3(lean, q->normal) / across;
        for (int r = 0; r < 3; r++)
            lean[r] = -q->depth / square * (lean[r] - back * own[r]);
        set_lean(q, n[k], lean);
    }
}

bool sf_pair_closes(sf_contact_pair *q, double back) {
    q->gap = fmax(q->gap, -back);
    return q->gap + sf_dot3(q->step, q->normal) < 0;
}

void sf_pair_rub(const sf_scene *c, const int32_t *node, sf_contact_pair *q) {
    q->friction = sf_pair_friction(c, q);
    if (q->friction > 0 && node) {
        sf_pair_lean(c, node, q);
        sf_pair_relative(q, c->at->step, q->step);
    }
}

void sf_pair_warm(sf_contact_pair *q, const double old[3]) {
    const double *n = q->normal, before[3] = {old[0], old[1], old[2]};
    double p = fmax(0, sf_dot3(before, n));
    for (int r = 0; r < 3; r++)
        q->force[r] = p > 0 && q->friction > 0 ? before[r] : p * n[r];
}

double sf_pair_friction(const sf_scene *c, const sf_contact_pair *q) {
    const sf_model *m = c->model;
    const sf_skin *skin = c->skin;
    if (q->body >= SF_BODY_SUPPORT)
        return m->support_friction[q->body - SF_BODY_SUPPORT];
    if (q->body == SF_BODY_SYMMETRY_X || q->body == SF_BODY_SYMMETRY_Y)
        return 0;
    if (q->body == SF_BODY_MISSILE)
        return m->missile.friction;
    if (q->body == SF_BODY_ANVIL && m->rest_count > 0) /* else there is one for free faces alone */
        return m->anvil.friction;
    if (m->pair_count == 0 || q->facet < 0)
        return m->skin_friction;
    int own = m->node_material[skin->node[sf_skin_member(skin, q->node, 0)]],
        other = m->node_material[skin->node[skin->facet[3 * q->facet]]];
    return sf_model_friction(m, own, other);
}

void sf_pair_list_parts(const sf_skin *skin, sf_contact_pair *q) {
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

/* The gap at the end of the step is that of the curved surface there. A point that was free and is deep
 * inside already did not come through the touching surface but round its rim, and pushing it out would throw
 * it. */
bool sf_pair_missile(const sf_scene *c, int64_t p, int64_t partner, sf_contact_pair *q) {
    const sf_body *body = &c->body[SF_FIRST_BODY - partner];
    const sf_missile *missile = &c->state->missile;
    const double *x = &c->at->position[3 * p], *step = &c->at->step[3 * p], *old = &c->at->force[3 * p];
    double ahead, now = 0, normal[3], away[3];
    if (!sf_missile_gap_ahead(c->model, c->response, body, x, step, &ahead, q->normal) || !(ahead < 0) ||
        (!sf_missile_gap(c->model, missile, body, x, &now, normal) && sf_dot3(old, old) == 0))
        return false;
    q->missile = c->response;
    sf_missile_free_motion(c->response, x, away);
    for (int r = 0; r < 3; r++) {
        q->place[r] = x[r];
        q->step[r] = step[r] - away[r];
    }
    q->gap = ahead - sf_dot3(q->step, q->normal);
    q->depth = -now;
    return true;
}

bool sf_pair_acts(const sf_scene *c, const sf_contact_pair *q) {
    const sf_skin *skin = c->skin;
    return !skin->watched || q->facet < 0 || sf_skin_is_rigid(skin, q->node) ||
           sf_skin_is_rigid(skin, skin->facet[3 * q->facet]);
}

int sf_pair_body(const sf_scene *c, int64_t p, int64_t partner) {
    if (partner < 0)
        return (int)(SF_FIRST_BODY - partner);
    int support = sf_skin_support(c->model, c->skin, p, partner);
    return support < 0 ? SF_BODY_PAD : SF_BODY_SUPPORT + support;
}

bool sf_pair_cross(const double u[3], const double v[3], const double between[3], double least, double n[3],
                   double place[2]) {
    double moment[3];
    sf_cross3(u, v, n);
    double square = sf_dot3(n, n);
    if (!(square > least * least * sf_dot3(u, u) * sf_dot3(v, v)))
        return false;
    for (int k = 0; k < 2; k++) {
        sf_cross3(between, k == 0 ? v : u, moment);
        place[k] = sf_dot3(moment, n) / square;
    }
    sf_unit3(n);
    return true;
}
