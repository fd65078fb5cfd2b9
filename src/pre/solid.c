/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/solid.h"

#include "base/mat3.h"
#include <stdlib.h>
#include <string.h>

/* An edge of a triangle, with the direction in which the triangle runs through it. */
typedef struct side {
    int32_t low, high; /* nodes, low < high */
    int32_t forwards;  /* 1: from low to high */
} side;

static int compare_side(const void *a, const void *b) {
    const side *p = a, *q = b;
    int first = (p->low > q->low) - (p->low < q->low), second = (p->high > q->high) - (p->high < q->high);
    return first ? first : second ? second : p->forwards - q->forwards;
}

static sf_status refuse_edge(const side *s, int64_t count, const double *position, sf_error *err) {
    const double *a = &position[3 * (int64_t)s->low], *b = &position[3 * (int64_t)s->high];
    return SF_FAIL(
        err, SF_ERR_MODEL,
        "the surface bounds no solid: %s at the edge from (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g) "
        "mm",
        count == 1   ? "it ends"
        : count == 2 ? "one triangle faces outwards and the next inwards"
                     : "more than two triangles meet",
        1e3 * a[0], 1e3 * a[1], 1e3 * a[2], 1e3 * b[0], 1e3 * b[1], 1e3 * b[2]);
}

static sf_status take_sides(int64_t node_count, int64_t triangle_count, const int32_t *triangle, side *list,
                            sf_error *err) {
    for (int64_t k = 0; k < 3 * triangle_count; k++) {
        int32_t a = triangle[k], b = triangle[k % 3 == 2 ? k - 2 : k + 1];
        if (a < 0 || a >= node_count || a == b)
            return SF_FAIL(err, SF_ERR_MODEL, "triangle %lld of the surface has no three nodes",
                           (long long)(k / 3));
        list[k] = (side){a < b ? a : b, a < b ? b : a, a < b};
    }
    return SF_OK;
}

static sf_status check_closed(int64_t node_count, const double *position, int64_t triangle_count,
                              const int32_t *triangle, sf_error *err) {
    int64_t count = 3 * triangle_count, same = 0;
    side *list = sf_alloc(err, (unsigned long)count, sizeof *list, "edges of a surface");
    if (!list || take_sides(node_count, triangle_count, triangle, list, err) != SF_OK)
        goto done;
    qsort(list, (size_t)count, sizeof *list, compare_side);
    for (int64_t k = 0; k < count && err->status == SF_OK; k += same) {
        for (same = 1;
             k + same < count && list[k + same].low == list[k].low && list[k + same].high == list[k].high;)
            same++;
        if (same != 2 || list[k].forwards == list[k + 1].forwards)
            refuse_edge(&list[k], same, position, err);
    }
done:
    free(list);
    return err->status;
}

/* The middle of the box: the sums are taken about it, so that a place far from the origin costs no digits. */
static void find_middle(int64_t count, const double *position, double middle[3]) {
    for (int c = 0; c < 3; c++) {
        double low = position[c], high = position[c];
        for (int64_t i = 1; i < count; i++) {
            low = fmin(low, position[3 * i + c]);
            high = fmax(high, position[3 * i + c]);
        }
        middle[c] = 0.5 * (low + high);
    }
}

/* Adds the tetrahedron of the triangle x and the origin: for its volume V and the sum s of its corners, the
 * integral of x is V s / 4, that of x x^T is V (sum of the corners' x x^T + s s^T) / 20. */
static void add_tetrahedron(const double x[3][3], double *volume, double first[3], double second[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
    double part = sf_triple3(x[0], x[1], x[2]) / 6, s[3];
    *volume += part;
    for (int c = 0; c < 3; c++) {
        s[c] = x[0][c] + x[1][c] + x[2][c];
        first[c] += part * s[c] / 4;
    }
    for (int k = 0; k < 6; k++) {
        int a = row[k], b = column[k];
        second[k] += part * (x[0][a] * x[0][b] + x[1][a] * x[1][b] + x[2][a] * x[2][b] + s[a] * s[b]) / 20;
    }
}

/* `second`: the integral of x x^T about the same place as the centroid. */
static void set_inertia(double volume, const double centroid[3], double second[6], double inertia[6]) {
    static const int row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < 6; k++)
        second[k] -= volume * centroid[row[k]] * centroid[column[k]];
    for (int k = 0; k < 3; k++)
        inertia[k] = second[(k + 1) % 3] + second[(k + 2) % 3];
    for (int k = 3; k < 6; k++)
        inertia[k] = -second[k];
}

sf_status sf_solid_measure(int64_t node_count, const double *position, int64_t triangle_count,
                           const int32_t *triangle, sf_solid *solid, sf_error *err) {
    double middle[3], volume = 0, first[3] = {0}, second[6] = {0};
    memset(solid, 0, sizeof *solid);
    if (triangle_count < 4)
        return SF_FAIL(err, SF_ERR_MODEL, "the surface bounds no solid: it has %lld triangles",
                       (long long)triangle_count);
    SF_TRY(check_closed(node_count, position, triangle_count, triangle, err));
    find_middle(node_count, position, middle);
    for (int64_t t = 0; t < triangle_count; t++) {
        double x[3][3];
        for (int v = 0; v < 3; v++)
            for (int c = 0; c < 3; c++)
                x[v][c] = position[3 * (int64_t)triangle[3 * t + v] + c] - middle[c];
        add_tetrahedron(x, &volume, first, second);
    }
    if (!(volume > 0) || !isfinite(volume))
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the surface bounds no solid: its volume is %g m3, so it is flat or turned inwards",
                       volume);
    for (int c = 0; c < 3; c++)
        first[c] /= volume;
    set_inertia(volume, first, second, solid->inertia);
    solid->volume = volume;
    for (int c = 0; c < 3; c++)
        solid->centroid[c] = middle[c] + first[c];
    return SF_OK;
}
