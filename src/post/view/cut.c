/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/cut.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/model.h"

/* A point closer to an end than this part of the thickness is at the end. */
static const double AT_END = 1e-6;

/* Extent of points along x (0) or y. */
static void find_extent(const double *position, int64_t count, int k, double extent[2]) {
    extent[0] = INFINITY;
    extent[1] = -INFINITY;
    for (int64_t i = 0; i < count; i++) {
        extent[0] = fmin(extent[0], position[3 * i + k]);
        extent[1] = fmax(extent[1], position[3 * i + k]);
    }
}

/* Files of earlier versions do not say where the planes are, nor do those where all nodes of a plane are of
 * the base too. A symmetry plane is an end of the modelled pad, where a whole missile has its middle, or one
 * that is modelled in part ends too: how many of the pad's two ends are such; *place (m) of the last. */
static int count_common_ends(const sf_results *r, int k, double *place) {
    double pad[2], missile[2];
    int count = 0;
    find_extent(r->position, r->node_count, k, pad);
    find_extent(r->surface_position, r->surface_node_count, k, missile);
    const double marks[3] = {0.5 * (missile[0] + missile[1]), missile[0], missile[1]};
    for (int end = 0; end < 2; end++) {
        double off = INFINITY;
        for (int mark = 0; mark < 3; mark++)
            off = fmin(off, fabs(marks[mark] - pad[end]));
        if (off > AT_END * r->thickness)
            continue;
        *place = pad[end];
        count++;
    }
    return count;
}

bool sf_axis_planes(const sf_results *r, double place[2]) {
    place[0] = r->symmetry_place[0];
    place[1] = r->symmetry_place[1];
    if (r->symmetry_factor == 1 << (isfinite(place[0]) + isfinite(place[1])))
        return true;
    double end[2];
    const int count[2] = {count_common_ends(r, 0, &end[0]), count_common_ends(r, 1, &end[1])};
    bool known = r->symmetry_factor == 4 ? count[0] == 1 && count[1] == 1 : count[0] + count[1] == 1;
    for (int k = 0; k < 2; k++)
        place[k] = known && count[k] ? end[k] : NAN;
    return known;
}

void sf_axis_find(const sf_results *r, double axis[2]) {
    double place[2], missile[2];
    sf_axis_planes(r, place);
    for (int k = 0; k < 2; k++) {
        find_extent(r->surface_position, r->surface_node_count, k, missile);
        axis[k] = isfinite(place[k]) ? place[k] : 0.5 * (missile[0] + missile[1]);
    }
}

/* The array with room for one more item; NULL, and the array as it was, if there is no memory. */
static void *grow(void *items, int64_t count, int64_t *room, size_t size, sf_error *err) {
    if (count < *room)
        return items;
    int64_t more = *room ? 2 * *room : 256;
    void *grown = realloc(items, (size_t)more * size);
    if (!grown)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the pictures of the report");
    else
        *room = more;
    return grown;
}

double sf_cut_value(const sf_cut_point *p, const double *field, int components, int component) {
    double a = field[components * (int64_t)p->node[0] + component];
    double b = field[components * (int64_t)p->node[1] + component];
    return a + p->weight * (b - a);
}

static double height_over(const sf_cut *cut, const double *position) {
    return position[1] - cut->plane;
}

/* The point where the edge between the nodes crosses the plane; false if it does not. */
static bool cross_edge(const sf_cut *cut, int32_t a, int32_t b, sf_cut_point *point) {
    double from = height_over(cut, &cut->results->position[3 * (int64_t)a]);
    double to = height_over(cut, &cut->results->position[3 * (int64_t)b]);
    if ((from < 0) == (to < 0))
        return false;
    *point = (sf_cut_point){{a, b}, from / (from - to)};
    return true;
}

/* A tetrahedron has a triangle or a quadrangle in the plane. The edges of the list follow each other around
 * it: of the four that a quadrangle crosses, those that are opposite in the tetrahedron are never neighbours.
 */
static sf_status cut_tetrahedron(sf_cut *cut, const int32_t *cell, const int corner[4], sf_error *err) {
    static const int edge[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    sf_cut_polygon polygon = {0};
    for (int k = 0; k < 6 && polygon.count < 4; k++)
        polygon.count += cross_edge(cut, cell[corner[edge[k][0]]], cell[corner[edge[k][1]]],
                                    &polygon.point[polygon.count]);
    if (polygon.count < 3)
        return SF_OK;
    if (polygon.count ==
        4) { /* two of the points are on opposite edges: they become the first and the third */
        sf_cut_point first = polygon.point[0];
        for (int k = 1; k < 4; k++) {
            const sf_cut_point *p = &polygon.point[k];
            bool shared = p->node[0] == first.node[0] || p->node[0] == first.node[1] ||
                          p->node[1] == first.node[0] || p->node[1] == first.node[1];
            if (!shared && k != 2) {
                sf_cut_point other = polygon.point[2];
                polygon.point[2] = *p;
                polygon.point[k] = other;
            }
        }
    }
    void *grown = grow(cut->polygon, cut->polygon_count, &cut->polygon_room, sizeof polygon, err);
    if (!grown)
        return err->status;
    cut->polygon = grown;
    cut->polygon[cut->polygon_count++] = polygon;
    return SF_OK;
}

static sf_status cut_face(sf_cut *cut, const int32_t *cell, const int corner[4], sf_error *err) {
    sf_cut_point point[4];
    int sides = corner[3] < 0 ? 3 : 4, count = 0;
    for (int k = 0; k < sides; k++)
        count += cross_edge(cut, cell[corner[k]], cell[corner[(k + 1) % sides]], &point[count]);
    if (count != 2)
        return SF_OK;
    void *grown = grow(cut->line, cut->line_count, &cut->line_room, sizeof *cut->line, err);
    if (!grown)
        return err->status;
    cut->line = grown;
    memcpy(cut->line[cut->line_count++], point, sizeof *cut->line);
    return SF_OK;
}

static sf_status cut_cells(sf_cut *cut, sf_error *err) {
    const sf_results *r = cut->results;
    for (int64_t c = 0; c < r->cell_count && err->status == SF_OK; c++) {
        const int32_t *cell = &r->cell_node[r->cell_ptr[c]];
        const int(*part)[4];
        int64_t vertices = r->cell_ptr[c + 1] - r->cell_ptr[c], below = 0;
        for (int64_t v = 0; v < vertices; v++)
            below += height_over(cut, &r->position[3 * (int64_t)cell[v]]) < 0;
        if (below == 0 || below == vertices)
            continue;
        int count = sf_cell_tetrahedra(r->cell_type[c], &part);
        for (int k = 0; k < count && err->status == SF_OK; k++)
            cut_tetrahedron(cut, cell, part[k], err);
        count = sf_cell_faces(r->cell_type[c], &part);
        for (int k = 0; k < count && err->status == SF_OK; k++)
            cut_face(cut, cell, part[k], err);
    }
    return err->status;
}

/* The part of a triangle in the plane. */
static bool cross_triangle(const sf_cut *cut, const double *const corner[3], double segment[2][2]) {
    int count = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = corner[k], *b = corner[(k + 1) % 3];
        double from = height_over(cut, a), to = height_over(cut, b);
        if ((from < 0) == (to < 0))
            continue;
        double weight = from / (from - to);
        segment[count][0] = a[0] + weight * (b[0] - a[0]);
        segment[count++][1] = a[2] + weight * (b[2] - a[2]);
    }
    return count == 2;
}

bool sf_cut_triangle(const sf_cut *cut, const sf_frame_head *head, int64_t t, double end[2][2]) {
    const sf_results *r = cut->results;
    double x[3][3];
    for (int k = 0; k < 3; k++)
        sf_results_place(r, head, &r->surface_position[3 * (int64_t)r->surface_triangle[3 * t + k]], x[k]);
    return cross_triangle(cut, (const double *const[3]){x[0], x[1], x[2]}, end);
}

static sf_status cut_missile(sf_cut *cut, sf_error *err) {
    const sf_results *r = cut->results;
    cut->missile[0] = INFINITY;
    cut->missile[1] = -INFINITY;
    for (int64_t t = 0; t < r->surface_triangle_count; t++) {
        double segment[2][2];
        const double *corner[3];
        for (int k = 0; k < 3; k++)
            corner[k] = &r->surface_position[3 * (int64_t)r->surface_triangle[3 * t + k]];
        if (!cross_triangle(cut, corner, segment))
            continue;
        void *grown = grow(cut->outline, cut->outline_count, &cut->outline_room, sizeof *cut->outline, err);
        if (!grown)
            return err->status;
        cut->outline = grown;
        memcpy(cut->outline[cut->outline_count++], segment, sizeof *cut->outline);
        for (int k = 0; k < 2; k++) {
            cut->missile[0] = fmin(cut->missile[0], segment[k][0]);
            cut->missile[1] = fmax(cut->missile[1], segment[k][0]);
        }
    }
    return SF_OK;
}

/* The plane, and whether the pad goes on beyond the missile's axis as its mirror image. */
static void find_plane(sf_cut *cut) {
    const sf_results *r = cut->results;
    double axis[2], place[2], low[3] = {INFINITY, INFINITY, INFINITY},
                              high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int64_t i = 0; i < r->node_count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], r->position[3 * i + k]);
            high[k] = fmax(high[k], r->position[3 * i + k]);
        }
    sf_axis_find(r, axis);
    sf_axis_planes(r, place);
    double near = 1e-6 * fmax(high[0] - low[0], high[1] - low[1]);
    cut->axis = axis[0];
    cut->mirrored = isfinite(place[0]);
    cut->plane = axis[1] + (axis[1] + near < high[1] ? near : -near);
    cut->x[0] = low[0];
    cut->x[1] = high[0];
    cut->z[0] = low[2];
    cut->z[1] = high[2];
}

sf_status sf_cut_make(const sf_results *results, sf_cut *cut, sf_error *err) {
    *cut = (sf_cut){.results = results};
    find_plane(cut);
    if (cut_cells(cut, err) == SF_OK)
        cut_missile(cut, err);
    return err->status;
}

void sf_cut_free(sf_cut *cut) {
    free(cut->polygon);
    free(cut->line);
    free(cut->outline);
    *cut = (sf_cut){0};
}
