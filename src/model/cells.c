/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/cells.h"

#include "model/model.h"

/* clang-format off */
static const sf_cell_shape shapes[] = {
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
    return type >= SF_CELL_TETRAHEDRON && type <= SF_CELL_HEXAHEDRON ? &shapes[type] : NULL;
}

void sf_face_sort(int32_t node[4]) {
    for (int i = 1; i < 4; i++)
        for (int j = i; j > 0 && node[j] < node[j - 1]; j--) {
            int32_t swap = node[j];
            node[j] = node[j - 1];
            node[j - 1] = swap;
        }
}

/* ---- the skin ---- */

/* A face of a cell: its nodes around it, and ascending. */
typedef struct face {
    int32_t node[4], sorted[4]; /* -1 in the fourth place of a triangle, in the first of the sorted ones */
} face;

/* The order is that of the bytes: the triangles of model.h5, and with them the bits of a run, follow it. */
static int by_nodes(const void *a, const void *b) {
    return memcmp(((const face *)a)->sorted, ((const face *)b)->sorted, sizeof((const face *)a)->sorted);
}

/* Returns the number of faces of all cells; writes them unless `out` is NULL. */
static int64_t list_faces(const sf_cells *c, face *out) {
    int64_t count = 0;
    for (int64_t k = 0; k < c->cell_count; k++) {
        const sf_cell_shape *shape = &shapes[c->type[k]];
        for (int f = 0; f < shape->faces && out; f++) {
            face *to = &out[count + f];
            for (int v = 0; v < 4; v++)
                to->node[v] = shape->face[f][v] < 0 ? -1 : c->node[c->ptr[k] + shape->face[f][v]];
            memcpy(to->sorted, to->node, sizeof to->sorted);
            sf_face_sort(to->sorted);
        }
        count += shape->faces;
    }
    return count;
}

/* Keeps the faces that are alone among sorted ones; returns how many. */
static int64_t keep_single(face *list, int64_t count) {
    int64_t kept = 0;
    for (int64_t k = 0, next; k < count; k = next) {
        for (next = k + 1; next < count && by_nodes(&list[k], &list[next]) == 0; next++)
            ;
        if (next == k + 1)
            list[kept++] = list[k];
    }
    return kept;
}

/* Numbers the nodes of the faces in the order of the mesh. */
static sf_status number_nodes(const sf_cells *c, const face *list, sf_skin_faces *s, sf_error *err) {
    SF_OWNED int32_t *place = sf_alloc(err, c->node_count, sizeof *place, "the pad's skin");
    s->node = sf_alloc(err, c->node_count, sizeof *s->node, "the pad's skin");
    s->face = sf_alloc(err, s->face_count, sizeof *s->face, "the pad's skin");
    for (int64_t k = 0; err->status == SF_OK && k < 4 * s->face_count; k++)
        if (list[k / 4].node[k % 4] >= 0)
            place[list[k / 4].node[k % 4]] = 1;
    for (int64_t i = 0; err->status == SF_OK && i < c->node_count; i++)
        if (place[i]) {
            place[i] = (int32_t)s->node_count;
            s->node[s->node_count++] = i;
        }
    for (int64_t k = 0; err->status == SF_OK && k < 4 * s->face_count; k++) {
        int32_t node = list[k / 4].node[k % 4];
        s->face[k / 4][k % 4] = node < 0 ? -1 : place[node];
    }
    return err->status;
}

sf_status sf_skin_faces_find(const sf_cells *c, sf_skin_faces *s, sf_error *err) {
    int64_t count = list_faces(c, NULL);
    SF_OWNED face *list = sf_alloc(err, count, sizeof *list, "the pad's faces");
    *s = (sf_skin_faces){0};
    SF_TRY(err->status);
    list_faces(c, list);
    qsort(list, (size_t)count, sizeof *list, by_nodes);
    s->face_count = keep_single(list, count);
    return number_nodes(c, list, s, err);
}

void sf_skin_faces_free(sf_skin_faces *s) {
    SF_FREE(s->face, s->node);
    *s = (sf_skin_faces){0};
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
                node[3 * *triangles + k] = (int32_t)skin.node[skin.face[i][corner[k]]];
            kind[(*triangles)++] = (uint8_t)(skin.face[i][3] < 0 ? 0 : 1 + half);
        }
    sf_skin_faces_free(&skin);
    if (out_half)
        *out_half = kind;
    else
        free(kind);
    return err->status;
}
