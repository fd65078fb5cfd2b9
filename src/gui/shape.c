/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/shape.h"

#include <math.h>
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

/* The missile's triangles at t = 0, and the exact sphere that contact takes for them. */
typedef struct missile_surface {
    int64_t triangles;
    const double *position;
    const int32_t *triangle;
    double radius; /* m; 0 or NaN: the triangles are the missile */
    const double *centre;
} missile_surface;

/* The point `i` and `j` parts of `parts` from the first corner of a triangle to the others, on the sphere if
 * there is one. */
static void place_point(const missile_surface *m, int64_t triangle, int parts, int i, int j, double out[3]) {
    const int share[3] = {parts - i - j, i, j};
    double length = 0;
    for (int d = 0; d < 3; d++) {
        out[d] = 0;
        for (int c = 0; c < 3; c++)
            out[d] += share[c] * m->position[3 * (int64_t)m->triangle[3 * triangle + c] + d] / parts;
        length += m->radius > 0 ? (out[d] - m->centre[d]) * (out[d] - m->centre[d]) : 0;
    }
    for (int d = 0; d < 3 && length > 0; d++)
        out[d] = m->centre[d] + m->radius / sqrt(length) * (out[d] - m->centre[d]);
}

/* Each triangle of a sphere becomes `parts` x `parts` smaller ones: the foam would be seen through coarse
 * ones. */
static sf_status take_missile(const missile_surface *m, sf_shape *s, sf_error *err) {
    int parts = m->radius > 0 ? 4 : 1;
    int64_t pieces = m->triangles * parts * parts;
    s->missile.position = sf_alloc(err, 9 * (unsigned long)pieces, sizeof(double), "the missile's picture");
    s->missile_position = sf_alloc(err, 9 * (unsigned long)pieces, sizeof(double), "the missile's picture");
    s->missile.face =
        sf_alloc(err, 4 * (unsigned long)pieces, sizeof *s->missile.face, "the missile's picture");
    if (err->status != SF_OK)
        return err->status;
    double *to = s->missile_position;
    for (int64_t t = 0; t < m->triangles; t++)
        for (int i = 0; i < parts; i++)
            for (int j = 0; i + j < parts; j++)
                for (int turned = 0; turned < (i + j + 1 < parts ? 2 : 1); turned++, to += 9) {
                    place_point(m, t, parts, i + 1, j, to);
                    place_point(m, t, parts, i + turned, j + 1, to + 3);
                    place_point(m, t, parts, i, j + turned, to + 6);
                }
    s->missile.node_count = 3 * pieces;
    s->missile.face_count = pieces;
    for (int64_t k = 0; k < 9 * pieces; k++)
        s->missile.position[k] = s->missile_position[k] / s->unit;
    for (int64_t k = 0; k < 4 * pieces; k++)
        s->missile.face[k] = k % 4 == 3 ? -1 : (int32_t)(3 * (k / 4) + k % 4);
    return SF_OK;
}

sf_status sf_shape_of_model(const sf_model *m, double unit, sf_shape *s, sf_error *err) {
    const sf_cells cells = {m->node_count, m->cell_count, m->position,
                            m->cell_type,  m->cell_ptr,   m->cell_node};
    *s = (sf_shape){.unit = unit};
    const missile_surface missile = {m->surface_triangle_count, m->surface_position, m->surface_triangle,
                                     m->missile.shape == SF_SHAPE_SPHERE ? m->missile.sphere_radius : 0,
                                     m->missile.sphere_centre};
    if (find_skin(&cells, s, err) != SF_OK || take_missile(&missile, s, err) != SF_OK)
        sf_shape_free(s);
    return err->status;
}

sf_status sf_shape_of_results(const sf_results *r, double unit, sf_shape *s, sf_error *err) {
    const sf_cells cells = {r->node_count, r->cell_count, r->position,
                            r->cell_type,  r->cell_ptr,   r->cell_node};
    *s = (sf_shape){.unit = unit};
    const missile_surface missile = {r->surface_triangle_count, r->surface_position, r->surface_triangle,
                                     r->sphere_radius, r->sphere_centre};
    if (find_skin(&cells, s, err) != SF_OK || take_missile(&missile, s, err) != SF_OK)
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
