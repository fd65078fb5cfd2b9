/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The outer surface of the missile's cells, whatever part of it is the group that touches the pad. */
#include "pre/mesh/mesh_raw.h"

#include "base/mat3.h"
#include "pre/mesh/cell_topology.h"
#include <stdlib.h>
#include <string.h>

/* A face of a cell by its tags in ascending order. */
typedef struct cell_face {
    size_t tag[SF_RAW_FACE];
    size_t cell;
    int face;
} cell_face;

static int compare_face(const void *a, const void *b) {
    const cell_face *p = a, *q = b;
    int tags = sf_raw_face_compare(p->tag, q->tag);
    return tags ? tags : (p->cell > q->cell) - (p->cell < q->cell);
}

typedef struct hull_builder {
    const sf_raw_mesh *raw;
    sf_tag_index *nodes;
    cell_face *list; /* [count] sorted */
    size_t count;
    size_t *parent; /* [cell_count] union of cells joined by faces */
    uint8_t *ours;  /* [cell_count] by parent: of the missile */
} hull_builder;

static size_t find_root(size_t *parent, size_t cell) {
    while (parent[cell] != cell)
        cell = parent[cell] = parent[parent[cell]];
    return cell;
}

static sf_status list_faces(hull_builder *b, sf_error *err) {
    const sf_raw_mesh *raw = b->raw;
    b->list = sf_alloc(err, 6 * raw->cell_count, sizeof *b->list, "faces of the missile");
    b->parent = sf_alloc(err, raw->cell_count, sizeof *b->parent, "cells of the missile");
    b->ours = sf_alloc(err, raw->cell_count, 1, "cells of the missile");
    if (err->status != SF_OK)
        return err->status;
    for (size_t k = 0; k < raw->cell_count; k++) {
        const sf_cell_topology *shape = sf_cell_topology_of(raw->cell_type[k]);
        b->parent[k] = k;
        for (int f = 0; f < shape->faces; f++) {
            cell_face *face = &b->list[b->count++];
            *face = (cell_face){.cell = k, .face = f};
            for (int a = 0; a < shape->face_size[f]; a++)
                face->tag[a] = raw->cell_node[SF_RAW_CELL * k + (size_t)shape->face[f][a]];
            sf_raw_face_sort(face->tag);
        }
    }
    qsort(b->list, b->count, sizeof *b->list, compare_face);
    return SF_OK;
}

/* Does the face at i of the list belong to one cell only? */
static bool is_outer(const hull_builder *b, size_t i) {
    return (i == 0 || sf_raw_face_compare(b->list[i - 1].tag, b->list[i].tag) != 0) &&
           (i + 1 == b->count || sf_raw_face_compare(b->list[i + 1].tag, b->list[i].tag) != 0);
}

/* Joins cells through faces, and marks those that a face of the group belongs to. */
static void find_cells(hull_builder *b) {
    const sf_raw_mesh *raw = b->raw;
    for (size_t i = 1; i < b->count; i++)
        if (sf_raw_face_compare(b->list[i - 1].tag, b->list[i].tag) == 0)
            b->parent[find_root(b->parent, b->list[i].cell)] = find_root(b->parent, b->list[i - 1].cell);
    for (size_t f = 0; f < raw->face_count; f++) {
        size_t wanted[SF_RAW_FACE], low = 0, high = b->count;
        memcpy(wanted, raw->face_node + SF_RAW_FACE * f, sizeof wanted);
        sf_raw_face_sort(wanted);
        while (low < high) {
            size_t middle = (low + high) / 2;
            if (sf_raw_face_compare(b->list[middle].tag, wanted) < 0)
                low = middle + 1;
            else
                high = middle;
        }
        if (low < b->count && sf_raw_face_compare(b->list[low].tag, wanted) == 0)
            b->ours[find_root(b->parent, b->list[low].cell)] = 1;
    }
}

static bool is_hull(const hull_builder *b, size_t i) {
    return is_outer(b, i) && b->ours[find_root(b->parent, b->list[i].cell)];
}

static const double *place_of(const hull_builder *b, size_t tag) {
    size_t place = sf_raw_mesh_find(b->raw, b->nodes, tag);
    return place != SIZE_MAX ? &b->raw->xyz[3 * place] : NULL;
}

/* Does the face, in the order of its topology, face away from its cell? */
static bool faces_outwards(const hull_builder *b, const cell_face *f, const size_t *node, int size) {
    const sf_cell_topology *shape = sf_cell_topology_of(b->raw->cell_type[f->cell]);
    double out[3] = {0}, u[3], v[3];
    for (int c = 0; c < 3; c++) {
        for (int a = 0; a < size; a++)
            out[c] += place_of(b, node[a])[c] / size;
        for (int a = 0; a < shape->vertices; a++)
            out[c] -= place_of(b, b->raw->cell_node[SF_RAW_CELL * f->cell + (size_t)a])[c] / shape->vertices;
        u[c] = place_of(b, node[1])[c] - place_of(b, node[0])[c];
        v[c] = place_of(b, node[2])[c] - place_of(b, node[0])[c];
    }
    return sf_triple3(out, u, v) > 0;
}

static void add_face(const hull_builder *b, const cell_face *f, int32_t *number, sf_surface *s) {
    const sf_cell_topology *shape = sf_cell_topology_of(b->raw->cell_type[f->cell]);
    int size = shape->face_size[f->face];
    size_t node[SF_RAW_FACE] = {0};
    for (int a = 0; a < size; a++)
        node[a] = b->raw->cell_node[SF_RAW_CELL * f->cell + (size_t)shape->face[f->face][a]];
    bool outwards = faces_outwards(b, f, node, size);
    for (int t = 0; t < size - 2; t++) {
        const size_t corner[3] = {node[0], node[t + (outwards ? 1 : 2)], node[t + (outwards ? 2 : 1)]};
        for (int a = 0; a < 3; a++)
            s->hull_triangle[3 * s->hull_triangle_count + a] =
                number[sf_raw_mesh_find(b->raw, b->nodes, corner[a])];
        s->hull_triangle_count++;
    }
}

/* All cells of the missile have nodes that exist. */
static bool has_nodes(const hull_builder *b) {
    for (size_t k = 0; k < b->raw->cell_count; k++)
        for (int a = 0; a < sf_cell_topology_of(b->raw->cell_type[k])->vertices; a++)
            if (!place_of(b, b->raw->cell_node[SF_RAW_CELL * k + (size_t)a]))
                return false;
    return true;
}

static sf_status write_hull(const hull_builder *b, double unit, sf_surface *s, sf_error *err) {
    const sf_raw_mesh *raw = b->raw;
    size_t most = 0;
    for (size_t i = 0; i < b->count; i++)
        most += is_hull(b, i) ? 2 : 0;
    int32_t *number = sf_alloc(err, raw->node_count, sizeof *number, "nodes of the missile");
    s->hull_position = sf_alloc(err, 3 * raw->node_count, sizeof(double), "nodes of the missile");
    s->hull_triangle = sf_alloc(err, 3 * most, sizeof(int32_t), "surface of the missile");
    if (err->status == SF_OK) {
        s->hull_node_count = (int64_t)raw->node_count;
        for (size_t n = 0; n < raw->node_count; n++)
            number[n] = (int32_t)n;
        for (size_t n = 0; n < 3 * raw->node_count; n++)
            s->hull_position[n] = unit * raw->xyz[n];
        for (size_t i = 0; i < b->count; i++)
            if (is_hull(b, i))
                add_face(b, &b->list[i], number, s);
    }
    free(number);
    return err->status;
}

sf_status sf_hull_assemble(const sf_raw_mesh *raw, double unit, sf_surface *s, sf_error *err) {
    hull_builder b = {.raw = raw};
    if (raw->cell_count == 0)
        return SF_OK;
    b.nodes = sf_raw_mesh_index(raw, err);
    if (b.nodes && has_nodes(&b) && list_faces(&b, err) == SF_OK) {
        find_cells(&b);
        write_hull(&b, unit, s, err);
    }
    free(b.nodes);
    free(b.list);
    free(b.parent);
    free(b.ours);
    return err->status;
}
