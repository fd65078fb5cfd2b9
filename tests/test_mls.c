/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shape functions and the neighbour grid on random clouds. */

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "point_fixture.h"
#include "post_check.h"
#include "pre/cloud/mls.h"

enum { SIDE = 7, NODES = SIDE * SIDE * SIDE };

/* A jittered lattice of unit spacing, scaled and shifted, with supports that differ from node to node. */
typedef struct cloud {
    double position[3 * NODES], support[NODES];
    int32_t all[NODES];
    sf_mls_cloud mls;
} cloud;

static void make_cloud(cloud *c, uint64_t *seed, double jitter, double scale, double shift) {
    for (int i = 0; i < NODES; i++) {
        const int at[3] = {i / (SIDE * SIDE), i / SIDE % SIDE, i % SIDE};
        for (int k = 0; k < 3; k++)
            c->position[3 * i + k] = shift + scale * (at[k] + point_random(seed, -jitter, jitter));
        c->support[i] = scale * point_random(seed, 1.9, 2.6);
        c->all[i] = i;
    }
    c->mls = (sf_mls_cloud){c->position, c->support, false};
}

static void random_point(uint64_t *seed, double scale, double shift, double x[3]) {
    for (int k = 0; k < 3; k++)
        x[k] = shift + scale * point_random(seed, 0, SIDE - 1);
}

static double distance_to(const cloud *c, int i, const double x[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += pow(c->position[3 * i + k] - x[k], 2);
    return sqrt(sum);
}

static void shape_functions_reproduce_linear_fields(void **state) {
    (void)state;
    static cloud c;
    static sf_mls_point point;
    uint64_t seed = 40;
    const double scales[3] = {1, 5e-3, 1e3};
    for (int trial = 0; trial < 600; trial++) {
        double scale = scales[trial % 3], shift = trial % 2 ? 3 * scale : 0, x[3], sum = 0, first[3] = {0};
        make_cloud(&c, &seed, trial % 4 ? 0.3 : 0, scale, shift);
        random_point(&seed, scale, shift, x);
        assert_int_equal(sf_mls_evaluate(&c.mls, x, NODES, c.all, &point), 0);
        for (int k = 0; k < point.count; k++) {
            sum += point.value[k];
            for (int a = 0; a < 3; a++)
                first[a] += point.value[k] * (c.position[3 * point.node[k] + a] - x[a]);
        }
        assert_close(sum, 1, 1e-12);
        for (int a = 0; a < 3; a++)
            assert_close(first[a] / scale, 0, 1e-12);
        assert_true(isfinite(point.condition) && point.condition >= 1);
    }
}

/* At the centre of a symmetric neighbourhood the first moments vanish: phi is w over the sum of w (Shepard).
 */
static void symmetric_neighbourhood_gives_normalised_weights(void **state) {
    (void)state;
    static cloud c;
    static sf_mls_point point;
    uint64_t seed = 41;
    make_cloud(&c, &seed, 0, 1, 0);
    for (int i = 0; i < NODES; i++)
        c.support[i] = 1.4;
    const double x[3] = {3, 3, 3};
    assert_int_equal(sf_mls_evaluate(&c.mls, x, NODES, c.all, &point), 0);
    assert_int_equal(point.count, 7); /* the node and six at q = 1/1.4; the next are at sqrt(2) > 1.4 */
    double own = sf_mls_weight(0), other = sf_mls_weight(1 / 1.4);
    for (int k = 0; k < 7; k++)
        assert_close(point.value[k],
                     (distance_to(&c, point.node[k], x) < 0.5 ? own : other) / (own + 6 * other), 1e-14);
}

static void nodes_out_of_reach_are_skipped_and_order_is_kept(void **state) {
    (void)state;
    static cloud c;
    static sf_mls_point point;
    uint64_t seed = 42;
    make_cloud(&c, &seed, 0.3, 1, 0);
    for (int trial = 0; trial < 50; trial++) {
        double x[3];
        int expected = 0;
        random_point(&seed, 1, 0, x);
        assert_int_equal(sf_mls_evaluate(&c.mls, x, NODES, c.all, &point), 0);
        for (int i = 0; i < NODES; i++)
            if (distance_to(&c, i, x) < c.support[i]) {
                assert_true(expected < point.count);
                assert_int_equal(point.node[expected++], i);
            }
        assert_int_equal(point.count, expected);
    }
}

/* phi and the conditioning do not know the unit of length or the origin. */
static void shape_functions_do_not_depend_on_units_or_place(void **state) {
    (void)state;
    static cloud c, moved;
    static sf_mls_point here, there;
    uint64_t seed = 43;
    make_cloud(&c, &seed, 0.3, 1, 0);
    moved = c;
    moved.mls = (sf_mls_cloud){moved.position, moved.support, false};
    for (int k = 0; k < 3 * NODES; k++)
        moved.position[k] = 1e-3 * (c.position[k] + 2);
    for (int i = 0; i < NODES; i++)
        moved.support[i] *= 1e-3;
    for (int trial = 0; trial < 50; trial++) {
        double x[3], y[3];
        random_point(&seed, 1, 0, x);
        for (int k = 0; k < 3; k++)
            y[k] = 1e-3 * (x[k] + 2);
        assert_int_equal(sf_mls_evaluate(&c.mls, x, NODES, c.all, &here), 0);
        assert_int_equal(sf_mls_evaluate(&moved.mls, y, NODES, moved.all, &there), 0);
        assert_int_equal(here.count, there.count);
        assert_close(point_distance(here.count, here.value, there.value), 0, 1e-11);
        assert_relative(there.condition, here.condition, 1e-10);
    }
}

/* w(q) and its one-sided derivatives from four values, exact for cubics; side = -1 looks from below. */
static void weight_derivatives(double q, int side, double d[3]) {
    double h = side * 0.05, f[4];
    for (int k = 0; k < 4; k++)
        f[k] = sf_mls_weight(q + k * h);
    d[0] = f[0];
    d[1] = (-11 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3]) / (6 * h);
    d[2] = (2 * f[0] - 5 * f[1] + 4 * f[2] - f[3]) / (h * h);
}

/* Cubic B-spline: value, slope and curvature at 0, at the joint and at the rim agree from both sides. */
static void weight_is_the_c2_cubic_spline(void **state) {
    (void)state;
    const double at[3] = {0, 0.5, 1}, expected[3][3] = {{2.0 / 3, 0, -8}, {1.0 / 6, -1, 4}, {0, 0, 0}};
    for (int k = 0; k < 3; k++)
        for (int side = k == 0 ? 1 : -1; side <= 1; side += 2) {
            double d[3];
            weight_derivatives(at[k], side, d);
            for (int order = 0; order < 3; order++)
                assert_close(d[order], expected[k][order], 1e-12);
        }
    for (double q = 0; q < 1; q += 0.01)
        assert_true(sf_mls_weight(q) > sf_mls_weight(q + 0.01) || q >= 0.99);
    assert_close(sf_mls_weight(1.7), 0, 0);
}

/* ---- singular points ---- */

/* `count` nodes in the plane through the point `x` normal to a random direction, or a random way off it. */
static void make_disc(cloud *c, uint64_t *seed, int count, double off, const double x[3]) {
    double q[9];
    point_rotation(seed, q);
    for (int i = 0; i < count; i++) {
        const double local[3] = {point_random(seed, -0.7, 0.7), point_random(seed, -0.7, 0.7),
                                 point_random(seed, -off, off)};
        for (int k = 0; k < 3; k++)
            c->position[3 * i + k] =
                x[k] + q[3 * k] * local[0] + q[3 * k + 1] * local[1] + q[3 * k + 2] * local[2];
        c->support[i] = 1.5;
        c->all[i] = i;
    }
    c->mls = (sf_mls_cloud){c->position, c->support, false};
}

/* In the rounded plane of a random direction the moment matrix can miss exact singularity by rounding: then
 * its conditioning says so. */
static void coplanar_neighbours_are_singular(void **state) {
    (void)state;
    static cloud c;
    static sf_mls_point point;
    uint64_t seed = 44;
    const double x[3] = {0.2, -0.4, 0.1};
    int singular = 0;
    for (int trial = 0; trial < 500; trial++) {
        int count = 5 + trial % 40;
        make_disc(&c, &seed, count, 0, x);
        int status = sf_mls_evaluate(&c.mls, x, count, c.all, &point);
        assert_int_equal(point.count, count);
        assert_true(status == 0 ? point.condition > 1e13 : isinf(point.condition));
        singular += status == -1;
    }
    assert_true(singular > 450);
}

/* Layers and rows of the bare lattice are singular to the last bit. */
static void layers_and_rows_of_a_lattice_are_singular(void **state) {
    (void)state;
    static cloud c;
    static sf_mls_point point;
    uint64_t seed = 48;
    make_cloud(&c, &seed, 0, 1, 0);
    for (int axis = 0; axis < 3; axis++) {
        const int stride[3] = {SIDE * SIDE, SIDE, 1};
        int32_t layer[NODES];
        int count = 0;
        for (int i = 0; i < NODES; i++)
            if (i / stride[axis] % SIDE == 3)
                layer[count++] = i;
        assert_int_equal(count, SIDE * SIDE);
        double x[3] = {3.2, 2.9, 3.1};
        x[axis] = 3;
        for (int lift = 0; lift < 2; lift++) { /* the point in the layer, and beside it */
            x[axis] += 0.3 * lift;
            assert_int_equal(sf_mls_evaluate(&c.mls, x, count, layer, &point), -1);
            assert_int_equal(sf_mls_evaluate(&c.mls, x, SIDE, layer, &point), -1);
            assert_true(isinf(point.condition));
        }
    }
}

/* The thinner the layer, the worse the conditioning: with the inverse square of its thickness. */
static void condition_tells_nearly_coplanar_neighbours(void **state) {
    (void)state;
    static cloud c;
    static sf_mls_point point;
    const double x[3] = {0, 0, 0};
    double condition[2];
    for (int k = 0; k < 2; k++) {
        uint64_t seed = 45; /* the same disc */
        make_disc(&c, &seed, 30, k ? 1e-4 : 1e-3, x);
        assert_int_equal(sf_mls_evaluate(&c.mls, x, 30, c.all, &point), 0);
        condition[k] = point.condition;
    }
    assert_relative(condition[1] / condition[0], 100, 0.01);
    assert_true(condition[0] > 1e5);
}

static void too_few_or_too_many_neighbours_are_refused(void **state) {
    (void)state;
    static cloud c;
    static sf_mls_point point;
    uint64_t seed = 46;
    const double x[3] = {0, 0, 0}, tetrahedron[12] = {0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5, -0.3, -0.3, -0.3};
    make_disc(&c, &seed, 4, 0.7, x);
    memcpy(c.position, tetrahedron, sizeof tetrahedron);
    for (int count = 0; count < 4; count++) {
        assert_int_equal(sf_mls_evaluate(&c.mls, x, count, c.all, &point), -1);
        assert_int_equal(point.count, count);
        assert_true(isinf(point.condition));
    }
    assert_int_equal(sf_mls_evaluate(&c.mls, x, 4, c.all, &point), 0); /* four: barycentric coordinates */
    double sum = 0;
    for (int k = 0; k < 4; k++)
        sum += point.value[k] * (k < 3 ? 0.5 : -0.9);
    assert_close(sum, 0, 1e-13);
    assert_close(point.value[0], 0.3 / 1.4, 1e-13);
    c.support[3] = 0.1; /* the fourth does not reach x any more */
    assert_int_equal(sf_mls_evaluate(&c.mls, x, 4, c.all, &point), -1);
    assert_int_equal(point.count, 3);

    static double crowd[3 * (SF_MLS_MAX_NODES + 1)], support[SF_MLS_MAX_NODES + 1];
    static int32_t everyone[SF_MLS_MAX_NODES + 1];
    for (int i = 0; i <= SF_MLS_MAX_NODES; i++) {
        for (int k = 0; k < 3; k++)
            crowd[3 * i + k] = point_random(&seed, -0.5, 0.5);
        support[i] = 2;
        everyone[i] = i;
    }
    const sf_mls_cloud full = {crowd, support, false};
    assert_int_equal(sf_mls_evaluate(&full, x, SF_MLS_MAX_NODES, everyone, &point), 0);
    assert_int_equal(sf_mls_evaluate(&full, x, SF_MLS_MAX_NODES + 1, everyone, &point), -1);
    assert_true(isinf(point.condition));
}

/* ---- neighbours ---- */

static int by_number(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* Compares queries at random places, also outside the cloud, with brute force. */
static void assert_queries_match(const sf_grid *grid, int count, const double *position,
                                 const double *support, uint64_t *seed, double extent) {
    static int32_t found[NODES], expected[NODES];
    for (int trial = 0; trial < 200; trial++) {
        double x[3], radius = trial % 3 ? point_random(seed, 0, 0.2 * extent) : 0;
        for (int k = 0; k < 3; k++)
            x[k] = position[k] + point_random(seed, -1.3, 1.3) * extent;
        int64_t n = 0;
        for (int i = 0; i < count; i++) {
            double dx = position[3 * i] - x[0], dy = position[3 * i + 1] - x[1],
                   dz = position[3 * i + 2] - x[2];
            if (sqrt(dx * dx + dy * dy + dz * dz) < support[i] + radius)
                expected[n++] = i;
        }
        assert_int_equal(sf_grid_query(grid, x, radius, NODES, found), n);
        assert_memory_equal(found, expected, (size_t)n * sizeof *found);
        if (n > 2) { /* a short list: the number is still right, and what it holds is among the neighbours */
            found[2] = -7;
            assert_int_equal(sf_grid_query(grid, x, radius, 2, found), n);
            assert_int_equal(found[2], -7); /* not written beyond the limit */
            assert_true(found[0] < found[1]);
            for (int k = 0; k < 2; k++)
                assert_non_null(bsearch(&found[k], expected, (size_t)n, sizeof *found, by_number));
        }
    }
}

static void grid_agrees_with_brute_force(void **state) {
    (void)state;
    static cloud c;
    uint64_t seed = 47;
    for (int kind = 0; kind < 5; kind++) {
        sf_error err = SF_ERROR_INIT;
        sf_grid grid;
        int count = kind == 4 ? 1 : NODES;
        make_cloud(&c, &seed, 0.4, 1, 10);
        for (int i = 0; i < NODES; i++) {
            c.support[i] = point_random(&seed, 0.2, 2.5);
            if (kind == 1) /* one outsized support */
                c.support[i] = i == 100 ? 20 : 0.8;
            if (kind == 2) /* many tiny ones */
                c.support[i] = i == 100 ? 1e-3 : 1e-5;
            if (kind == 3) /* a sheet */
                c.position[3 * i + 1] = 4;
        }
        assert_int_equal(sf_grid_build(&grid, count, c.position, c.support, &err), SF_OK);
        for (int k = 0; k < 3; k++)
            assert_true(grid.bins[k] >= 1);
        assert_true(grid.bins[0] * grid.bins[1] * grid.bins[2] < 100 * NODES);
        assert_queries_match(&grid, count, c.position, c.support, &seed, kind == 2 ? 0.5 : SIDE);
        sf_grid_free(&grid);
    }
}

/* Nodes exactly at their reach do not count: the inequality is strict. */
static void node_at_exactly_its_support_is_out(void **state) {
    (void)state;
    const double position[6] = {0, 0, 0, 2, 0, 0}, support[2] = {1, 1}, middle[3] = {1, 0, 0};
    sf_error err = SF_ERROR_INIT;
    sf_grid grid;
    int32_t found[2];
    assert_int_equal(sf_grid_build(&grid, 2, position, support, &err), SF_OK);
    assert_int_equal(sf_grid_query(&grid, middle, 0, 2, found), 0);
    assert_int_equal(sf_grid_query(&grid, middle, 1e-9, 2, found), 2);
    sf_grid_free(&grid);
}

/* As the sides of a section lie: the volume of their box says nothing of how many bins are in a row. */
static void grid_of_a_line_has_no_more_bins_than_its_room(void **state) {
    enum { COUNT = 52 };
    double position[3 * COUNT] = {0}, support[COUNT];
    int64_t start[SF_GRID_STARTS(COUNT)];
    int32_t node[COUNT], found[COUNT];
    sf_grid grid;
    (void)state;
    for (int k = 0; k < COUNT; k++) {
        position[3 * k] = k < COUNT - 1 ? 1e-3 * k : 10;
        support[k] = 1e-3;
    }
    sf_grid_fill(&grid, COUNT, position, support, start, node);
    assert_true(grid.bins[0] * grid.bins[1] * grid.bins[2] + 2 <= SF_GRID_STARTS(COUNT));
    assert_int_equal(sf_grid_query(&grid, &position[3 * 20], 1.5e-3, COUNT, found), 5);
    assert_int_equal(found[0], 18);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shape_functions_reproduce_linear_fields),
        cmocka_unit_test(symmetric_neighbourhood_gives_normalised_weights),
        cmocka_unit_test(nodes_out_of_reach_are_skipped_and_order_is_kept),
        cmocka_unit_test(shape_functions_do_not_depend_on_units_or_place),
        cmocka_unit_test(weight_is_the_c2_cubic_spline),
        cmocka_unit_test(coplanar_neighbours_are_singular),
        cmocka_unit_test(layers_and_rows_of_a_lattice_are_singular),
        cmocka_unit_test(condition_tells_nearly_coplanar_neighbours),
        cmocka_unit_test(too_few_or_too_many_neighbours_are_refused),
        cmocka_unit_test(grid_agrees_with_brute_force),
        cmocka_unit_test(node_at_exactly_its_support_is_out),
        cmocka_unit_test(grid_of_a_line_has_no_more_bins_than_its_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
