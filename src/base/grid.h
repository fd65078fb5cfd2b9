/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A uniform grid over points, which finds those whose own balls reach a ball; radii differ from point to
 * point. */
#pragma once
#include "base/error.h"

typedef struct sf_grid {
    const double *position; /* [n][3] m, borrowed */
    const double *support;  /* [n] m, borrowed */
    double origin[3];       /* m */
    double width;           /* m, edge of a bin, at least the largest support */
    int64_t bins[3];
    int64_t *start; /* [bins + 1] */
    int32_t *node;  /* [n] by bin, ascending within a bin */
} sf_grid;

/* Builds the grid over `count` nodes; `position` and `support` must outlive it and keep their values. */
sf_status sf_grid_build(sf_grid *grid, int64_t count, const double *position, const double *support,
                        sf_error *err);
void sf_grid_free(sf_grid *grid);

/* The same in memory of the caller, who releases it: `start` has SF_GRID_STARTS(count) items, `node` has
 * `count`. */
#define SF_GRID_STARTS(count) (4 * (count) + 68) /* at least the bins and 2 */
void sf_grid_fill(sf_grid *grid, int64_t count, const double *position, const double *support, int64_t *start,
                  int32_t *node);

/* Writes up to `limit` nodes J with |X_J - centre| < R_J + radius to `out`, ascending; returns how many there
 * are (more than `limit` means that `out` holds only the first ones found). */
int64_t sf_grid_query(const sf_grid *grid, const double centre[3], double radius, int64_t limit,
                      int32_t *out);
/* The same in the order of the bins. */
int64_t sf_grid_gather(const sf_grid *grid, const double centre[3], double radius, int64_t limit,
                       int32_t *out);

/* Finds a ball round a triangle, as a point of a grid: its centroid, and the largest distance of a corner. */
void sf_grid_ball(const double *position, const int32_t node[3], double centre[3], double *radius);
