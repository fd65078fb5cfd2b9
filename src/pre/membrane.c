/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/steps.h"

#include "base/mat3.h"

/* Adds the triangles of a boundary face: of a quadrangle those on both diagonals. */
static void add_face(const sf_mesh *mesh, const sf_layers *l, const sf_boundary_face *face, sf_model *m) {
    int layer = mesh->cell_layer ? mesh->cell_layer[face->cell] : 0;
    for (int k = 0; k < (face->size == 4 ? 4 : 1); k++) {
        for (int v = 0; v < 3; v++)
            m->membrane_triangle[3 * m->membrane_count + v] =
                sf_layers_copy(l, face->node[(k + v) % face->size], layer);
        m->membrane_share[m->membrane_count++] = face->size == 4 ? 0.5 : 1;
    }
}

static sf_status add_group(const sf_mesh *mesh, const sf_dual *dual, const sf_layers *l,
                           const sf_node_set *set, uint8_t *taken, sf_model *m, sf_error *err) {
    int64_t before = m->membrane_count;
    SF_OWNED uint8_t *member = sf_node_set_mark(mesh, set, err);
    for (int64_t f = 0; member && f < dual->face_count && err->status == SF_OK; f++) {
        const sf_boundary_face *face = &dual->face[f];
        bool inside = sf_face_is_inside(face, member);
        if (inside && taken[f]++)
            SF_REFUSE(err, "membrane.faces: a face of the group \"%s\" is in another one, too", set->name);
        else if (inside)
            add_face(mesh, l, face, m);
    }
    if (err->status == SF_OK && m->membrane_count == before)
        SF_REFUSE(err, "membrane.faces: no face of the group \"%s\" is on the surface of the pad", set->name);
    return err->status;
}

sf_status sf_membrane_take(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, const sf_layers *l,
                           sf_model *m, sf_error *err) {
    unsigned long most = 4 * (unsigned long)dual->face_count;
    if (c->membrane_count == 0)
        return SF_OK;
    SF_OWNED uint8_t *taken = sf_alloc(err, (unsigned long)dual->face_count, 1, "membrane");
    m->membrane = c->membrane_card;
    m->membrane_triangle = sf_alloc(err, 3 * most, sizeof *m->membrane_triangle, "membrane");
    m->membrane_share = sf_alloc(err, most, sizeof *m->membrane_share, "membrane");
    for (int g = 0; g < c->membrane_count && err->status == SF_OK; g++) {
        const sf_node_set *set = sf_group_need(mesh, "membrane.faces", c->membrane_group[g], err);
        if (set)
            add_group(mesh, dual, l, set, taken, m, err);
    }
    return err->status;
}

void sf_membrane_weigh(sf_model *m) {
    double area = m->membrane.density * m->membrane.thickness;
    for (int64_t t = 0; t < m->membrane_count; t++) {
        const int32_t *node = &m->membrane_triangle[3 * t];
        double normal[3];
        sf_triangle_normal(&m->position[3 * (int64_t)node[0]], &m->position[3 * (int64_t)node[1]],
                           &m->position[3 * (int64_t)node[2]], normal);
        for (int k = 0; k < 3; k++)
            m->mass[node[k]] += area * m->membrane_share[t] * sqrt(sf_dot3(normal, normal)) / 6;
    }
}
