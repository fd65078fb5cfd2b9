/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/ridges.h"

#include "base/mat3.h"
#include "base/sets.h"
#include <string.h>

static const double ON_PLANE = 1e-6; /* of the surface's size */

/* A surface whose nodes at one place are one, and its size (m). */
typedef struct surface {
    int64_t nodes, triangles;
    const double *position;
    int32_t *triangle; /* [triangles][3] */
    double size;
    const sf_ridge_limits *limits;
} surface;

typedef struct vertex {
    double x[3];
    int32_t node;
} vertex;

static int compare_places(const void *a, const void *b) {
    const vertex *one = a, *other = b;
    for (int r = 0; r < 3; r++)
        if (one->x[r] != other->x[r])
            return SF_ORDER(one->x[r], other->x[r]);
    return SF_ORDER(one->node, other->node);
}

/* Gives each triangle the first of the nodes at its corners' places. */
static sf_status join_nodes(const int32_t *triangle, surface *s, sf_error *err) {
    SF_OWNED vertex *list = sf_alloc(err, s->nodes, sizeof *list, "edges of a surface");
    SF_OWNED int32_t *first = sf_alloc(err, s->nodes, sizeof *first, "edges of a surface");
    s->triangle = sf_alloc(err, 3 * s->triangles, sizeof *s->triangle, "edges of a surface");
    SF_TRY(err->status);
    double low[3], high[3];
    sf_box3(s->nodes, s->position, low, high);
    s->size = sf_distance3(low, high);
    for (int64_t i = 0; i < s->nodes; i++) {
        memcpy(list[i].x, &s->position[3 * i], sizeof list[i].x);
        list[i].node = (int32_t)i;
    }
    qsort(list, (size_t)s->nodes, sizeof *list, compare_places);
    for (int64_t i = 0; i < s->nodes; i++) {
        bool same = i > 0;
        for (int r = 0; r < 3; r++)
            same = same && list[i].x[r] == list[i - 1].x[r]; /* 0 and -0, too */
        first[list[i].node] = same ? first[list[i - 1].node] : list[i].node;
    }
    for (int64_t k = 0; k < 3 * s->triangles; k++)
        s->triangle[k] = first[triangle[k]];
    return SF_OK;
}

/* True if an angle (rad) between facets of this width (m) enters the pad by more than is small. */
static bool is_sharp(const surface *s, double angle, double width) {
    return angle / 4 * fmax(1, s->limits->spacing / (2 * width)) > s->limits->depth;
}

/* Bits of the symmetry planes that the point lies in. */
static int planes_of(const surface *s, const double x[3]) {
    int in = 0;
    for (int r = 0; r < 2; r++)
        in |= (fabs(x[r] - s->limits->place[r]) < ON_PLANE * s->size) << r;
    return in;
}

static double angle_between(const double a[3], const double b[3]) {
    double cross[3];
    sf_cross3(a, b, cross);
    return atan2(sqrt(sf_dot3(cross, cross)), sf_dot3(a, b));
}

/* One side of an edge: the facet's normal, the arm in it, and its height (m) over the edge. */
typedef struct side {
    double normal[3], arm[3], width;
} side;

static side side_of(const surface *s, int64_t slot) {
    side out;
    const double *x[3];
    double along[3];
    sf_corners(s->position, &s->triangle[3 * (slot / 3)], x);
    sf_triangle_normal(x[0], x[1], x[2], out.normal);
    sf_unit3(out.normal);
    const double *a = x[slot % 3], *b = x[(slot + 1) % 3], *c = x[(slot + 2) % 3];
    sf_sub3(b, a, along);
    sf_unit3(along);
    sf_cross3(out.normal, along, out.arm);
    double across[3];
    sf_sub3(c, a, across);
    out.width = sf_dot3(across, out.arm);
    return out;
}

/* The other side of an edge in a symmetry plane, 1 or 2: the image of the one. */
static side side_beyond(const side *one, int plane) {
    side out = *one;
    out.normal[plane - 1] *= -1;
    out.arm[plane - 1] *= -1;
    return out;
}

/* Adds the edge of `count` half edges if it is sharp and convex, and marks its ends. */
static void take_edge(const surface *s, const sf_half_edge *half, int64_t count, uint8_t *mark,
                      sf_ridges *out) {
    int in = planes_of(s, &s->position[3 * (int64_t)half->low]) &
             planes_of(s, &s->position[3 * (int64_t)half->high]);
    int plane = in == 3 ? 0 : in;
    if (count == 1 && plane == 0) /* the surface ends there: what lies beyond is not known */
        return;
    side one = side_of(s, half->slot),
         other = count > 1 ? side_of(s, half[1].slot) : side_beyond(&one, plane);
    double angle = angle_between(one.normal, other.normal);
    if (!(sf_dot3(one.normal, other.arm) < 0) || !is_sharp(s, angle, 0.5 * (one.width + other.width)))
        return;
    mark[half->low] = mark[half->high] = 1;
    if (in != 0)
        return;
    sf_ridge *ridge = &out->ridge[out->count++];
    ridge->node[0] = half->low;
    ridge->node[1] = half->high;
    ridge->facet = half->slot / 3;
    memcpy(ridge->arm[0], one.arm, sizeof one.arm);
    memcpy(ridge->arm[1], other.arm, sizeof other.arm);
}

/* Marks the nodes at which the facets turn as at the tip of a cone. */
static sf_status mark_tips(const surface *s, uint8_t *mark, sf_error *err) {
    SF_OWNED double *normal = sf_alloc(err, 3 * s->nodes, sizeof *normal, "edges of a surface");
    SF_OWNED double *turn = sf_alloc(err, s->nodes, sizeof *turn, "edges of a surface");
    SF_OWNED double *length = sf_alloc(err, s->nodes, sizeof *length, "edges of a surface");
    SF_TRY(err->status);
    for (int64_t k = 0; k < 3 * s->triangles; k++) {
        side one = side_of(s, k);
        for (int r = 0; r < 3; r++)
            normal[3 * (int64_t)s->triangle[k] + r] += one.normal[r];
    }
    for (int64_t i = 0; i < s->nodes; i++) {
        int in = planes_of(s, &s->position[3 * i]);
        for (int r = 0; r < 2; r++)
            normal[3 * i + r] *= !(in >> r & 1);
    }
    for (int64_t k = 0; k < 3 * s->triangles; k++) {
        int64_t i = s->triangle[k], next = s->triangle[k - k % 3 + (k + 1) % 3];
        side one = side_of(s, k);
        turn[i] = fmax(turn[i], 2 * angle_between(one.normal, &normal[3 * i]));
        length[i] = fmax(length[i], sf_distance3(&s->position[3 * i], &s->position[3 * next]));
    }
    for (int64_t i = 0; i < s->nodes; i++)
        mark[i] |= length[i] > 0 && is_sharp(s, turn[i], length[i]);
    return SF_OK;
}

/* Lists the marked nodes as corners, with their arms. */
static sf_status list_corners(const surface *s, const uint8_t *mark, sf_ridges *out, sf_error *err) {
    SF_OWNED int32_t *number = sf_alloc(err, s->nodes, sizeof *number, "edges of a surface");
    for (int64_t i = 0; number && i < s->nodes; i++)
        out->corner_count += mark[i];
    SF_TRY(SF_ALLOC_ALL(err, "edges of a surface", SF_ROOM(out->corner, out->corner_count),
                        SF_ROOM(out->facet, out->corner_count), SF_ROOM(out->ptr, out->corner_count + 2)));
    for (int64_t i = 0, k = 0; i < s->nodes; i++) {
        number[i] = mark[i] ? (int32_t)k : -1;
        if (mark[i])
            out->corner[k++] = (int32_t)i;
    }
    for (int64_t k = 0; k < 3 * s->triangles; k++)
        if (number[s->triangle[k]] >= 0)
            out->ptr[number[s->triangle[k]] + 2] += 2;
    for (int64_t k = 0; k < out->corner_count; k++)
        out->ptr[k + 2] += out->ptr[k + 1];
    out->arm = sf_alloc(err, 3 * (unsigned long)out->ptr[out->corner_count + 1], sizeof *out->arm,
                        "edges of a surface");
    for (int64_t k = 0; out->arm && k < 3 * s->triangles; k++)
        for (int of = 1; of < 3 && number[s->triangle[k]] >= 0; of++) {
            out->facet[number[s->triangle[k]]] = (int32_t)(k / 3);
            int64_t i = s->triangle[k], other = s->triangle[k - k % 3 + (k + of) % 3];
            double *arm = &out->arm[3 * out->ptr[number[i] + 1]++];
            sf_sub3(&s->position[3 * other], &s->position[3 * i], arm);
            sf_unit3(arm);
        }
    return err->status;
}

sf_status sf_ridges_find(int64_t nodes, const double *position, int64_t triangles, const int32_t *triangle,
                         const sf_ridge_limits *limits, sf_ridges *out, sf_error *err) {
    surface s = {nodes, triangles, position, NULL, 0, limits};
    SF_OWNED uint8_t *mark = sf_alloc(err, nodes, 1, "edges of a surface");
    *out = (sf_ridges){0};
    if (mark && join_nodes(triangle, &s, err) == SF_OK) {
        SF_OWNED sf_half_edge *half = sf_half_edges(triangles, s.triangle, err);
        out->ridge = sf_alloc(err, 3 * triangles, sizeof *out->ridge, "edges of a surface");
        for (int64_t k = 0, end; half && out->ridge && k < 3 * triangles; k = end) {
            end = sf_half_edges_end(half, k, 3 * triangles);
            take_edge(&s, &half[k], end - k, mark, out);
        }
        if (err->status == SF_OK && mark_tips(&s, mark, err) == SF_OK)
            list_corners(&s, mark, out, err);
    }
    SF_FREE(s.triangle);
    if (err->status != SF_OK)
        sf_ridges_free(out);
    return err->status;
}

void sf_ridges_free(sf_ridges *r) {
    SF_CLEAR(r, r->ridge, r->corner, r->facet, r->ptr, r->arm);
}
