/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "solver/contact/shapes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "body_fixture.h"
#include "point_fixture.h"
#include "post_check.h"

/* The gap to a convex body: inside minus the distance to the nearest plane; outside the foot of the normal is
 * on the body, and the whole body lies behind the plane through it (projection onto a convex set). */
static void assert_convex_gap(const body *b, const double x[3], double gap, const double normal[3]) {
    double plane = body_largest_plane(b, x), foot[3];
    double noise =
        fabs(gap) < 1e-6 * b->spacing ? fabs(gap) : 1e-12; /* so close the normal is the feature's */
    assert_close(body_dot(normal, normal), 1, 1e-12);
    for (int k = 0; k < 3; k++)
        foot[k] = x[k] - gap * normal[k];
    assert_close(body_largest_plane(b, foot), 0, noise);
    if (plane < 0)
        assert_close(gap, plane, 1e-12);
    else
        assert_true(gap > 0 && gap >= plane - 1e-12);
    for (int64_t i = 0; plane > 0 && noise == 1e-12 && i < b->surface.node_count; i++) {
        double r[3];
        body_vector(foot, &b->surface.position[3 * i], r);
        if (body_dot(r, normal) > 1e-9)
            fail_msg("node %d stands %g before the tangent plane", (int)i, body_dot(r, normal));
    }
}

static sf_body sphere(double cap_cosine) {
    sf_error err = SF_ERROR_INIT;
    sf_body s;
    sf_model model = {.missile = {.shape = SF_SHAPE_SPHERE,
                                  .sphere_centre = {0.1, -0.2, 0.3},
                                  .sphere_radius = 0.08,
                                  .sphere_cap_cosine = cap_cosine,
                                  .direction = {0, 0.6, -0.8}}};
    assert_int_equal(sf_body_build(&model, SF_BODY_MISSILE, &s, &err), SF_OK);
    return s;
}

static void sphere_gap_is_distance_minus_radius(void **state) {
    (void)state;
    sf_body s = sphere(-1);
    const double centre[3] = {0.1, -0.2, 0.3};
    uint64_t seed = 20;
    for (int trial = 0; trial < 1000; trial++) {
        double u[3], length, distance = point_random(&seed, 0.01, 0.2), x[3], gap, normal[3];
        for (int k = 0; k < 3; k++)
            u[k] = point_random(&seed, -1, 1);
        length = sqrt(body_dot(u, u));
        for (int k = 0; k < 3; k++) {
            u[k] /= length;
            x[k] = centre[k] + distance * u[k];
        }
        assert_true(sf_body_gap(&s, x, &gap, normal));
        assert_close(gap, distance - 0.08, 1e-15);
        assert_close(point_distance(3, normal, u), 0, 1e-13);
    }
    double gap, normal[3];
    assert_false(sf_body_gap(&s, centre, &gap, normal)); /* no direction there */
    sf_body_free(&s);
}

static void sphere_cap_ends_at_its_rim(void **state) {
    (void)state;
    sf_body s = sphere(0.5); /* 60 degrees about (0, 0.6, -0.8) */
    for (int degrees = 0; degrees <= 180; degrees++) {
        if (degrees == 60)
            continue;
        double angle = degrees * M_PI / 180, gap, normal[3];
        const double u[3] = {sin(angle), 0.6 * cos(angle), -0.8 * cos(angle)};
        const double x[3] = {0.1 + 0.07 * u[0], -0.2 + 0.07 * u[1], 0.3 + 0.07 * u[2]};
        assert_true(sf_body_gap(&s, x, &gap, normal) == (degrees < 60));
    }
    sf_body_free(&s);
}

/* A polyhedron between the balls of radius R and R - sagitta has its signed distance between theirs. */
static void fine_triangles_agree_with_the_exact_sphere(void **state) {
    (void)state;
    const double centre[3] = {0.2, -0.1, 0.5};
    double worst[2] = {0};
    for (int level = 0; level < 2; level++) {
        body b;
        sf_body s;
        double sagitta = 0;
        uint64_t seed = 21;
        body_ball(&b, 12 << level, 1, centre);
        body_build(&b, 0.3, &s);
        for (int64_t t = 0; t < b.surface.triangle_count; t++) {
            double n[3], r[3];
            body_face_normal(&b, t, n);
            body_vector(centre, body_node(&b, b.surface.triangle[3 * t]), r);
            assert_true(body_dot(n, r) > 0); /* outward */
            sagitta = larger(sagitta, 1 - body_dot(n, r));
        }
        for (int trial = 0; trial < 3000; trial++) {
            double u[3], x[3], gap, normal[3], distance = point_random(&seed, 0.75, 1.25);
            for (int k = 0; k < 3; k++)
                u[k] = point_random(&seed, -1, 1);
            double length = sqrt(body_dot(u, u));
            for (int k = 0; k < 3; k++) {
                u[k] /= length;
                x[k] = centre[k] + distance * u[k];
            }
            assert_true(sf_body_gap(&s, x, &gap, normal));
            assert_true(gap >= distance - 1 - 1e-12 && gap <= distance - 1 + sagitta + 1e-12);
            assert_true(body_dot(normal, u) > cos(3.0 / (12 << level)));
            worst[level] = larger(worst[level], gap - (distance - 1));
        }
        body_free(&b, &s);
    }
    assert_true(worst[1] < 0.3 * worst[0]); /* second order in the edge length */
}

/* Random points close to a face, an edge or a vertex of a coarse ball, on both sides. */
static void sign_and_distance_are_exact_near_faces_edges_and_vertices(void **state) {
    (void)state;
    const double centre[3] = {-0.3, 0.4, 0.1};
    body b;
    sf_body s;
    uint64_t seed = 22;
    int inside = 0;
    body_ball(&b, 3, 1, centre);
    body_build(&b, 0.4, &s);
    for (int trial = 0; trial < 12000; trial++) {
        int64_t t = (int64_t)point_random(&seed, 0, (double)b.surface.triangle_count);
        double weight[3] = {point_random(&seed, 0, 1), trial % 3 ? point_random(&seed, 0, 1) : 0,
                            trial % 3 == 2 ? point_random(&seed, 0, 1) : 0};
        double sum = weight[0] + weight[1] + weight[2], x[3], gap, normal[3];
        double noise = pow(10, point_random(&seed, -6, -1));
        for (int k = 0; k < 3; k++) {
            x[k] = point_random(&seed, -noise, noise);
            for (int c = 0; c < 3; c++)
                x[k] += weight[c] / sum * body_node(&b, b.surface.triangle[3 * t + c])[k];
        }
        assert_true(sf_body_gap(&s, x, &gap, normal));
        assert_convex_gap(&b, x, gap, normal);
        inside += gap < 0;
    }
    assert_true(inside > 1000 && inside < 11000);
    body_free(&b, &s);
}

/* On the surface the gap is zero and the normal still points outwards. */
static void normal_on_the_surface_is_outward(void **state) {
    (void)state;
    const double centre[3] = {0, 0, 0};
    body b;
    sf_body s;
    body_ball(&b, 4, 1, centre);
    body_build(&b, 0.4, &s);
    for (int64_t t = 0; t < b.surface.triangle_count; t++)
        for (int kind = 0; kind < 3; kind++) { /* centroid, middle of an edge, vertex */
            double x[3] = {0}, gap, normal[3];
            for (int c = 0; c < 3 - kind; c++)
                for (int k = 0; k < 3; k++)
                    x[k] += body_node(&b, b.surface.triangle[3 * t + c])[k] / (3 - kind);
            assert_true(sf_body_gap(&s, x, &gap, normal));
            assert_close(gap, 0, 1e-12);
            assert_close(body_dot(normal, normal), 1, 1e-12);
            assert_true(body_dot(normal, x) > 0.9 * sqrt(body_dot(x, x)));
        }
    body_free(&b, &s);
}

/* Points before the apex in its whole normal cone, where a face's own normal, or the plain mean over a fan of
 * slivers, would take outside for inside; turned inside out, the same points are inside a notch. */
static void sharp_vertex_has_the_right_side_whatever_its_triangles(void **state) {
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        body b;
        sf_body s;
        double n[3][3];
        uint64_t seed = 23;
        body_spike(&b, 30, mirrored);
        body_build(&b, 0.2, &s);
        body_face_normal(&b, 0, n[0]);
        body_face_normal(&b, b.surface.triangle_count - 2, n[1]);
        body_face_normal(&b, b.surface.triangle_count - 1, n[2]);
        assert_true(body_dot(n[0], n[1]) < -0.3); /* sharp */
        for (int trial = 0; trial < 2000; trial++) {
            double x[3] = {0}, gap, normal[3];
            for (int face = 0; face < 3; face++) {
                double share = point_random(&seed, 0.001, 1) * (trial % 4 == face + 1 ? 30 : 1);
                for (int k = 0; k < 3; k++)
                    x[k] += (mirrored ? -1 : 1) * share * n[face][k];
            }
            double length = sqrt(body_dot(x, x)), distance = point_random(&seed, 1e-4, 0.19);
            for (int k = 0; k < 3; k++)
                x[k] *= distance / length;
            assert_true(sf_body_gap(&s, x, &gap, normal));
            assert_close(gap, mirrored ? -distance : distance, 1e-12);
            for (int k = 0; k < 3; k++)
                assert_close(normal[k], (mirrored ? -x[k] : x[k]) / distance, 1e-9);
        }
        body_free(&b, &s);
    }
}

/* The same before the sharp edges, in the wedge between the normals of their two faces. */
static void sharp_edge_has_the_right_side(void **state) {
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        body b;
        sf_body s;
        uint64_t seed = 29;
        body_spike(&b, 30, mirrored);
        body_build(&b, 0.2, &s);
        int64_t last = b.surface.triangle_count;
        const int64_t face[3][2] = {{last - 2, last - 1}, {0, last - 1}, {last - 4, last - 2}};
        const int32_t corner[3] = {(int32_t)b.surface.node_count - 2, 0, (int32_t)b.surface.node_count - 3};
        for (int trial = 0; trial < 3000; trial++) {
            int e = trial % 3;
            double n[2][3], x[3], gap, normal[3], along = point_random(&seed, 0.3, 0.7);
            double share = trial % 2 ? 1e-3 : 1 - 1e-3, length = 0;
            for (int k = 0; k < 2; k++)
                body_face_normal(&b, face[e][k], n[k]);
            assert_true(body_dot(n[0], n[1]) < -0.3);
            double out[3];
            for (int k = 0; k < 3; k++)
                out[k] = (mirrored ? -1 : 1) * (share * n[0][k] + (1 - share) * n[1][k]);
            length = sqrt(body_dot(out, out));
            double distance = point_random(&seed, 1e-4, 0.19);
            for (int k = 0; k < 3; k++)
                x[k] = along * body_node(&b, corner[e])[k] + distance / length * out[k];
            assert_true(sf_body_gap(&s, x, &gap, normal));
            assert_close(gap, mirrored ? -distance : distance, 1e-12);
        }
        body_free(&b, &s);
    }
}

static void surface_is_found_up_to_its_reach(void **state) {
    (void)state;
    const double centre[3] = {0, 0, 0};
    body b;
    sf_body s;
    uint64_t seed = 24;
    body_ball(&b, 6, 1, centre);
    body_build(&b, 0.15, &s);
    int found = 0;
    for (int trial = 0; trial < 5000; trial++) {
        double x[3], gap, normal[3], plane;
        for (int k = 0; k < 3; k++)
            x[k] = point_random(&seed, -1.3, 1.3);
        plane = body_largest_plane(&b, x);
        bool near = sf_body_gap(&s, x, &gap, normal);
        if (plane > 0.15 || plane < -0.15)
            assert_false(near);
        if (plane < 0 && plane > -0.15)
            assert_true(near);
        if (near) {
            assert_convex_gap(&b, x, gap, normal);
            assert_true(fabs(gap) <= 0.15);
        }
        found += near;
    }
    assert_true(found > 300);
    body_free(&b, &s);
}

static void plate_gap_is_the_height_below_it(void **state) {
    (void)state;
    body b;
    sf_body s;
    uint64_t seed = 25;
    body_plate(&b, 7, 0.3);
    body_build(&b, 0.02, &s);
    for (int trial = 0; trial < 2000; trial++) {
        double x[3] = {point_random(&seed, 0, 0.3), point_random(&seed, 0, 0.3),
                       trial % 10 ? point_random(&seed, -0.0199, 0.0199) : 0};
        double gap, normal[3];
        const double down[3] = {0, 0, -1};
        assert_true(sf_body_gap(&s, x, &gap, normal));
        assert_close(gap, -x[2], 1e-16);
        assert_close(point_distance(3, normal, down), 0, 1e-12);
        x[2] = trial % 2 ? 0.0201 : -0.0201;
        assert_false(sf_body_gap(&s, x, &gap, normal));
    }
    body_free(&b, &s);
}

/* Beside the rim of an open surface: outside by the distance to the rim, or nothing. Never inside: the foam
 * that stands up beside a flat punch is not in it. */
static void beside_the_rim_of_a_plate_nothing_is_inside(void **state) {
    (void)state;
    body b;
    sf_body s;
    uint64_t seed = 26;
    body_plate(&b, 7, 0.3);
    body_build(&b, 0.02, &s);
    int outside = 0;
    for (int trial = 0; trial < 4000; trial++) {
        double beside = point_random(&seed, 0.004, 0.03), gap, normal[3];
        double x[3] = {-beside, point_random(&seed, 0, 0.3), point_random(&seed, -0.019, 0.019)};
        if (trial % 4 == 0) /* at a corner */
            x[1] = 0.3 + point_random(&seed, 0, 0.01);
        if (trial % 2)
            x[0] = 0.3 + beside;
        double corner = fmax(0, x[1] - 0.3), distance = sqrt(beside * beside + x[2] * x[2] + corner * corner);
        bool near = sf_body_gap(&s, x, &gap, normal);
        assert_true(near == (x[2] <= 0 && distance < 0.02));
        if (near)
            assert_close(gap, distance, 1e-15);
        outside += near;
    }
    assert_true(outside > 200);
    body_free(&b, &s);
}

/* An eighth of a ball cut by its symmetry planes: points in those planes keep the gap of the whole ball. Also
 * inside out, a hollow in a larger missile, where the nearest points lie on the tilted rim. */
static void rim_on_a_symmetry_plane_is_part_of_the_missile(void **state) {
    (void)state;
    for (int hollow = 0; hollow < 2; hollow++) {
        const double centre[3] = {0, 0, 0};
        body b;
        sf_body s;
        body_ball(&b, 8, 1, centre);
        b.surface.triangle_count /= 8; /* x, y, z >= 0 */
        for (int64_t t = 0; hollow && t < b.surface.triangle_count; t++) {
            int32_t *v = &b.surface.triangle[3 * t], swap = v[1];
            v[1] = v[2];
            v[2] = swap;
        }
        body_build(&b, 0.25, &s);
        for (double angle = 0.05; angle < 1.55; angle += 0.01)
            for (double distance = 0.8; distance < 1.2; distance += 0.017) {
                const double x[3] = {distance < 0.9 ? -1e-3 : 0, distance * sin(angle),
                                     distance * cos(angle)};
                double gap, normal[3];
                assert_true(sf_body_gap(&s, x, &gap, normal));
                assert_close(gap, hollow ? 1 - distance : distance - 1, 0.02);
            }
        for (int64_t i = 0; i < b.surface.node_count; i++) { /* on the rim, and barely inside */
            double x[3], gap, normal[3];
            memcpy(x, body_node(&b, i), sizeof x);
            if (x[0] != 0 || x[1] <= 0 || x[2] <= 0)
                continue;
            for (int k = 1; k < 3; k++)
                x[k] *= hollow ? 1 + 1e-7 : 1 - 1e-7;
            x[0] = -1e-6;
            assert_true(sf_body_gap(&s, x, &gap, normal));
            assert_true(gap < 0);
        }
        body_free(&b, &s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_gap_is_distance_minus_radius),
        cmocka_unit_test(sphere_cap_ends_at_its_rim),
        cmocka_unit_test(fine_triangles_agree_with_the_exact_sphere),
        cmocka_unit_test(sign_and_distance_are_exact_near_faces_edges_and_vertices),
        cmocka_unit_test(normal_on_the_surface_is_outward),
        cmocka_unit_test(sharp_vertex_has_the_right_side_whatever_its_triangles),
        cmocka_unit_test(sharp_edge_has_the_right_side),
        cmocka_unit_test(surface_is_found_up_to_its_reach),
        cmocka_unit_test(plate_gap_is_the_height_below_it),
        cmocka_unit_test(beside_the_rim_of_a_plate_nothing_is_inside),
        cmocka_unit_test(rim_on_a_symmetry_plane_is_part_of_the_missile),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
