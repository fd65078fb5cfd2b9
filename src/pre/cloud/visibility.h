/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which nodes do not see each other although they are near? The support of a node is a ball; across a slit or
 * a gap it would join what is apart. Two nodes see each other if mesh edges lead from one to the other
 * without leaving a ball that is little larger than their distance (docs/adr/0015). */
#ifndef SF_PRE_CLOUD_VISIBILITY_H
#define SF_PRE_CLOUD_VISIBILITY_H

#include "base/error.h"
#include "pre/cloud/dual.h"
#include "pre/cloud/neighbours.h"
#include "pre/mesh/mesh.h"

/* The nodes hidden from one node. */
typedef struct sf_hidden {
    int64_t count;
    int32_t *node; /* [count] ascending; NULL if there is none */
} sf_hidden;

/* For every node the hidden ones among those whose support meets the ball of radius reach[node] (m) about it.
 * In a convex body there is none. The same for any number of threads. Returns [mesh->node_count], owned by
 * the caller (sf_visibility_free), or NULL. */
sf_hidden *sf_visibility_build(const sf_mesh *mesh, const sf_dual *dual, const sf_grid *grid,
                               const double *reach, sf_error *err);
void sf_visibility_free(sf_hidden *hidden, int64_t node_count);

/* Removes the hidden nodes from the `count` ascending candidates; returns how many remain. */
int64_t sf_visibility_filter(const sf_hidden *hidden, int64_t count, int32_t *candidate);

#endif
