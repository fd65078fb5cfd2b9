/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes and bodies. All that a point of the pad may touch is a body of one of them: the missile is a sphere
 * cap or a surface of triangles, the anvil and the symmetry planes are planes, supports, other layers and the
 * pad itself are faces. The row of a shape says which points are near, and how gap and
 * normal are found; the lists of points near a face are those of the whole skin (contact/broad.c). */
#pragma once
#include "model/model.h"

typedef struct sf_contact_pair sf_contact_pair; /* contact/pair.h */
typedef struct sf_scene sf_scene;

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

typedef struct sf_shape {
    /* Makes the data of the missile's shape for points of the spacing `reach` (m). */
    sf_status (*build)(const sf_model *model, double reach, void **data, sf_error *err);
    void (*release)(void *data);
    /* Returns whether the gap can be less than `margin` (m, from 0) at x; false is certain. */
    bool (*is_near)(const void *data, const double x[3], double margin);
    /* Finds the signed distance of x (negative inside) and the outward normal at the nearest place. Returns
     * false where the surface is out of reach, and beyond its rim. */
    bool (*gap)(const void *data, const double x[3], double *gap, double normal[3]);
    /* Finds the pair of a point and a partner; false: they do not face each other. */
    bool (*meet)(const sf_scene *scene, int64_t point, int64_t partner, sf_contact_pair *out);
    double entry, deepest; /* of the spacing: deepest gap of a pair that is new, and of one that goes on */
    double back;           /* m s-1, at which a depth of the skin is taken back at most */
} sf_shape;

/* The table. A new row is a file and its line here; that of a missile has a place in the list of shapes.c. */
extern const sf_shape sf_shape_sphere;  /* an exact cap */
extern const sf_shape sf_shape_surface; /* rigid triangles */
extern const sf_shape sf_shape_plane;   /* normal to an axis */
extern const sf_shape sf_shape_face;    /* faces of the pad, and of supports */

static inline bool sf_body_is_near(const sf_body *body, const double x[3], double margin) {
    return body->shape->is_near(body->data, x, margin);
}
static inline bool sf_body_gap(const sf_body *body, const double x[3], double *gap, double normal[3]) {
    return body->shape->gap(body->data, x, gap, normal);
}
