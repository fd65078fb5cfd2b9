/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/shape_plane.h"

#include "solver/contact/pair.h"

typedef struct plane {
    int axis;     /* of its normal */
    double place; /* m, on that axis */
    double side;  /* 1 or -1: the pad lies above or below it on that axis */
} plane;

static sf_status build(const sf_model *m, int body, double reach, void **data, sf_error *err) {
    (void)reach;
    double low[3], high[3];
    plane own = {.axis = body == SF_BODY_ANVIL ? 2 : body - SF_BODY_SYMMETRY_X, .side = 1};
    if (body >= SF_BODY_MISSILE || (body == SF_BODY_ANVIL && !(m->anvil.depth > 0) && m->rest_count == 0))
        return SF_OK;
    sf_box3(m->node_count, m->position, low, high);
    if (body == SF_BODY_ANVIL)
        own.place = sf_model_anvil_plane(m, high[2]);
    else if (!sf_symmetry_plane(m, own.axis, &own.place))
        return SF_OK;
    else if (own.place - low[own.axis] > high[own.axis] - own.place)
        own.side = -1;
    plane *kept = *data = sf_alloc(err, 1, sizeof *kept, "planes of contact");
    if (kept)
        *kept = own;
    return err->status;
}

static bool gap(const void *data, const double x[3], double *gap, double normal[3]) {
    const plane *own = data;
    *gap = own->side * (x[own->axis] - own->place);
    normal[0] = normal[1] = normal[2] = 0;
    normal[own->axis] = own->side;
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

const sf_shape sf_shape_plane = {.build = build,
                                 .release = free,
                                 .is_near = is_near,
                                 .gap = gap,
                                 .meet = meet,
                                 .entry = INFINITY,
                                 .deepest = INFINITY,
                                 .back = 0.1};
