/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pads that cannot be meant, by whole programs: each once gave a plausible a_max without a word. Coarse
 * blocks of 200 mm under the hemisphere. */
#include "program_fixture.h"

#include "model_fixture.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const char GEOMETRY[] =
    "SetFactory(\"OpenCASCADE\");\n"
    "DefineConstant[ kind = 0, size = 20 ];\n"
    "b = 100;\n"
    "If (kind <= 2 || kind == 6)\n" /* whole, slit, cored, cavity */
    "  Box(1) = {-b, -b, 0, 2*b, 2*b, 50};\n"
    "  If (kind == 1) Box(2) = {-60, -2, 10, 120, 4, 50}; EndIf\n"
    "  If (kind == 2) Cylinder(2) = {20, 0, -1, 0, 0, 60, 12}; EndIf\n"
    "  If (kind == 6) Sphere(2) = {0, 0, 25, 15}; EndIf\n"
    "  If (kind > 0) BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; } EndIf\n"
    "ElseIf (kind == 3)\n" /* 0.5 mm apart */
    "  Box(1) = {-b, -b, 0, 2*b, 2*b, 24.5};\n"
    "  Box(2) = {-b, -b, 25, 2*b, 2*b, 25};\n"
    "ElseIf (kind == 4)\n" /* overlapping */
    "  Box(1) = {-b, -b, 0, 2*b, 2*b, 33};\n"
    "  Box(2) = {-b, -b, 20, 2*b, 2*b, 30};\n"
    "ElseIf (kind == 5)\n" /* fused */
    "  Box(1) = {-b, -b, 0, 2*b, 2*b, 25};\n"
    "  Box(2) = {-b, -b, 25, 2*b, 2*b, 25};\n"
    "  BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n"
    "ElseIf (kind == 7)\n" /* meshes that do not coincide; 1 um lest nodes do */
    "  Box(1) = {-b, -b, 0, 2*b, 2*b, 25};\n"
    "  Box(2) = {-b + 7, -b + 7, 25, 2*b - 14, 2*b - 14, 25};\n"
    "EndIf\n"
    "tol = 1e-3;\n"
    "base() = Surface In BoundingBox{-2*b, -2*b, -tol, 2*b, 2*b, tol};\n"
    "top() = Surface In BoundingBox{-2*b, -2*b, 50 - tol, 2*b, 2*b, 50 + tol};\n"
    "front() = Surface In BoundingBox{-2*b, -b - tol, -tol, 2*b, -b + tol, 50 + tol};\n"
    "Physical Surface(\"base\") = base();\n"
    "Physical Surface(\"top\") = top();\n"
    "Physical Surface(\"front\") = front();\n"
    "Physical Volume(\"pad\") = Volume{:};\n"
    "Mesh.CharacteristicLengthMax = size;\n"
    "Mesh.CharacteristicLengthMin = size;\n"
    "Mesh.Algorithm3D = 1;\n";

static const char CASE[] =
    "geometry: { file = \"blocks.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
    "  parameters = { kind = 0; size = 20.0; };\n"
    "  missile_parameters = { diameter = 160.0; element_size = 20.0; quarter = 0; }; };\n"
    "pad: { mesh_error_limit = 1.0; };\n"
    "material: {\n@include \"materials/eva35.cfg\"\n};\n"
    "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\n"
    "solver: { end_time = \"40 ms\"; };\n"
    "output: { frame_interval = \"20 ms\"; };\n";

static int set_up(void **state) {
    program_group_folder(state);
    program_write_text(*state, "blocks.geo", GEOMETRY);
    program_write_text(*state, "blocks.cfg", CASE);
    return program_shell(*state, "cp -r '%s' '%s' .", fixture_source("geo"),
                         fixture_source("examples/materials"))
        .code;
}

/* With further words of the command line. */
static void assert_refused(const program_place *p, const char *words, const char *const *parts) {
    program_result r = program_run(p, "pre", "blocks.cfg -o none.h5 %s", words);
    assert_int_equal(r.code, 2);
    for (; *parts; parts++)
        if (!strstr(r.err, *parts))
            fail_msg("\"%s\" is missing in: %s", *parts, r.err);
    assert_int_not_equal(program_shell(p, "ls none.h5").code, 0);
}

static void pads_in_parts_are_refused(void **state) {
    assert_refused(
        *state, "--set geometry.parameters.kind=3",
        (const char *const[]){"2 parts that share no faces", "is 0.5 mm from", "fuse the volumes", NULL});
    assert_refused(*state, "--set geometry.parameters.kind=7",
                   (const char *const[]){"2 parts that share no faces", "fuse the volumes", NULL});
}

static void overlapping_volumes_are_refused(void **state) {
    assert_refused(*state, "--set geometry.parameters.kind=4",
                   (const char *const[]){"the pad overlaps itself", "lies inside the cell at", NULL});
}

static void pads_that_are_not_held_are_refused(void **state) {
    assert_refused(*state, "--set pad.fixed='[]' --set pad.sliding='[\"front\"]'",
                   (const char *const[]){"pad.sliding", "nothing holds the pad along z", NULL});
    program_result wall =
        program_succeed(*state, "pre", "blocks.cfg -o wall.h5 --set pad.fixed='[\"front\"]'");
    assert_non_null(strstr(wall.err, "% of the nodes of the pad's underside (z = 0 mm) are held along z"));
}

static void pads_in_one_piece_are_built(void **state) {
    static const int kinds[] = {0, 1, 2, 5, 6};
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
        program_succeed(*state, "pre", "blocks.cfg -o good%d.h5 --set geometry.parameters.kind=%d", kinds[k],
                        kinds[k]);
}

static double a_max(const program_place *p, int kind) {
    program_succeed(p, "solve", "good%d.h5 -o run%d.h5", kind, kind);
    program_succeed(p, "post", "run%d.h5 -o out%d", kind, kind);
    char name[32];
    snprintf(name, sizeof name, "out%d/summary.json", kind);
    program_bytes summary = program_read_file(program_path(p, name));
    const char *at = strstr(summary.data, "\"a_max_g\":");
    assert_non_null(at);
    double value = strtod(at + strlen("\"a_max_g\":"), NULL);
    free(summary.data);
    return value;
}

/* The kernel glued the sides of a slit of 4 mm through the impact point: a_max stayed within 1 %. */
static void a_slit_makes_the_pad_softer(void **state) {
    double whole = a_max(*state, 0), slit = a_max(*state, 1);
    assert_true(whole > 60 && whole < 130);
    if (!(slit < 0.95 * whole))
        fail_msg("a_max %.2f g with a slit, %.2f g without", slit, whole);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pads_in_parts_are_refused),
        cmocka_unit_test(overlapping_volumes_are_refused),
        cmocka_unit_test(pads_that_are_not_held_are_refused),
        cmocka_unit_test(pads_in_one_piece_are_built),
        cmocka_unit_test(a_slit_makes_the_pad_softer),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
