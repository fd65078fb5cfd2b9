/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The foam on the missile's path: the thickness of pads that are no flat blocks, parts of a missile that pass
 * between the nodes, missiles that are not symmetric about a plane of the pad. */
#include "check.h"
#include "model/model_io.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const char CASE[] =
    "geometry: { file = \"pad.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
    "missile_parameters = { diameter = 100.0; element_size = 15.0; quarter = 0; }; };\n"
    "material: {\n@include \"materials/eva35.cfg\"\n};\n"
    "pad: { mesh_error_limit = 10.0; };\n"
    "missile: { mass = \"1 kg\"; velocity = \"2 m/s\"; };\nsolver: { end_time = \"1 ms\"; };\n";

#define MESH(size)                                                                                           \
    "Mesh.MeshSizeMax = " size "; Mesh.MeshSizeMin = " size "; Physical Volume(\"pad\") = Volume{:};\n"

static const struct {
    const char *what, *geo, *more;
    double thickness, bound; /* mm */
} rows[] = {
    {"a block",
     "Box(1) = {-60, -60, 0, 120, 120, 40};\n" MESH(
         "10.0") "Physical Surface(\"base\") = {5}; Physical Surface(\"top\") = {6};\n",
     "", 40, 1e-9},
    {"a block, obliquely",
     "Box(1) = {-60, -60, 0, 120, 120, 40};\n" MESH(
         "10.0") "Physical Surface(\"base\") = {5}; Physical Surface(\"top\") = {6};\n",
     "--set 'missile.direction=[0.5, 0.0, -1.0]'", 40, 1e-6},
    {"half a tube on a post",
     "Cylinder(1) = {0, -60, 0, 0, 120, 0, 100}; Cylinder(2) = {0, -60, 0, 0, 120, 0, 60};\n"
     "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
     "Box(4) = {-101, -60, 0, 202, 120, 101}; BooleanIntersection(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };\n" MESH(
         "12.0") "in() = Surface In BoundingBox{-61, -61, -1, 61, 61, 61}; out() = Surface{:}; out() -= in();\n"
                 "out() -= Surface In BoundingBox{-101, -61, -1, 101, -59, 101}; out() -= Surface In BoundingBox{-101, 59, -1, 101, 61, 101};\n"
                 "out() -= Surface In BoundingBox{-101, -61, -1, 101, 61, 1};\n"
                 "Physical Surface(\"base\") = in(); Physical Surface(\"top\") = out();\n",
     "", 40, 1.5},
    {"a block over a cavity",
     "Box(1) = {-60, -60, 0, 120, 120, 50}; Box(2) = {-60, -50, 15, 120, 100, 20};\n"
     "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n" MESH(
         "8.0") "Physical Surface(\"base\") = Surface In BoundingBox{-61, -61, -0.1, 61, 61, 0.1};\n"
                "Physical Surface(\"top\") = Surface In BoundingBox{-61, -61, 49.9, 61, 61, 50.1};\n",
     "", 30, 1e-6},
};

static int set_up(void **state) {
    return program_group_case(state);
}

static void thickness_is_the_foam_on_the_missiles_path(void **state) {
    const program_place *p = *state;
    program_write_text(p, "path.cfg", CASE);
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        char geo[2048];
        sf_model m = {0};
        sf_error err = SF_ERROR_INIT;
        snprintf(geo, sizeof geo, "SetFactory(\"OpenCASCADE\");\n%s", rows[k].geo);
        program_write_text(p, "pad.geo", geo);
        program_succeed(p, "pre", "path.cfg -o path.h5 --force %s", rows[k].more);
        assert_int_equal(sf_model_read(program_path(p, "path.h5"), &m, NULL, &err), SF_OK);
        if (!(fabs(1e3 * m.thickness - rows[k].thickness) <= rows[k].bound))
            fail_msg("%s: %.6g mm, not %g", rows[k].what, 1e3 * m.thickness, rows[k].thickness);
        sf_model_free(&m);
    }
}

/* A tube on a post passed as a pad of its whole height, and a block was compressed beyond the limit of its
 * law until the run failed with a sentence about contact. */
static void a_motion_that_the_foam_cannot_follow_is_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        int row;
        const char *depth, *said;
    } cases[] = {{2, "45", "45 mm deep into a pad that is"},
                 {0, "38.8", "its foam cannot be compressed beyond 0.9479"},
                 {0, "37", NULL}};
    program_write_text(
        p, "path.cfg",
        "geometry: { file = \"pad.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
        "missile_parameters = { diameter = 100.0; element_size = 15.0; quarter = 0; }; };\n"
        "material: {\n@include \"materials/eva35.cfg\"\n};\n"
        "missile: { motion = \"motion.csv\"; };\nsolver: { end_time = \"100 ms\"; };\n");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char text[2048];
        snprintf(text, sizeof text, "SetFactory(\"OpenCASCADE\");\n%s", rows[cases[k].row].geo);
        program_write_text(p, "pad.geo", text);
        snprintf(text, sizeof text, "time_s,displacement_mm\n0,0\n0.1,%s\n", cases[k].depth);
        program_write_text(p, "motion.csv", text);
        program_result r = program_run(p, "pre", "path.cfg -o path.h5 --force");
        if (cases[k].said ? r.code == 0 || !strstr(r.err, cases[k].said) : r.code != 0)
            fail_msg("%s mm: %d, %s", cases[k].depth, r.code, r.err);
    }
}

static const char MISSILE[] =
    "Physical Volume(\"missile\") = v(); Physical Surface(\"missile_surface\") = Boundary{Volume{v()};};\n"
    "Mesh.MeshSizeMax = 10; Mesh.MeshSizeMin = 5;\n";

/* A plate of 80 x 80 mm with a prong below it, over a pad of `planes` symmetry planes. */
static program_result prong(const program_place *p, const char *box, bool quarter) {
    char text[2048];
    snprintf(text, sizeof text,
             "SetFactory(\"OpenCASCADE\");\nBox(1) = {-40, -40, 30, 80, 80, 20}; Box(2) = {%s, 35};\n"
             "v() = BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; };\n%s",
             box, MISSILE);
    program_write_text(p, "prong.geo", text);
    snprintf(
        text, sizeof text,
        "Point(1) = {%s, %s, 0};\na() = Extrude {%s, 0, 0} { Point{1}; Layers{%s}; };\n"
        "b() = Extrude {0, %s, 0} { Curve{a(1)}; Layers{%s}; Recombine; };\n"
        "c() = Extrude {0, 0, 50} { Surface{b(1)}; Layers{5}; Recombine; };\n"
        "Physical Volume(\"pad\") = {c(1)}; Physical Surface(\"base\") = {b(1)}; Physical Surface(\"top\") = {c(0)};\n%s",
        quarter ? "0" : "-60", quarter ? "0" : "-60", quarter ? "60" : "120", quarter ? "6" : "12",
        quarter ? "60" : "120", quarter ? "6" : "12",
        quarter ? "Physical Surface(\"symmetry_x\") = {c(5)}; Physical Surface(\"symmetry_y\") = {c(2)};\n"
                : "");
    program_write_text(p, "pad.geo", text);
    program_write_text(
        p, "prong.cfg",
        "geometry: { file = \"pad.geo\"; missile_file = \"prong.geo\"; length_unit = \"mm\"; };\n"
        "material: {\n@include \"materials/eva35.cfg\"\n};\npad: { mesh_error_limit = 10.0; };\n"
        "missile: { mass = \"1 kg\"; velocity = \"2 m/s\"; };\nsolver: { end_time = \"1 ms\"; };\n");
    return program_run(p, "pre", "prong.cfg -o prong.h5 --force");
}

static void a_missile_that_is_not_symmetric_needs_the_whole_pad(void **state) {
    program_result r = prong(*state, "5, 5, 0, 25, 25", true);
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "not symmetric about the plane \"symmetry_x\""));
    assert_int_equal(prong(*state, "5, 5, 0, 25, 25", false).code, 0);
    assert_int_equal(prong(*state, "-15, -15, 0, 30, 30", true).code, 0);
    r = prong(*state, "-15, 5, 0, 30, 25", true);
    assert_non_null(strstr(r.err, "not symmetric about the plane \"symmetry_y\""));
}

static void a_part_between_the_nodes_is_refused(void **state) {
    program_result r = prong(*state, "1.5, 1.5, 0, 7, 7", false);
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "passes between the contact nodes"));
    assert_non_null(strstr(r.err, "is 30 mm inside the foam"));
    assert_int_equal(prong(*state, "-1.5, -1.5, 0, 7, 7", false).code, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thickness_is_the_foam_on_the_missiles_path),
        cmocka_unit_test(a_missile_that_is_not_symmetric_needs_the_whole_pad),
        cmocka_unit_test(a_part_between_the_nodes_is_refused),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_motion_that_the_foam_cannot_follow_is_refused),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
