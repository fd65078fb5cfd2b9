/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape_plane.h"

#include "solver/contact/pair.h"

sf_status sf_plane_build(const sf_plane *plane, sf_body *body, sf_error *err) {
    sf_plane *data = sf_alloc(err, 1, sizeof *data, "planes of contact");
    if (data)
        *data = *plane;
    *body = (sf_body){&sf_shape_plane, data};
    return err->status;
}

static bool gap(const void *data, const double x[3], double *gap, double normal[3]) {
    const sf_plane *plane = data;
    *gap = plane->side * (x[plane->axis] - plane->place);
    normal[0] = normal[1] = normal[2] = 0;
    normal[plane->axis] = plane->side;
    return true;
}

static bool is_near(const void *data, const double x[3], double margin) {
    double height, normal[3];
    return gap(data, x, &height, normal) && height < margin;
}

/* For a point that rests the plane goes through its place at rest, where it has settled. */
static bool meet(const sf_scene *c, int64_t p, int64_t partner, sf_contact_pair *q) {
    const double *x = &c->at->position[3 * p];
    if (!c->response)
        return sf_body_gap(&c->body[SF_FIRST_BODY - partner], x, &q->gap, q->normal);
    q->gap = x[2] - c->skin->rest[3 * p + 2];
    memcpy(q->normal, (const double[3]){0, 0, 1}, sizeof q->normal);
    return true;
}

const sf_shape sf_shape_plane = {.release = free,
                                 .is_near = is_near,
                                 .gap = gap,
                                 .meet = meet,
                                 .entry = INFINITY,
                                 .deepest = INFINITY,
                                 .back = 0.1};
