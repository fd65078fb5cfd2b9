/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/bodies.h"

#include "pre/mesh/cell_topology.h"
#include <stdlib.h>
#include <string.h>

enum { ALL = SF_FIX_X | SF_FIX_Y | SF_FIX_Z };

typedef struct cell_face {
    int32_t key[4]; /* ascending; the first is -1 for a triangle */
    int32_t cell;
} cell_face;

/* What stands for those joined to `k` so far: the lowest. */
static int32_t leader(int32_t *parent, int32_t k) {
    while (parent[k] != k)
        k = parent[k] = parent[parent[k]];
    return k;
}

static void join(int32_t *parent, int32_t a, int32_t b) {
    a = leader(parent, a);
    b = leader(parent, b);
    parent[a > b ? a : b] = a > b ? b : a;
}

static int32_t *all_alone(int64_t count, sf_error *err) {
    int32_t *parent = sf_alloc(err, (unsigned long)count, sizeof *parent, "parts of the pad");
    for (int32_t k = 0; parent && k < (int32_t)count; k++)
        parent[k] = k;
    return parent;
}

static int by_value(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

static int by_key(const void *a, const void *b) {
    const cell_face *x = a, *y = b;
    for (int k = 0; k < 4; k++)
        if (x->key[k] != y->key[k])
            return x->key[k] < y->key[k] ? -1 : 1;
    return (x->cell > y->cell) - (x->cell < y->cell);
}

static int64_t count_faces(const sf_model *m) {
    int64_t count = 0;
    for (int64_t c = 0; c < m->cell_count; c++)
        count += sf_cell_topology_of(m->cell_type[c])->faces;
    return count;
}

/* Faces of all cells; `place` [node_count]: the same for nodes that are tied altogether. */
static void list_faces(const sf_model *m, int32_t *place, cell_face *face) {
    for (int32_t c = 0; c < (int32_t)m->cell_count; c++) {
        const sf_cell_topology *topology = sf_cell_topology_of(m->cell_type[c]);
        const int32_t *v = &m->cell_node[m->cell_ptr[c]];
        for (int f = 0; f < topology->faces; f++, face++) {
            *face = (cell_face){{-1, -1, -1, -1}, c};
            for (int p = 0; p < topology->face_size[f]; p++)
                face->key[p] = leader(place, v[topology->face[f][p]]);
            qsort(face->key, 4, sizeof face->key[0], by_value);
        }
    }
}

/* [cell_count] the lowest cell of each one's body; owned by the caller. */
static int32_t *join_cells(const sf_model *m, sf_error *err) {
    int64_t count = count_faces(m);
    int32_t *place = all_alone(m->node_count, err), *parent = all_alone(m->cell_count, err);
    cell_face *face = sf_alloc(err, (unsigned long)count, sizeof *face, "faces of the cells");
    if (err->status == SF_OK) {
        for (int64_t k = 0; k < m->tie_count; k++)
            if (m->tie_mask[k] == ALL)
                join(place, m->tie_node[k], m->tie_other[k]);
        list_faces(m, place, face);
        qsort(face, (size_t)count, sizeof *face, by_key);
        for (int64_t k = 1; k < count; k++)
            if (memcmp(face[k].key, face[k - 1].key, sizeof face[k].key) == 0)
                join(parent, face[k].cell, face[k - 1].cell);
        for (int32_t c = 0; c < (int32_t)m->cell_count; c++)
            parent[c] = leader(parent, c);
    }
    free(place);
    free(face);
    if (err->status == SF_OK)
        return parent;
    free(parent);
    return NULL;
}

/* Bodies in the order of their first nodes; b->cell holds the lowest cells and becomes the numbers. `number`
 * [cell_count] is room. */
static void number_bodies(const sf_model *m, int32_t *number, sf_bodies *b) {
    for (int64_t i = 0; i < m->node_count; i++)
        b->node[i] = -1;
    for (int64_t c = 0; c < m->cell_count; c++) {
        number[c] = -1;
        for (int64_t k = m->cell_ptr[c]; k < m->cell_ptr[c + 1]; k++)
            if (b->node[m->cell_node[k]] < 0)
                b->node[m->cell_node[k]] = b->cell[c];
    }
    for (int32_t i = 0; i < (int32_t)m->node_count; i++) {
        int32_t body = b->node[i] < 0 ? 0 : b->node[i];
        if (number[body] < 0) {
            b->first[b->count] = i;
            number[body] = (int32_t)b->count++;
        }
        b->node[i] = number[body];
    }
    for (int64_t c = 0; c < m->cell_count; c++)
        b->cell[c] = number[b->cell[c]];
}

static sf_status find_parts(const sf_model *m, sf_bodies *b, sf_error *err) {
    unsigned long cells = (unsigned long)m->cell_count;
    int32_t *number = sf_alloc(err, cells, sizeof *number, "parts of the pad");
    b->node = sf_alloc(err, (unsigned long)m->node_count, sizeof *b->node, "parts of the pad");
    b->first = sf_alloc(err, cells, sizeof *b->first, "parts of the pad");
    if (err->status == SF_OK && (b->cell = join_cells(m, err)))
        number_bodies(m, number, b);
    free(number);
    return err->status;
}

sf_status sf_bodies_find(const sf_model *m, sf_bodies *b, sf_error *err) {
    *b = (sf_bodies){0};
    if (m->node_material[m->node_count - 1] > 0) {
        find_parts(m, b, err);
    } else {
        b->count = 1;
        b->cell = sf_alloc(err, (unsigned long)m->cell_count, sizeof *b->cell, "parts of the pad");
        b->node = sf_alloc(err, (unsigned long)m->node_count, sizeof *b->node, "parts of the pad");
        b->first = sf_alloc(err, 1, sizeof *b->first, "parts of the pad");
    }
    if (err->status != SF_OK)
        sf_bodies_free(b);
    return err->status;
}

void sf_bodies_free(sf_bodies *b) {
    free(b->cell);
    free(b->node);
    free(b->first);
    *b = (sf_bodies){0};
}
