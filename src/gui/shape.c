/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/shape.h"

#include <stdlib.h>
#include <string.h>

static sf_status find_skin(const sf_cells *c, sf_shape *s, sf_error *err) {
    sf_skin_faces skin;
    if (sf_skin_faces_find(c, &skin, err) == SF_OK)
        s->pad.position =
            sf_alloc(err, 3 * (unsigned long)skin.node_count, sizeof(double), "the pad's picture");
    for (int64_t k = 0; k < 3 * skin.node_count && s->pad.position; k++)
        s->pad.position[k] = c->position[3 * skin.node[k / 3] + k % 3] / s->unit;
    s->pad.node_count = skin.node_count;
    s->pad.face_count = skin.face_count;
    s->pad.face = (int32_t *)skin.face;
    s->pad_node = skin.node;
    return err->status;
}

static sf_status take_missile(int64_t nodes, const double *position, int64_t triangles,
                              const int32_t *triangle, sf_shape *s, sf_error *err) {
    unsigned long n = 3 * (unsigned long)nodes;
    s->missile.position = sf_alloc(err, n, sizeof(double), "the missile's picture");
    s->missile_position = sf_alloc(err, n, sizeof(double), "the missile's picture");
    s->missile.face =
        sf_alloc(err, 4 * (unsigned long)triangles, sizeof *s->missile.face, "the missile's picture");
    if (err->status != SF_OK)
        return err->status;
    s->missile.node_count = nodes;
    s->missile.face_count = triangles;
    for (unsigned long k = 0; k < n; k++) {
        s->missile_position[k] = position[k];
        s->missile.position[k] = position[k] / s->unit;
    }
    for (int64_t k = 0; k < 4 * triangles; k++)
        s->missile.face[k] = k % 4 == 3 ? -1 : triangle[3 * (k / 4) + k % 4];
    return SF_OK;
}

sf_status sf_shape_of_model(const sf_model *m, double unit, sf_shape *s, sf_error *err) {
    const sf_cells cells = {m->node_count, m->cell_count, m->position,
                            m->cell_type,  m->cell_ptr,   m->cell_node};
    *s = (sf_shape){.unit = unit};
    if (find_skin(&cells, s, err) != SF_OK ||
        take_missile(m->surface_node_count, m->surface_position, m->surface_triangle_count,
                     m->surface_triangle, s, err) != SF_OK)
        sf_shape_free(s);
    return err->status;
}

sf_status sf_shape_of_results(const sf_results *r, double unit, sf_shape *s, sf_error *err) {
    const sf_cells cells = {r->node_count, r->cell_count, r->position,
                            r->cell_type,  r->cell_ptr,   r->cell_node};
    *s = (sf_shape){.unit = unit};
    if (find_skin(&cells, s, err) != SF_OK ||
        take_missile(r->surface_node_count, r->surface_position, r->surface_triangle_count,
                     r->surface_triangle, s, err) != SF_OK)
        sf_shape_free(s);
    return err->status;
}

void sf_shape_free(sf_shape *s) {
    free(s->pad.position);
    free(s->pad.face);
    free(s->pad_node);
    free(s->missile.position);
    free(s->missile.face);
    free(s->missile_position);
    *s = (sf_shape){0};
}

static void gather(const sf_shape *s, const sf_frame *fields, sf_shape_frame *out) {
    const double *u = fields->field[SF_FRAME_DISPLACEMENT], *mises = fields->field[SF_FRAME_VON_MISES];
    for (int64_t k = 0; k < s->pad.node_count; k++) {
        for (int d = 0; d < 3 && u; d++)
            out->pad[3 * k + d] = u[3 * s->pad_node[k] + d] / s->unit;
        if (mises)
            out->stress[k] = 1e-3 * mises[s->pad_node[k]];
    }
}

sf_status sf_shape_read_frame(const sf_shape *s, const sf_results *r, const sf_frame_head *head,
                              sf_shape_frame *out, sf_error *err) {
    sf_frame fields = {{0}};
    *out = (sf_shape_frame){0};
    if (sf_frame_read_fields(r, head, SF_FIELD_DISPLACEMENT | SF_FIELD_VON_MISES, &fields, err) != SF_OK)
        return err->status;
    out->pad = sf_alloc(err, 3 * (unsigned long)s->pad.node_count, sizeof(double), "a frame");
    out->missile = sf_alloc(err, 3 * (unsigned long)s->missile.node_count, sizeof(double), "a frame");
    if (fields.field[SF_FRAME_VON_MISES])
        out->stress = sf_alloc(err, (unsigned long)s->pad.node_count, sizeof(double), "a frame");
    if (err->status == SF_OK)
        gather(s, &fields, out);
    for (int64_t k = 0; k < s->missile.node_count && err->status == SF_OK; k++) {
        double place[3];
        sf_results_place(r, head, &s->missile_position[3 * k], place);
        for (int d = 0; d < 3; d++)
            out->missile[3 * k + d] = (place[d] - s->missile_position[3 * k + d]) / s->unit;
    }
    sf_frame_free(&fields);
    if (err->status != SF_OK)
        sf_shape_frame_free(out);
    return err->status;
}

void sf_shape_frame_free(sf_shape_frame *f) {
    free(f->pad);
    free(f->stress);
    free(f->missile);
    *f = (sf_shape_frame){0};
}
