/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape.h"

#include "base/mat3.h"

#define ADDRESS(name) &sf_shape_##name,
const sf_shape *const sf_shapes[SF_SHAPES] = {SF_SHAPE_ROWS(ADDRESS)};

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
    for (int k = 0; k < SF_SHAPES && !body->data && err->status == SF_OK; k++)
        if (sf_shapes[k]->build) {
            body->shape = sf_shapes[k];
            sf_shapes[k]->build(m, number, reach, &body->data, err);
        }
    if (err->status != SF_OK || !body->data)
        sf_body_free(body);
    return err->status;
}

void sf_body_free(sf_body *body) {
    if (body->data)
        body->shape->release(body->data);
    *body = (sf_body){0};
}
