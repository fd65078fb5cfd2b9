/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Is the missile a sphere, and where does it touch first? */
#include "extreme.h"
#include "pre/mesh/missile_shape.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "body_fixture.h"
#include "point_fixture.h"
#include "post_check.h"

static void sphere_is_fitted_to_a_cap(void **state) {
    (void)state;
    const double centre[3] = {0.3, -1.2, 0.08};
    body b;
    sf_error err = SF_ERROR_INIT;
    double found[3], radius, deviation;
    body_ball(&b, 9, 0.08, centre);
    int64_t cap = 0; /* keep only the nodes of a shallow cap */
    for (int64_t i = 0; i < b.surface.node_count; i++)
        if (body_node(&b, i)[2] < 0.08 - 0.07)
            memmove(body_node(&b, cap++), body_node(&b, i), 3 * sizeof(double));
    assert_true(cap > 10 && cap < b.surface.node_count / 4);
    b.surface.node_count = cap;
    assert_int_equal(sf_missile_fit_sphere(&b.surface, found, &radius, &deviation, &err), SF_OK);
    assert_close(point_distance(3, found, centre), 0, 1e-11);
    assert_close(radius, 0.08, 1e-11);
    assert_close(deviation, 0, 1e-11);
    body_free(&b, NULL);
}

/* Octahedron with one axis longer: by symmetry the centre stays, and R^2 is the mean of the squares. */
static void deviation_is_relative_to_the_fitted_sphere(void **state) {
    (void)state;
    body b;
    sf_error err = SF_ERROR_INIT;
    double found[3], radius, deviation, squared = (4 + 2 * 1.1 * 1.1) / 6;
    const double centre[3] = {5, 6, 7};
    body_ball(&b, 1, 1, centre);
    for (int64_t i = 0; i < 6; i++)
        body_node(&b, i)[0] = 5 + 1.1 * (body_node(&b, i)[0] - 5);
    assert_int_equal(sf_missile_fit_sphere(&b.surface, found, &radius, &deviation, &err), SF_OK);
    assert_close(point_distance(3, found, centre), 0, 1e-12);
    assert_close(radius, sqrt(squared), 1e-12);
    assert_close(deviation, fmax(1.1 / sqrt(squared) - 1, 1 - 1 / sqrt(squared)), 1e-12);
    body_free(&b, NULL);
}

static void flat_or_tiny_surfaces_have_no_sphere(void **state) {
    (void)state;
    body b;
    double found[3], radius, deviation;
    sf_error err = SF_ERROR_INIT;
    body_plate(&b, 3, 0.3);
    assert_int_equal(sf_missile_fit_sphere(&b.surface, found, &radius, &deviation, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "flat"));
    err = (sf_error)SF_ERROR_INIT;
    b.surface.node_count = 3;
    assert_int_equal(sf_missile_fit_sphere(&b.surface, found, &radius, &deviation, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "3 nodes"));
    body_free(&b, NULL);
}

static void shape_rule_decides_between_sphere_and_triangles(void **state) {
    (void)state;
    const double centre[3] = {0, 0, 0.08};
    for (int ovality = 0; ovality < 3;
         ovality++) { /* relative to the radius: 0, below and above the tolerance */
        const double stretch[3] = {0, 5e-7, 5e-6};
        body b;
        body_ball(&b, 6, 0.08, centre);
        for (int64_t i = 0; i < b.surface.node_count; i++)
            body_node(&b, i)[0] *= 1 + stretch[ovality];
        for (int rule = 0; rule < 3; rule++) {
            sf_error err = SF_ERROR_INIT;
            sf_missile_card card = {.direction = {0, 0, -1}, .shape = -1};
            sf_status status = sf_missile_set_shape(&b.surface, rule, &card, &err);
            if (rule == 1 && ovality == 2) {
                assert_int_equal(status, SF_ERR_MODEL);
                assert_non_null(strstr(err.text, "deviates"));
                continue;
            }
            assert_int_equal(status, SF_OK);
            assert_int_equal(card.shape, rule == 2 || ovality == 2 ? SF_SHAPE_SURFACE : SF_SHAPE_SPHERE);
            if (card.shape == SF_SHAPE_SPHERE) {
                assert_close(card.sphere_radius, 0.08, 1e-6);
                assert_close(card.sphere_cap_cosine, -1, 1e-6); /* the whole ball */
                assert_close(point_distance(3, card.sphere_centre, centre), 0, 1e-9);
            }
        }
        body_free(&b, NULL);
    }
}

/* Moving downwards; a ball's upper half, one with the lowest triangles removed, and one inside out. */
static void spheres_that_do_not_lead_are_triangles(void **state) {
    (void)state;
    const double centre[3] = {0, 0, 0.08};
    for (int kind = 0; kind < 4; kind++) {
        body b;
        sf_missile_card card = {.direction = {0, 0, -1}};
        sf_error err = SF_ERROR_INIT;
        int64_t kept = 0;
        body_ball(&b, 6, 0.08, centre);
        int32_t *node = b.surface.triangle;
        for (int64_t t = 0; t < b.surface.triangle_count; t++) {
            double height = 0;
            for (int v = 0; v < 3; v++)
                height += body_node(&b, node[3 * t + v])[2] / 3;
            if ((kind == 1 && height < 0.08) || (kind == 2 && height < 0.01))
                continue;
            const int32_t turned[3] = {node[3 * t], node[3 * t + (kind == 3 ? 2 : 1)],
                                       node[3 * t + (kind == 3 ? 1 : 2)]};
            memcpy(&node[3 * kept++], turned, sizeof turned);
        }
        b.surface.triangle_count = kept;
        assert_int_equal(sf_missile_set_shape(&b.surface, 0, &card, &err), SF_OK);
        assert_int_equal(card.shape, kind == 0 ? SF_SHAPE_SPHERE : SF_SHAPE_SURFACE);
        assert_int_equal(sf_missile_set_shape(&b.surface, 1, &card, &err), kind == 0 ? SF_OK : SF_ERR_MODEL);
        assert_true(kind == 0 || strstr(err.text, "does not cover the point"));
        body_free(&b, NULL);
    }
}

/* The corners of a box, of a cube too, lie on a sphere. */
static void boxes_are_no_spheres(void **state) {
    (void)state;
    static const double half[3][3] = {{0.05, 0.03, 0.01}, {0.02, 0.02, 0.02}, {0.01, 0.02, 0.05}};
    static const int32_t side[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (int k = 0; k < 3; k++) {
        double corner[8][3];
        for (int i = 0; i < 24; i++)
            corner[i / 3][i % 3] = (i / 3 >> i % 3 & 1 ? 1 : -1) * half[k][i % 3];
        const sf_surface box = {.node_count = 8,
                                .position = &corner[0][0],
                                .triangle_count = 12,
                                .triangle = (int32_t *)(uintptr_t)side};
        sf_missile_card card = {.direction = {0, 0, -1}};
        sf_error err = SF_ERROR_INIT;
        double centre[3], radius, deviation;
        assert_int_equal(sf_missile_fit_sphere(&box, centre, &radius, &deviation, &err), SF_OK);
        assert_true(deviation < 1e-9); /* by its nodes alone it would be one */
        assert_int_equal(sf_missile_set_shape(&box, 0, &card, &err), SF_OK);
        assert_int_equal(card.shape, SF_SHAPE_SURFACE);
        assert_int_equal(sf_missile_set_shape(&box, 1, &card, &err), SF_ERR_MODEL);
        assert_non_null(strstr(err.text, "of the radius within its sphere"));
    }
}

static void cap_cosine_is_that_of_the_outermost_node(void **state) {
    (void)state;
    const double centre[3] = {0, 0, 0};
    body b;
    sf_error err = SF_ERROR_INIT;
    sf_missile_card card = {.direction = {0, 0, -1}};
    body_ball(&b, 8, 2, centre);
    int64_t cap = 0, kept = 0;
    double rim = -2;
    int32_t to[4096];
    assert_true(b.surface.node_count <= 4096);
    for (int64_t i = 0; i < b.surface.node_count; i++) {
        to[i] = -1;
        if (body_node(&b, i)[2] < -0.9) {
            rim = larger(rim, body_node(&b, i)[2]);
            to[i] = (int32_t)cap;
            memmove(body_node(&b, cap++), body_node(&b, i), 3 * sizeof(double));
        }
    }
    for (int64_t t = 0; t < b.surface.triangle_count; t++) {
        const int32_t *node = &b.surface.triangle[3 * t], there[3] = {to[node[0]], to[node[1]], to[node[2]]};
        if (there[0] >= 0 && there[1] >= 0 && there[2] >= 0)
            memcpy(&b.surface.triangle[3 * kept++], there, sizeof there);
    }
    b.surface.node_count = cap;
    b.surface.triangle_count = kept;
    assert_int_equal(sf_missile_set_shape(&b.surface, 0, &card, &err), SF_OK);
    assert_int_equal(card.shape, SF_SHAPE_SPHERE);
    assert_close(card.sphere_cap_cosine, -rim / 2, 1e-9);
    body_free(&b, NULL);
}

/* Distance to one point, or infinity with the error checked. */
static double travel_to(const sf_surface *surface, const sf_missile_card *card, const double x[3]) {
    const int32_t first = 0;
    sf_error err = SF_ERROR_INIT;
    double distance;
    sf_status status = sf_missile_distance(surface, card, x, 1, &first, &distance, &err);
    if (status == SF_OK) {
        assert_true(isfinite(distance));
        return distance;
    }
    assert_int_equal(status, SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "never touches"));
    return INFINITY;
}

/* The point is touched after the distance: moved back by it, it lies on the sphere, or the path misses the
 * cap. */
static void sphere_touches_after_the_distance_along_an_oblique_path(void **state) {
    (void)state;
    sf_missile_card card = {.shape = SF_SHAPE_SPHERE,
                            .direction = {0.48, 0.6, -0.64},
                            .sphere_centre = {0.1, 0.2, 0.5},
                            .sphere_radius = 0.3,
                            .sphere_cap_cosine = 0.5};
    sf_surface none = {0};
    uint64_t seed = 27;
    int hits = 0;
    for (int trial = 0; trial < 2000; trial++) {
        double x[3], r[3], across = 0, along = 0;
        for (int k = 0; k < 3; k++) {
            x[k] = point_random(&seed, -1, 1);
            r[k] = x[k] - card.sphere_centre[k];
            along += r[k] * card.direction[k];
        }
        for (int k = 0; k < 3; k++)
            across += pow(r[k] - along * card.direction[k], 2);
        double distance = travel_to(&none, &card, x);
        assert_true(isfinite(distance) ==
                    (sqrt(across) < 0.3 * sqrt(0.75))); /* the rim: sine of 60 degrees */
        if (!isfinite(distance))
            continue;
        double foot[3];
        for (int k = 0; k < 3; k++)
            foot[k] = r[k] - distance * card.direction[k];
        assert_close(sqrt(body_dot(foot, foot)), 0.3, 1e-12);
        assert_true(body_dot(foot, card.direction) > 0); /* the front, not the back */
        hits++;
    }
    assert_true(hits > 50);
}

/* Triangles: after the distance the front of the polyhedron is on the point, by the gap of the solver's own
 * surface. */
static void triangles_touch_where_their_gap_vanishes(void **state) {
    (void)state;
    const double centre[3] = {0.1, 0.2, 0.5};
    sf_missile_card card = {.shape = SF_SHAPE_SURFACE, .direction = {0.48, 0.6, -0.64}};
    body b;
    sf_body s;
    uint64_t seed = 28;
    int hits = 0;
    body_ball(&b, 5, 0.3, centre);
    body_build(&b, 0.1, &s);
    for (int trial = 0; trial < 2000; trial++) {
        double x[3], foot[3], ahead[3], gap, normal[3];
        for (int k = 0; k < 3; k++)
            x[k] = point_random(&seed, -1, 1);
        double distance = travel_to(&b.surface, &card, x);
        if (!isfinite(distance))
            continue;
        for (int k = 0; k < 3; k++) {
            foot[k] = x[k] - distance * card.direction[k];
            ahead[k] = foot[k] + 1e-4 * card.direction[k];
        }
        assert_close(body_largest_plane(&b, foot), 0, 1e-12);
        assert_true(sf_body_gap(&s, foot, &gap, normal));
        assert_close(gap, 0, 1e-12);
        assert_true(sf_body_gap(&s, ahead, &gap, normal));
        assert_true(gap > 0); /* not yet touched a little earlier: the front */
        hits++;
    }
    assert_true(hits > 50);
    body_free(&b, &s);
}

static void plate_touches_the_highest_point_below_it(void **state) {
    (void)state;
    sf_missile_card card = {.shape = SF_SHAPE_SURFACE, .direction = {0.6, 0, -0.8}};
    const double points[4][3] = {{0.5, 0.1, -0.4}, {0.35, 0.2, -0.2}, {0.5, 0.2, -0.1}, {0.2, 0.35, -0.05}};
    const int32_t all[4] = {0, 1, 2, 3};
    sf_error err = SF_ERROR_INIT;
    double distance;
    body b;
    body_plate(&b, 4, 0.3);
    assert_close(travel_to(&b.surface, &card, points[0]), 0.5, 1e-12);  /* lands at x = 0.2 of the plate */
    assert_close(travel_to(&b.surface, &card, points[1]), 0.25, 1e-12); /* at 0.2 */
    assert_true(isinf(travel_to(&b.surface, &card, points[2])));        /* passes beyond x = 0.3 */
    assert_true(isinf(travel_to(&b.surface, &card, points[3])));        /* beyond y = 0.3 */
    assert_int_equal(sf_missile_distance(&b.surface, &card, points[0], 4, all, &distance, &err), SF_OK);
    assert_close(distance, 0.25, 1e-12);
    const double above[3] = {0.1, 0.1, 0.04}; /* already passed: negative */
    assert_close(travel_to(&b.surface, &card, above), -0.05, 1e-12);
    card.direction[0] = 1; /* sliding along its own plane */
    card.direction[2] = 0;
    assert_true(isinf(travel_to(&b.surface, &card, points[0])));
    body_free(&b, NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_is_fitted_to_a_cap),
        cmocka_unit_test(deviation_is_relative_to_the_fitted_sphere),
        cmocka_unit_test(flat_or_tiny_surfaces_have_no_sphere),
        cmocka_unit_test(shape_rule_decides_between_sphere_and_triangles),
        cmocka_unit_test(spheres_that_do_not_lead_are_triangles),
        cmocka_unit_test(boxes_are_no_spheres),
        cmocka_unit_test(cap_cosine_is_that_of_the_outermost_node),
        cmocka_unit_test(sphere_touches_after_the_distance_along_an_oblique_path),
        cmocka_unit_test(triangles_touch_where_their_gap_vanishes),
        cmocka_unit_test(plate_touches_the_highest_point_below_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
