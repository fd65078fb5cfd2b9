/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Volume, centroid and inertia of the solid inside a closed surface of triangles, for unit density. */
#ifndef SF_CORE_SOLID_H
#define SF_CORE_SOLID_H

#include "base/error.h"
#include <stdint.h>

typedef struct sf_solid {
    double volume;      /* m3 */
    double centroid[3]; /* m */
    double inertia[6];  /* m5, the tensor about the centroid: xx = integral of y^2 + z^2, xy = -integral of x
                           y;  stored (xx, yy, zz, xy, yz, xz) like base/mat3.h */
} sf_solid;

/* Exact for the polyhedron that the triangles bound. `position` [node_count][3] m, `triangle`
 * [triangle_count][3] turned outwards. SF_ERR_MODEL unless each edge belongs to exactly two triangles that
 * run through it in opposite directions (open, branching or wrongly turned surfaces; nodes that coincide are
 * not joined), and the volume is positive. The surface may have several parts and hollows; it is not checked
 * for intersections. */
sf_status sf_solid_measure(int64_t node_count, const double *position, int64_t triangle_count,
                           const int32_t *triangle, sf_solid *solid, sf_error *err);

#endif
