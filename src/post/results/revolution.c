/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/results/revolution.h"

#include "model/cells.h"
#include "model/model.h"

enum { SECTORS = 12 }; /* of the quarter */

static bool is_on_axis(const sf_revolution *v, int32_t node) {
    return v->node[v->place[node]] == node && v->place[node] < v->axis_nodes;
}

static int32_t node_at(const sf_revolution *v, int32_t node, int plane) {
    int64_t beside = v->section_nodes - v->axis_nodes;
    if (is_on_axis(v, node))
        return v->place[node];
    return (int32_t)(v->axis_nodes + plane * beside) + v->place[node];
}

sf_status sf_revolution_build(int64_t nodes, const double *position, sf_revolution *v, sf_error *err) {
    *v = (sf_revolution){.section_nodes = nodes};
    int32_t beside = 0;
    for (int64_t i = 0; i < nodes; i++)
        v->axis_nodes += position[3 * i] == 0;
    v->nodes = v->axis_nodes + (SECTORS + 1) * (nodes - v->axis_nodes);
    if (v->nodes > INT32_MAX)
        return SF_FAIL(err, SF_ERR_IO, "/model/position: the body of revolution has %lld nodes, more than %d",
                       (long long)v->nodes, INT32_MAX);
    SF_ALLOC_ALL(err, "the body of revolution", SF_ROOM(v->place, nodes), SF_ROOM(v->node, v->nodes),
                 SF_ROOM(v->plane, v->nodes));
    int32_t axis = 0;
    for (int32_t i = 0; err->status == SF_OK && i < (int32_t)nodes; i++) {
        if (position[3 * (int64_t)i] == 0) {
            v->place[i] = axis;
            v->node[axis++] = i;
            continue;
        }
        v->place[i] = beside++;
        for (int k = 0; k <= SECTORS; k++) {
            int64_t node = v->axis_nodes + k * (nodes - v->axis_nodes) + v->place[i];
            v->node[node] = i;
            v->plane[node] = (uint8_t)k;
        }
    }
    if (err->status != SF_OK)
        sf_revolution_free(v);
    return err->status;
}

void sf_revolution_free(sf_revolution *v) {
    SF_CLEAR(v, v->place, v->node, v->plane);
}

static void add_cell(sf_cell_lists *r, int type, int count, const int32_t *node) {
    r->type[r->count++] = (uint8_t)type;
    memcpy(&r->node[r->entries], node, (size_t)count * sizeof *node);
    r->entries += count;
    r->ptr[r->count] = r->entries;
}

/* A triangle between two half planes, its corners from one on the axis on, counter-clockwise in (R, Z). */
static void add_wedge(sf_cell_lists *r, const sf_revolution *p, const int32_t v[3], int k) {
    int32_t a[3], b[3];
    int axis = 0;
    for (int c = 0; c < 3; c++) {
        a[c] = node_at(p, v[c], k);
        b[c] = node_at(p, v[c], k + 1);
        axis += a[c] == b[c];
    }
    if (axis == 0) {
        add_cell(r, SF_CELL_PRISM, 6, (const int32_t[]){b[0], b[1], b[2], a[0], a[1], a[2]});
    } else if (axis == 1) { /* v[0] */
        add_cell(r, SF_CELL_PYRAMID, 5, (const int32_t[]){a[1], a[2], b[2], b[1], a[0]});
    } else if (a[1] == b[1]) { /* v[0] and v[1] */
        add_cell(r, SF_CELL_TETRAHEDRON, 4, (const int32_t[]){a[0], b[2], a[2], a[1]});
    } else { /* v[0] and v[2] */
        add_cell(r, SF_CELL_TETRAHEDRON, 4, (const int32_t[]){a[0], a[1], b[1], a[2]});
    }
}

/* A cell between two half planes; `v`: its corners, turned so that one on the axis is the first, and of two
 * the second one is the last. */
static void add_cells(sf_cell_lists *r, const sf_revolution *p, int vertices, const int32_t *v, int k) {
    int32_t a[4], b[4];
    int axis = 0;
    for (int c = 0; c < vertices; c++) {
        a[c] = node_at(p, v[c], k);
        b[c] = node_at(p, v[c], k + 1);
        axis += a[c] == b[c];
    }
    if (vertices == 3) {
        add_wedge(r, p, v, k);
    } else if (axis == 0) {
        add_cell(r, SF_CELL_HEXAHEDRON, 8, (const int32_t[]){b[0], b[1], b[2], b[3], a[0], a[1], a[2], a[3]});
    } else if (axis == 2) { /* v[0] and v[3]: triangles at the lower and the upper side */
        add_cell(r, SF_CELL_PRISM, 6, (const int32_t[]){a[0], a[1], b[1], a[3], a[2], b[2]});
    } else {
        add_wedge(r, p, (const int32_t[]){v[0], v[1], v[2]}, k);
        add_wedge(r, p, (const int32_t[]){v[0], v[2], v[3]}, k);
    }
}

sf_status sf_revolution_cells(const sf_revolution *v, sf_cell_lists *cells, sf_error *err) {
    const sf_cell_lists old = *cells;
    sf_cell_lists out = {0};
    SF_ALLOC_ALL(err, "the body of revolution", SF_ROOM(out.type, 2 * SECTORS * old.count),
                 SF_ROOM(out.ptr, 2 * SECTORS * old.count + 1), SF_ROOM(out.node, 3 * SECTORS * old.entries));
    for (int64_t c = 0; err->status == SF_OK && c < old.count; c++) {
        int vertices = old.type[c] == SF_CELL_TRIANGLE ? 3 : 4, first = 0;
        const int32_t *corner = &old.node[old.ptr[c]];
        int32_t turned[4];
        for (int a = 0; a < vertices; a++) /* on the axis, and the next one is not */
            if (is_on_axis(v, corner[a]) && !is_on_axis(v, corner[(a + 1) % vertices]))
                first = a;
        for (int a = 0; a < vertices; a++)
            turned[a] = corner[(first + a) % vertices];
        for (int k = 0; k < SECTORS; k++)
            add_cells(&out, v, vertices, turned, k);
    }
    if (err->status != SF_OK) {
        SF_FREE(out.type, out.ptr, out.node);
        return err->status;
    }
    SF_FREE(old.type, old.ptr, old.node);
    *cells = out;
    return SF_OK;
}

double sf_revolution_share(const sf_revolution *v, int64_t node) {
    if (node < v->axis_nodes)
        return 0.25;
    return (v->plane[node] == 0 || v->plane[node] == SECTORS ? 0.125 : 0.25) / SECTORS;
}

/* Components of a vector with the parts R, theta and Z. */
static void turn_vector(double cosine, double sine, const double in[3], double out[3]) {
    out[0] = cosine * in[0] - sine * in[1];
    out[1] = sine * in[0] + cosine * in[1];
    out[2] = in[2];
}

static void turn_tensor(double cosine, double sine, const double in[9], double out[9]) {
    double half[9];
    for (int r = 0; r < 3; r++) /* in Q^T */
        turn_vector(cosine, sine, &in[3 * r], &half[3 * r]);
    for (int c = 0; c < 3; c++) {
        double column[3] = {half[c], half[3 + c], half[6 + c]}, turned[3];
        turn_vector(cosine, sine, column, turned);
        for (int r = 0; r < 3; r++)
            out[3 * r + c] = turned[r];
    }
}

sf_status sf_revolution_field(const sf_revolution *v, int components, bool vector, double **field,
                              sf_error *err) {
    double *out = sf_alloc(err, v->nodes, (unsigned long)components * sizeof *out, "the body of revolution");
    SF_TRY(err->status);
    for (int64_t i = 0; i < v->nodes; i++) {
        int plane = v->plane[i];
        double angle = plane * M_PI / (2 * SECTORS), cosine = plane == SECTORS ? 0 : cos(angle),
               sine = plane == SECTORS ? 1 : sin(angle);
        const double *from = &(*field)[components * (int64_t)v->node[i]];
        double *to = &out[components * i];
        if (vector)
            turn_vector(cosine, sine, from, to);
        else if (components == 9)
            turn_tensor(cosine, sine, from, to);
        else
            memcpy(to, from, (size_t)components * sizeof *to);
    }
    free(*field);
    *field = out;
    return SF_OK;
}
