/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shapes.h"

#include "base/mat3.h"
#include "solver/contact/shape_edge.h"
#include "solver/contact/shape_face.h"
#include "solver/contact/shape_plane.h"
#include "solver/contact/shape_sphere.h"
#include "solver/contact/shape_surface.h"
#include "solver/contact/sharp.h"

const sf_shape *const sf_shapes[] = {&sf_shape_plane,
                                     &sf_shape_sphere,
                                     &sf_shape_surface,
                                     &sf_shape_face,
                                     &sf_shape_edge,
                                     &sf_shape_sharp,
                                     NULL};

sf_shape_triangles sf_shape_triangles_of(const sf_model *m, int body) {
    sf_shape_triangles out = {0};
    for (int k = 0; sf_shapes[k] && out.count == 0; k++)
        if (sf_shapes[k]->triangles)
            out = sf_shapes[k]->triangles(m, body);
    return out;
}

sf_status sf_body_build(const sf_model *m, int number, sf_body *body, sf_error *err) {
    double reach = 0;
    for (int64_t c = 0; c < m->contact_count; c++)
        reach = fmax(reach, m->spacing[m->contact_node[c]]);
    *body = (sf_body){0};
    for (int k = 0; sf_shapes[k] && !body->data && err->status == SF_OK; k++)
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
