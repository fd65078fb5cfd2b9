/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moving least squares shape functions: linear basis, cubic B-spline weight with one radius per node
 * (Belytschko, Lu, Gu 1994; theory eq. 1-3); and the nodes that do not see each other. The basis is shifted
 * to the point of evaluation and scaled by the local radius. */
#pragma once
#include "base/grid.h"
#include "pre/cloud/dual.h"

enum { SF_MLS_MAX_NODES = 1024 };

/* The nodes that the approximation is built on; borrowed. */
typedef struct sf_mls_cloud {
    const double *position; /* [n][3] m */
    const double *support;  /* [n] m, R */
    bool is_plane;          /* all of them and the points of evaluation lie in y = 0: y is left out */
} sf_mls_cloud;

/* Shape functions at one point. */
typedef struct sf_mls_point {
    int count;                      /* nodes whose support covers the point */
    int32_t node[SF_MLS_MAX_NODES]; /* in the order of the candidates */
    double value[SF_MLS_MAX_NODES]; /* phi */
    double condition;               /* 1-norm condition number of the moment matrix; infinite if singular */
} sf_mls_point;

/* Evaluates phi at `x` from `count` candidate nodes (those out of reach are skipped). Returns 0, or -1 when
 * the moment matrix is singular or too many nodes reach the point: only `count` and `condition` are set then.
 */
int sf_mls_evaluate(const sf_mls_cloud *cloud, const double x[3], int64_t count, const int32_t *candidate,
                    sf_mls_point *out);

/* Cubic B-spline weight of q = distance / R: 2/3 at 0, zero from 1 on. */
double sf_mls_weight(double q);

/* Which nodes do not see each other although they are near? The support of a node is a ball; across a slit or
 * a gap it would join what is apart. Two nodes see each other if mesh edges lead from one to the other
 * without leaving a ball that is little larger than their distance (docs/adr/0015). */

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
