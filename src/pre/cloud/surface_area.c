/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/surface_area.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

static double length(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

sf_status sf_surface_area(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set, double *area,
                          sf_error *err) {
    uint8_t *member = sf_alloc(err, (unsigned long)mesh->node_count, 1, "the nodes of a surface group");
    if (!member)
        return err->status;
    for (int64_t k = 0; k < set->count; k++)
        member[set->node[k]] = 1;
    for (int64_t f = 0; f < dual->face_count; f++) {
        const sf_boundary_face *face = &dual->face[f];
        bool inside = true;
        for (int k = 0; k < face->size; k++)
            inside = inside && member[face->node[k]];
        for (int k = 0; inside && k < face->size; k++) {
            sf_facet_triangle part[2];
            double weight[2][4];
            sf_dual_boundary(mesh, face, k, part, weight);
            area[face->node[k]] += length(part[0].area) + length(part[1].area);
        }
    }
    free(member);
    return SF_OK;
}
