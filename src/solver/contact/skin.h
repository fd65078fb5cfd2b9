/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/mat3.h"
#include "solver/point_rows.h"
#include "solver/contact/shape.h"

/* Points and faces of the pad in one solve of contact (contact/contact.h). Those of the skin may touch the
 * pad itself, the anvil, a symmetry plane or the rigid supports, whose faces are behind them. The contact
 * points touch the missile, and behind them the base of a resting pad the anvil; their faces are those that
 * sharp edges of the missile may press. */

/* Constants. The points of the skin are numbered from 0: first the nodes of the pad, ascending in the model,
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
    int64_t faces;  /* of the pad, the first facets */
    int64_t facet_count;
    int32_t *facet; /* [facet_count][3] nodes of the skin, turned outwards; of a section two and the first */
    uint8_t *half;  /* [facet_count] as of sf_model.skin_half */
    int64_t *ring_ptr; /* [count + 1] */
    int32_t *ring;     /* [..] facets at each node; of a centroid its own */
    /* The parts into which sharp edges cut the surface round a node, its sides, have a normal each. The first
     * side of a point has its number. */
    int32_t *side;      /* [facet_count][3] of the facet's nodes that the facet belongs to */
    int32_t *next_side; /* [..] next side of the same node; -1: none */
    /* The edges of two of the pad's faces: two nodes, and the third nodes of both; -1 or -2 for the mirror
     * image of the first face, beyond the symmetry plane normal to x or y. Of a section the sides,
     * counter-clockwise, and two times SF_NO_FACES. */
    int64_t line_count;
    int32_t *line;       /* [line_count][4] */
    int32_t *line_of;    /* [facet_count][3] from a facet's node to its next, at one facet; -1: none */
    int64_t sharp_count; /* the first lines: sharp and convex edges of a pad that touches itself */
    uint8_t *held;    /* [count] SF_FIX_* bits; of a support's node those of the symmetry planes it is on */
    uint8_t *passive; /* [count] 1: touches no support: on a flat part of one, or a centroid */
    uint8_t
        *touches;   /* [count] bits 1 << SF_BODY_* of the bodies that may touch the point, but for supports */
    double *normal; /* [count][3] outward at rest, unit */
    double *facet_normal; /* [facet_count][3] likewise */
    bool alone;           /* the pad touches the supports only */
    bool watched;         /* its pairs with itself have no forces */
    double spacing;       /* m, smallest of the skin, or of the points that the missile may touch */
    double plane[2];      /* m, places of the symmetry planes normal to x and y; NAN: there is none */
    double on_plane;      /* m, how near to one a point lies in it */
    sf_point_rows rows;
} sf_skin;

enum { SF_NO_FACES = -3 };

/* Returns the bits of the symmetry planes, 1 normal to x and 2 to y, that a place (m) at rest lies in. */
int sf_skin_planes_at(const sf_skin *skin, const double x[3]);

sf_status sf_skin_build(const sf_model *model, sf_skin *skin, sf_error *err);
sf_status sf_skin_build_contact(const sf_model *model, sf_skin *skin, sf_error *err);
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

static inline bool sf_skin_touches(const sf_skin *skin, int64_t point, int number) {
    return skin->touches[point] >> number & 1;
}

/* True if both are facets, and have a node in common. */
static inline bool sf_skin_facets_meet(const sf_skin *skin, int64_t one, int64_t other) {
    for (int k = 0; k < 9 && one >= 0 && other >= 0; k++)
        if (skin->facet[3 * one + k / 3] == skin->facet[3 * other + k % 3])
            return true;
    return false;
}

/* The vector from the first node of a line to its third node number k, 2 or 3. */
static inline void sf_skin_third(const double *position, const int32_t line[4], int k, double out[3]) {
    sf_sub3(&position[3 * (int64_t)line[line[k] < 0 ? 2 : k]], &position[3 * (int64_t)line[0]], out);
    if (line[k] < 0)
        out[-1 - line[k]] *= -1;
}

/* The nodes among which a force on a facet is shared: 4 of a quadrangle, 3 of a triangle; 0 of a plane, whose
 * number is below 0. */
static inline int sf_skin_corners(const sf_skin *skin, int64_t facet) {
    if (facet < 0)
        return 0;
    return skin->half[facet] ? 4 : 3;
}

/* Node k of them: those of the facet, then that of the other half of its quadrangle. */
static inline int64_t sf_skin_corner(const sf_skin *skin, int64_t facet, int k) {
    if (k < 3)
        return skin->facet[3 * facet + k];
    return skin->facet[3 * facet + (skin->half[facet] == 1 ? 5 : -2)];
}

/* The support in a pair of node and facet (below 0: a plane); -1: none. */
static inline int sf_skin_support(const sf_model *model, const sf_skin *skin, int64_t node, int64_t facet) {
    int64_t own = sf_skin_is_rigid(skin, node) ? skin->ring[skin->ring_ptr[node]] : facet;
    return own >= model->skin_count ? model->support_part[own - model->skin_count] : -1;
}
