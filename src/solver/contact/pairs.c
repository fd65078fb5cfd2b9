/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/pairs.h"

int64_t sf_pair_last(const sf_scene *c, int64_t p) {
    const double *force = &c->at->force[3 * p];
    if (!c->response)
        return c->at->partner[p];
    return sf_dot3(force, force) == 0
               ? SF_NO_PARTNER
               : SF_FIRST_BODY -
                     (sf_skin_touches(c->skin, p, SF_BODY_ANVIL) ? SF_BODY_ANVIL : SF_BODY_MISSILE);
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
    bool slowly = !c->response && sf_pair_acts(c, &q); /* missile and resting base take back all of it */
    if (!sf_pair_closes(&q, slowly ? shape->back * c->state->dt : INFINITY))
        return;
    t->nearest = distance;
    *t->out = q;
}

bool sf_pair_find(const sf_scene *c, int64_t p, sf_contact_pair *out, sf_contact_pair *passed) {
    const int32_t *facet = c->response ? NULL : &c->at->candidate[SF_SELF_CANDIDATES * p];
    search t = {.scene = c,
                .point = p,
                .last = sf_pair_last(c, p),
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
