/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pad and missile that do not face each other: exchanged groups, a pad upside down, a missile inside the pad,
 * a surface turned away or without sides. */
#include "check.h"
#include "model_fixture.h"
#include "pre/mesh/missile_shape.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";
static const double DOWN[3] = {0, 0, -1};

/* The missile pulled the foam out through its bottom: 43 g, and every check passed. */
static void exchanged_groups_are_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *set, *part;
    } rows[] = {
        {"--set pad.contact=base --set 'pad.fixed=[\"top\"]'", "\"base\" does not face the missile"},
        {"--set pad.contact=sides", "\"sides\" does not face the missile"},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        program_result r = program_run(p, "pre", "'%s' -o new.h5 %s %s", fixture_source(EXAMPLE),
                                       program_coarse(25), rows[k].set);
        assert_int_not_equal(r.code, 0);
        if (!strstr(r.err, rows[k].part) || !strstr(r.err, "pad.contact"))
            fail_msg("\"%s\" is missing in: %s", rows[k].part, r.err);
    }
    assert_int_not_equal(program_shell(p, "ls new.h5").code, 0);
}

/* A block under a plate; the error of the build. */
static sf_error build_block(sf_mesh *mesh, sf_surface *plate) {
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    sf_model m;
    sf_build_report report;
    fixture_case(&c, NULL);
    c.symmetry_count = 0;
    sf_model_build(&c, mesh, plate, &m, &report, NULL, &err);
    sf_model_free(&m);
    sf_surface_free(plate);
    sf_mesh_free(mesh);
    sf_case_free(&c);
    return err;
}

static void make_block(sf_mesh *mesh, sf_surface *plate) {
    const fixture_block block = {.cells = {4, 4, 4}, .spacing = 0.01};
    fixture_block_mesh(&block, mesh);
    fixture_plate(0.1, 0.02, 0.02, plate);
}

/* Turned by 180 degrees about the y axis, groups and all. */
static void pad_upside_down_is_refused(void **state) {
    (void)state;
    sf_mesh mesh;
    sf_surface plate;
    make_block(&mesh, &plate);
    sf_error upright = build_block(&mesh, &plate);
    assert_int_equal(upright.status, SF_OK);
    make_block(&mesh, &plate);
    for (int64_t i = 0; i < mesh.node_count; i++) {
        mesh.position[3 * i] = 0.04 - mesh.position[3 * i];
        mesh.position[3 * i + 2] = 0.04 - mesh.position[3 * i + 2];
    }
    sf_error turned = build_block(&mesh, &plate);
    assert_int_equal(turned.status, SF_ERR_INPUT);
    assert_non_null(strstr(turned.text, "upside down"));
}

/* Top and base in one group. */
static void what_faces_away_may_be_in_the_group(void **state) {
    (void)state;
    sf_mesh mesh;
    sf_surface plate;
    make_block(&mesh, &plate);
    sf_node_set *top = &mesh.set[1], *base = &mesh.set[0];
    int32_t *both = calloc((size_t)(top->count + base->count), sizeof *both);
    int64_t used = 0;
    assert_non_null(both);
    for (int64_t k = 0; k < base->count - 5; k++) /* but one row of the base: not balanced */
        both[used++] = base->node[k];
    for (int64_t k = 0; k < top->count; k++)
        both[used++] = top->node[k];
    free(top->node);
    top->node = both;
    top->count = used;
    sf_error err = build_block(&mesh, &plate);
    assert_int_equal(err.status, SF_OK);
}

/* The contact group is the floor of a hollow 3 mm deep; the plate covers its rim, too. */
static void missile_inside_the_pad_is_refused(void **state) {
    (void)state;
    sf_mesh mesh;
    sf_surface plate;
    make_block(&mesh, &plate);
    sf_node_set *top = &mesh.set[1];
    int64_t used = 0;
    for (int64_t k = 0; k < top->count; k++) {
        double *x = &mesh.position[3 * (int64_t)top->node[k]];
        bool inner = x[0] > 0.005 && x[0] < 0.035 && x[1] > 0.005 && x[1] < 0.035;
        x[2] -= inner ? 0.003 : 0;
        if (inner)
            top->node[used++] = top->node[k];
    }
    top->count = used;
    sf_error err = build_block(&mesh, &plate);
    assert_int_equal(err.status, SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the missile starts inside the pad"));
    assert_non_null(strstr(err.text, "by 3 mm"));
}

/* z component of the area. */
static double lift(const sf_surface *s) {
    double sum = 0;
    for (int64_t t = 0; t < s->triangle_count; t++) {
        const double *a = &s->position[3 * (int64_t)s->triangle[3 * t]],
                     *b = &s->position[3 * (int64_t)s->triangle[3 * t + 1]],
                     *c = &s->position[3 * (int64_t)s->triangle[3 * t + 2]];
        sum += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    }
    return sum;
}

static void reverse(sf_surface *s, int64_t every) {
    for (int64_t t = 0; t < s->triangle_count; t += every) {
        int32_t swap = s->triangle[3 * t];
        s->triangle[3 * t] = s->triangle[3 * t + 1];
        s->triangle[3 * t + 1] = swap;
    }
}

/* Such a surface never touched, and the solver spoke of points that passed between its triangles. */
static void open_surfaces_are_turned_to_the_pad(void **state) {
    (void)state;
    for (int every = 1; every <= 3; every++)
        for (int shape = 0; shape < 2; shape++) {
            sf_surface s = {0};
            sf_error err = SF_ERROR_INIT;
            if (shape == 0)
                fixture_plate(0.2, 0, 0, &s);
            else
                fixture_dome(0.08, 4, 0, 0, &s);
            double before = lift(&s);
            assert_true(before < -0.01);
            reverse(&s, every);
            assert_int_equal(sf_surface_orient(&s, DOWN, &err), SF_OK);
            assert_true(fabs(lift(&s) / before - 1) < 1e-12);
            sf_surface_free(&s);
        }
}

/* A surface that its own cells turn away from the pad. */
static void solid_surface_turned_away_is_refused(void **state) {
    (void)state;
    sf_surface s = {0};
    sf_error err = SF_ERROR_INIT;
    fixture_plate(0.2, 0, 0, &s);
    reverse(&s, 1);
    s.solid = calloc(2, 1);
    assert_non_null(s.solid);
    s.solid[0] = s.solid[1] = 1;
    assert_int_equal(sf_surface_orient(&s, DOWN, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "no part of the missile's surface faces along its motion"));
    assert_true(lift(&s) > 0); /* it stays as it is */
    sf_surface_free(&s);
}

/* A band of `count` quadrangles with half a turn or none. */
static void make_band(int count, bool twist, sf_surface *s) {
    const double radius = 0.05, half = 0.02;
    *s = (sf_surface){.node_count = 2 * count, .triangle_count = 2 * count};
    s->position = calloc((size_t)(6 * count), sizeof *s->position);
    s->triangle = calloc((size_t)(6 * count), sizeof *s->triangle);
    assert_non_null(s->position);
    assert_non_null(s->triangle);
    for (int k = 0; k < count; k++) {
        double turn = 2 * acos(-1) * k / count, tilt = twist ? turn / 2 : 0.3;
        for (int side = 0; side < 2; side++) {
            double *x = &s->position[3 * (2 * k + side)], r = radius + (side ? half : -half) * cos(tilt);
            x[0] = r * cos(turn);
            x[1] = r * sin(turn);
            x[2] = 0.3 + (side ? half : -half) * sin(tilt);
        }
        bool last = k == count - 1;
        int32_t a = 2 * k, b = 2 * k + 1, next = last ? 0 : 2 * k + 2;
        int32_t c = next + (last && twist ? 1 : 0), d = next + (last && twist ? 0 : 1);
        const int32_t pair[6] = {a, b, d, a, d, c};
        memcpy(&s->triangle[6 * k], pair, sizeof pair);
    }
}

static void one_sided_surface_is_refused(void **state) {
    (void)state;
    for (int twist = 0; twist < 2; twist++) {
        sf_surface s;
        sf_error err = SF_ERROR_INIT;
        make_band(12, twist, &s);
        assert_int_equal(sf_surface_orient(&s, DOWN, &err), twist ? SF_ERR_INPUT : SF_OK);
        if (twist)
            assert_non_null(strstr(err.text, "one-sided"));
        else
            assert_true(lift(&s) < 0);
        sf_surface_free(&s);
    }
}

/* Through gmsh: a sheet without cells, drawn clockwise and counter-clockwise. */
static void sheet_drawn_either_way_is_one_model(void **state) {
    const program_place *p = *state;
    double a_max[2];
    for (int k = 0; k < 2; k++) {
        char text[512];
        snprintf(
            text, sizeof text,
            "Point(1) = {-60, -60, 80}; Point(2) = {60, -60, 80}; Point(3) = {60, 60, 80}; Point(4) = {-60, "
            "60, 80};\nFor i In {1:4}\nLine(i) = {i, (i %% 4) + 1};\nEndFor\nCurve Loop(1) = {%s};\n"
            "Plane Surface(1) = {1};\nPhysical Surface(\"missile_surface\") = {1};\nMesh.MeshSizeMax = 40;\n",
            k ? "-4, -3, -2, -1" : "1, 2, 3, 4");
        program_write_text(p, "sheet.geo", text);
        program_succeed(p, "pre",
                        "'%s' -o sheet%d.h5 %s --set geometry.missile_file=$PWD/sheet.geo --set "
                        "geometry.missile_parameters='{}' --set solver.end_time='2 ms'",
                        fixture_source(EXAMPLE), k, program_coarse(25));
        program_result solved = program_succeed(p, "solve", "sheet%d.h5 -o sheet%d-r.h5", k, k);
        assert_null(strstr(solved.err, "passed between"));
        program_succeed(p, "post", "sheet%d-r.h5 -o sheet%d", k, k);
        program_result a = program_shell(p, "grep -m1 '\"a_max_g\":' sheet%d/summary.json", k);
        assert_non_null(strchr(a.out, ':'));
        a_max[k] = atof(strchr(a.out, ':') + 1);
    }
    assert_true(a_max[0] > 5);
    assert_true(fabs(a_max[0] / a_max[1] - 1) < 0.02);
}

/* From the case to summary.json, on a whole pad. */
static void impact_point_is_reported(void **state) {
    const program_place *p = *state;
    program_result pre = program_succeed(
        p, "pre",
        "'%s' -o hit.h5 %s --set geometry.parameters.quarter=0 --set "
        "geometry.missile_parameters.quarter=0 --set 'missile.position=[\"-30 mm\", \"2 cm\"]' "
        "--set missile.gap='3 mm' --set solver.end_time='1 ms'",
        fixture_source(EXAMPLE), program_coarse(25));
    assert_non_null(strstr(pre.out, "(-30, 20) mm: there the missile's lowest point arrives"));
    program_succeed(p, "solve", "hit.h5 -o hit-r.h5");
    program_succeed(p, "post", "hit-r.h5 -o hit");
    assert_true(fabs(program_file_number(p, "hit/summary.json", "impact_x_mm") + 30) < 1e-9);
    assert_true(fabs(program_file_number(p, "hit/summary.json", "impact_y_mm") - 20) < 1e-9);
}

/* Writes two surfaces of boxes, each 60 mm wide and centred at x = 0 and x = `apart`, the second one of the
 * given width; mm. Both face outwards. */
static void write_boxes(const program_place *p, const char *name, double width, double apart) {
    static const int face[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    char text[8192];
    int used = snprintf(text, sizeof text, "solid boxes\n");
    for (int k = 0; k < 24; k++) {
        double side = k < 12 ? 60 : width, place[3] = {k < 12 ? 0 : apart, 0, 100};
        used += snprintf(text + used, sizeof text - (size_t)used, "facet normal 0 0 0\nouter loop\n");
        for (int v = 0; v < 3; v++) {
            double x[3];
            for (int c = 0; c < 3; c++)
                x[c] = place[c] + ((face[k % 12][v] >> c & 1) - 0.5) * side;
            used += snprintf(text + used, sizeof text - (size_t)used, "vertex %.3f %.3f %.3f\n", x[0], x[1],
                             x[2]);
        }
        used += snprintf(text + used, sizeof text - (size_t)used, "endloop\nendfacet\n");
    }
    snprintf(text + used, sizeof text - (size_t)used, "endsolid boxes\n");
    program_write_text(p, name, text);
}

/* Through gmsh, as CAD writes a hollow body: the volumes of both surfaces were added. */
static void facets_within_facets_are_a_cavity(void **state) {
    const program_place *p = *state;
    static const struct {
        double width, apart;
        const char *freedom, *said;
    } rows[] = {
        /* moments of 4.6 kg (60^5 - 40^5) / (60^3 - 40^3) / 6 mm2 */
        {40, 0, "free", "152 cm3, centroid (0, 0, "},
        {40, 0, "free", "principal moments 34.056, 34.056, 34.056 kg cm2"},
        {40, 0, "guided", "152 cm3, centroid (0, 0, "},
        {60, 80, "free", "432 cm3, centroid (40, 0, "},
        {60, 30, "free", "two of its closed parts overlap at "},
        {60, 0, "free", "leave"},
        {60, 30, "guided", "volume and inertia are unknown: two of its closed parts overlap"},
    };
    program_write_text(p, "boxes.geo",
                       "Merge \"boxes.stl\";\ns() = Surface{:};\n"
                       "Physical Surface(\"missile_surface\") = s();\n");
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        write_boxes(p, "boxes.stl", rows[k].width, rows[k].apart);
        program_result r = program_run(
            p, "pre",
            "'%s' -o boxes.h5 --force %s --set geometry.missile_file=$PWD/boxes.geo --set "
            "geometry.missile_parameters='{}' --set geometry.parameters.quarter=0 --set missile.freedom=%s",
            fixture_source(EXAMPLE), program_coarse(25), rows[k].freedom);
        if (!strstr(r.out, rows[k].said) && !strstr(r.err, rows[k].said))
            fail_msg("%zu: \"%s\" is missing in: %s%s", k, rows[k].said, r.out, r.err);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exchanged_groups_are_refused),
        cmocka_unit_test(pad_upside_down_is_refused),
        cmocka_unit_test(what_faces_away_may_be_in_the_group),
        cmocka_unit_test(missile_inside_the_pad_is_refused),
        cmocka_unit_test(open_surfaces_are_turned_to_the_pad),
        cmocka_unit_test(solid_surface_turned_away_is_refused),
        cmocka_unit_test(one_sided_surface_is_refused),
        cmocka_unit_test(sheet_drawn_either_way_is_one_model),
        cmocka_unit_test(impact_point_is_reported),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(facets_within_facets_are_a_cavity),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_folder, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
