/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/grid.h"

#include "base/sets.h"

#include "base/mat3.h"

#include <string.h>

static int64_t bin_of(const sf_grid *grid, int axis, double x) {
    double b = floor((x - grid->origin[axis]) / grid->width);
    return (int64_t)fmin(fmax(0, b), (double)(grid->bins[axis] - 1));
}

static int64_t bin_index(const sf_grid *grid, const double x[3]) {
    return (bin_of(grid, 0, x[0]) * grid->bins[1] + bin_of(grid, 1, x[1])) * grid->bins[2] +
           bin_of(grid, 2, x[2]);
}

static int64_t count_bins(sf_grid *grid, const double low[3], const double high[3]) {
    for (int c = 0; c < 3; c++)
        grid->bins[c] = (int64_t)((high[c] - low[c]) / grid->width) + 1;
    return grid->bins[0] * grid->bins[1] * grid->bins[2];
}

/* Sets all but the arrays. The number of bins is bounded: one outsized support would make every bin huge, and
 * one tiny one would make too many. Points on a line or in a plane need wider bins than the volume of their
 * box says. Returns the number. */
static int64_t lay_bins(sf_grid *grid, int64_t count, const double *position, const double *support) {
    double low[3], high[3], volume = 1;
    *grid = (sf_grid){.position = position, .support = support};
    sf_box3(count, position, low, high);
    for (int64_t i = 0; i < count; i++)
        grid->width = fmax(grid->width, support[i]);
    for (int c = 0; c < 3; c++)
        volume *= high[c] - low[c] + grid->width;
    grid->width = fmax(grid->width, cbrt(volume / (4.0 * (double)count + 64)));
    if (!(grid->width > 0)) /* points without supports at one place or in a plane */
        grid->width = 1;
    memcpy(grid->origin, low, sizeof low);
    while (count_bins(grid, low, high) > 4 * count + 64)
        grid->width *= 1.25;
    return count_bins(grid, low, high);
}

/* Sorts the nodes by bin; the bins' starts are zeros. */
static void sort_nodes(sf_grid *grid, int64_t count, int64_t bins) {
    for (int64_t i = 0; i < count; i++)
        grid->start[bin_index(grid, &grid->position[3 * i]) + 2]++;
    for (int64_t b = 0; b < bins; b++)
        grid->start[b + 2] += grid->start[b + 1];
    for (int64_t i = 0; i < count; i++)
        grid->node[grid->start[bin_index(grid, &grid->position[3 * i]) + 1]++] = (int32_t)i;
}

sf_status sf_grid_build(sf_grid *grid, int64_t count, const double *position, const double *support,
                        sf_error *err) {
    int64_t bins = lay_bins(grid, count, position, support);
    SF_ALLOC_ALL(err, "neighbour grid", SF_ROOM(grid->start, bins + 2), SF_ROOM(grid->node, count));
    if (err->status == SF_OK)
        sort_nodes(grid, count, bins);
    else
        sf_grid_free(grid);
    return err->status;
}

void sf_grid_fill(sf_grid *grid, int64_t count, const double *position, const double *support, int64_t *start,
                  int32_t *node) {
    int64_t bins = lay_bins(grid, count, position, support);
    grid->start = start;
    grid->node = node;
    memset(start, 0, (size_t)(bins + 2) * sizeof *start);
    sort_nodes(grid, count, bins);
}

void sf_grid_free(sf_grid *grid) {
    SF_CLEAR(grid, grid->start, grid->node);
}

int64_t sf_grid_gather(const sf_grid *grid, const double centre[3], double radius, int64_t limit,
                       int32_t *out) {
    int64_t found = 0, low[3], high[3];
    for (int c = 0; c < 3; c++) {
        low[c] = bin_of(grid, c, centre[c] - radius - grid->width);
        high[c] = bin_of(grid, c, centre[c] + radius + grid->width);
    }
    for (int64_t i = low[0]; i <= high[0]; i++)
        for (int64_t j = low[1]; j <= high[1]; j++) {
            int64_t row = (i * grid->bins[1] + j) * grid->bins[2];
            for (int64_t k = grid->start[row + low[2]]; k < grid->start[row + high[2] + 1]; k++) {
                int32_t node = grid->node[k];
                const double *p = &grid->position[3 * node];
                double dx = p[0] - centre[0], dy = p[1] - centre[1], dz = p[2] - centre[2];
                double reach = grid->support[node] + radius;
                if (dx * dx + dy * dy + dz * dz >= reach * reach)
                    continue;
                if (found < limit)
                    out[found] = node;
                found++;
            }
        }
    return found;
}

int64_t sf_grid_query(const sf_grid *grid, const double centre[3], double radius, int64_t limit,
                      int32_t *out) {
    int64_t found = sf_grid_gather(grid, centre, radius, limit, out);
    qsort(out, (size_t)(found < limit ? found : limit), sizeof *out, sf_by_number);
    return found;
}

void sf_grid_ball(const double *position, const int32_t node[3], double centre[3], double *radius) {
    const double *corner[3];
    sf_corners(position, node, corner);
    *radius = 0;
    for (int r = 0; r < 3; r++)
        centre[r] = (corner[0][r] + corner[1][r] + corner[2][r]) / 3;
    for (int k = 0; k < 3; k++)
        *radius = fmax(*radius, sf_distance3(corner[k], centre));
}
