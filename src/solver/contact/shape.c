/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape.h"

#include "base/mat3.h"

const sf_shape *const sf_shapes[SF_SHAPES] = {&sf_shape_plane, &sf_shape_sphere, &sf_shape_surface,
                                              &sf_shape_face,  &sf_shape_edge,   &sf_shape_sharp};

const sf_shape *sf_shape_of(const sf_model *m, int body) {
    static const sf_shape *const missile[] = {
        [SF_SHAPE_SPHERE] = &sf_shape_sphere, [SF_SHAPE_SURFACE] = &sf_shape_surface};
    if (body == SF_BODY_MISSILE)
        return missile[m->missile.shape];
    return body == SF_BODY_PAD || body >= SF_BODY_SUPPORT ? &sf_shape_face : &sf_shape_plane;
}

sf_shape_triangles sf_shape_triangles_of(const sf_model *m, int body) {
    const sf_shape *shape = sf_shape_of(m, body);
    return shape->triangles ? shape->triangles(m) : (sf_shape_triangles){0};
}

sf_status sf_body_build(const sf_model *m, int number, sf_body *body, sf_error *err) {
    double reach = 0;
    for (int64_t c = 0; c < m->contact_count; c++)
        reach = fmax(reach, m->spacing[m->contact_node[c]]);
    *body = (sf_body){.shape = sf_shape_of(m, number)};
    if (body->shape->build(m, number, reach, &body->data, err) != SF_OK || !body->data)
        sf_body_free(body);
    return err->status;
}

void sf_body_free(sf_body *body) {
    if (body->data)
        body->shape->release(body->data);
    *body = (sf_body){0};
}
