/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/cells.h"

#include "base/sets.h"
#include "model/model.h"
#include <gsl/gsl_sort.h>

/* clang-format off */
static const sf_cell_shape shapes[] = {
    [SF_CELL_TRIANGLE] = {
        "triangle", 3, 3, 3, 0, 3,
        {{0, 1}, {1, 2}, {2, 0}},
        {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}},
        {{0, 0}, {1, 1}, {2, 2}},
        {{0}},
        {{0, 1, 2, -1}, {1, 2, 0, -1}, {2, 0, 1, -1}}, {0, 2, 1}},
    [SF_CELL_QUADRANGLE] = {
        "quadrangle", 4, 4, 4, 0, 4,
        {{0, 1}, {1, 2}, {2, 3}, {3, 0}},
        {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}},
        {{0, 0}, {1, 1}, {2, 2}, {3, 3}},
        {{0}},
        {{0, 1, 3, -1}, {1, 2, 0, -1}, {2, 3, 1, -1}, {3, 0, 2, -1}}, {0, 3, 2, 1}},
    [SF_CELL_TETRAHEDRON] = {
        "tetrahedron", 4, 6, 4, 1, 1,
        {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
        {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}},
        {{1, 0}, {2, 0}, {3, 0}, {3, 1}, {1, 2}, {2, 3}},
        {{0, 1, 2, 3}},
        {{0, 1, 2, 3}}, {1, 0, 2, 3}},
    [SF_CELL_PYRAMID] = {
        "pyramid", 5, 8, 5, 2, 4,
        {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}},
        {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}},
        {{1, 0}, {2, 0}, {3, 0}, {4, 0}, {4, 1}, {1, 2}, {2, 3}, {3, 4}},
        {{0, 1, 2, 4}, {0, 2, 3, 4}},
        {{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}}, {0, 3, 2, 1, 4}},
    [SF_CELL_PRISM] = {
        "prism", 6, 9, 5, 3, 6,
        {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}},
        {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}},
        {{2, 0}, {3, 0}, {4, 0}, {1, 2}, {1, 3}, {1, 4}, {4, 2}, {2, 3}, {3, 4}},
        {{0, 1, 2, 5}, {0, 1, 4, 5}, {0, 4, 3, 5}},
        {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}}, {3, 4, 5, 0, 1, 2}},
    [SF_CELL_HEXAHEDRON] = {
        "hexahedron", 8, 12, 6, 6, 8,
        {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
        {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
        {{2, 0}, {3, 0}, {4, 0}, {5, 0}, {1, 2}, {1, 3}, {1, 4}, {1, 5}, {5, 2}, {2, 3}, {3, 4}, {4, 5}},
        {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}},
        {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7},
         {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}}, {4, 5, 6, 7, 0, 1, 2, 3}},
};
/* clang-format on */

const sf_cell_shape *sf_cell_shape_of(int type) {
    return type >= SF_CELL_TRIANGLE && type <= SF_CELL_HEXAHEDRON ? &shapes[type] : NULL;
}

sf_cell_face *sf_cell_faces(const sf_cells *c, int64_t *place, int (*compare)(const void *, const void *),
                            int64_t *count, sf_error *err) {
    *count = 0;
    for (int64_t k = 0; k < c->cell_count; k++)
        *count += shapes[c->type[k]].faces;
    sf_cell_face *list = sf_alloc(err, *count, sizeof *list, "cell faces"), *face = list;
    for (int64_t k = 0; list && k < c->cell_count; k++) {
        const sf_cell_shape *shape = &shapes[c->type[k]];
        for (int f = 0; f < shape->faces; f++, face++) {
            *face = (sf_cell_face){{-1, -1, -1, -1}, (int32_t)k, (int8_t)f};
            for (int p = 0; p < sf_cell_face_size(shape, f); p++) {
                int32_t node = c->node[c->ptr[k] + shape->face[f][p]];
                face->key[p] = place ? (int32_t)sf_sets_find(place, node) : node;
            }
            gsl_sort_int(face->key, 1, 4);
        }
    }
    if (list)
        qsort(list, (size_t)*count, sizeof *list, compare);
    return list;
}

/* ---- the skin ---- */

/* The order is that of the bytes: the triangles of model.h5, and with them the bits of a run, follow it. */
static int by_nodes(const void *a, const void *b) {
    return memcmp(((const sf_cell_face *)a)->key, ((const sf_cell_face *)b)->key, 4 * sizeof(int32_t));
}

/* Keeps the faces that are alone among sorted ones; returns how many. */
static int64_t keep_single(sf_cell_face *list, int64_t count) {
    int64_t kept = 0;
    for (int64_t k = 0, next; k < count; k = next) {
        for (next = k + 1; next < count && by_nodes(&list[k], &list[next]) == 0; next++)
            ;
        if (next == k + 1)
            list[kept++] = list[k];
    }
    return kept;
}

/* Node `v` of a face, around it; -1: the fourth of a triangle. */
static int32_t node_of(const sf_cells *c, const sf_cell_face *face, int64_t v) {
    int corner = shapes[c->type[face->cell]].face[face->local][v];
    return corner < 0 ? -1 : c->node[c->ptr[face->cell] + corner];
}

/* The cells of a section are what shows of it. */
static sf_status take_section(const sf_cells *c, sf_skin_faces *s, sf_error *err) {
    s->face_count = c->cell_count;
    s->face = sf_alloc(err, s->face_count, sizeof *s->face, "the pad's skin");
    SF_TRY(err->status);
    for (int64_t k = 0; k < 4 * s->face_count; k++) {
        int64_t vertices = c->ptr[k / 4 + 1] - c->ptr[k / 4];
        s->face[k / 4][k % 4] = k % 4 < vertices ? c->node[c->ptr[k / 4] + k % 4] : -1;
    }
    s->node =
        sf_list_number(c->node_count, 4 * s->face_count, s->face[0], &s->node_count, "the pad's skin", err);
    return err->status;
}

sf_status sf_skin_faces_find(const sf_cells *c, sf_skin_faces *s, sf_error *err) {
    int64_t count;
    *s = (sf_skin_faces){0};
    if (c->cell_count > 0 && sf_cell_is_plane(&shapes[c->type[0]]))
        return take_section(c, s, err);
    SF_OWNED sf_cell_face *list = sf_cell_faces(c, NULL, by_nodes, &count, err);
    SF_TRY(err->status);
    s->face_count = keep_single(list, count);
    s->face = sf_alloc(err, s->face_count, sizeof *s->face, "the pad's skin");
    SF_TRY(err->status);
    for (int64_t k = 0; k < 4 * s->face_count; k++)
        s->face[k / 4][k % 4] = node_of(c, &list[k / 4], k % 4);
    s->node =
        sf_list_number(c->node_count, 4 * s->face_count, s->face[0], &s->node_count, "the pad's skin", err);
    return err->status;
}

sf_status sf_section_sides(const sf_cells *c, int64_t *count, int32_t **side, sf_error *err) {
    SF_OWNED sf_cell_face *list = sf_cell_faces(c, NULL, by_nodes, count, err);
    SF_TRY(err->status);
    *count = keep_single(list, *count);
    *side = sf_alloc(err, 2 * *count, sizeof **side, "sides of the section");
    for (int64_t k = 0; *side && k < 2 * *count; k++)
        (*side)[k] = node_of(c, &list[k / 2], k % 2);
    return err->status;
}

void sf_skin_faces_free(sf_skin_faces *s) {
    SF_CLEAR(s, s->face, s->node);
}

sf_status sf_skin_triangles(const sf_cells *cells, int64_t *triangles, int32_t **out, uint8_t **out_half,
                            sf_error *err) {
    sf_skin_faces skin;
    *triangles = 0;
    sf_skin_faces_find(cells, &skin, err);
    int32_t *node = *out = sf_alloc(err, 6 * skin.face_count, sizeof *node, "surface of the pad");
    uint8_t *kind = sf_alloc(err, 2 * skin.face_count, 1, "surface of the pad");
    for (int64_t i = 0; err->status == SF_OK && i < skin.face_count; i++)
        for (int half = 0; half < (skin.face[i][3] < 0 ? 1 : 2); half++) {
            const int corner[3] = {0, 1 + half, 2 + half};
            for (int k = 0; k < 3; k++)
                node[3 * *triangles + k] = skin.node[skin.face[i][corner[k]]];
            kind[(*triangles)++] = (uint8_t)(skin.face[i][3] < 0 ? 0 : 1 + half);
        }
    sf_skin_faces_free(&skin);
    if (out_half)
        *out_half = kind;
    else
        free(kind);
    return err->status;
}
