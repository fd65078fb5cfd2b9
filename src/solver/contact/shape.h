/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bodies and their shapes. All that the pad may touch is a body of one of them: the missile is a
 * sphere cap or a surface of triangles, the anvil and the symmetry planes are planes, supports, other layers
 * and the pad itself are faces and edges. The row of a shape holds what contact does with it in the order of
 * a step: bodies are made, candidates listed, pairs found, each within the limits of the row. What a row has
 * no use for is NULL. A new shape is a file with its row, which shapes.c lists. */
#pragma once
#include "model/model.h"

typedef struct sf_contact_pair sf_contact_pair; /* contact/pair.h */
typedef struct sf_scene sf_scene;               /* likewise */
struct sf_listing;                              /* contact/listing.h */
struct sf_contact_system;                       /* contact/solve.h */

/* Bodies; supports are numbered from SF_BODY_SUPPORT on. */
enum {
    SF_BODY_PAD = -1,
    SF_BODY_ANVIL,
    SF_BODY_SYMMETRY_X,
    SF_BODY_SYMMETRY_Y,
    SF_BODY_MISSILE,
    SF_BODY_SUPPORT,
    SF_BODIES = SF_BODY_SUPPORT + SF_SUPPORTS
};

/* The partner of a point: the number of a facet of the skin, or one of these. */
enum { SF_NO_PARTNER = -1, SF_FIRST_BODY = -2 /* body b: SF_FIRST_BODY - b */ };

/* A body that is no part of the skin. Points are in its own frame: that of its position at t = 0. */
typedef struct sf_body {
    const struct sf_shape *shape; /* NULL: there is none */
    void *data;                   /* of the shape; owned */
} sf_body;

/* Triangles turned outwards; borrowed from the model. */
typedef struct sf_shape_triangles {
    int64_t node_count, count;
    const double *position;  /* [node_count][3] m */
    const int32_t *triangle; /* [count][3] */
} sf_shape_triangles;

typedef struct sf_shape {
    /* Makes the data of a body for points of the spacing `reach` (m), if the model's body has this shape. */
    sf_status (*build)(const sf_model *model, int body, double reach, void **data, sf_error *err);
    void (*release)(void *data);
    /* Returns whether the gap can be less than `margin` (m, from 0) at x; false is certain. */
    bool (*is_near)(const void *data, const double x[3], double margin);
    /* Finds the signed distance of x (negative inside) and the outward normal at the nearest place. Returns
     * false where the surface is out of reach, and beyond its rim. */
    bool (*gap)(const void *data, const double x[3], double *gap, double normal[3]);
    /* Returns the triangles of a body of this shape, whose sharp edges press the pad between its nodes. */
    sf_shape_triangles (*triangles)(const sf_model *model, int body);
    /* Lists the candidates of points, or of `add`, and marks the points that these need. */
    sf_status (*list)(const sf_scene *scene, struct sf_listing *listing, sf_error *err);
    /* Finds the normals that pairs need, of the skin as it lies now. */
    void (*turn)(const sf_scene *scene);
    /* Finds the pair of a point and a partner; false: they do not face each other. */
    bool (*meet)(const sf_scene *scene, int64_t point, int64_t partner, sf_contact_pair *out);
    /* Adds the pairs that are not those of points to the system; `most`: how many in a step. */
    sf_status (*add)(const sf_scene *scene, struct sf_contact_system *system, sf_error *err);
    int64_t (*most)(const sf_scene *scene);
    double entry, deepest; /* of the spacing: deepest gap of a pair that is new, and of one that goes on */
    double back;           /* m s-1, at which a depth is taken back at most */
} sf_shape;

static inline bool sf_body_is_near(const sf_body *body, const double x[3], double margin) {
    return body->shape->is_near(body->data, x, margin);
}
static inline bool sf_body_gap(const sf_body *body, const double x[3], double *gap, double normal[3]) {
    return body->shape->gap(body->data, x, gap, normal);
}
