/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/skin.h"

#include <math.h>
#include <stdlib.h>

#include "base/mat3.h"

static sf_status number_nodes(const sf_model *m, sf_skin *skin, sf_error *err) {
    int32_t *place = sf_alloc(err, (unsigned long)m->node_count, sizeof *place, "skin of the pad");
    skin->node = sf_alloc(err, (unsigned long)m->node_count, sizeof *skin->node, "skin of the pad");
    skin->facet = sf_alloc(err, 3 * (unsigned long)m->skin_count, sizeof *skin->facet, "skin of the pad");
    skin->facet_count = m->skin_count;
    for (int64_t k = 0; err->status == SF_OK && k < 3 * m->skin_count; k++)
        place[m->skin_triangle[k]] = 1;
    for (int64_t i = 0; err->status == SF_OK && i < m->node_count; i++)
        if (place[i]) {
            place[i] = (int32_t)skin->count;
            skin->node[skin->count++] = (int32_t)i;
        }
    for (int64_t k = 0; err->status == SF_OK && k < 3 * m->skin_count; k++)
        skin->facet[k] = place[m->skin_triangle[k]];
    free(place);
    return err->status;
}

static sf_status list_rings(sf_skin *skin, sf_error *err) {
    int64_t corners = 3 * skin->facet_count;
    skin->ring_ptr = sf_alloc(err, (unsigned long)skin->count + 2, sizeof *skin->ring_ptr, "skin of the pad");
    skin->ring = sf_alloc(err, (unsigned long)corners, sizeof *skin->ring, "skin of the pad");
    if (err->status != SF_OK)
        return err->status;
    for (int64_t k = 0; k < corners; k++)
        skin->ring_ptr[skin->facet[k] + 2]++;
    for (int64_t p = 0; p < skin->count; p++)
        skin->ring_ptr[p + 2] += skin->ring_ptr[p + 1];
    for (int64_t k = 0; k < corners; k++)
        skin->ring[skin->ring_ptr[skin->facet[k] + 1]++] = (int32_t)(k / 3);
    return SF_OK;
}

/* Normals at rest; those of a node are weighted by the areas. */
static sf_status find_normals(const sf_model *m, sf_skin *skin, sf_error *err) {
    skin->normal = sf_alloc(err, 3 * (unsigned long)skin->count, sizeof(double), "skin of the pad");
    skin->facet_normal =
        sf_alloc(err, 3 * (unsigned long)skin->facet_count, sizeof(double), "skin of the pad");
    for (int64_t f = 0; err->status == SF_OK && f < skin->facet_count; f++) {
        const double *x[3];
        double side[2][3], *normal = &skin->facet_normal[3 * f];
        for (int k = 0; k < 3; k++)
            x[k] = &m->position[3 * (int64_t)skin->node[skin->facet[3 * f + k]]];
        for (int r = 0; r < 3; r++) {
            side[0][r] = x[1][r] - x[0][r];
            side[1][r] = x[2][r] - x[0][r];
        }
        sf_cross3(side[0], side[1], normal);
        for (int k = 0; k < 3; k++)
            for (int r = 0; r < 3; r++)
                skin->normal[3 * (int64_t)skin->facet[3 * f + k] + r] += normal[r];
        sf_unit3(normal);
    }
    for (int64_t p = 0; err->status == SF_OK && p < skin->count; p++)
        sf_unit3(&skin->normal[3 * p]);
    return err->status;
}

static sf_status mark_held(const sf_model *m, sf_skin *skin, sf_error *err) {
    uint8_t *mark = sf_alloc(err, (unsigned long)m->node_count, 1, "skin of the pad");
    double top = -INFINITY;
    skin->held = sf_alloc(err, (unsigned long)skin->count, 1, "skin of the pad");
    skin->rests = sf_alloc(err, (unsigned long)skin->count, 1, "skin of the pad");
    for (int64_t k = 0; err->status == SF_OK && k < m->fixed_count; k++)
        mark[m->fixed_node[k]] = m->fixed_mask[k];
    for (int64_t k = 0; err->status == SF_OK && k < m->rest_count; k++)
        mark[m->rest_node[k]] |= 8;
    for (int64_t p = 0; err->status == SF_OK && p < skin->count; p++) {
        skin->held[p] = mark[skin->node[p]] & 7;
        skin->rests[p] = mark[skin->node[p]] >> 3;
    }
    for (int64_t i = 0; i < m->node_count; i++)
        top = fmax(top, m->position[3 * i + 2]);
    skin->anvil = m->anvil.depth > 0 ? top - m->anvil.depth : -INFINITY;
    free(mark);
    return err->status;
}

sf_status sf_skin_build(const sf_model *m, sf_skin *skin, sf_error *err) {
    *skin = (sf_skin){.spacing = INFINITY};
    if (m->skin_count == 0)
        return SF_OK;
    if (number_nodes(m, skin, err) != SF_OK || list_rings(skin, err) != SF_OK ||
        find_normals(m, skin, err) != SF_OK || mark_held(m, skin, err) != SF_OK ||
        sf_contact_rows_of_nodes(m, skin->count, skin->node, &skin->rows, err) != SF_OK) {
        sf_skin_free(skin);
        return err->status;
    }
    for (int64_t p = 0; p < skin->count; p++) {
        double sum = 0;
        for (int64_t k = skin->rows.ptr[p]; k < skin->rows.ptr[p + 1]; k++)
            sum += fabs(skin->rows.value[k]);
        skin->spread = fmax(skin->spread, sum);
        skin->spacing = fmin(skin->spacing, m->spacing[skin->node[p]]);
    }
    return SF_OK;
}

void sf_skin_free(sf_skin *skin) {
    free(skin->node);
    free(skin->facet);
    free(skin->ring_ptr);
    free(skin->ring);
    free(skin->held);
    free(skin->rests);
    free(skin->normal);
    free(skin->facet_normal);
    sf_contact_rows_free(&skin->rows);
    *skin = (sf_skin){0};
}
