/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile meets every free face of the pad, whether pad.contact names it or not: a pad whose group is a
 * part of its top against one whose group is the whole top, and a blow near an edge, where the side folds up
 * into the missile. By whole programs. */
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "extreme.h"
#include "post/results/results.h"
#include "post_check.h"

/* A block of 120 x 120 x 50 mm of cells of 12 mm, of two halves; the group "top" is the top of the left half,
 * or of both with `whole`. */
static const char BLOCK[] =
    "DefineConstant[ whole = 0 ];\n"
    "For k In {0:2}\n  Point(k+1) = {60*k-60,-60,0};\nEndFor\n"
    "Line(1) = {1,2}; Line(2) = {2,3}; Transfinite Curve {1,2} = 6;\n"
    "Extrude {0,120,0} { Line{1,2}; Layers{10}; Recombine; }\n"
    "Extrude {0,0,50} { Surface{:}; Layers{4}; Recombine; }\n"
    "Physical Volume(\"pad\") = Volume{:};\n"
    "Physical Surface(\"base\") = Surface In BoundingBox{-61,-61,-0.1,61,61,0.1};\n"
    "Physical Surface(\"top\") = Surface In BoundingBox{-61,-61,49.9,60*whole+1,61,50.1};\n";

static const char CASE[] =
    "geometry: { file = \"block.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
    "  missile_parameters = { diameter = 160.0; element_size = 10.0; quarter = 0; }; };\n"
    "material: {\n@include \"materials/eva35.cfg\"\n};\n"
    "missile: { mass = \"4.6 kg\"; velocity = \"3 m/s\"; };\n"
    "pad: { mesh_error_limit = 10.0; };\n"
    "solver: { end_time = \"26 ms\"; };\n"
    "output: { frame_interval = \"2 ms\"; };\n";

/* Depth (m) of the pad's deepest node inside the missile, which is a sphere, over all frames. */
static double deepest_inside(const program_place *p) {
    sf_results r;
    sf_frame frame;
    sf_error err = SF_ERROR_INIT;
    double deepest = 0;
    assert_int_equal(sf_results_open(program_path(p, "r.h5"), &r, &err), SF_OK);
    assert_true(r.frame_count > 10 && r.sphere_radius > 0);
    for (int64_t k = 0; k < r.frame_count; k++) {
        assert_int_equal(sf_frame_read(&r, &r.frames[k], &frame, &err), SF_OK);
        for (int64_t i = 0; i < r.node_count; i++) {
            double arm[3];
            for (int c = 0; c < 3; c++)
                arm[c] = r.position[3 * i + c] + frame.field[SF_FRAME_DISPLACEMENT][3 * i + c] -
                         r.sphere_centre[c] - r.frames[k].missile_displacement[c];
            deepest = larger(deepest, r.sphere_radius - sqrt(sf_dot3(arm, arm)));
        }
        sf_frame_free(&frame);
    }
    sf_results_close(&r);
    return deepest;
}

/* a_max (g) of a drop; the missile has no node of the pad inside. */
static double drop(const program_place *p, const char *overrides) {
    program_succeed(p, "pre", "case.cfg -o m.h5 --force %s", overrides);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_succeed(p, "post", "r.h5 -o out --force");
    double a_max = program_file_number(p, "out/summary.json", "a_max_g"), inside = deepest_inside(p);
    print_message("a_max %.3f g, foam %.2g mm inside the missile: %s\n", a_max, 1e3 * inside, overrides);
    assert_true(inside < 0.01 * 12e-3);
    return a_max;
}

static void the_missile_touches_faces_that_are_not_named(void **state) {
    const program_place *p = *state;
    program_write_text(p, "block.geo", BLOCK);
    program_write_text(p, "case.cfg", CASE);
    double part = drop(p, "--set geometry.parameters.whole=0"),
           whole = drop(p, "--set geometry.parameters.whole=1");
    assert_relative(part, whole, 1e-12);
    drop(p, "--set geometry.parameters.whole=1 --set missile.position='[\"58 mm\",\"0 mm\"]'");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_missile_touches_faces_that_are_not_named),
    };
    return cmocka_run_group_tests(tests, program_group_example, program_group_tear_down);
}
