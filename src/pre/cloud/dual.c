/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/cloud/dual.h"

#include "base/mat3.h"
#include "base/sets.h"
#include <string.h>

typedef struct raw_edge {
    int32_t low, high;
    sf_edge_use use;
} raw_edge;

static int by_edge(const void *a, const void *b) {
    const raw_edge *x = a, *y = b;
    int low = SF_ORDER(x->low, y->low), high = SF_ORDER(x->high, y->high);
    if (low == 0 && high == 0)
        return SF_ORDER(x->use.cell, y->use.cell);
    return low ? low : high;
}

static sf_status build_edges(const sf_mesh *mesh, sf_dual *dual, sf_error *err) {
    int64_t count = 0, k = 0;
    for (int64_t c = 0; c < mesh->cell_count; c++)
        count += sf_cell_shape_of(mesh->cell_type[c])->edges;
    SF_OWN(raw_edge, raw, count, "cell edges", err);
    for (int64_t c = 0; c < mesh->cell_count; c++) {
        const sf_cell_shape *shape = sf_cell_shape_of(mesh->cell_type[c]);
        const int32_t *v = &mesh->cell_node[mesh->cell_ptr[c]];
        for (int e = 0; e < shape->edges; e++) {
            int32_t a = v[shape->edge[e][0]], b = v[shape->edge[e][1]];
            raw[k++] = (raw_edge){a < b ? a : b, a < b ? b : a, {(int32_t)c, (int8_t)e, a > b}};
        }
    }
    qsort(raw, (size_t)count, sizeof *raw, by_edge);
    for (k = 0; k < count; k++)
        dual->edge_count += k == 0 || raw[k].low != raw[k - 1].low || raw[k].high != raw[k - 1].high;
    SF_ALLOC_ALL(err, "edges", SF_ROOM(dual->edge, 2 * dual->edge_count),
                 SF_ROOM(dual->use_ptr, dual->edge_count + 1), SF_ROOM(dual->use, count));
    int64_t edge = -1;
    for (k = 0; k < count && err->status == SF_OK; k++) {
        if (k == 0 || raw[k].low != raw[k - 1].low || raw[k].high != raw[k - 1].high) {
            edge++;
            dual->edge[2 * edge] = raw[k].low;
            dual->edge[2 * edge + 1] = raw[k].high;
            dual->use_ptr[edge] = k;
        }
        dual->use[k] = raw[k].use;
    }
    if (err->status == SF_OK)
        dual->use_ptr[dual->edge_count] = count;
    return err->status;
}

/* True if both cells see the face with its vertices in the same sense: they then lie on the same side of
 * it. */
static bool is_same_side(const sf_mesh *mesh, const sf_cell_face *a, const sf_cell_face *b) {
    const sf_cell_shape *first = sf_cell_shape_of(mesh->cell_type[a->cell]),
                        *second = sf_cell_shape_of(mesh->cell_type[b->cell]);
    const int32_t *v = &mesh->cell_node[mesh->cell_ptr[a->cell]],
                  *w = &mesh->cell_node[mesh->cell_ptr[b->cell]];
    const int *p = first->face[a->local], *q = second->face[b->local];
    int size = sf_cell_face_size(first, a->local), k = 0;
    if (size == 2)
        return w[q[0]] == v[p[0]];
    while (k < size - 1 && w[q[k]] != v[p[0]])
        k++;
    return w[q[(k + 1) % size]] == v[p[1]];
}

static void add_boundary(const sf_mesh *mesh, const sf_cell_face *raw, sf_dual *dual) {
    sf_boundary_face *face = &dual->face[dual->face_count++];
    const sf_cell_shape *shape = sf_cell_shape_of(mesh->cell_type[raw->cell]);
    *face = (sf_boundary_face){
        raw->cell, raw->local, (int8_t)sf_cell_face_size(shape, raw->local), {-1, -1, -1, -1}};
    for (int p = 0; p < face->size; p++)
        face->node[p] = mesh->cell_node[mesh->cell_ptr[face->cell] + shape->face[face->local][p]];
}

static sf_status add_inner(const sf_mesh *mesh, const sf_cell_face *raw, sf_dual *dual, sf_error *err) {
    sf_inner_face *face = &dual->inner[dual->inner_count++];
    *face = (sf_inner_face){{raw[0].cell, raw[1].cell}, {raw->key[0], raw->key[1], raw->key[2], raw->key[3]}};
    if (!is_same_side(mesh, &raw[0], &raw[1]))
        return SF_OK;
    const double *x = &mesh->position[3 * (int64_t)raw->key[3]];
    return SF_REFUSE(err,
                     "the pad's cells overlap: two that share a face at (%.4g, %.4g, %.4g) mm lie on the "
                     "same side of it",
                     1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
}

/* Faces sorted by their vertices: alone = boundary, pairs = interior. */
static sf_status build_faces(const sf_mesh *mesh, sf_dual *dual, sf_error *err) {
    int64_t count, k;
    SF_OWNED sf_cell_face *raw = sf_cell_faces(&SF_CELLS_OF(mesh), NULL, sf_cell_face_compare, &count, err);
    dual->face = sf_alloc(err, count, sizeof *dual->face, "boundary faces");
    dual->inner = sf_alloc(err, (unsigned long)count / 2, sizeof *dual->inner, "inner faces");
    SF_TRY(err->status);
    for (k = 0; k < count && err->status == SF_OK;) {
        int64_t end = k + 1;
        while (end < count && memcmp(raw[end].key, raw[k].key, sizeof raw[k].key) == 0)
            end++;
        if (end - k > 2) {
            const double *x = &mesh->position[3 * (int64_t)raw[k].key[3]];
            SF_REFUSE(err,
                      "the pad's cells overlap: %lld of them share one face at (%.4g, %.4g, %.4g) mm; no "
                      "more than two can",
                      (long long)(end - k), 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
        } else if (end - k == 2) {
            add_inner(mesh, &raw[k], dual, err);
        } else {
            add_boundary(mesh, &raw[k], dual);
        }
        k = end;
    }
    return err->status;
}

static sf_status build_adjacency(const sf_mesh *mesh, sf_dual *dual, sf_error *err) {
    int64_t n = mesh->node_count;
    SF_TRY(SF_ALLOC_ALL(err, "edge adjacency", SF_ROOM(dual->edge_ptr, n + 2),
                        SF_ROOM(dual->edge_node, 2 * dual->edge_count),
                        SF_ROOM(dual->edge_id, 2 * dual->edge_count)));
    for (int64_t k = 0; k < 2 * dual->edge_count; k++)
        dual->edge_ptr[dual->edge[k] + 2]++;
    for (int64_t i = 0; i < n; i++)
        dual->edge_ptr[i + 2] += dual->edge_ptr[i + 1];
    /* Edges ascend by (low, high): taking high ends first fills each row with lower neighbours first, in
     * order. */
    for (int end = 1; end >= 0; end--)
        for (int64_t e = 0; e < dual->edge_count; e++) {
            int64_t slot = dual->edge_ptr[dual->edge[2 * e + end] + 1]++;
            dual->edge_node[slot] = dual->edge[2 * e + 1 - end];
            dual->edge_id[slot] = e;
        }
    return SF_OK;
}

sf_status sf_dual_build(const sf_mesh *mesh, sf_dual *dual, sf_error *err) {
    memset(dual, 0, sizeof *dual);
    if (build_edges(mesh, dual, err) != SF_OK || build_faces(mesh, dual, err) != SF_OK ||
        build_adjacency(mesh, dual, err) != SF_OK)
        sf_dual_free(dual);
    return err->status;
}

void sf_dual_free(sf_dual *dual) {
    SF_CLEAR(dual, dual->edge, dual->use_ptr, dual->use, dual->face, dual->inner, dual->edge_ptr,
             dual->edge_node, dual->edge_id);
}

static void triangle(const double a[3], const double b[3], const double c[3], sf_facet_triangle *out) {
    sf_triangle_normal(a, b, c, out->area);
    for (int k = 0; k < 3; k++) {
        out->centroid[k] = (a[k] + b[k] + c[k]) / 3;
        out->area[k] *= 0.5;
    }
}

static void mean_of(const sf_mesh *mesh, int count, const int32_t *cell_node, const int *local,
                    double out[3]) {
    out[0] = out[1] = out[2] = 0;
    for (int k = 0; k < count; k++)
        for (int c = 0; c < 3; c++)
            out[c] += mesh->position[3 * cell_node[local ? local[k] : k] + c];
    for (int c = 0; c < 3; c++)
        out[c] /= count;
}

/* Gauss's points of the surface that the line from a to b makes about the axis; N to the right of the line.
 */
static void ring(const double a[3], const double b[3], sf_facet_triangle out[2]) {
    static const double OFF = 0.28867513459481287; /* 1 / sqrt(12) */
    for (int t = 0; t < 2; t++) {
        double part = 0.5 + (t == 0 ? -OFF : OFF);
        for (int k = 0; k < 3; k++)
            out[t].centroid[k] = (1 - part) * a[k] + part * b[k];
        double girth = M_PI * out[t].centroid[0];
        out[t].area[0] = girth * (b[2] - a[2]);
        out[t].area[1] = 0;
        out[t].area[2] = -girth * (b[0] - a[0]);
    }
}

void sf_dual_fan(const sf_mesh *mesh, const sf_edge_use *use, double place[2][3], double weight[2]) {
    const sf_cell_shape *shape = sf_cell_shape_of(mesh->cell_type[use->cell]);
    const int32_t *v = &mesh->cell_node[mesh->cell_ptr[use->cell]];
    double middle[3], centre[3];
    mean_of(mesh, 2, v, shape->edge[use->local], middle);
    mean_of(mesh, shape->vertices, v, NULL, centre);
    for (int end = 0; end < 2; end++) { /* of the cell's edge; counter-clockwise with the first end */
        const double *x = &mesh->position[3 * (int64_t)v[shape->edge[use->local][end]]];
        int side = end ^ use->reversed;
        for (int k = 0; k < 3; k++)
            place[side][k] = (x[k] + middle[k] + centre[k]) / 3;
        double twice = (middle[0] - x[0]) * (centre[2] - x[2]) - (middle[2] - x[2]) * (centre[0] - x[0]);
        weight[side] = (end == 0 ? M_PI : -M_PI) * twice;
    }
}

static void turn_back(sf_facet_triangle out[2]) {
    for (int t = 0; t < 2; t++)
        for (int k = 0; k < 3; k++)
            out[t].area[k] = -out[t].area[k];
}

void sf_dual_facet(const sf_mesh *mesh, const sf_edge_use *use, sf_facet_triangle out[2]) {
    const sf_cell_shape *shape = sf_cell_shape_of(mesh->cell_type[use->cell]);
    const int32_t *v = &mesh->cell_node[mesh->cell_ptr[use->cell]];
    int along = shape->edge_face[use->local][0], against = shape->edge_face[use->local][1];
    double middle[3], face_along[3], face_against[3], centre[3];
    mean_of(mesh, 2, v, shape->edge[use->local], middle);
    mean_of(mesh, shape->vertices, v, NULL, centre);
    if (sf_cell_is_plane(shape)) {
        ring(middle, centre, out);
    } else {
        mean_of(mesh, sf_cell_face_size(shape, along), v, shape->face[along], face_along);
        mean_of(mesh, sf_cell_face_size(shape, against), v, shape->face[against], face_against);
        triangle(middle, face_against, centre, &out[0]);
        triangle(middle, centre, face_along, &out[1]);
    }
    if (use->reversed)
        turn_back(out);
}

/* The half of a section's side at its vertex `corner`. */
static void ring_boundary(const sf_mesh *mesh, const sf_boundary_face *face, int corner,
                          sf_facet_triangle out[2], double weight[2][4]) {
    const double *a = &mesh->position[3 * (int64_t)face->node[0]],
                 *b = &mesh->position[3 * (int64_t)face->node[1]];
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (a[k] + b[k]);
    ring(corner == 0 ? a : middle, corner == 0 ? middle : b, out);
    double length = sf_distance3(a, b);
    memset(weight, 0, 2 * sizeof *weight);
    for (int t = 0; t < 2; t++) {
        weight[t][1] = sf_distance3(out[t].centroid, a) / length;
        weight[t][0] = 1 - weight[t][1];
    }
}

void sf_dual_boundary(const sf_mesh *mesh, const sf_boundary_face *face, int corner, sf_facet_triangle out[2],
                      double weight[2][4]) {
    int size = face->size, next = (corner + 1) % size, previous = (corner + size - 1) % size;
    double centre[3], ends[2][3];
    if (size == 2) {
        ring_boundary(mesh, face, corner, out, weight);
        return;
    }
    const double *x = &mesh->position[3 * face->node[corner]];
    mean_of(mesh, size, face->node, NULL, centre);
    for (int k = 0; k < 3; k++) {
        ends[0][k] = 0.5 * (x[k] + mesh->position[3 * face->node[next] + k]);
        ends[1][k] = 0.5 * (x[k] + mesh->position[3 * face->node[previous] + k]);
    }
    triangle(x, ends[0], centre, &out[0]);
    triangle(x, centre, ends[1], &out[1]);
    for (int t = 0; t < 2; t++) {
        for (int k = 0; k < 4; k++)
            weight[t][k] = k < size ? 1.0 / (3 * size) : 0;
        weight[t][corner] += 0.5;
        weight[t][t == 0 ? next : previous] += 1.0 / 6;
    }
}

static double length(const double a[3]) {
    return sqrt(sf_dot3(a, a));
}

uint8_t *sf_surface_members(const sf_mesh *mesh, const sf_node_set *set, sf_error *err) {
    uint8_t *member = sf_alloc(err, mesh->node_count, 1, "the nodes of a surface group");
    for (int64_t k = 0; member && k < set->count; k++)
        member[set->node[k]] = 1;
    return member;
}

bool sf_surface_has_face(const sf_boundary_face *face, const uint8_t *member) {
    bool inside = true;
    for (int k = 0; k < face->size; k++)
        inside = inside && member[face->node[k]];
    return inside;
}

sf_status sf_surface_area(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set, int layer,
                          double *area, sf_error *err) {
    SF_OWNED uint8_t *member = sf_surface_members(mesh, set, err);
    for (int64_t f = 0; member && f < dual->face_count; f++) {
        const sf_boundary_face *face = &dual->face[f];
        if (layer != SF_ANY_LAYER && mesh->cell_layer[face->cell] != layer)
            continue;
        for (int k = 0; sf_surface_has_face(face, member) && k < face->size; k++) {
            sf_facet_triangle part[2];
            double weight[2][4];
            sf_dual_boundary(mesh, face, k, part, weight);
            area[face->node[k]] += length(part[0].area) + length(part[1].area);
        }
    }
    return err->status;
}

/* Outward area vector, m2. */
static void face_area(const sf_mesh *mesh, const sf_boundary_face *face, double out[3]) {
    if (face->size == 2) {
        sf_facet_triangle point[2];
        ring(&mesh->position[3 * (int64_t)face->node[0]], &mesh->position[3 * (int64_t)face->node[1]], point);
        for (int c = 0; c < 3; c++)
            out[c] = point[0].area[c] + point[1].area[c];
        return;
    }
    const double *p = &mesh->position[3 * face->node[0]], *q = &mesh->position[3 * face->node[1]],
                 *r = &mesh->position[3 * face->node[2]],
                 *s = face->size == 4 ? &mesh->position[3 * face->node[3]] : p;
    double d[3], e[3];
    sf_sub3(r, p, d);
    sf_sub3(s, q, e);
    sf_cross3(d, e, out);
    for (int c = 0; c < 3; c++)
        out[c] *= 0.5;
}

sf_status sf_surface_find_sides(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set,
                                const double direction[3], sf_surface_sides *sides, sf_error *err) {
    SF_OWNED uint8_t *member = sf_surface_members(mesh, set, err);
    *sides = (sf_surface_sides){0};
    for (int64_t f = 0; member && f < dual->face_count; f++) {
        double a[3];
        if (!sf_surface_has_face(&dual->face[f], member))
            continue;
        face_area(mesh, &dual->face[f], a);
        double along = sf_dot3(a, direction);
        sides->area += length(a);
        sides->facing += fmax(0, -along);
    }
    return err->status;
}
