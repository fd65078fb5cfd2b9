/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/axis.h"

/* A point closer to an end than this part of the thickness is at the end. */
static const double AT_END = 1e-6;

/* Files of earlier versions do not say where the planes are, nor do those where all nodes of a plane are of
 * the base too. A symmetry plane is an end of the modelled pad, where a whole missile has its middle, or one
 * that is modelled in part ends too: how many of the pad's two ends are such; *place (m) of the last. */
static int count_common_ends(const sf_results *r, int k, double *place) {
    double low[3], high[3], first[3], last[3];
    int count = 0;
    sf_box3(r->node_count, r->position, low, high);
    sf_box3(r->surface_node_count, r->surface_position, first, last);
    const double pad[2] = {low[k], high[k]}, marks[3] = {0.5 * (first[k] + last[k]), first[k], last[k]};
    for (int end = 0; end < 2; end++) {
        double off = INFINITY;
        for (int mark = 0; mark < 3; mark++)
            off = fmin(off, fabs(marks[mark] - pad[end]));
        if (off > AT_END * r->thickness)
            continue;
        *place = pad[end];
        count++;
    }
    return count;
}

bool sf_axis_planes(const sf_results *r, double place[2]) {
    place[0] = r->symmetry_place[0];
    place[1] = r->symmetry_place[1];
    if (r->symmetry_factor == 1 << (isfinite(place[0]) + isfinite(place[1])))
        return true;
    double end[2];
    const int count[2] = {count_common_ends(r, 0, &end[0]), count_common_ends(r, 1, &end[1])};
    bool known = r->symmetry_factor == 4 ? count[0] == 1 && count[1] == 1 : count[0] + count[1] == 1;
    for (int k = 0; k < 2; k++)
        place[k] = known && count[k] ? end[k] : NAN;
    return known;
}

void sf_axis_find(const sf_results *r, double axis[2]) {
    double place[2], low[3], high[3];
    sf_axis_planes(r, place);
    sf_box3(r->surface_node_count, r->surface_position, low, high);
    for (int k = 0; k < 2; k++)
        axis[k] = isfinite(place[k]) ? place[k] : 0.5 * (low[k] + high[k]);
}
