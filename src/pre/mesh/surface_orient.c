/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/surface_orient.h"

#include "base/mat3.h"
#include <stdbool.h>
#include <stdlib.h>

static const double EDGE_ON = 1e-3; /* share of the area: below it a surface faces neither way */

typedef struct use {
    int32_t low, high;
    int64_t slot; /* 3 triangle + edge */
    bool rising;  /* the triangle runs from low to high */
} use;

static int by_ends(const void *a, const void *b) {
    const use *p = a, *q = b;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    return (p->slot > q->slot) - (p->slot < q->slot);
}

typedef struct orienter {
    const sf_surface *surface;
    int64_t *beyond;  /* [triangles][3] triangle across the edge; -1: none, or more than one */
    uint8_t *twisted; /* [triangles][3] that triangle runs through the edge in the same sense */
    uint8_t *part;    /* [triangles] 1: reached */
    uint8_t *flip;    /* [triangles] against the part's first triangle */
    int64_t *member;  /* [triangles] of the part */
} orienter;

static sf_status find_neighbours(orienter *o, sf_error *err) {
    int64_t count = 3 * o->surface->triangle_count;
    const int32_t *node = o->surface->triangle;
    use *list = sf_alloc(err, (size_t)count, sizeof *list, "edges of the missile");
    if (!list)
        return err->status;
    for (int64_t k = 0; k < count; k++) {
        int32_t a = node[k], b = node[k % 3 == 2 ? k - 2 : k + 1];
        list[k] = (use){a < b ? a : b, a < b ? b : a, k, a < b};
        o->beyond[k] = -1;
    }
    qsort(list, (size_t)count, sizeof *list, by_ends);
    for (int64_t first = 0, end; first < count; first = end) {
        for (end = first + 1;
             end < count && list[end].low == list[first].low && list[end].high == list[first].high; end++)
            ;
        if (end - first != 2)
            continue;
        for (int k = 0; k < 2; k++) {
            o->beyond[list[first + k].slot] = list[first + 1 - k].slot / 3;
            o->twisted[list[first + k].slot] = list[first].rising == list[first + 1].rising;
        }
    }
    free(list);
    return SF_OK;
}

static const double *vertex(const sf_surface *s, int64_t triangle, int corner) {
    return &s->position[3 * (int64_t)s->triangle[3 * triangle + corner]];
}

static void area_vector(const sf_surface *s, int64_t t, double area[3]) {
    double u[3], v[3];
    for (int c = 0; c < 3; c++) {
        u[c] = vertex(s, t, 1)[c] - vertex(s, t, 0)[c];
        v[c] = vertex(s, t, 2)[c] - vertex(s, t, 0)[c];
    }
    sf_cross3(u, v, area);
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
                return SF_FAIL(err, SF_ERR_INPUT,
                               "the missile's surface is one-sided, like a Moebius strip, near (%.4g, %.4g, "
                               "%.4g) m of its geometry: it has no outside for the pad to touch",
                               x[0], x[1], x[2]);
            }
            o->part[next] = 1;
            o->flip[next] = flip;
            o->member[(*count)++] = next;
        }
    return SF_OK;
}

/* Is the part, with the flips of the walk, to be turned over? */
static bool is_inverted(const orienter *o, int64_t count, const double direction[3]) {
    double area = 0, facing = 0, given = 0, volume = 0;
    bool closed = true;
    for (int64_t k = 0; k < count; k++) {
        int64_t t = o->member[k];
        double a[3], sign = o->flip[t] ? -1 : 1;
        area_vector(o->surface, t, a);
        double size = sqrt(sf_dot3(a, a));
        area += size;
        given += sign * size;
        facing += sign * sf_dot3(a, direction);
        volume += sign * sf_dot3(a, vertex(o->surface, t, 0));
        for (int e = 0; e < 3; e++)
            closed = closed && o->beyond[3 * t + e] >= 0;
    }
    if (closed)
        return volume < 0;
    return fabs(facing) > EDGE_ON * area ? facing < 0 : given < 0;
}

static void turn_part(const orienter *o, int64_t count, const double direction[3], sf_surface *surface) {
    for (int64_t k = 0; surface->solid && k < count; k++)
        if (surface->solid[o->member[k]])
            return;
    bool inverted = is_inverted(o, count, direction);
    for (int64_t k = 0; k < count; k++) {
        int32_t *node = &surface->triangle[3 * o->member[k]];
        if (o->flip[o->member[k]] == inverted)
            continue;
        int32_t swap = node[1];
        node[1] = node[2];
        node[2] = swap;
    }
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
    return SF_FAIL(err, SF_ERR_INPUT,
                   "missile.group: no part of the missile's surface faces along its motion (%g, %g, %g): the "
                   "cells lie on the pad's side of it, so the pad can never touch it",
                   direction[0], direction[1], direction[2]);
}

sf_status sf_surface_orient(sf_surface *surface, const double direction[3], sf_error *err) {
    size_t n = (size_t)surface->triangle_count;
    orienter o = {.surface = surface,
                  .beyond = sf_alloc(err, 3 * n, sizeof *o.beyond, "missile edges"),
                  .twisted = sf_alloc(err, 3 * n, 1, "missile edges"),
                  .part = sf_alloc(err, n, 1, "missile triangles"),
                  .flip = sf_alloc(err, n, 1, "missile triangles"),
                  .member = sf_alloc(err, n, sizeof *o.member, "missile triangles")};
    if (err->status == SF_OK && find_neighbours(&o, err) == SF_OK)
        for (int64_t t = 0, count; t < surface->triangle_count && err->status == SF_OK; t++)
            if (!o.part[t] && walk(&o, t, &count, err) == SF_OK)
                turn_part(&o, count, direction, surface);
    free(o.beyond);
    free(o.twisted);
    free(o.part);
    free(o.flip);
    free(o.member);
    return err->status == SF_OK ? check_facing(surface, direction, err) : err->status;
}
