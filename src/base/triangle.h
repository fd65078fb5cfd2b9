/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/error.h"
#include "base/mat3.h"

/* Normal of a triangle, of twice its area. */
static inline void sf_triangle_normal(const double *a, const double *b, const double *c, double out[3]) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
    }
    sf_cross3(u, v, out);
}

/* An edge of a triangle. */
typedef struct sf_half_edge {
    int32_t low, high; /* nodes */
    int64_t slot;      /* 3 * triangle + place of the vertex that it runs from */
    bool rises;        /* it runs from low to high */
} sf_half_edge;

static inline int sf_half_edge_compare(const void *a, const void *b) {
    const sf_half_edge *x = a, *y = b;
    int low = (x->low > y->low) - (x->low < y->low), high = (x->high > y->high) - (x->high < y->high);
    return low ? low : high ? high : (x->slot > y->slot) - (x->slot < y->slot);
}

/* [3 count] the edges of the triangles, those at the same place together; owned by the caller, NULL on
 * failure. */
static inline sf_half_edge *sf_half_edges(int64_t count, const int32_t *triangle, sf_error *err) {
    sf_half_edge *edge = sf_alloc(err, 3 * (unsigned long)count, sizeof *edge, "edges of triangles");
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

/* Finds the point of a triangle that is nearest to x (Ericson 2005, section 5.1.5). `feature`: where it lies,
 * 0-2 vertex, 3-5 edge, 6 face. */
static inline void sf_triangle_nearest(const double *a, const double *b, const double *c, const double x[3],
                                       double out[3], int *feature) {
    double ab[3], ac[3], ap[3], bp[3], cp[3], s = 0, t = 0;
    for (int k = 0; k < 3; k++) {
        ab[k] = b[k] - a[k];
        ac[k] = c[k] - a[k];
        ap[k] = x[k] - a[k];
        bp[k] = x[k] - b[k];
        cp[k] = x[k] - c[k];
    }
    double d1 = sf_dot3(ab, ap), d2 = sf_dot3(ac, ap), d3 = sf_dot3(ab, bp), d4 = sf_dot3(ac, bp),
           d5 = sf_dot3(ab, cp), d6 = sf_dot3(ac, cp);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (d1 <= 0 && d2 <= 0) {
        *feature = 0;
    } else if (d3 >= 0 && d4 <= d3) {
        *feature = 1;
        s = 1;
    } else if (d6 >= 0 && d5 <= d6) {
        *feature = 2;
        t = 1;
    } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        *feature = 3;
        s = d1 / (d1 - d3);
    } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        *feature = 4;
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        s = 1 - t;
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        *feature = 5;
        t = d2 / (d2 - d6);
    } else {
        *feature = 6;
        s = vb / (va + vb + vc);
        t = vc / (va + vb + vc);
    }
    for (int k = 0; k < 3; k++)
        out[k] = a[k] + s * ab[k] + t * ac[k];
}
