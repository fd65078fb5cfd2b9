/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shapes.h"

#include "base/mat3.h"
#include "solver/contact/shape_plane.h"

/* The missile's shapes, by SF_SHAPE_*. */
static const sf_shape *const shapes[] = {
    [SF_SHAPE_SPHERE] = &sf_shape_sphere, [SF_SHAPE_SURFACE] = &sf_shape_surface};

sf_status sf_body_of_missile(const sf_model *m, sf_body *body, sf_error *err) {
    double reach = 0;
    for (int64_t c = 0; c < m->contact_count; c++)
        reach = fmax(reach, m->spacing[m->contact_node[c]]);
    *body = (sf_body){.shape = shapes[m->missile.shape]};
    if (body->shape->build(m, reach, &body->data, err) != SF_OK)
        sf_body_free(body);
    return err->status;
}

sf_status sf_bodies_of_planes(const sf_model *m, double spacing, sf_body *body, sf_error *err) {
    double low[3], high[3], place;
    sf_box3(m->node_count, m->position, low, high);
    if (m->anvil.depth > 0)
        sf_plane_build(&(sf_plane){2, sf_model_anvil_plane(m, high[2]), 1}, &body[SF_BODY_ANVIL], err);
    for (int axis = 0; axis < 2; axis++)
        if (sf_symmetry_plane(m, axis, &place))
            sf_plane_build(&(sf_plane){axis, place, low[axis] < place - 0.5 * spacing ? -1 : 1},
                           &body[SF_BODY_SYMMETRY_X + axis], err);
    return err->status;
}

void sf_body_free(sf_body *body) {
    if (body->data)
        body->shape->release(body->data);
    *body = (sf_body){0};
}
