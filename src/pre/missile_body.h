/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile as a body: its impact point on the pad's top, where its lowest point arrives, and the centre of
 * mass and inertia of one with six degrees of freedom. */
#pragma once
#include "case/case.h"
#include "pre/mesh/mesh.h"

/* The missile's lowest point (m): of its sphere, or of its surface's nodes; where several are lowest the
 * centroid of the flat faces there, or, without such faces, the middle of the box around these nodes. */
void sf_impact_lowest(const sf_surface *surface, const sf_missile_card *card, double point[3]);

/* Height (m) of the pad's highest point. */
double sf_impact_top(const sf_model *model);

/* Moves the surface, and the card's sphere, in x and y so that the lowest point, on its way along
 * the direction, comes to missile.position at the height of the pad's highest point. Normal to a symmetry
 * plane nothing moves. Does nothing without missile.position. The card's shape is set, its body not yet;
 * the model has its cloud and its sets. SF_ERR_INPUT: the position lies off a
 * symmetry plane, or outside the convex outline of the contact nodes. */
sf_status sf_impact_place(const sf_case *c, const sf_model *model, sf_surface *surface, sf_missile_card *card,
                          sf_error *err);

/* The impact point (m) of a complete model, by the same rule; on its symmetry planes. */
void sf_impact_point(const sf_model *model, double point[3]);

/* Volume, centroid and inertia of the solid inside a closed surface of triangles, for unit density. */

typedef struct sf_solid {
    double volume;      /* m3 */
    double centroid[3]; /* m */
    double inertia[6];  /* m5, the tensor about the centroid: xx = integral of y^2 + z^2, xy = -integral of x
                           y;  stored (xx, yy, zz, xy, yz, xz) like base/mat3.h */
} sf_solid;

/* Exact for the polyhedron that the triangles bound. `position` [node_count][3] m, `triangle`
 * [triangle_count][3] turned out of the material, into cavities. SF_ERR_MODEL unless each edge belongs to
 * exactly two triangles that run through it in opposite directions (open, branching or wrongly turned
 * surfaces; nodes that coincide are not joined), and the volume is positive. SF_ERR_INPUT: closed parts
 * overlap, or one within another is not turned into a cavity. */
sf_status sf_solid_measure(int64_t node_count, const double *position, int64_t triangle_count,
                           const int32_t *triangle, sf_solid *solid, sf_error *err);

/* The missile's solid: its cells (of a whole model), or the inside of its closed surface; where the surface
 * is a sphere, with what lies between the triangles and the sphere. */
typedef struct sf_missile_body {
    sf_solid solid;
    sf_error none; /* why there is none; SF_ERR_INPUT: its parts overlap */
} sf_missile_body;

/* Finds the body, and sets freedom, centre, inertia and angular velocity of the model's missile by the case;
 * what the case does not give comes from the body, with uniform density. The missile has mass and shape; the
 * surface is not placed yet, the centre lies by it. SF_ERR_INPUT: a free missile has no body, or none can
 * have this inertia. */
sf_status sf_missile_take_body(const sf_case *c, const sf_surface *surface, sf_model *model,
                               sf_missile_body *body, sf_error *err);
