/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The area of a surface group that belongs to each of its nodes: by the median dual, as the volumes do. */
#ifndef SF_PRE_CLOUD_SURFACE_AREA_H
#define SF_PRE_CLOUD_SURFACE_AREA_H

#include "pre/cloud/dual.h"

/* Adds to area [mesh->node_count], m2, the shares of the boundary faces whose nodes all belong to `set`. */
sf_status sf_surface_area(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set, double *area,
                          sf_error *err);

#endif
