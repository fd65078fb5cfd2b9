/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape.h"

#include "base/mat3.h"

const sf_shape *const sf_shapes[SF_SHAPES] = {&sf_shape_plane, &sf_shape_sphere, &sf_shape_surface,
                                              &sf_shape_face,  &sf_shape_edge,   &sf_shape_sharp};

sf_shape_triangles sf_shape_triangles_of(const sf_model *m, int body) {
    sf_shape_triangles out = {0};
    for (int k = 0; k < SF_SHAPES && out.count == 0; k++)
        if (sf_shapes[k]->triangles)
            out = sf_shapes[k]->triangles(m, body);
    return out;
}

sf_status sf_body_build(const sf_model *m, int number, sf_body *body, sf_error *err) {
    double reach = 0;
    for (int64_t c = 0; c < m->contact_count; c++)
        reach = fmax(reach, m->spacing[m->contact_node[c]]);
    *body = (sf_body){0};
    for (int k = 0; k < SF_SHAPES && !body->data; k++) {
        body->shape = sf_shapes[k];
        if (sf_shapes[k]->build && sf_shapes[k]->build(m, number, reach, &body->data, err) != SF_OK)
            sf_body_free(body);
        SF_TRY(err->status);
    }
    if (!body->data)
        body->shape = NULL;
    return SF_OK;
}

void sf_body_free(sf_body *body) {
    if (body->data)
        body->shape->release(body->data);
    *body = (sf_body){0};
}
