/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile's surface from raw faces: triangles, and which side of them is outside. */
#include "pre/mesh/mesh_raw.h"

#include "base/mat3.h"
#include "pre/mesh/cell_topology.h"

#include <stdlib.h>
#include <string.h>

/* A face by its tags in ascending order, with the cell behind it. */
typedef struct face_key {
    size_t tag[SF_RAW_FACE];
    size_t face;      /* index in raw */
    int behind;       /* cells that have this face */
    double centre[3]; /* of the cell behind */
} face_key;

static int compare_key(const void *a, const void *b) {
    const face_key *p = a, *q = b;
    return sf_raw_face_compare(p->tag, q->tag);
}

/* Shared by the steps below. */
typedef struct surface_builder {
    const sf_raw_mesh *raw;
    sf_tag_index *nodes;
    face_key *keys;  /* [face_count] sorted */
    uint8_t *known;  /* [face_count] 1: a cell is behind it */
    double *outward; /* [face_count][3] vector from inside to the face; zero: unknown */
} surface_builder;

static const double *node_position(const surface_builder *b, size_t tag) {
    size_t place = sf_raw_mesh_find(b->raw, b->nodes, tag);
    return place != SIZE_MAX ? b->raw->xyz + 3 * place : NULL;
}

static sf_status prepare(surface_builder *b, sf_error *err) {
    const sf_raw_mesh *raw = b->raw;
    b->nodes = sf_raw_mesh_index(raw, err);
    b->keys = sf_alloc(err, raw->face_count, sizeof *b->keys, "surface faces");
    b->known = sf_alloc(err, raw->face_count, 1, "face marks");
    b->outward = sf_alloc(err, 3 * raw->face_count, sizeof *b->outward, "outward vectors");
    if (err->status != SF_OK)
        return err->status;
    for (size_t f = 0; f < raw->face_count; f++) {
        memcpy(b->keys[f].tag, raw->face_node + SF_RAW_FACE * f, sizeof b->keys[f].tag);
        for (int a = 0; a < SF_RAW_FACE; a++)
            if (b->keys[f].tag[a] != 0 && !node_position(b, b->keys[f].tag[a]))
                return SF_FAIL(err, SF_ERR_INPUT, "a face uses node %zu, which the mesh does not have",
                               b->keys[f].tag[a]);
        sf_raw_face_sort(b->keys[f].tag);
        b->keys[f].face = f;
    }
    qsort(b->keys, raw->face_count, sizeof *b->keys, compare_key);
    return SF_OK;
}

/* Average position of the `count` tags. */
static void average(const surface_builder *b, const size_t *tag, int count, double c[3]) {
    memset(c, 0, 3 * sizeof *c);
    for (int a = 0; a < count; a++) {
        const double *x = node_position(b, tag[a]);
        for (int i = 0; x && i < 3; i++)
            c[i] += x[i] / count;
    }
}

/* Finds the cells behind the faces. */
static sf_status match_cells(surface_builder *b, sf_error *err) {
    const sf_raw_mesh *raw = b->raw;
    for (size_t k = 0; k < raw->cell_count; k++) {
        const sf_cell_topology *shape = sf_cell_topology_of(raw->cell_type[k]);
        const size_t *node = raw->cell_node + SF_RAW_CELL * k;
        for (int f = 0; f < shape->faces; f++) {
            face_key wanted = {0};
            for (int a = 0; a < shape->face_size[f]; a++)
                wanted.tag[a] = node[shape->face[f][a]];
            sf_raw_face_sort(wanted.tag);
            face_key *found = bsearch(&wanted, b->keys, raw->face_count, sizeof *b->keys, compare_key);
            if (!found)
                continue;
            average(b, node, shape->vertices, found->centre);
            if (++found->behind > 1)
                return SF_FAIL(err, SF_ERR_INPUT,
                               "the missile's surface has cells on both sides near (%g, %g, %g) in the "
                               "geometry's unit: it must be an outer surface",
                               found->centre[0], found->centre[1], found->centre[2]);
        }
    }
    return SF_OK;
}

/* From the inside to each face: from the cell behind it, or from the centroid of the whole surface. */
static void find_outward(surface_builder *b) {
    const sf_raw_mesh *raw = b->raw;
    double middle[3] = {0.0, 0.0, 0.0}, c[3];
    for (size_t f = 0; f < raw->face_count; f++) {
        average(b, raw->face_node + SF_RAW_FACE * f, sf_raw_mesh_face_size(raw, f), c);
        for (int i = 0; i < 3; i++)
            middle[i] += c[i] / (double)raw->face_count;
    }
    for (size_t k = 0; k < raw->face_count; k++) {
        size_t f = b->keys[k].face;
        const double *inside = b->keys[k].behind ? b->keys[k].centre : middle;
        average(b, raw->face_node + SF_RAW_FACE * f, sf_raw_mesh_face_size(raw, f), c);
        for (size_t i = 0; i < 3; i++)
            b->outward[3 * f + i] = c[i] - inside[i];
    }
}

/* Twice the face's area vector in its own vertex order, dotted with its outward vector. */
static double side(const surface_builder *b, size_t face) {
    const size_t *tag = b->raw->face_node + SF_RAW_FACE * face;
    const double *p = node_position(b, tag[0]);
    const double *q = node_position(b, tag[1]);
    const double *r = node_position(b, tag[2]);
    const double *s = sf_raw_mesh_face_size(b->raw, face) == 4 ? node_position(b, tag[3]) : p;
    double d[3], e[3];
    for (int i = 0; i < 3; i++) {
        d[i] = r[i] - p[i];
        e[i] = s[i] - q[i];
    }
    return sf_triple3(b->outward + 3 * face, d, e);
}

/* 1 where a face must be reversed. With a cell behind it each face decides for itself; without, those of a
 * part (which the generator turns alike) decide together, so that hollows are not turned inside out. */
static void decide(surface_builder *b, uint8_t *reverse) {
    const sf_raw_mesh *raw = b->raw;
    for (size_t k = 0; k < raw->face_count; k++)
        b->known[b->keys[k].face] = b->keys[k].behind > 0;
    for (size_t f = 0; f < raw->face_count;) {
        /* Faces of a part stand together. */
        size_t end = f;
        double sum = 0.0;
        for (; end < raw->face_count && raw->face_part[end] == raw->face_part[f]; end++)
            sum += side(b, end);
        for (; f < end; f++)
            reverse[f] = b->known[f] ? side(b, f) < 0.0 : sum < 0.0;
    }
}

/* Numbers the nodes of the faces in the order of `tag` and writes positions and triangles. */
static sf_status write_surface(const surface_builder *b, const uint8_t *reverse, double unit,
                               sf_surface *surface, sf_error *err) {
    const sf_raw_mesh *raw = b->raw;
    int32_t *number = sf_alloc(err, raw->node_count, sizeof *number, "surface nodes");
    for (size_t f = 0; number && f < raw->face_count; f++) {
        surface->triangle_count += sf_raw_mesh_face_size(raw, f) - 2;
        for (int a = 0; a < sf_raw_mesh_face_size(raw, f); a++)
            number[(node_position(b, raw->face_node[SF_RAW_FACE * f + (size_t)a]) - raw->xyz) / 3] = 1;
    }
    for (size_t n = 0; number && n < raw->node_count; n++)
        number[n] = number[n] ? (int32_t)surface->node_count++ : -1;
    surface->position = sf_alloc(err, 3 * (size_t)surface->node_count, sizeof(double), "surface positions");
    surface->triangle =
        sf_alloc(err, 3 * (size_t)surface->triangle_count, sizeof(int32_t), "surface triangles");
    surface->solid = sf_alloc(err, (size_t)surface->triangle_count, 1, "surface triangles");
    uint8_t *solid = surface->solid;
    int32_t *out = surface->triangle;
    for (size_t n = 0; err->status == SF_OK && n < raw->node_count; n++)
        for (size_t i = 0; number[n] >= 0 && i < 3; i++)
            surface->position[3 * (size_t)number[n] + i] = unit * raw->xyz[3 * n + i];
    for (size_t f = 0; err->status == SF_OK && f < raw->face_count; f++) {
        int32_t node[SF_RAW_FACE] = {0};
        for (int a = 0; a < sf_raw_mesh_face_size(raw, f); a++)
            node[a] = number[(node_position(b, raw->face_node[SF_RAW_FACE * f + (size_t)a]) - raw->xyz) / 3];
        for (int t = 0; t < sf_raw_mesh_face_size(raw, f) - 2; t++) {
            *out++ = node[0];
            *out++ = node[t + (reverse[f] ? 2 : 1)];
            *out++ = node[t + (reverse[f] ? 1 : 2)];
            *solid++ = b->known[f];
        }
    }
    if (err->status == SF_OK && surface->node_count > 0)
        memcpy(surface->origin, surface->position, sizeof surface->origin);
    free(number);
    return err->status;
}

sf_status sf_surface_assemble(const sf_raw_mesh *raw, double unit, sf_surface *surface, sf_error *err) {
    memset(surface, 0, sizeof *surface);
    surface_builder b = {.raw = raw};
    uint8_t *reverse = NULL;
    if (prepare(&b, err) != SF_OK || match_cells(&b, err) != SF_OK)
        goto done;
    find_outward(&b);
    reverse = sf_alloc(err, raw->face_count, 1, "face marks");
    if (!reverse)
        goto done;
    decide(&b, reverse);
    write_surface(&b, reverse, unit, surface, err);
done:
    free(reverse);
    free(b.nodes);
    free(b.keys);
    free(b.outward);
    free(b.known);
    if (err->status != SF_OK)
        sf_surface_free(surface);
    return err->status;
}
