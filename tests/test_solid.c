/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Volume, centroid and inertia of closed surfaces, against closed forms. */

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "body_fixture.h"
#include "point_fixture.h"
#include "post_check.h"
#include "pre/missile_body.h"

enum { BOX_NODES = 8, BOX_TRIANGLES = 12 };

static const int32_t TETRAHEDRON[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
static const double FAR[3] = {3, -40, 700}; /* m: the sums must not lose digits there */

/* The box [0, size], its nodes from `first` on. */
static void make_box(const double size[3], int32_t first, double (*x)[3], int32_t (*triangle)[3]) {
    static const int32_t quad[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (int i = 0; i < BOX_NODES; i++)
        for (int c = 0; c < 3; c++)
            x[i][c] = (i >> c & 1) * size[c];
    for (int t = 0; t < BOX_TRIANGLES; t++)
        for (int v = 0; v < 3; v++)
            triangle[t][v] = first + quad[t / 2][v == 0 ? 0 : v + t % 2];
}

static void tetrahedron_is_exact(void **state) {
    (void)state;
    const double size[3] = {0.3, 0.5, 0.2}, volume = 0.3 * 0.5 * 0.2 / 6;
    double x[4][3];
    sf_solid s;
    sf_error err = SF_ERROR_INIT;
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++)
            x[i][c] = FAR[c] + (i == c + 1 ? size[c] : 0);
    assert_int_equal(sf_solid_measure(4, x[0], 4, TETRAHEDRON[0], &s, &err), SF_OK);
    assert_relative(s.volume, volume, 1e-11);
    for (int c = 0; c < 3; c++) {
        double b = size[(c + 1) % 3], d = size[(c + 2) % 3];
        assert_close(s.centroid[c], FAR[c] + size[c] / 4, 1e-12 * FAR[2]);
        assert_relative(s.inertia[c], volume * 3 * (b * b + d * d) / 80, 1e-11);
        assert_relative(s.inertia[3 + c], volume * size[c] * b / 80, 1e-11); /* -integral of x y */
    }
}

static void turned_box_is_exact(void **state) {
    (void)state;
    const double size[3] = {0.1, 0.4, 0.25}, volume = 0.1 * 0.4 * 0.25;
    double corner[BOX_NODES][3], x[BOX_NODES][3], q[9], own[9] = {0}, turned[9], back[9], inertia[9];
    int32_t triangle[BOX_TRIANGLES][3];
    uint64_t seed = 7;
    sf_solid s;
    sf_error err = SF_ERROR_INIT;
    make_box(size, 0, corner, triangle);
    point_rotation(&seed, q);
    for (int i = 0; i < BOX_NODES; i++)
        for (int c = 0; c < 3; c++)
            x[i][c] = q[3 * c] * corner[i][0] + q[3 * c + 1] * corner[i][1] + q[3 * c + 2] * corner[i][2];
    for (int c = 0; c < 3; c++)
        own[4 * c] = volume * (pow(size[(c + 1) % 3], 2) + pow(size[(c + 2) % 3], 2)) / 12;
    point_product(q, own, turned);
    point_transpose(q, back);
    point_product(turned, back, inertia);
    assert_int_equal(sf_solid_measure(BOX_NODES, x[0], BOX_TRIANGLES, triangle[0], &s, &err), SF_OK);
    assert_relative(s.volume, volume, 1e-14);
    for (int c = 0; c < 3; c++) {
        double middle = (q[3 * c] * size[0] + q[3 * c + 1] * size[1] + q[3 * c + 2] * size[2]) / 2;
        assert_close(s.centroid[c], middle, 1e-15);
        assert_relative(s.inertia[c], inertia[4 * c], 1e-13);
    }
    assert_close(s.inertia[3], inertia[1], 1e-13 * own[0]);
    assert_close(s.inertia[4], inertia[5], 1e-13 * own[0]);
    assert_close(s.inertia[5], inertia[2], 1e-13 * own[0]);
}

/* A box with a hollow: its inner surface faces into the hollow. */
static void hollows_are_left_out(void **state) {
    (void)state;
    const double outer[3] = {0.4, 0.4, 0.4}, inner[3] = {0.2, 0.2, 0.2};
    double x[2 * BOX_NODES][3], volume = pow(0.4, 3) - pow(0.2, 3);
    int32_t triangle[2 * BOX_TRIANGLES][3];
    sf_solid s;
    sf_error err = SF_ERROR_INIT;
    make_box(outer, 0, x, triangle);
    make_box(inner, BOX_NODES, x + BOX_NODES, triangle + BOX_TRIANGLES);
    for (int k = 0; k < 3 * BOX_NODES; k++)
        x[BOX_NODES + k / 3][k % 3] += 0.05;
    for (int t = BOX_TRIANGLES; t < 2 * BOX_TRIANGLES; t++) {
        int32_t swap = triangle[t][0];
        triangle[t][0] = triangle[t][1];
        triangle[t][1] = swap;
    }
    assert_int_equal(sf_solid_measure(2 * BOX_NODES, x[0], (int64_t)2 * BOX_TRIANGLES, triangle[0], &s, &err),
                     SF_OK);
    assert_relative(s.volume, volume, 1e-14);
    for (int c = 0; c < 3; c++) {
        double centroid = (pow(0.4, 3) * 0.2 - pow(0.2, 3) * 0.15) / volume;
        assert_relative(s.centroid[c], centroid, 1e-14);
        /* each box's own, and its volume times the square of its distance from the common centroid */
        assert_relative(
            s.inertia[c],
            pow(0.4, 5) / 6 - pow(0.2, 5) / 6 +
                2 * (pow(0.4, 3) * pow(0.2 - centroid, 2) - pow(0.2, 3) * pow(0.15 - centroid, 2)),
            1e-13);
    }
}

/* Facets with their nodes on the sphere lie inside it: the defect falls with the square of their size. */
static void sphere_converges_with_the_square_of_the_facets(void **state) {
    (void)state;
    const double radius = 0.08, centre[3] = {0.2, -0.1, 0.4}, volume = 4 * M_PI * pow(radius, 3) / 3;
    double defect[2][2];
    for (int k = 0; k < 2; k++) {
        body b;
        sf_solid s;
        sf_error err = SF_ERROR_INIT;
        body_ball(&b, 16 << k, radius, centre);
        assert_int_equal(sf_solid_measure(b.surface.node_count, b.surface.position, b.surface.triangle_count,
                                          b.surface.triangle, &s, &err),
                         SF_OK);
        defect[k][0] = 1 - s.volume / volume;
        defect[k][1] = 1 - s.inertia[0] / (0.4 * volume * radius * radius);
        for (int c = 0; c < 3; c++) {
            assert_close(s.centroid[c], centre[c], 1e-15);
            assert_relative(s.inertia[c], s.inertia[0], 1e-12);
            assert_close(s.inertia[3 + c], 0, 1e-12 * s.inertia[0]);
        }
        body_free(&b, NULL);
    }
    for (int k = 0; k < 2; k++) {
        assert_true(defect[1][k] > 0 && defect[1][k] < 5e-3);
        assert_close(log2(defect[0][k] / defect[1][k]), 2, 0.02);
    }
}

static void what_bounds_no_solid_is_refused(void **state) {
    (void)state;
    static const double x[6][3] = {{0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}, {-0.1, 0, 0}, {0, 0, 0}};
    static const struct {
        int32_t triangle[8][3];
        int64_t count;
        const char *part;
    } rows[] = {
        {{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}}, 3, "it has 3 triangles"},
        {{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 5}},
         4,
         "it ends at the edge from (100, 0, 0) to (0, 0, 100) mm"},
        {{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 3, 2}}, 4, "one triangle faces outwards and the next inwards"},
        {{{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}, 4, "turned inwards"},
        {{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 2}, {0, 3, 4}, {0, 2, 3}, {4, 3, 2}},
         8,
         "more than two triangles meet at the edge"},
        {{{0, 2, 1}, {0, 1, 3}, {0, 3, 3}, {1, 2, 3}}, 4, "triangle 2 of the surface has no three nodes"},
        {{{0, 2, 1}, {0, 1, 6}, {0, 6, 2}, {1, 2, 6}}, 4, "triangle 1 of the surface has no three nodes"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        sf_solid s;
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(sf_solid_measure(6, x[0], rows[k].count, rows[k].triangle[0], &s, &err),
                         SF_ERR_MODEL);
        if (!strstr(err.text, rows[k].part))
            fail_msg("\"%s\" is missing in: %s", rows[k].part, err.text);
        assert_close(s.volume, 0, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tetrahedron_is_exact),
        cmocka_unit_test(turned_box_is_exact),
        cmocka_unit_test(hollows_are_left_out),
        cmocka_unit_test(sphere_converges_with_the_square_of_the_facets),
        cmocka_unit_test(what_bounds_no_solid_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
