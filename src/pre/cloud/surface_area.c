/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/surface_area.h"

#include "base/mat3.h"
#include <stdbool.h>
#include <stdlib.h>

static double length(const double a[3]) {
    return sqrt(sf_dot3(a, a));
}

/* [node_count] 1: in the set; owned by the caller. */
static uint8_t *mark_members(const sf_mesh *mesh, const sf_node_set *set, sf_error *err) {
    uint8_t *member = sf_alloc(err, (unsigned long)mesh->node_count, 1, "the nodes of a surface group");
    for (int64_t k = 0; member && k < set->count; k++)
        member[set->node[k]] = 1;
    return member;
}

static bool is_inside(const sf_boundary_face *face, const uint8_t *member) {
    bool inside = true;
    for (int k = 0; k < face->size; k++)
        inside = inside && member[face->node[k]];
    return inside;
}

sf_status sf_surface_area(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set, int layer,
                          double *area, sf_error *err) {
    uint8_t *member = mark_members(mesh, set, err);
    for (int64_t f = 0; member && f < dual->face_count; f++) {
        const sf_boundary_face *face = &dual->face[f];
        if (layer != SF_ANY_LAYER && mesh->cell_layer[face->cell] != layer)
            continue;
        for (int k = 0; is_inside(face, member) && k < face->size; k++) {
            sf_facet_triangle part[2];
            double weight[2][4];
            sf_dual_boundary(mesh, face, k, part, weight);
            area[face->node[k]] += length(part[0].area) + length(part[1].area);
        }
    }
    free(member);
    return err->status;
}

/* Outward area vector, m2. */
static void face_area(const sf_mesh *mesh, const sf_boundary_face *face, double out[3]) {
    const double *p = &mesh->position[3 * face->node[0]], *q = &mesh->position[3 * face->node[1]],
                 *r = &mesh->position[3 * face->node[2]],
                 *s = face->size == 4 ? &mesh->position[3 * face->node[3]] : p;
    double d[3], e[3];
    for (int c = 0; c < 3; c++) {
        d[c] = r[c] - p[c];
        e[c] = s[c] - q[c];
    }
    sf_cross3(d, e, out);
    for (int c = 0; c < 3; c++)
        out[c] *= 0.5;
}

sf_status sf_surface_look(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set,
                          const double direction[3], sf_surface_sides *sides, sf_error *err) {
    uint8_t *member = mark_members(mesh, set, err);
    *sides = (sf_surface_sides){0};
    for (int64_t f = 0; member && f < dual->face_count; f++) {
        double a[3];
        if (!is_inside(&dual->face[f], member))
            continue;
        face_area(mesh, &dual->face[f], a);
        double along = sf_dot3(a, direction);
        sides->area += length(a);
        sides->facing -= along;
        sides->away += along > 0.5 * length(a) ? length(a) : 0;
    }
    free(member);
    return err->status;
}
