/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/ledger.h"

/* Work (J) of half the force of a pair over the motion (m) of its points relative to what they touch: lost in
 * contact, lost in friction, and done by a driven missile, which moves `away` (m). That starts on the pad and
 * catches the surface points up at once: of the work of the impulse (the force at t = 0 for half a step,
 * `first`) they keep one half. */
static void half_work(const sf_contact_pair *pair, const double motion[3], const double away[3], bool first,
                      double work[3]) {
    const double *q = pair->force, *n = pair->normal;
    double lost = -0.5 * sf_dot3(q, motion);
    work[0] = pair->friction > 0 ? -0.5 * sf_dot3(q, n) * sf_dot3(motion, n) : lost;
    work[1] = lost - work[0];
    work[2] = pair->missile && pair->missile->mobility == 0 ? 0.5 * sf_dot3(q, away) : 0;
    work[0] += first ? 0.5 * work[2] : 0;
}

void sf_ledger_book(const sf_scene *c, const sf_contact_pair *pair, bool first) {
    sf_state *s = c->state;
    double motion[3], away[3] = {0}, work[3];
    sf_pair_relative(pair, c->at->motion, motion);
    if (pair->missile)
        sf_missile_motion_at(c->model, &s->missile, pair->place, away);
    sf_sub3(motion, away, motion);
    half_work(pair, motion, away, first, work);
    s->ledger.contact += work[0];
    s->ledger.friction += work[1];
    s->ledger.external += work[2];
    s->ledger.anvil += pair->body == SF_BODY_ANVIL ? work[0] + work[1] : 0;
    if (!c->response || pair->node < 0)
        return;
    double *rubbed = &s->contact_rubbed[pair->node];
    s->rubbed_back -= fmax(0, -*rubbed);
    *rubbed += work[1];
    s->rubbed_back += fmax(0, -*rubbed);
}

void sf_ledger_book_ahead(const sf_scene *c, const sf_contact_system *w, const sf_contact_pair *pair) {
    double motion[3], away[3] = {0}, work[3];
    sf_contact_motion(w, pair, motion);
    if (pair->missile)
        sf_missile_free_motion(pair->missile, pair->place, away);
    half_work(pair, motion, away, c->state->step == 0, work);
    for (int k = 0; k < 3; k++)
        c->state->ahead[k] += work[k];
}

void sf_ledger_take_ahead(sf_state *s) {
    s->ledger.contact += s->ahead[0];
    s->ledger.friction += s->ahead[1];
    s->ledger.external += s->ahead[2];
    memset(s->ahead, 0, sizeof s->ahead);
}

void sf_ledger_outside(const sf_model *m, const sf_weight *weight, const sf_state *s, sf_wrench *outside) {
    for (int b = 0; b < SF_BODIES; b++)
        for (int r = 0; r < 3; r++) {
            outside->force[r] += s->of_body[b].force[r];
            outside->moment[r] += s->of_body[b].moment[r];
        }
    for (int64_t k = 0; k < weight->count; k++) {
        double x[3];
        for (int r = 0; r < 3; r++)
            x[r] = m->position[3 * (int64_t)weight->node[k] + r] + s->d[3 * (int64_t)weight->node[k] + r];
        sf_wrench_add(outside, x, weight->pull[k]);
    }
}

void sf_ledger_supports(const sf_model *m, sf_state *s, const double base[3]) {
    double place;
    for (int r = 0; r < 3; r++)
        s->base_reaction[r] = base[r] + s->of_body[SF_BODY_ANVIL].force[r];
    for (int k = 0; k < m->support_count; k++) {
        double force[3];
        for (int r = 0; r < 3; r++) {
            force[r] = s->of_body[SF_BODY_SUPPORT + k].force[r];
            s->base_reaction[r] += force[r];
            force[r] *= r == 2 || !sf_symmetry_plane(m, r, &place);
        }
        s->support_force[k] = sqrt(sf_dot3(force, force));
    }
}
