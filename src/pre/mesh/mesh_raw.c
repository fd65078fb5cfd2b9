/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesh_raw.h"

#include "base/mat3.h"
#include "base/sets.h"
#include <gsl/gsl_sort.h>
#include <string.h>

void sf_raw_mesh_free(sf_raw_mesh *raw) {
    sf_free_all((size_t)raw->group_count, raw->group_name);
    SF_CLEAR(raw, raw->tag, raw->xyz, raw->cell_type, raw->cell_chosen, raw->cell_node, raw->face_group,
             raw->face_part, raw->face_node, raw->group_name);
}

sf_status sf_raw_mesh_add_cell(sf_raw_mesh *raw, int type, int chosen, const size_t *node, int count,
                               sf_error *err) {
    if (!sf_grow(&raw->cell_type, raw->cell_count, sizeof *raw->cell_type) ||
        !sf_grow(&raw->cell_chosen, raw->cell_count, sizeof *raw->cell_chosen) ||
        !sf_grow(&raw->cell_node, raw->cell_count, SF_RAW_CELL * sizeof *raw->cell_node))
        return SF_NO_MEMORY(err, "%zu mesh cells", raw->cell_count);
    size_t k = raw->cell_count++;
    raw->cell_type[k] = (uint8_t)type;
    raw->cell_chosen[k] = (uint8_t)chosen;
    for (int a = 0; a < SF_RAW_CELL; a++)
        raw->cell_node[SF_RAW_CELL * k + (size_t)a] = a < count ? node[a] : 0;
    return SF_OK;
}

sf_status sf_raw_mesh_add_face(sf_raw_mesh *raw, int32_t group, int32_t part, const size_t *node, int count,
                               sf_error *err) {
    if (!sf_grow(&raw->face_group, raw->face_count, sizeof *raw->face_group) ||
        !sf_grow(&raw->face_part, raw->face_count, sizeof *raw->face_part) ||
        !sf_grow(&raw->face_node, raw->face_count, SF_RAW_FACE * sizeof *raw->face_node))
        return SF_NO_MEMORY(err, "%zu mesh faces", raw->face_count);
    size_t k = raw->face_count++;
    raw->face_group[k] = group;
    raw->face_part[k] = part;
    for (int a = 0; a < SF_RAW_FACE; a++)
        raw->face_node[SF_RAW_FACE * k + (size_t)a] = a < count ? node[a] : 0;
    return SF_OK;
}

static int compare_tag(const void *a, const void *b) {
    return SF_ORDER(((const sf_tag_index *)a)->tag, ((const sf_tag_index *)b)->tag);
}

sf_tag_index *sf_raw_mesh_index(const sf_raw_mesh *raw, sf_error *err) {
    sf_tag_index *index = sf_alloc(err, raw->node_count, sizeof *index, "node tags");
    if (!index)
        return NULL;
    for (size_t n = 0; n < raw->node_count; n++)
        index[n] = (sf_tag_index){raw->tag[n], n};
    qsort(index, raw->node_count, sizeof *index, compare_tag);
    return index;
}

size_t sf_raw_mesh_find(const sf_raw_mesh *raw, const sf_tag_index *index, size_t tag) {
    sf_tag_index wanted = {tag, 0};
    const sf_tag_index *found = bsearch(&wanted, index, raw->node_count, sizeof *index, compare_tag);
    return found ? found->place : SIZE_MAX;
}

const double *sf_raw_mesh_place(const sf_raw_mesh *raw, const sf_tag_index *index, size_t tag) {
    size_t place = sf_raw_mesh_find(raw, index, tag);
    return place != SIZE_MAX ? raw->xyz + 3 * place : NULL;
}

static int cell_vertices(const sf_raw_mesh *raw, size_t cell) {
    return sf_cell_shape_of(raw->cell_type[cell])->vertices;
}

int sf_raw_face_compare(const void *one, const void *other) {
    const size_t *a = one, *b = other;
    for (int i = 0; i < SF_RAW_FACE; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

void sf_raw_cell_face(const sf_raw_mesh *raw, size_t cell, int face, size_t tag[SF_RAW_FACE]) {
    const int *vertex = sf_cell_shape_of(raw->cell_type[cell])->face[face];
    for (int a = 0; a < SF_RAW_FACE; a++)
        tag[a] = vertex[a] < 0 ? 0 : raw->cell_node[SF_RAW_CELL * cell + (size_t)vertex[a]];
    gsl_sort_ulong(tag, 1, SF_RAW_FACE);
}

/* 3 or 4; 2 of a side. */
static int face_size(const sf_raw_mesh *raw, size_t face) {
    const size_t *node = &raw->face_node[SF_RAW_FACE * face];
    int triangle = node[2] != 0 ? 3 : 2;
    return node[3] != 0 ? 4 : triangle;
}

enum { UNUSED = -1, OTHER = -2 };

/* Numbers the nodes of the chosen cells from 0 in the order of `tag`; others get UNUSED, or OTHER if some
 * other cell uses them. `number` is [node_count], by place. */
static sf_status number_nodes(const sf_raw_mesh *raw, const sf_tag_index *index, int32_t *number,
                              sf_mesh *mesh, sf_error *err) {
    for (size_t n = 0; n < raw->node_count; n++)
        number[n] = UNUSED;
    for (size_t k = 0; k < raw->cell_count; k++) {
        for (int a = 0; a < cell_vertices(raw, k); a++) {
            size_t tag = raw->cell_node[SF_RAW_CELL * k + (size_t)a];
            size_t place = sf_raw_mesh_find(raw, index, tag);
            if (place == SIZE_MAX)
                return SF_REFUSE(err, "a cell uses node %zu, which the mesh does not have", tag);
            if (raw->cell_chosen[k])
                number[place] = 0;
            else if (number[place] == UNUSED)
                number[place] = OTHER;
        }
    }
    for (size_t n = 0; n < raw->node_count; n++) {
        mesh->orphan_count += number[n] == UNUSED;
        if (number[n] == 0)
            number[n] = (int32_t)mesh->node_count++;
    }
    return SF_OK;
}

static sf_status copy_cells(const sf_raw_mesh *raw, const sf_tag_index *index, const int32_t *number,
                            int layers, double unit, sf_mesh *mesh, sf_error *err) {
    int64_t entries = 0;
    for (size_t k = 0; k < raw->cell_count; k++) {
        mesh->cell_count += raw->cell_chosen[k] > 0;
        entries += raw->cell_chosen[k] ? cell_vertices(raw, k) : 0;
    }
    mesh->position = sf_alloc(err, 3 * (size_t)mesh->node_count, sizeof *mesh->position, "mesh positions");
    mesh->cell_type = sf_alloc(err, (size_t)mesh->cell_count, sizeof *mesh->cell_type, "cell types");
    mesh->cell_ptr = sf_alloc(err, (size_t)mesh->cell_count + 1, sizeof *mesh->cell_ptr, "cell list");
    mesh->cell_node = sf_alloc(err, (size_t)entries, sizeof *mesh->cell_node, "cell vertices");
    if (layers > 1)
        mesh->cell_layer = sf_alloc(err, (size_t)mesh->cell_count, 1, "layers of the cells");
    SF_TRY(err->status);
    for (size_t n = 0; n < raw->node_count; n++)
        for (size_t i = 0; number[n] >= 0 && i < 3; i++)
            mesh->position[3 * (size_t)number[n] + i] = unit * raw->xyz[3 * n + i];
    int64_t cell = 0;
    for (size_t k = 0; k < raw->cell_count; k++) {
        if (!raw->cell_chosen[k])
            continue;
        int count = cell_vertices(raw, k);
        mesh->cell_type[cell] = raw->cell_type[k];
        if (layers > 1)
            mesh->cell_layer[cell] = raw->cell_chosen[k] - 1;
        for (int a = 0; a < count; a++)
            mesh->cell_node[mesh->cell_ptr[cell] + a] =
                number[sf_raw_mesh_find(raw, index, raw->cell_node[SF_RAW_CELL * k + (size_t)a])];
        mesh->cell_ptr[cell + 1] = mesh->cell_ptr[cell] + count;
        cell++;
    }
    return SF_OK;
}

/* Marks the nodes of the group's faces that lie wholly in the chosen cells, and writes these faces to the
 * set; returns how many nodes. */
static int64_t mark_group(const sf_raw_mesh *raw, const sf_tag_index *index, const int32_t *number, int group,
                          uint8_t *mark, sf_node_set *set) {
    int64_t marked = 0;
    for (size_t f = 0; f < raw->face_count; f++) {
        int32_t node[SF_RAW_FACE] = {-1, -1, -1, -1};
        int count = raw->face_group[f] == group ? face_size(raw, f) : 0;
        bool whole = count > 0;
        for (int a = 0; a < count; a++) {
            size_t place = sf_raw_mesh_find(raw, index, raw->face_node[SF_RAW_FACE * f + (size_t)a]);
            node[a] = place == SIZE_MAX ? UNUSED : number[place];
            whole = whole && node[a] >= 0;
        }
        set->left_out += count > 0 && !whole;
        for (int a = 0; whole && a < count; a++) {
            marked += !mark[node[a]];
            mark[node[a]] = 1;
        }
        gsl_sort_int(node, 1, SF_RAW_FACE);
        if (whole)
            memcpy(&set->face[SF_RAW_FACE * set->face_count++], node, sizeof node);
    }
    return marked;
}

static int64_t count_faces(const sf_raw_mesh *raw, int group) {
    int64_t count = 0;
    for (size_t f = 0; f < raw->face_count; f++)
        count += raw->face_group[f] == group;
    return count;
}

static sf_status build_sets(const sf_raw_mesh *raw, const sf_tag_index *index, const int32_t *number,
                            sf_mesh *mesh, sf_error *err) {
    SF_OWNED uint8_t *mark = sf_alloc(err, (size_t)mesh->node_count, 1, "node marks");
    mesh->set = sf_alloc(err, (size_t)raw->group_count, sizeof *mesh->set, "node sets");
    for (int g = 0; mark && mesh->set && g < raw->group_count && err->status == SF_OK; g++) {
        sf_node_set *set = &mesh->set[mesh->set_count];
        *set = (sf_node_set){0};
        memset(mark, 0, (size_t)mesh->node_count);
        set->face =
            sf_alloc(err, SF_RAW_FACE * (size_t)count_faces(raw, g), sizeof *set->face, "surface faces");
        int64_t count = set->face ? mark_group(raw, index, number, g, mark, set) : 0;
        if (count == 0) {
            sf_release(&set->face);
            continue;
        }
        mesh->set_count++;
        set->name = strdup(raw->group_name[g]);
        set->node = sf_alloc(err, (size_t)count, sizeof *set->node, "node set");
        if (!set->name)
            SF_NO_MEMORY(err, "the node set %s", raw->group_name[g]);
        for (int32_t n = 0; set->node && n < mesh->node_count; n++)
            if (mark[n])
                set->node[set->count++] = n;
    }
    return err->status;
}

sf_status sf_mesh_assemble(const sf_raw_mesh *raw, int layers, double unit, sf_mesh *mesh, sf_error *err) {
    memset(mesh, 0, sizeof *mesh);
    if (raw->node_count > INT32_MAX)
        return SF_REFUSE(err, "the mesh has %zu nodes" SF_AT_MOST("%d"), raw->node_count, INT32_MAX);
    SF_OWNED sf_tag_index *index = sf_raw_mesh_index(raw, err);
    SF_OWNED int32_t *number = sf_alloc(err, raw->node_count, sizeof *number, "node numbers");
    if (err->status == SF_OK && number_nodes(raw, index, number, mesh, err) == SF_OK &&
        copy_cells(raw, index, number, layers, unit, mesh, err) == SF_OK)
        build_sets(raw, index, number, mesh, err);
    if (err->status == SF_OK)
        sf_mesh_orient(mesh);
    else
        sf_mesh_free(mesh);
    return err->status;
}

/* The missile's surface from raw faces: triangles, and which side of them is outside. */

/* A face by its tags in ascending order, with the cell behind it. */
typedef struct face_key {
    size_t tag[SF_RAW_FACE];
    size_t face;      /* index in raw */
    int behind;       /* cells that have this face */
    double centre[3]; /* of the cell behind */
} face_key;

/* Shared by the steps below. */
typedef struct surface_builder {
    const sf_raw_mesh *raw;
    sf_tag_index *nodes;
    face_key *keys;  /* [face_count] sorted */
    uint8_t *known;  /* [face_count] 1: a cell is behind it */
    double *outward; /* [face_count][3] vector from inside to the face; zero: unknown */
} surface_builder;

static const double *node_position(const surface_builder *b, size_t tag) {
    return sf_raw_mesh_place(b->raw, b->nodes, tag);
}

static sf_status prepare(surface_builder *b, sf_error *err) {
    const sf_raw_mesh *raw = b->raw;
    b->nodes = sf_raw_mesh_index(raw, err);
    b->keys = sf_alloc(err, raw->face_count, sizeof *b->keys, "surface faces");
    b->known = sf_alloc(err, raw->face_count, 1, "face marks");
    b->outward = sf_alloc(err, 3 * raw->face_count, sizeof *b->outward, "outward vectors");
    SF_TRY(err->status);
    for (size_t f = 0; f < raw->face_count; f++) {
        memcpy(b->keys[f].tag, raw->face_node + SF_RAW_FACE * f, sizeof b->keys[f].tag);
        for (int a = 0; a < SF_RAW_FACE; a++)
            if (b->keys[f].tag[a] != 0 && !node_position(b, b->keys[f].tag[a]))
                return SF_REFUSE(err, "a face uses node %zu, which the mesh does not have",
                                 b->keys[f].tag[a]);
        gsl_sort_ulong(b->keys[f].tag, 1, SF_RAW_FACE);
        b->keys[f].face = f;
    }
    qsort(b->keys, raw->face_count, sizeof *b->keys, sf_raw_face_compare);
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
        const sf_cell_shape *shape = sf_cell_shape_of(raw->cell_type[k]);
        const size_t *node = raw->cell_node + SF_RAW_CELL * k;
        for (int f = 0; f < shape->faces; f++) {
            size_t wanted[SF_RAW_FACE];
            sf_raw_cell_face(raw, k, f, wanted);
            face_key *found = bsearch(wanted, b->keys, raw->face_count, sizeof *b->keys, sf_raw_face_compare);
            if (!found)
                continue;
            average(b, node, shape->vertices, found->centre);
            if (++found->behind > 1)
                return SF_REFUSE(err,
                                 "the surface of the missile or support has cells on both sides near (%g, "
                                 "%g, %g) in the geometry's unit: it must be an outer surface",
                                 found->centre[0], found->centre[1], found->centre[2]);
        }
    }
    return SF_OK;
}

/* Finds the outward direction of each face: from the cell behind it, or from the centroid of the whole
 * surface. */
static void find_outward(surface_builder *b) {
    const sf_raw_mesh *raw = b->raw;
    double middle[3] = {0.0, 0.0, 0.0}, c[3];
    for (size_t f = 0; f < raw->face_count; f++) {
        average(b, raw->face_node + SF_RAW_FACE * f, face_size(raw, f), c);
        for (int i = 0; i < 3; i++)
            middle[i] += c[i] / (double)raw->face_count;
    }
    for (size_t k = 0; k < raw->face_count; k++) {
        size_t f = b->keys[k].face;
        const double *inside = b->keys[k].behind ? b->keys[k].centre : middle;
        average(b, raw->face_node + SF_RAW_FACE * f, face_size(raw, f), c);
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
    const double *s = face_size(b->raw, face) == 4 ? node_position(b, tag[3]) : p;
    double d[3], e[3];
    sf_sub3(r, p, d);
    sf_sub3(s, q, e);
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
    SF_OWNED int32_t *number = sf_alloc(err, raw->node_count, sizeof *number, "surface nodes");
    for (size_t f = 0; number && f < raw->face_count; f++) {
        surface->triangle_count += face_size(raw, f) - 2;
        for (int a = 0; a < face_size(raw, f); a++)
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
        for (int a = 0; a < face_size(raw, f); a++)
            node[a] = number[(node_position(b, raw->face_node[SF_RAW_FACE * f + (size_t)a]) - raw->xyz) / 3];
        for (int t = 0; t < face_size(raw, f) - 2; t++) {
            *out++ = node[0];
            *out++ = node[t + (reverse[f] ? 2 : 1)];
            *out++ = node[t + (reverse[f] ? 1 : 2)];
            *solid++ = b->known[f];
        }
    }
    if (err->status == SF_OK && surface->node_count > 0)
        memcpy(surface->origin, surface->position, sizeof surface->origin);
    return err->status;
}

sf_status sf_surface_assemble(const sf_raw_mesh *raw, double unit, sf_surface *surface, sf_error *err) {
    memset(surface, 0, sizeof *surface);
    surface_builder b = {.raw = raw};
    SF_OWNED uint8_t *reverse = sf_alloc(err, raw->face_count, 1, "face marks");
    if (reverse && prepare(&b, err) == SF_OK && match_cells(&b, err) == SF_OK) {
        find_outward(&b);
        decide(&b, reverse);
        write_surface(&b, reverse, unit, surface, err);
    }
    SF_FREE(b.nodes, b.keys, b.outward, b.known);
    if (err->status != SF_OK)
        sf_surface_free(surface);
    return err->status;
}
