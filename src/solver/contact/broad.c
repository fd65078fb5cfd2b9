/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/broad.h"

#include "solver/contact/listing.h"
#include "solver/contact/shapes.h"

/* Reach of the lists, and the part of it at which they are made anew if it is more than twice a step's
 * travel; spacings. Of contact points, and of the skin. */
static const double CONTACT_REACH = 2, CONTACT_REST = 1, SKIN_REACH = 1.2, SKIN_REST = 0.36;
static const char purpose[] = "candidates of contact";

bool sf_broad_is_due(const sf_scene *c) {
    const sf_state *s = c->state;
    double rest = (c->response ? CONTACT_REST : SKIN_REST) * c->skin->spacing,
           speed = c->skin->rows.spread * s->fastest;
    speed += c->response ? sf_missile_fastest(c->model, &s->missile) : speed;
    c->at->room -= s->dt_old * speed;
    if (s->step > 0 && c->at->room > fmax(rest, 2 * s->dt * speed))
        return false;
    for (int64_t p = 0; p < c->skin->count; p++)
        c->at->near[p] = (int32_t)p;
    c->at->near_count = c->skin->count;
    return true;
}

/* True if a body that is no part of the skin may touch the point within the reach of the lists, of which
 * their room may be no more than a step's travel; the anvil may touch what rests on it at any time. */
static bool meets_body(const sf_scene *c, int64_t p, double reach) {
    const double *x = &c->at->position[3 * p];
    for (int k = 0; k <= SF_BODY_MISSILE; k++)
        if (sf_skin_touches(c->skin, p, k) &&
            (k == SF_BODY_MISSILE ? sf_missile_near(c->model, &c->state->missile, &c->body[k], x, reach)
                                  : c->response || sf_body_is_near(&c->body[k], x, reach)))
            return true;
    return false;
}

/* Lists the nodes whose positions and normals a step needs, from those that are used. */
static void list_nodes(const sf_scene *c, const sf_listing *l) {
    const sf_skin *skin = c->skin;
    uint8_t *used = l->used;
    sf_contact_points *at = c->at;
    at->close_count = at->near_count = 0;
    for (int64_t p = 0; p < skin->count; p++)
        if (used[p] || meets_body(c, p, l->reach)) {
            used[p] = 1;
            at->close[at->close_count++] = (int32_t)p;
        }
    for (int64_t k = 0; k < at->close_count && !c->response; k++)
        for (int64_t e = skin->ring_ptr[at->close[k]]; e < skin->ring_ptr[at->close[k] + 1]; e++)
            for (int a = 0; a < 3; a++)
                used[skin->facet[3 * (int64_t)skin->ring[e] + a]] = 1;
    for (int64_t p = 0; p < skin->count; p++)
        if (used[p])
            at->near[at->near_count++] = (int32_t)p;
}

sf_status sf_broad_list(const sf_scene *c, sf_error *err) {
    sf_listing l = {.used = sf_workspace_take(&c->at->work.used, c->skin->count, 1, purpose, err),
                    .reach = (c->response ? CONTACT_REACH : SKIN_REACH) * c->skin->spacing};
    SF_TRY(err->status);
    memset(l.used, 0, (size_t)c->skin->count);
    c->at->room = l.reach;
    for (int k = 0; sf_shapes[k]; k++)
        if (sf_shapes[k]->list)
            SF_TRY(sf_shapes[k]->list(c, &l, err));
    list_nodes(c, &l);
    return SF_OK;
}
