/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/foam_path.h"

#include "base/mat3.h"
#include "base/sets.h"
#include "pre/mesh/missile_shape.h"
#include "pre/missile_body.h"
#include "pre/support.h"

enum { MOST_RAYS = 200, MOST_HITS = 256 };
static const double FACING = 0.1; /* least cosine between the missile's direction and a face it touches */
static const double ZONE = 0.5;   /* of the length under the first touch */
static const double FACETS =
    0.02; /* of the thickness: those of pad and support on a curved face overlap by less */
static const double SAME = 1e-6; /* of the extent: one place; the same thickness */

typedef enum node_mark { MARK_TOUCHED = 1, MARK_HELD = 2 } node_mark;

typedef struct triangle {
    int32_t node[3];
    double travel; /* m, of the missile to its centroid; infinity: it is not touched */
} triangle;

typedef struct surface_of_pad {
    int64_t count;
    triangle *list; /* owned; turned outwards */
} surface_of_pad;

/* A place where a ray crosses the pad's surface. */
typedef struct hit {
    double at, order; /* m, along the ray; by which the places are sorted */
    bool leaves, held;
} hit;

/* ---- the pad's surface ---- */

static sf_status find_surface(const sf_model *m, surface_of_pad *out, sf_error *err) {
    SF_OWNED int32_t *node = NULL;
    *out = (surface_of_pad){0};
    if (sf_skin_triangles(&SF_CELLS_OF(m), &out->count, &node, NULL, err) == SF_OK)
        out->list = sf_alloc(err, out->count, sizeof *out->list, "surface of the pad");
    for (int64_t i = 0; out->list && i < out->count; i++)
        memcpy(out->list[i].node, &node[3 * i], sizeof out->list[i].node);
    return err->status;
}

static uint8_t *mark_nodes(const sf_model *m, sf_error *err) {
    uint8_t *mark = sf_alloc(err, m->node_count, 1, "thickness of the pad");
    for (int64_t k = 0; mark && k < m->contact_count; k++)
        mark[m->contact_node[k]] |= MARK_TOUCHED;
    for (int64_t k = 0; mark && k < m->fixed_count; k++)
        mark[m->fixed_node[k]] |= m->fixed_base[k] && (m->fixed_mask[k] & SF_FIX_Z) ? MARK_HELD : 0;
    for (int64_t k = 0; mark && k < m->rest_count; k++)
        mark[m->rest_node[k]] |= MARK_HELD;
    return mark;
}

static bool all_marked(const uint8_t *mark, const triangle *t, node_mark which) {
    return mark[t->node[0]] & mark[t->node[1]] & mark[t->node[2]] & which;
}

/* ---- rays ---- */

static void find_centroid(const sf_model *m, const triangle *t, double out[3]) {
    const double *x[3];
    sf_corners(m->position, t->node, x);
    for (int k = 0; k < 3; k++)
        out[k] = (x[0][k] + x[1][k] + x[2][k]) / 3;
}

/* The cosine between the triangle's outward normal and the missile's direction. */
static double facing(const sf_model *m, const triangle *t) {
    double normal[3];
    sf_face_normal(m->position, t->node, normal);
    return sf_dot3(normal, m->missile.direction) / sqrt(sf_dot3(normal, normal));
}

static int by_place(const void *a, const void *b) {
    return SF_ORDER(((const hit *)a)->order, ((const hit *)b)->order);
}

/* The parts of a ray: foam, and air between the parts of foam and below them to the anvil. */
typedef struct path {
    double foam, air; /* m */
} path;

/* The path of the ray from the centroid of triangle `first`. */
static path follow_ray(const sf_model *m, const surface_of_pad *pad, const uint8_t *mark, int64_t first,
                       double slack) {
    hit hits[MOST_HITS];
    int count = 0;
    double from[3], sum = 0, begin = 0, end = 0;
    bool inside = true, held = false;
    find_centroid(m, &pad->list[first], from);
    for (int64_t i = 0; i < pad->count && count < MOST_HITS; i++) {
        const double *x[3];
        sf_corners(m->position, pad->list[i].node, x);
        double at = -sf_triangle_travel(x[0], x[1], x[2], m->missile.direction, from);
        if (i == first || !isfinite(at) || at < slack)
            continue;
        hit h = {.at = at, .leaves = facing(m, &pad->list[i]) > 0};
        h.order = h.at + (h.leaves ? 0 : 0.5 * slack); /* between layers the ray leaves before it enters */
        h.held = all_marked(mark, &pad->list[i], MARK_HELD);
        hits[count++] = h;
    }
    double support = sf_support_distance(m, from, m->missile.direction),
           last = support + FACETS * m->thickness;
    qsort(hits, (size_t)count, sizeof *hits, by_place);
    /* At an edge two triangles meet: the second changes nothing. */
    for (int k = 0; k < count && !held && hits[k].at < last; k++) {
        if (inside && hits[k].leaves) {
            end = hits[k].at;
            sum += end - begin;
            held = hits[k].held;
        } else if (!inside && !hits[k].leaves) {
            begin = hits[k].at;
        }
        inside = !hits[k].leaves;
    }
    double fall = -m->missile.direction[2], floor = sf_impact_top(m) - m->anvil.depth,
           anvil = m->anvil.depth > 0 ? (from[2] - floor) / fall : INFINITY, ground = fmin(anvil, support),
           below = isfinite(ground) && !held ? fmax(0, ground - end) : 0;
    return (path){sum, isfinite(ground) ? end - sum + below : 0};
}

/* ---- the zone ---- */

/* Sets the travel of each face that the missile may touch; returns the first touched, or -1. */
static int64_t find_touched(const sf_model *m, const surface_of_pad *pad, const uint8_t *mark) {
    const sf_surface missile = sf_surface_of_missile(m);
    int64_t first = -1;
    for (int64_t i = 0; i < pad->count; i++) {
        triangle *t = &pad->list[i];
        double centroid[3];
        t->travel = INFINITY;
        if (!all_marked(mark, t, MARK_TOUCHED) || facing(m, t) > -FACING)
            continue;
        find_centroid(m, t, centroid);
        t->travel = sf_missile_travel(&missile, &m->missile, centroid);
        if (isfinite(t->travel) && (first < 0 || t->travel < pad->list[first].travel))
            first = i;
    }
    return first;
}

static path shortest_path(const sf_model *m, const surface_of_pad *pad, const uint8_t *mark, int64_t first,
                          double slack) {
    path least = follow_ray(m, pad, mark, first, slack);
    double end = pad->list[first].travel + ZONE * least.foam;
    int64_t zone = 0, seen = 0;
    for (int64_t i = 0; i < pad->count; i++)
        zone += pad->list[i].travel <= end;
    int64_t stride = 1 + zone / MOST_RAYS;
    for (int64_t i = 0; i < pad->count; i++) {
        if (!(pad->list[i].travel <= end) || seen++ % stride != 0)
            continue;
        const path own = follow_ray(m, pad, mark, i, slack);
        least = own.foam > slack && own.foam < least.foam ? own : least;
    }
    return least;
}

/* ---- between the nodes ---- */

/* Returns the depth (m) of a point of the missile inside the foam when the first contact node is touched, 0
 * if it is no more than the rounding of a missile between nodes. */
static double depth_inside(const sf_model *m, const surface_of_pad *pad, const double point[3]) {
    static const double ROUNDING = 0.5; /* of the spacing */
    double deepest = 0;
    for (int64_t i = 0; i < pad->count; i++) {
        const triangle *t = &pad->list[i];
        const double *x[3];
        if (!isfinite(t->travel))
            continue;
        sf_corners(m->position, t->node, x);
        double spacing = fmax(fmax(m->spacing[t->node[0]], m->spacing[t->node[1]]), m->spacing[t->node[2]]),
               inside = sf_triangle_travel(x[0], x[1], x[2], m->missile.direction, point) + m->missile.gap;
        if (isfinite(inside) && inside > ROUNDING * spacing)
            deepest = fmax(deepest, inside);
    }
    return deepest;
}

/* The contact acts at the nodes of the pad alone: a part of the missile that is narrower than their spacing
 * passes between them and would start inside the foam. */
static sf_status check_between(const sf_model *m, const surface_of_pad *pad, sf_error *err) {
    const double *d = m->missile.direction;
    double start = INFINITY;
    for (int64_t k = 0; k < m->contact_count; k++)
        start = fmin(start, sf_dot3(&m->position[3 * (int64_t)m->contact_node[k]], d));
    for (int64_t v = 0; v < m->surface_node_count && m->missile.shape != SF_SHAPE_SPHERE; v++) {
        const double *x = &m->surface_position[3 * v];
        double depth = sf_dot3(x, d) + m->missile.gap > start ? depth_inside(m, pad, x) : 0;
        if (depth > 0)
            return SF_REFUSE(err,
                             "a part of the missile passes between the contact nodes: when the first of them "
                             "is touched, its point at (%.4g, %.4g) mm is %.4g mm inside the foam; take a "
                             "mesh whose spacing there is below the width of that part",
                             1e3 * x[0], 1e3 * x[1], 1e3 * depth);
    }
    return SF_OK;
}

sf_status sf_foam_path_measure(sf_model *m, sf_error *between, sf_error *err) {
    double extent = m->thickness, slack = SAME * extent;
    surface_of_pad pad;
    SF_OWNED uint8_t *mark = mark_nodes(m, err);
    if (mark && find_surface(m, &pad, err) == SF_OK) {
        int64_t first = find_touched(m, &pad, mark);
        const path least = first < 0 ? (path){0, 0} : shortest_path(m, &pad, mark, first, slack);
        double length = least.foam, upright = -m->missile.direction[2] * length;
        m->air = least.air > slack ? -m->missile.direction[2] * least.air : 0;
        if (length > slack && fabs(upright - extent) > SAME * extent)
            m->thickness = upright;
        check_between(m, &pad, between);
        free(pad.list);
    }
    return err->status;
}
