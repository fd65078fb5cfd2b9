/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/ledger.h"

#include "base/mat3.h"

double sf_ledger_book(sf_state *s, bool at_anvil, const double force[3], const double motion[3],
                      const double *n) {
    double lost = -sf_dot3(force, motion), normal = n ? -sf_dot3(force, n) * sf_dot3(motion, n) : lost;
    s->ledger.contact += normal;
    s->ledger.friction += lost - normal;
    if (at_anvil)
        s->ledger.anvil += lost;
    return lost - normal;
}

/* The anvil's forces on the base of a resting pad, and its weight. */
static void add_anvil(const sf_model *m, const sf_anvil *a, const sf_state *s, sf_wrench *outside) {
    for (int64_t c = m->contact_count; c < sf_model_points(m); c++)
        sf_wrench_add(outside, &s->contact_position[3 * c], &s->contact_force[3 * c]);
    for (int64_t k = 0; k < a->count; k++) {
        double x[3];
        for (int r = 0; r < 3; r++)
            x[r] = m->position[3 * (int64_t)a->node[k] + r] + s->d[3 * (int64_t)a->node[k] + r];
        sf_wrench_add(outside, x, a->pull[k]);
    }
}

void sf_ledger_outside(const sf_model *m, const sf_operators *op, const sf_state *s, bool all,
                       sf_wrench *outside) {
    const sf_skin *skin = &op->skin;
    if (all)
        add_anvil(m, &op->anvil, s, outside);
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < m->support_count; k++)
            outside->force[r] += s->self_sharp_force[k][r];
        outside->moment[r] += s->self_sharp_moment[r];
    }
    for (int64_t k = 0; skin->count > 0 && k < s->self_close_count; k++) {
        int64_t p = s->self_close[k], facet = s->self_partner[p];
        const double *q = &s->self_force[3 * p];
        bool symmetric = facet < SF_SKIN_FIRST_PLANE - SF_SKIN_ANVIL;
        if (facet != SF_SKIN_NOTHING && sf_skin_is_rigid(skin, p)) /* on the facet's nodes */
            for (int c = 0; c < sf_skin_corners(skin, facet); c++) {
                double weight = s->self_weight[4 * p + c];
                const double back[3] = {-weight * q[0], -weight * q[1], -weight * q[2]};
                sf_wrench_add(outside, &s->self_position[3 * sf_skin_corner(skin, facet, c)], back);
            }
        else if (facet < 0 ? facet != SF_SKIN_NOTHING && (all || !symmetric)
                           : sf_skin_is_rigid(skin, skin->facet[3 * facet]))
            sf_wrench_add(outside, &s->self_position[3 * p], q);
    }
}

void sf_ledger_supports(const sf_model *m, const sf_skin *skin, sf_state *s) {
    double force[SF_SUPPORTS][3], place;
    memcpy(force, s->self_sharp_force, sizeof force);
    for (int64_t k = 0; skin->count > 0 && k < s->self_close_count; k++) {
        int64_t p = s->self_close[k], facet = s->self_partner[p];
        int support = facet != SF_SKIN_NOTHING ? sf_skin_support(m, skin, p, facet) : -1;
        for (int r = 0; r < 3 && support >= 0; r++)
            force[support][r] +=
                sf_skin_is_rigid(skin, p) ? -s->self_force[3 * p + r] : s->self_force[3 * p + r];
    }
    for (int k = 0; k < m->support_count; k++) {
        for (int axis = 0; axis < 2; axis++)
            force[k][axis] *= !sf_symmetry_plane(m, axis, &place);
        s->support_force[k] = sqrt(sf_dot3(force[k], force[k]));
    }
}
