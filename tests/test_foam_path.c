/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thickness of pads that are no flat blocks: the length of foam on the missile's path. */
#include "program_fixture.h"

#include "model/model_io.h"
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
    return program_group_example(state);
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

/* Without it a tube on a post passed as a pad of its whole height. */
static void a_motion_through_the_foam_is_refused(void **state) {
    const program_place *p = *state;
    char geo[2048];
    snprintf(geo, sizeof geo, "SetFactory(\"OpenCASCADE\");\n%s", rows[2].geo);
    program_write_text(p, "pad.geo", geo);
    program_write_text(p, "motion.csv", "time_s,displacement_mm\n0,0\n0.1,45\n");
    program_write_text(
        p, "path.cfg",
        "geometry: { file = \"pad.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
        "missile_parameters = { diameter = 100.0; element_size = 15.0; quarter = 0; }; };\n"
        "material: {\n@include \"materials/eva35.cfg\"\n};\n"
        "missile: { motion = \"motion.csv\"; };\nsolver: { end_time = \"100 ms\"; };\n");
    program_result r = program_run(p, "pre", "path.cfg -o path.h5 --force");
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "45 mm deep into a pad that is"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thickness_is_the_foam_on_the_missiles_path),
        cmocka_unit_test(a_motion_through_the_foam_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
