/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/listing.h"

sf_status sf_listing_facets(const sf_scene *c, sf_listing *l, sf_error *err) {
    int64_t count = c->skin->facet_count, first = c->skin->faces;
    sf_contact_work *work = &c->at->work;
    int64_t *start[2];
    int32_t *node[2];
    if (l->centre)
        return SF_OK;
    l->centre = sf_workspace_take(&work->centre, 3 * count, sizeof *l->centre, "candidates of contact", err);
    l->radius = sf_workspace_take(&work->radius, count, sizeof *l->radius, "candidates of contact", err);
    l->found = sf_workspace_take(&work->found, count, sizeof *l->found, "candidates of contact", err);
    for (int k = 0; k < 2; k++) {
        start[k] = sf_workspace_take(&work->grid_start[k], SF_GRID_STARTS(count), sizeof *start[k],
                                     "candidates of contact", err);
        node[k] =
            sf_workspace_take(&work->grid_node[k], count, sizeof *node[k], "candidates of contact", err);
    }
    SF_TRY(err->status);
    for (int64_t k = 0; k < count; k++)
        sf_grid_ball(c->at->position, &c->skin->facet[3 * k], &l->centre[3 * k], &l->radius[k]);
    sf_grid_fill(&l->pad, first, l->centre, l->radius, start[0], node[0]);
    if (count > first)
        sf_grid_fill(&l->support, count - first, &l->centre[3 * first], &l->radius[first], start[1], node[1]);
    return SF_OK;
}

double sf_listing_distance(const sf_scene *c, const double x[3], int64_t facet) {
    const double *corner[3];
    double nearest[3];
    int feature;
    sf_corners(c->at->position, &c->skin->facet[3 * facet], corner);
    sf_triangle_nearest(corner[0], corner[1], corner[2], x, nearest, &feature);
    return sf_distance3(x, nearest);
}
