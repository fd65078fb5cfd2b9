/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/rigid_support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mat3.h"
#include "base/sets.h"
#include "pre/free_faces.h"
#include "pre/mesh/missile_shape.h"

static const double SHARP =
    0.77; /* cosine of the normals of two faces, 40 degrees: their edge is no facet edge */

/* A surface of triangles; borrowed. */
typedef struct triangles {
    int64_t count;
    const double *position;
    const int32_t *node; /* [count][3] */
} triangles;

static const double *corner(const triangles *s, int64_t t, int k) {
    return &s->position[3 * (int64_t)s->node[3 * t + k]];
}

/* Normal of a triangle, of twice its area; to its unit vector with `unit`. */
static void find_normal(const triangles *s, int64_t t, bool unit, double out[3]) {
    double side[2][3];
    for (int k = 0; k < 2; k++)
        for (int r = 0; r < 3; r++)
            side[k][r] = corner(s, t, k + 1)[r] - corner(s, t, 0)[r];
    sf_cross3(side[0], side[1], out);
    if (unit)
        sf_unit3(out);
}

/* ---- sharp edges ---- */

typedef struct half_edge {
    int32_t low, high;
    int64_t at_low, at_high; /* corners, 3 * triangle + place */
} half_edge;

static int by_ends(const void *a, const void *b) {
    const half_edge *x = a, *y = b;
    int low = (x->low > y->low) - (x->low < y->low), high = (x->high > y->high) - (x->high < y->high);
    return low ? low : high ? high : (x->at_low > y->at_low) - (x->at_low < y->at_low);
}

/* Joins the corners at the ends of the edges that are not sharp. */
static void join_corners(const triangles *s, half_edge *edge, int64_t *parent) {
    int64_t count = 3 * s->count;
    for (int64_t k = 0; k < count; k++) {
        int64_t next = k % 3 == 2 ? k - 2 : k + 1;
        bool rises = s->node[k] < s->node[next];
        edge[k] = (half_edge){s->node[rises ? k : next], s->node[rises ? next : k], rises ? k : next,
                              rises ? next : k};
    }
    qsort(edge, (size_t)count, sizeof *edge, by_ends);
    for (int64_t k = 1; k < count; k++) {
        double one[3], other[3];
        if (edge[k].low != edge[k - 1].low || edge[k].high != edge[k - 1].high)
            continue;
        find_normal(s, edge[k].at_low / 3, true, one);
        find_normal(s, edge[k - 1].at_low / 3, true, other);
        if (sf_dot3(one, other) < SHARP)
            continue;
        sf_sets_join(parent, edge[k].at_low, edge[k - 1].at_low);
        sf_sets_join(parent, edge[k].at_high, edge[k - 1].at_high);
    }
}

/* The model's nodes are the corners that were joined. */
static sf_status split_edges(const triangles *s, sf_model *m, sf_error *err) {
    unsigned long corners = 3 * (unsigned long)s->count;
    half_edge *edge = sf_alloc(err, corners, sizeof *edge, "edges of the support");
    int64_t *parent = sf_sets_alone((int64_t)corners, "edges of the support", err);
    m->support_position = sf_alloc(err, 3 * corners, sizeof *m->support_position, "support");
    m->support_triangle = sf_alloc(err, corners, sizeof *m->support_triangle, "support");
    if (err->status == SF_OK) {
        join_corners(s, edge, parent);
        for (int64_t k = 0; k < (int64_t)corners; k++) { /* a leader is the first of its corners */
            int64_t first = sf_sets_find(parent, k);
            m->support_triangle[k] =
                first < k ? m->support_triangle[first] : (int32_t)m->support_node_count++;
            memcpy(&m->support_position[3 * (int64_t)m->support_triangle[k]], corner(s, k / 3, (int)(k % 3)),
                   3 * sizeof(double));
        }
        m->support_triangle_count = s->count;
    }
    free(edge);
    free(parent);
    return err->status;
}

/* ---- checks ---- */

static double least_spacing(const sf_model *m) {
    double least = INFINITY;
    for (int64_t i = 0; i < m->node_count; i++)
        least = fmin(least, m->spacing[i]);
    return least;
}

static triangles support_of(const sf_model *m) {
    return (triangles){m->support_triangle_count, m->support_position, m->support_triangle};
}

/* Depth (m) of x behind the nearest place of the surface; 0 before it, and beside an open one. */
static double depth_behind(const triangles *s, const double x[3]) {
    static const double SAME = 1e-9, STRAIGHT = 0.5; /* of a squared distance; cosine */
    double best = INFINITY, sum[3] = {0}, ray[3] = {0};
    for (int64_t t = 0; t < s->count; t++) {
        double point[3], r[3], normal[3];
        int feature;
        sf_triangle_nearest(corner(s, t, 0), corner(s, t, 1), corner(s, t, 2), x, point, &feature);
        for (int k = 0; k < 3; k++)
            r[k] = x[k] - point[k];
        double square = sf_dot3(r, r);
        if (square > best * (1 + SAME))
            continue;
        bool nearer = square < best * (1 - SAME);
        find_normal(s, t, true, normal);
        for (int k = 0; k < 3; k++) {
            sum[k] = normal[k] + (nearer ? 0 : sum[k]);
            ray[k] = r[k];
        }
        best = fmin(best, square);
    }
    sf_unit3(sum);
    double behind = -sf_dot3(ray, sum);
    return behind > STRAIGHT * sqrt(best) ? sqrt(best) : 0;
}

typedef struct box {
    double low[3], high[3];
} box;

static bool is_in_box(const box *b, const double x[3]) {
    bool in = true;
    for (int r = 0; r < 3; r++)
        in = in && x[r] >= b->low[r] && x[r] <= b->high[r];
    return in;
}

/* The point of `count`, within the surface's box, that lies deepest behind it. */
static double deepest_behind(const triangles *s, const box *around, int64_t count, const double *position,
                             double place[3]) {
    double deepest = 0;
    for (int64_t i = 0; i < count; i++) {
        const double *x = &position[3 * i];
        double depth = is_in_box(around, x) ? depth_behind(s, x) : 0;
        if (depth > deepest)
            memcpy(place, x, 3 * sizeof *x);
        deepest = fmax(deepest, depth);
    }
    return deepest;
}

/* Nodes of the pad that lie deeper than SF_CONTACT_ENTRY would never touch. Corners of the support between
 * the nodes of a curved face are deeper where both are meshed. */
static sf_status check_apart(const sf_model *m, const triangles *pad, sf_error *err) {
    static const double BETWEEN = 0.5; /* of the spacing */
    const triangles support = support_of(m);
    box of_pad, of_support;
    sf_box3(m->node_count, m->position, of_pad.low, of_pad.high);
    sf_box3(m->support_node_count, m->support_position, of_support.low, of_support.high);
    double x[3], spacing = least_spacing(m),
                 node = deepest_behind(&support, &of_support, m->node_count, m->position, x);
    bool pierced = node <= SF_CONTACT_ENTRY * spacing;
    double depth =
        pierced ? deepest_behind(pad, &of_pad, m->support_node_count, m->support_position, x) : node;
    if (depth <= (pierced ? BETWEEN : SF_CONTACT_ENTRY) * spacing)
        return SF_OK;
    return SF_REFUSE(
        err,
        "geometry.support_file: pad and support overlap at the start: at (%.4g, %.4g, %.4g) mm the %s "
        "is %.4g mm inside the %s; move the support, or turn its surface outwards (close it)",
        1e3 * x[0], 1e3 * x[1], 1e3 * x[2], pierced ? "support" : "pad", 1e3 * depth,
        pierced ? "pad" : "support");
}

double sf_support_distance(const sf_model *m, const double x[3], const double direction[3]) {
    static const double BEHIND = 0.01; /* of the thickness: facets of curved faces overlap by less */
    const triangles s = support_of(m);
    double nearest = INFINITY;
    for (int64_t t = 0; t < s.count; t++) {
        double normal[3],
            at = -sf_triangle_travel(corner(&s, t, 0), corner(&s, t, 1), corner(&s, t, 2), direction, x);
        find_normal(&s, t, false, normal);
        if (isfinite(at) && sf_dot3(normal, direction) < 0 && at < nearest && at > -BEHIND * m->thickness)
            nearest = at;
    }
    return nearest;
}

/* Some face of the pad has the support before it. */
static sf_status check_reach(const sf_model *m, const triangles *pad, sf_error *err) {
    double nearest = INFINITY;
    for (int64_t t = 0; t < pad->count && nearest > m->thickness; t++) {
        double normal[3], middle[3];
        find_normal(pad, t, true, normal);
        for (int r = 0; r < 3; r++)
            middle[r] = (corner(pad, t, 0)[r] + corner(pad, t, 1)[r] + corner(pad, t, 2)[r]) / 3;
        nearest = fmin(nearest, fabs(sf_support_distance(m, middle, normal)));
    }
    if (nearest <= m->thickness)
        return SF_OK;
    return SF_REFUSE(
        err,
        "geometry.support_file: no face of the pad has the support before it within the pad's thickness "
        "of %.4g mm%s: check its place and the unit of length",
        1e3 * m->thickness, isfinite(nearest) ? ", the nearest is farther" : "");
}

/* A node of the pad keeps a limited number of facets in reach. */
static sf_status check_size(const sf_model *m, const triangles *s, sf_error *err) {
    static const double LEAST = 0.25; /* of the spacing */
    double area = 0, normal[3], spacing = least_spacing(m);
    for (int64_t t = 0; t < s->count; t++) {
        find_normal(s, t, false, normal);
        area += sqrt(sf_dot3(normal, normal));
    }
    double side = sqrt(area / (double)s->count);
    if (side >= LEAST * spacing)
        return SF_OK;
    return SF_REFUSE(
        err,
        "geometry.support_file: the triangles of the support are %.3g mm wide, the pad's spacing is %.3g mm: "
        "mesh the support coarser, with at least %.3g mm",
        1e3 * side, 1e3 * spacing, 1e3 * LEAST * spacing);
}

sf_status sf_support_take(const sf_case *c, sf_surface *surface, sf_model *m, sf_error *err) {
    double against[3];
    int32_t *face = NULL;
    if (!surface)
        return SF_OK;
    for (int r = 0; r < 3; r++)
        against[r] = -c->missile_card.direction[r];
    SF_TRY(sf_surface_turn(surface, against, err));
    const triangles given = {surface->triangle_count, surface->position, surface->triangle};
    triangles pad = {0, m->position, NULL};
    m->support_friction = c->support_friction;
    if (check_size(m, &given, err) == SF_OK && split_edges(&given, m, err) == SF_OK &&
        sf_skin_triangles(m, &pad.count, &face, err) == SF_OK) {
        pad.node = face;
        if (check_apart(m, &pad, err) == SF_OK)
            check_reach(m, &pad, err);
    }
    free(face);
    return err->status;
}

/* Compares vertices with triangles, both ways; the missile does not turn. */
sf_status sf_support_find_travel(sf_model *m, sf_error *err) {
    const sf_surface missile = sf_surface_of_missile(m);
    double travel = INFINITY;
    for (int64_t k = 0; k < m->support_node_count; k++)
        travel = fmin(travel, sf_missile_travel(&missile, &m->missile, &m->support_position[3 * k]));
    for (int64_t k = 0; k < m->surface_node_count && m->support_triangle_count > 0; k++)
        travel = fmin(travel, sf_support_distance(m, &m->surface_position[3 * k], m->missile.direction));
    if (travel <= m->missile.gap)
        return SF_REFUSE(
            err, "geometry.support_file: the missile meets the support %.4g mm before it meets the pad",
            1e3 * (m->missile.gap - travel));
    m->support_travel = isfinite(travel) ? travel : 0;
    return SF_OK;
}
