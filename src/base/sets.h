/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdint.h>

#include "base/error.h"

/* Ascending lists and disjoint sets of numbers, and the edges of triangles.
 *
 * Disjoint sets of the numbers from 0 on: `parent` leads from each to the lowest of its set. */

/* [count] each number alone; owned by the caller, NULL on failure. `what`: for the sentence. */
static inline int64_t *sf_sets_alone(int64_t count, const char *what, sf_error *err) {
    int64_t *parent = sf_alloc(err, count, sizeof *parent, what);
    for (int64_t k = 0; parent && k < count; k++)
        parent[k] = k;
    return parent;
}

/* Returns the lowest of the set of `k`; the paths are halved on the way. */
static inline int64_t sf_sets_find(int64_t *parent, int64_t k) {
    while (parent[k] != k)
        k = parent[k] = parent[parent[k]];
    return k;
}

static inline void sf_sets_join(int64_t *parent, int64_t a, int64_t b) {
    a = sf_sets_find(parent, a);
    b = sf_sets_find(parent, b);
    parent[a > b ? a : b] = a > b ? b : a;
}

/* The order of two numbers, for functions of qsort: -1, 0 or 1. */
#define SF_ORDER(x, y) (((x) > (y)) - ((x) < (y)))

/* Defines such a function for records of `type`, by one member and then by another. */
#define SF_ORDER_BY(function, type, first, second)                                                           \
    static int function(const void *a, const void *b) {                                                      \
        const type *x = a, *y = b;                                                                           \
        return x->first != y->first ? SF_ORDER(x->first, y->first) : SF_ORDER(x->second, y->second);         \
    }

/* Compares two numbers of type int32_t, for qsort. */
static inline int sf_by_number(const void *a, const void *b) {
    return SF_ORDER(*(const int32_t *)a, *(const int32_t *)b);
}

/* Returns the first place from `low` to `high` - 1 of an ascending list whose number is not below `value`;
 * `high` if there is none. */
static inline int64_t sf_list_find(const int32_t *list, int64_t low, int64_t high, int64_t value) {
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (list[middle] < value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Replaces numbers from 0 to `all` - 1 by their places in the ascending list of those that occur; -1 stays.
 * Returns the list, owned by the caller, and its length; NULL on failure. `what`: for the sentence. */
static inline int32_t *sf_list_number(int64_t all, int64_t count, int32_t *number, int64_t *length,
                                      const char *what, sf_error *err) {
    SF_OWNED int32_t *place = sf_alloc(err, all, sizeof *place, what);
    int64_t used = 0;
    for (int64_t k = 0; place && k < count; k++)
        if (number[k] >= 0)
            place[number[k]] = 1;
    for (int64_t i = 0; place && i < all; i++)
        used += place[i];
    int32_t *list = sf_alloc(err, used, sizeof *list, what);
    *length = 0;
    for (int64_t i = 0; place && list && i < all; i++)
        if (place[i]) {
            place[i] = (int32_t)*length;
            list[(*length)++] = (int32_t)i;
        }
    for (int64_t k = 0; place && list && k < count; k++)
        number[k] = number[k] < 0 ? -1 : place[number[k]];
    return sf_keep(list, err);
}

/* Returns the last k below `count` - 1 with x[k] <= place, x ascending; 0 if there is none. */
static inline int64_t sf_interval_find(const double *x, int64_t count, double place) {
    int64_t low = 0, high = count - 1;
    while (high - low > 1) {
        int64_t middle = (low + high) / 2;
        *(x[middle] <= place ? &low : &high) = middle;
    }
    return low;
}

/* An edge of a triangle. */
typedef struct sf_half_edge {
    int32_t low, high; /* nodes */
    int64_t slot;      /* 3 * triangle + place of the vertex that it runs from */
    bool rises;        /* it runs from low to high */
} sf_half_edge;

static inline int sf_half_edge_compare(const void *a, const void *b) {
    const sf_half_edge *x = a, *y = b;
    int low = SF_ORDER(x->low, y->low), high = SF_ORDER(x->high, y->high);
    return low ? low : high ? high : SF_ORDER(x->slot, y->slot);
}

/* [3 count] the edges of the triangles, those at the same place together; owned by the caller, NULL on
 * failure. */
static inline sf_half_edge *sf_half_edges(int64_t count, const int32_t *triangle, sf_error *err) {
    sf_half_edge *edge = sf_alloc(err, 3 * count, sizeof *edge, "edges of triangles");
    for (int64_t k = 0; edge && k < 3 * count; k++) {
        int32_t a = triangle[k], b = triangle[k % 3 == 2 ? k - 2 : k + 1];
        edge[k] = (sf_half_edge){a < b ? a : b, a < b ? b : a, k, a < b};
    }
    if (edge)
        qsort(edge, 3 * (size_t)count, sizeof *edge, sf_half_edge_compare);
    return edge;
}

/* Returns the first of `count` that is at another place than `first`. */
static inline int64_t sf_half_edges_end(const sf_half_edge *edge, int64_t first, int64_t count) {
    int64_t end = first + 1;
    while (end < count && edge[end].low == edge[first].low && edge[end].high == edge[first].high)
        end++;
    return end;
}
