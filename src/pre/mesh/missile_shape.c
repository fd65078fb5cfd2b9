/* SPDX-License-Identifier: GPL-3.0-or-later */

#include "pre/mesh/missile_shape.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit.h>
#include <gsl/gsl_sort.h>

#include "base/mat3.h"
#include "base/sets.h"
#include "pre/mesh/closed_parts.h"

static const double EDGE_ON = 1e-3; /* share of the area: below it a surface faces neither way */

typedef struct orienter {
    const sf_surface *surface;
    int64_t *beyond;  /* [triangles][3] triangle across the edge; -1: none, or more than one */
    uint8_t *twisted; /* [triangles][3] that triangle runs through the edge in the same sense */
    uint8_t *part;    /* [triangles] 1: reached */
    uint8_t *flip;    /* [triangles] against the part's first triangle */
    int64_t *member;  /* [triangles] of the part */
    int64_t *closed;  /* [triangles] lowest triangle of its closed part; -1: of an open one */
    int64_t closed_count;
} orienter;

static sf_status find_neighbours(orienter *o, sf_error *err) {
    int64_t count = 3 * o->surface->triangle_count;
    SF_OWNED sf_half_edge *edge = sf_half_edges(o->surface->triangle_count, o->surface->triangle, err);
    for (int64_t k = 0; edge && k < count; k++)
        o->beyond[k] = -1;
    for (int64_t first = 0, end; edge && first < count; first = end) {
        end = sf_half_edges_end(edge, first, count);
        if (end - first != 2)
            continue;
        for (int k = 0; k < 2; k++) {
            o->beyond[edge[first + k].slot] = edge[first + 1 - k].slot / 3;
            o->twisted[edge[first + k].slot] = edge[first].rises == edge[first + 1].rises;
        }
    }
    return err->status;
}

static const double *vertex(const sf_surface *s, int64_t triangle, int corner) {
    return &s->position[3 * (int64_t)s->triangle[3 * triangle + corner]];
}

static void area_vector(const sf_surface *s, int64_t t, double area[3]) {
    sf_face_normal(s->position, &s->triangle[3 * t], area);
    for (int c = 0; c < 3; c++)
        area[c] *= 0.5;
}

/* Collects the part of `seed` into member[0 .. *count). */
static sf_status walk(orienter *o, int64_t seed, int64_t *count, sf_error *err) {
    *count = 1;
    o->member[0] = seed;
    o->part[seed] = 1;
    for (int64_t k = 0; k < *count; k++)
        for (int e = 0; e < 3; e++) {
            int64_t t = o->member[k], next = o->beyond[3 * t + e];
            if (next < 0)
                continue;
            uint8_t flip = o->flip[t] ^ o->twisted[3 * t + e];
            if (o->part[next] && o->flip[next] == flip)
                continue;
            if (o->part[next]) {
                const double *x = vertex(o->surface, t, e);
                return SF_REFUSE(err,
                                 "the surface of the missile or support is one-sided, like a Moebius strip, "
                                 "near (%.4g, %.4g, %.4g) m of its geometry: it has no outside for the pad "
                                 "to touch",
                                 x[0], x[1], x[2]);
            }
            o->part[next] = 1;
            o->flip[next] = flip;
            o->member[(*count)++] = next;
        }
    return SF_OK;
}

static bool is_closed(const orienter *o, int64_t count) {
    for (int64_t k = 0; k < 3 * count; k++)
        if (o->beyond[3 * o->member[k / 3] + k % 3] < 0)
            return false;
    return true;
}

/* True if the part, with the flips of the walk, must be turned over. */
static bool is_inverted(const orienter *o, int64_t count, bool closed, const double direction[3]) {
    double area = 0, facing = 0, given = 0, volume = 0;
    for (int64_t k = 0; k < count; k++) {
        int64_t t = o->member[k];
        double a[3], sign = o->flip[t] ? -1 : 1;
        area_vector(o->surface, t, a);
        double size = sqrt(sf_dot3(a, a));
        area += size;
        given += sign * size;
        facing += sign * sf_dot3(a, direction);
        volume += sign * sf_dot3(a, vertex(o->surface, t, 0));
    }
    if (closed)
        return volume < 0;
    return fabs(facing) > EDGE_ON * area ? facing < 0 : given < 0;
}

static void turn_over(sf_surface *surface, int64_t t) {
    int32_t *node = &surface->triangle[3 * t], swap = node[1];
    node[1] = node[2];
    node[2] = swap;
}

/* The first member is the lowest triangle of the part. */
static void turn_part(orienter *o, int64_t count, const double direction[3], sf_surface *surface) {
    bool closed = is_closed(o, count), backed = false;
    for (int64_t k = 0; k < count; k++) {
        o->closed[o->member[k]] = closed ? o->member[0] : -1;
        backed = backed || (surface->solid && surface->solid[o->member[k]]);
    }
    o->closed_count += closed;
    bool inverted = !backed && is_inverted(o, count, closed, direction);
    for (int64_t k = 0; k < count && !backed; k++)
        if (o->flip[o->member[k]] != inverted)
            turn_over(surface, o->member[k]);
}

/* Turns the surfaces of cavities inwards. Parts that overlap stay turned outwards: contact never reaches what
 * is inside. */
static sf_status turn_cavities(const orienter *o, sf_surface *s, sf_error *err) {
    const sf_closed_parts all = {s->node_count, s->position, s->triangle_count, s->triangle, o->closed};
    SF_OWNED int32_t *depth = NULL;
    if (o->closed_count < 2)
        return SF_OK;
    depth = sf_alloc(err, s->triangle_count, sizeof *depth, "closed parts of a surface");
    if (depth && sf_closed_parts_nest(&all, depth, SF_IGNORED, err) == SF_OK)
        for (int64_t t = 0; t < s->triangle_count; t++)
            if (o->closed[t] >= 0 && depth[o->closed[t]] % 2 == 1 && !(s->solid && s->solid[t]))
                turn_over(s, t);
    return err->status;
}

static sf_status check_facing(const sf_surface *s, const double direction[3], sf_error *err) {
    double facing = 0, area = 0;
    for (int64_t t = 0; t < s->triangle_count; t++) {
        double a[3];
        area_vector(s, t, a);
        facing += fmax(sf_dot3(a, direction), 0);
        area += sqrt(sf_dot3(a, a));
    }
    if (facing > EDGE_ON * area)
        return SF_OK;
    return SF_REFUSE(err,
                     "missile.group: no part of the missile's surface faces along its motion (%g, %g, %g): "
                     "the cells lie on the pad's side of it, so the pad can never touch it",
                     direction[0], direction[1], direction[2]);
}

sf_status sf_surface_turn(sf_surface *surface, const double direction[3], sf_error *err) {
    size_t n = (size_t)surface->triangle_count;
    orienter o = {.surface = surface,
                  .beyond = sf_alloc(err, 3 * n, sizeof *o.beyond, "missile edges"),
                  .twisted = sf_alloc(err, 3 * n, 1, "missile edges"),
                  .part = sf_alloc(err, n, 1, "missile triangles"),
                  .flip = sf_alloc(err, n, 1, "missile triangles"),
                  .member = sf_alloc(err, n, sizeof *o.member, "missile triangles"),
                  .closed = sf_alloc(err, n, sizeof *o.closed, "missile triangles")};
    if (err->status == SF_OK && find_neighbours(&o, err) == SF_OK) {
        for (int64_t t = 0, count; t < surface->triangle_count && err->status == SF_OK; t++)
            if (!o.part[t] && walk(&o, t, &count, err) == SF_OK)
                turn_part(&o, count, direction, surface);
        if (err->status == SF_OK)
            turn_cavities(&o, surface, err);
    }
    SF_FREE(o.beyond, o.twisted, o.part, o.flip, o.member, o.closed);
    return err->status;
}

sf_status sf_surface_orient(sf_surface *surface, const double direction[3], sf_error *err) {
    SF_TRY(sf_surface_turn(surface, direction, err));
    return check_facing(surface, direction, err);
}

/* The outer surface of the missile's cells, whatever part of it is the group that touches the pad. */

/* A face of a cell by its tags in ascending order. */
typedef struct cell_face {
    size_t tag[SF_RAW_FACE];
    size_t cell;
    int face;
} cell_face;

typedef struct hull_builder {
    const sf_raw_mesh *raw;
    sf_tag_index *nodes;
    cell_face *list; /* [count] sorted */
    size_t count;
    int64_t *parent; /* [cell_count] union of cells joined by faces */
    uint8_t *ours;   /* [cell_count] by parent: of the missile */
} hull_builder;

static sf_status list_faces(hull_builder *b, sf_error *err) {
    const sf_raw_mesh *raw = b->raw;
    b->list = sf_alloc(err, 6 * raw->cell_count, sizeof *b->list, "faces of the missile");
    b->parent = sf_sets_alone((int64_t)raw->cell_count, "cells of the missile", err);
    b->ours = sf_alloc(err, raw->cell_count, 1, "cells of the missile");
    SF_TRY(err->status);
    for (size_t k = 0; k < raw->cell_count; k++) {
        const sf_cell_shape *shape = sf_cell_shape_of(raw->cell_type[k]);
        for (int f = 0; f < shape->faces; f++) {
            cell_face *face = &b->list[b->count++];
            *face = (cell_face){.cell = k, .face = f};
            sf_raw_cell_face(raw, k, f, face->tag);
        }
    }
    qsort(b->list, b->count, sizeof *b->list, sf_raw_face_compare);
    return SF_OK;
}

/* True if the face at i of the list belongs to one cell only. */
static bool is_outer(const hull_builder *b, size_t i) {
    return (i == 0 || sf_raw_face_compare(b->list[i - 1].tag, b->list[i].tag) != 0) &&
           (i + 1 == b->count || sf_raw_face_compare(b->list[i + 1].tag, b->list[i].tag) != 0);
}

/* Joins cells through faces, and marks those that a face of the group belongs to. */
static void find_cells(hull_builder *b) {
    const sf_raw_mesh *raw = b->raw;
    for (size_t i = 1; i < b->count; i++)
        if (sf_raw_face_compare(b->list[i - 1].tag, b->list[i].tag) == 0)
            sf_sets_join(b->parent, (int64_t)b->list[i].cell, (int64_t)b->list[i - 1].cell);
    for (size_t f = 0; f < raw->face_count; f++) {
        size_t wanted[SF_RAW_FACE];
        memcpy(wanted, raw->face_node + SF_RAW_FACE * f, sizeof wanted);
        gsl_sort_ulong(wanted, 1, SF_RAW_FACE);
        const cell_face *found = bsearch(wanted, b->list, b->count, sizeof *b->list, sf_raw_face_compare);
        if (found)
            b->ours[sf_sets_find(b->parent, (int64_t)found->cell)] = 1;
    }
}

static bool is_hull(const hull_builder *b, size_t i) {
    return is_outer(b, i) && b->ours[sf_sets_find(b->parent, (int64_t)b->list[i].cell)];
}

static const double *place_of(const hull_builder *b, size_t tag) {
    return sf_raw_mesh_place(b->raw, b->nodes, tag);
}

/* True if the face, in the order of its topology, faces away from its cell. */
static bool faces_outwards(const hull_builder *b, const cell_face *f, const size_t *node, int size) {
    const sf_cell_shape *shape = sf_cell_shape_of(b->raw->cell_type[f->cell]);
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

static void add_face(const hull_builder *b, const cell_face *f, sf_surface *s) {
    const sf_cell_shape *shape = sf_cell_shape_of(b->raw->cell_type[f->cell]);
    int size = sf_cell_face_size(shape, f->face);
    size_t node[SF_RAW_FACE] = {0};
    for (int a = 0; a < size; a++)
        node[a] = b->raw->cell_node[SF_RAW_CELL * f->cell + (size_t)shape->face[f->face][a]];
    bool outwards = faces_outwards(b, f, node, size);
    for (int t = 0; t < size - 2; t++) {
        const size_t corner[3] = {node[0], node[t + (outwards ? 1 : 2)], node[t + (outwards ? 2 : 1)]};
        for (int a = 0; a < 3; a++)
            s->hull_triangle[3 * s->hull_triangle_count + a] =
                (int32_t)sf_raw_mesh_find(b->raw, b->nodes, corner[a]);
        s->hull_triangle_count++;
    }
}

/* All cells of the missile have nodes that exist. */
static bool has_nodes(const hull_builder *b) {
    for (size_t k = 0; k < b->raw->cell_count; k++)
        for (int a = 0; a < sf_cell_shape_of(b->raw->cell_type[k])->vertices; a++)
            if (!place_of(b, b->raw->cell_node[SF_RAW_CELL * k + (size_t)a]))
                return false;
    return true;
}

static sf_status write_hull(const hull_builder *b, double unit, sf_surface *s, sf_error *err) {
    const sf_raw_mesh *raw = b->raw;
    size_t most = 0;
    for (size_t i = 0; i < b->count; i++)
        most += is_hull(b, i) ? 2 : 0;
    s->hull_position = sf_alloc(err, 3 * raw->node_count, sizeof(double), "nodes of the missile");
    s->hull_triangle = sf_alloc(err, 3 * most, sizeof(int32_t), "surface of the missile");
    SF_TRY(err->status);
    s->hull_node_count = (int64_t)raw->node_count;
    for (size_t n = 0; n < 3 * raw->node_count; n++)
        s->hull_position[n] = unit * raw->xyz[n];
    for (size_t i = 0; i < b->count; i++)
        if (is_hull(b, i))
            add_face(b, &b->list[i], s);
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
    SF_FREE(b.nodes, b.list, b.parent, b.ours);
    return err->status;
}

static const double SPHERE_TOLERANCE = 1e-6;
static const double DEEPEST = 0.25; /* of the radius; facets of an icosahedron lie 0.2 deep, of a cube 0.36 */

/* |x|^2 = 2 c.x + (R^2 - |c|^2) is linear in c and the constant; solved about the nodes' mean, scaled. */
sf_status sf_missile_fit_sphere(const sf_surface *surface, double centre[3], double *radius,
                                double *deviation, sf_error *err) {
    int64_t n = surface->node_count;
    double mean[3] = {0}, scale = 0, chisq;
    if (n < 4)
        return SF_FAIL(err, SF_ERR_MODEL, "the missile's surface has %lld nodes" SF_AT_LEAST("4"),
                       (long long)n);
    for (int64_t k = 0; k < 3 * n; k++)
        mean[k % 3] += surface->position[k] / (double)n;
    for (int64_t k = 0; k < 3 * n; k++)
        scale = fmax(scale, fabs(surface->position[k] - mean[k % 3]));
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    gsl_matrix *a = gsl_matrix_alloc((size_t)n, 4), *covariance = gsl_matrix_alloc(4, 4);
    gsl_vector *rhs = gsl_vector_alloc((size_t)n), *x = gsl_vector_alloc(4);
    gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc((size_t)n, 4);
    if (!a || !covariance || !rhs || !x || !work) {
        SF_NO_MEMORY(err, "the sphere of %lld nodes", (long long)n);
        goto done;
    }
    for (int64_t i = 0; i < n; i++) {
        double p[3], square = 0;
        for (int c = 0; c < 3; c++) {
            p[c] = (surface->position[3 * i + c] - mean[c]) / scale;
            square += p[c] * p[c];
            gsl_matrix_set(a, (size_t)i, (size_t)c, 2 * p[c]);
        }
        gsl_matrix_set(a, (size_t)i, 3, 1);
        gsl_vector_set(rhs, (size_t)i, square);
    }
    size_t rank = 0;
    if (gsl_multifit_linear_tsvd(a, rhs, 1e-10, x, covariance, &chisq, &rank, work) != GSL_SUCCESS ||
        rank < 4) {
        SF_FAIL(err, SF_ERR_MODEL, "the missile's surface is flat: no sphere fits it");
        goto done;
    }
    double square = gsl_vector_get(x, 3);
    for (size_t c = 0; c < 3; c++) {
        square += gsl_vector_get(x, c) * gsl_vector_get(x, c);
        centre[c] = mean[c] + scale * gsl_vector_get(x, c);
    }
    *radius = scale * sqrt(square);
    *deviation = 0;
    for (int64_t i = 0; i < n; i++) {
        double r[3];
        sf_sub3(&surface->position[3 * i], centre, r);
        *deviation = fmax(*deviation, fabs(sqrt(sf_dot3(r, r)) / *radius - 1));
    }
done:
    gsl_multifit_linear_free(work);
    gsl_matrix_free(a);
    gsl_matrix_free(covariance);
    gsl_vector_free(rhs);
    gsl_vector_free(x);
    gsl_set_error_handler(handler);
    return err->status;
}

/* True if the surface, from outside, covers the point of the sphere that leads along the direction. A
 * recess, a bowl that opens downwards and a ring do not. */
static bool covers_pole(const sf_surface *surface, const double centre[3], double radius,
                        const double direction[3]) {
    static const double SLACK = 1e-9;
    for (int64_t t = 0; t < surface->triangle_count; t++) {
        double x[3][3];
        for (int v = 0; v < 3; v++)
            for (int c = 0; c < 3; c++)
                x[v][c] =
                    (surface->position[3 * (int64_t)surface->triangle[3 * t + v] + c] - centre[c]) / radius;
        if (sf_triple3(x[0], x[1], x[2]) > 0 && sf_triple3(direction, x[1], x[2]) >= -SLACK &&
            sf_triple3(x[0], direction, x[2]) >= -SLACK && sf_triple3(x[0], x[1], direction) >= -SLACK)
            return true;
    }
    return false;
}

/* The largest depth of a facet's centroid within the sphere, over the radius. The corners of a box or a
 * cylinder lie on a sphere, too. */
static double deepest_facet(const sf_surface *surface, const double centre[3], double radius) {
    double deepest = 0;
    for (int64_t t = 0; t < surface->triangle_count; t++) {
        double middle[3];
        for (int c = 0; c < 3; c++)
            middle[c] = (vertex(surface, t, 0)[c] + vertex(surface, t, 1)[c] + vertex(surface, t, 2)[c]) / 3;
        deepest = fmax(deepest, 1 - sf_distance3(middle, centre) / radius);
    }
    return deepest;
}

/* Finds the sphere that a surface is to within its facets; a failure says why it is none. */
static sf_status find_sphere(const sf_surface *surface, const double direction[3], double centre[3],
                             double *radius, sf_error *err) {
    double deviation;
    SF_TRY(sf_missile_fit_sphere(surface, centre, radius, &deviation, err));
    if (deviation > SPHERE_TOLERANCE)
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the surface deviates from the best sphere by %.3g of its radius (bound %.0e)",
                       deviation, SPHERE_TOLERANCE);
    double depth = deepest_facet(surface, centre, *radius);
    if (depth > DEEPEST)
        return SF_FAIL(err, SF_ERR_MODEL,
                       "a facet of the surface lies %.2g of the radius within its sphere (bound %g): mesh it "
                       "more finely",
                       depth, DEEPEST);
    if (!covers_pole(surface, centre, *radius, direction))
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the surface does not cover the point of its sphere that leads along "
                       "missile.direction, or is hollow there");
    return SF_OK;
}

sf_status sf_missile_set_shape(const sf_surface *surface, int rule, sf_missile_card *card, sf_error *err) {
    double centre[3], radius;
    sf_error reason = SF_ERROR_INIT;
    card->shape = SF_SHAPE_SURFACE;
    if (rule == 2)
        return SF_OK;
    if (find_sphere(surface, card->direction, centre, &radius, &reason) != SF_OK)
        return rule == 1 ? SF_FAIL(err, SF_ERR_MODEL, "missile.shape is \"sphere\", but %s", reason.text)
                         : SF_OK;
    card->shape = SF_SHAPE_SPHERE;
    card->sphere_radius = radius;
    card->sphere_cap_cosine = 1;
    memcpy(card->sphere_centre, centre, sizeof centre);
    for (int64_t i = 0; i < surface->node_count; i++) {
        double r[3];
        sf_sub3(&surface->position[3 * i], centre, r);
        card->sphere_cap_cosine = fmin(card->sphere_cap_cosine, sf_dot3(r, card->direction) / radius);
    }
    return SF_OK;
}

/* Travel of a sphere until it touches x, or infinity. */
static double sphere_travel(const sf_missile_card *card, const double x[3]) {
    double r[3], along, across;
    sf_sub3(x, card->sphere_centre, r);
    along = sf_dot3(r, card->direction);
    across = sf_dot3(r, r) - along * along;
    double square = card->sphere_radius * card->sphere_radius - across;
    if (square < 0 || sqrt(square) < card->sphere_cap_cosine * card->sphere_radius)
        return INFINITY;
    return along - sqrt(square);
}

double sf_triangle_travel(const double *a, const double *b, const double *c, const double direction[3],
                          const double x[3]) {
    double u[3], v[3], r[3], p[3], q[3];
    sf_sub3(b, a, u);
    sf_sub3(c, a, v);
    sf_sub3(x, a, r);
    sf_cross3(direction, v, p);
    sf_cross3(r, u, q);
    double determinant = sf_dot3(u, p), slack = 1e-9;
    if (determinant == 0)
        return INFINITY;
    double s = sf_dot3(r, p) / determinant, t = sf_dot3(direction, q) / determinant;
    if (s < -slack || t < -slack || s + t > 1 + slack)
        return INFINITY;
    return -sf_dot3(v, q) / determinant; /* x = point of the triangle + travel * direction */
}

double sf_missile_travel(const sf_surface *surface, const sf_missile_card *card, const double x[3]) {
    if (card->shape == SF_SHAPE_SPHERE)
        return sphere_travel(card, x);
    double travel = INFINITY;
    for (int64_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *v = &surface->triangle[3 * t];
        travel = fmin(travel, sf_triangle_travel(&surface->position[3 * v[0]], &surface->position[3 * v[1]],
                                                 &surface->position[3 * v[2]], card->direction, x));
    }
    return travel;
}

sf_status sf_missile_distance(const sf_surface *surface, const sf_missile_card *card, const double *position,
                              int64_t count, const int32_t *node, double *distance, sf_error *err) {
    *distance = INFINITY;
    for (int64_t k = 0; k < count; k++)
        *distance = fmin(*distance, sf_missile_travel(surface, card, &position[3 * (int64_t)node[k]]));
    if (!isfinite(*distance))
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the missile, moving along (%g, %g, %g), never touches the contact group: check its "
                       "position over the pad and missile.direction",
                       card->direction[0], card->direction[1], card->direction[2]);
    return SF_OK;
}

sf_surface sf_surface_of_missile(const sf_model *m) {
    return (sf_surface){.node_count = m->surface_node_count,
                        .position = m->surface_position,
                        .triangle_count = m->surface_triangle_count,
                        .triangle = m->surface_triangle};
}
