/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A surface group as faces: the boundary faces whose nodes all belong to it. Its area by nodes, and the way
 * it looks. */
#ifndef SF_PRE_CLOUD_SURFACE_AREA_H
#define SF_PRE_CLOUD_SURFACE_AREA_H

#include "pre/cloud/dual.h"

enum { SF_ANY_LAYER = -1 };

/* Adds to area [mesh->node_count], m2, the share of each node by the median dual, as the volumes do; of the
 * faces of one layer only, unless it is SF_ANY_LAYER. */
sf_status sf_surface_area(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set, int layer,
                          double *area, sf_error *err);

typedef struct sf_surface_sides {
    double area;   /* m2 */
    double facing; /* m2, projected against the direction; negative: the group faces along it */
    double away;   /* m2, of the faces whose outward normal is within 60 degrees of the direction */
} sf_surface_sides;

/* How the group faces what comes along `direction` (unit vector). */
sf_status sf_surface_look(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set,
                          const double direction[3], sf_surface_sides *sides, sf_error *err);

#endif
