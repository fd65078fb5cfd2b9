/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "body_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void body_alloc(body *b, int64_t nodes, int64_t triangles) {
    sf_error err = SF_ERROR_INIT;
    memset(b, 0, sizeof *b);
    b->surface.node_count = nodes;
    b->surface.triangle_count = triangles;
    b->surface.position = sf_alloc(&err, 3 * (unsigned long)nodes, sizeof(double), "test surface");
    b->surface.triangle = sf_alloc(&err, 3 * (unsigned long)triangles, sizeof(int32_t), "test surface");
    assert_int_equal(err.status, SF_OK);
}

void body_build(body *b, double reach, sf_body *out) {
    sf_error err = SF_ERROR_INIT;
    b->spacing = reach;
    b->model.contact_count = 1;
    b->model.contact_node = &b->contact_node;
    b->model.spacing = &b->spacing;
    b->model.missile.shape = SF_SHAPE_SURFACE;
    b->model.surface_node_count = b->surface.node_count;
    b->model.surface_triangle_count = b->surface.triangle_count;
    b->model.surface_position = b->surface.position;
    b->model.surface_triangle = b->surface.triangle;
    assert_int_equal(sf_body_build(&b->model, SF_BODY_MISSILE, out, &err), SF_OK);
}

void body_free(body *b, sf_body *s) {
    if (s)
        sf_body_free(s);
    free(b->surface.position);
    free(b->surface.triangle);
}

double *body_node(body *b, int64_t i) {
    return &b->surface.position[3 * i];
}

void body_vector(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = b[k] - a[k];
}

double body_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void body_face_normal(const body *b, int64_t t, double n[3]) {
    const double *p[3];
    double u[3], v[3];
    for (int c = 0; c < 3; c++)
        p[c] = &b->surface.position[3 * (int64_t)b->surface.triangle[3 * t + c]];
    body_vector(p[0], p[1], u);
    body_vector(p[0], p[2], v);
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    double length = sqrt(body_dot(n, n));
    for (int k = 0; k < 3; k++)
        n[k] /= length;
}

static void add_triangle(body *b, int64_t *count, int32_t p, int32_t q, int32_t r, bool mirrored) {
    int32_t *t = &b->surface.triangle[3 * (*count)++];
    t[0] = p;
    t[1] = mirrored ? r : q;
    t[2] = mirrored ? q : r;
}

void body_ball(body *b, int n, double radius, const double centre[3]) {
    int32_t *index = malloc(sizeof *index * (size_t)(2 * n + 1) * (size_t)(2 * n + 1) * 2);
    int32_t nodes = 0;
    int64_t triangles = 0;
    body_alloc(b, 4 * n * n + 2, 8 * n * n);
    for (int z = 0; z < 2; z++) /* upper and lower half share the equator's nodes */
        for (int i = -n; i <= n; i++)
            for (int j = -n; j <= n; j++) {
                int k = n - abs(i) - abs(j), at = (z * (2 * n + 1) + i + n) * (2 * n + 1) + j + n;
                if (k < 0)
                    continue;
                if (z == 1 && k == 0) {
                    index[at] = index[at - (2 * n + 1) * (2 * n + 1)];
                    continue;
                }
                double x[3] = {i, j, z ? -k : k}, length = sqrt(body_dot(x, x));
                for (int c = 0; c < 3; c++)
                    body_node(b, nodes)[c] = centre[c] + radius * x[c] / length;
                index[at] = nodes++;
            }
    for (int octant = 0; octant < 8; octant++) {
        int sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, z = octant >> 2;
        bool mirrored = sx * sy * (z ? -1 : 1) < 0;
#define BALL_NODE(i, j) index[(z * (2 * n + 1) + sx * (i) + n) * (2 * n + 1) + sy * (j) + n]
        for (int i = 0; i < n; i++)
            for (int j = 0; i + j < n; j++) {
                add_triangle(b, &triangles, BALL_NODE(i, j), BALL_NODE(i + 1, j), BALL_NODE(i, j + 1),
                             mirrored);
                if (i + j + 1 < n)
                    add_triangle(b, &triangles, BALL_NODE(i + 1, j), BALL_NODE(i + 1, j + 1),
                                 BALL_NODE(i, j + 1), mirrored);
            }
#undef BALL_NODE
    }
    assert_int_equal(nodes, b->surface.node_count);
    assert_int_equal(triangles, b->surface.triangle_count);
    free(index);
}

void body_plate(body *b, int n, double side) {
    int64_t triangles = 0;
    body_alloc(b, (n + 1) * (n + 1), 2 * n * n);
    for (int i = 0; i <= n; i++)
        for (int j = 0; j <= n; j++) {
            body_node(b, i * (n + 1) + j)[0] = side * i / n;
            body_node(b, i * (n + 1) + j)[1] = side * j / n;
        }
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < n; j++) {
            int32_t a = i * (n + 1) + j, c = a + n + 1;
            add_triangle(b, &triangles, a, a + 1, c, false);
            add_triangle(b, &triangles, a + 1, c + 1, c, false);
        }
}

void body_spike(body *b, int slivers, bool mirrored) {
    const double corner[3][3] = {{0.3, 0, 1}, {-0.15, 0.26, 1}, {-0.15, -0.26, 1}};
    int64_t triangles = 0;
    int32_t last =
        slivers; /* nodes 0 .. slivers run from corner 0 to corner 1; then corner 2; then the apex */
    body_alloc(b, slivers + 3, 2 * slivers + 2);
    for (int i = 0; i <= slivers; i++)
        for (int c = 0; c < 3; c++)
            body_node(b, i)[c] = corner[0][c] + (corner[1][c] - corner[0][c]) * i / slivers;
    memcpy(body_node(b, last + 1), corner[2], sizeof corner[2]);
    int32_t apex = last + 2;
    for (int32_t i = 0; i < last; i++) {
        add_triangle(b, &triangles, apex, i + 1, i, mirrored);
        add_triangle(b, &triangles, last + 1, i, i + 1, mirrored);
    }
    add_triangle(b, &triangles, apex, last + 1, last, mirrored);
    add_triangle(b, &triangles, apex, 0, last + 1, mirrored);
}

double body_largest_plane(const body *b, const double x[3]) {
    double largest = -INFINITY;
    for (int64_t t = 0; t < b->surface.triangle_count; t++) {
        double n[3], r[3];
        body_face_normal(b, t, n);
        body_vector(&b->surface.position[3 * (int64_t)b->surface.triangle[3 * t]], x, r);
        largest = larger(largest, body_dot(n, r));
    }
    return largest;
}
