/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "solver/contact/contact_rows.h"

/* The faces of the pad that may touch the pad itself, the anvil, a symmetry plane or the rigid support, with
 * those of the support behind them, as the solver needs them (solver/contact/self_contact.h). */

/* A plane that stops the pad: that of the anvil, and those of symmetry, beyond which its mirror image is. */
enum {
    SF_SKIN_NOTHING = -1,
    SF_SKIN_FIRST_PLANE = -2
}; /* partners of a node that are no facet; plane k: FIRST_PLANE - k */
enum { SF_SKIN_ANVIL, SF_SKIN_SYMMETRY_X, SF_SKIN_SYMMETRY_Y, SF_SKIN_PLANES };
typedef struct sf_skin_plane {
    int axis;     /* of its normal */
    double place; /* m, on that axis */
    double side;  /* 1 or -1: the pad lies above or below it on that axis; 0: there is no plane */
} sf_skin_plane;

/* Constants of the skin. Its points are numbered from 0: first the nodes of the pad, ascending in the model,
 * then those of the support, which do not move, then the centroids of the pad's triangles, which are the mean
 * of three nodes. */
typedef struct sf_skin {
    int64_t count;  /* points; 0: nothing touches */
    int64_t moving; /* nodes of the pad */
    int64_t nodes;  /* of pad and support */
    int32_t *node;  /* [moving] of the model */
    int32_t *own;   /* [count - nodes] facet of each centroid */
    double *rest;   /* [count][3] m, position at rest */
    double *size;   /* [count] m, spacing; of a support's node the least of the pad */
    int64_t facet_count;
    int32_t *facet;    /* [facet_count][3] nodes of the skin, turned outwards */
    uint8_t *half;     /* [facet_count] as of sf_model.skin_half */
    int64_t *ring_ptr; /* [count + 1] */
    int32_t *ring;     /* [..] facets at each node; of a centroid its own */
    /* The parts into which sharp edges cut the surface round a node, its sides, have a normal each. The first
     * side of a point has its number. */
    int32_t *side;      /* [facet_count][3] of the facet's nodes that the facet belongs to */
    int32_t *next_side; /* [..] next side of the same node; -1: none */
    /* The sharp convex edges of a pad that touches itself: two nodes, and the third nodes of both facets; -1
     * or -2 for the mirror image of the first facet, beyond the symmetry plane normal to x or y. */
    int64_t edge_count;
    int32_t *edge;    /* [edge_count][4] */
    int32_t *edge_of; /* [facet_count][3] from a facet's node to its next, at one facet; -1: none */
    uint8_t *held;    /* [count] SF_FIX_* bits; of a support's node those of the symmetry planes it is on */
    uint8_t *passive; /* [count] 1: touches no support: on a flat part of one, or a centroid */
    uint8_t *rests;   /* [count] 1: the anvil presses the node in the missile's solve (contact.h) */
    double *normal;   /* [count][3] outward at rest, unit */
    double *facet_normal; /* [facet_count][3] likewise */
    bool alone;           /* the pad touches the supports only */
    bool watched;         /* its pairs with itself have no forces */
    sf_skin_plane plane[SF_SKIN_PLANES];
    double spacing; /* m, smallest of the skin */
    sf_contact_rows rows;
} sf_skin;

sf_status sf_skin_build(const sf_model *model, sf_skin *skin, sf_error *err);
void sf_skin_free(sf_skin *skin);

static inline bool sf_skin_is_rigid(const sf_skin *skin, int64_t node) {
    return node >= skin->moving && node < skin->nodes;
}

/* The nodes whose mean a point is, 1 or 3, and number k of them. */
static inline int sf_skin_members(const sf_skin *skin, int64_t point) {
    return point < skin->nodes ? 1 : 3;
}
static inline int64_t sf_skin_member(const sf_skin *skin, int64_t point, int k) {
    return point < skin->nodes ? point : skin->facet[3 * (int64_t)skin->own[point - skin->nodes] + k];
}

/* True if plane k may stop the node: not if it is held there, or rests on the anvil already. */
static inline bool sf_skin_is_stopped(const sf_skin *skin, int64_t node, int k) {
    return skin->plane[k].side != 0 && node < skin->moving &&
           !((skin->held[node] >> skin->plane[k].axis) & 1) && !(k == SF_SKIN_ANVIL && skin->rests[node]);
}

/* Height (m) of the point x over plane k. */
static inline double sf_skin_height(const sf_skin *skin, const double x[3], int k) {
    const sf_skin_plane *plane = &skin->plane[k];
    return plane->side * (x[plane->axis] - plane->place);
}

/* The nodes among which a force on a facet is shared: 4 of a quadrangle, 3 of a triangle; 0 of a plane, whose
 * number is below 0. */
static inline int sf_skin_corners(const sf_skin *skin, int64_t facet) {
    return facet < 0 ? 0 : skin->half[facet] ? 4 : 3;
}

/* Node k of them: those of the facet, then that of the other half of its quadrangle. */
static inline int64_t sf_skin_corner(const sf_skin *skin, int64_t facet, int k) {
    return skin->facet[3 * facet + (k < 3 ? k : skin->half[facet] == 1 ? 5 : -2)];
}

/* The support in a pair of node and facet (below 0: a plane); -1: none. */
static inline int sf_skin_support(const sf_model *model, const sf_skin *skin, int64_t node, int64_t facet) {
    int64_t own = sf_skin_is_rigid(skin, node) ? skin->ring[skin->ring_ptr[node]] : facet;
    return own >= model->skin_count ? model->support_part[own - model->skin_count] : -1;
}
