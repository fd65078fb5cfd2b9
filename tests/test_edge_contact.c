/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sharp missiles press the faces of the pad between its nodes: a wedge, a bar and a cube on its corner, askew
 * to a coarse mesh. By whole programs. */
#include "check.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>

#include "post_check.h"

static const double SPACING = 12; /* mm, of the pad's nodes */

static const char BLOCK[] = "Point(1) = {-60,-60,0};\nExtrude {120,0,0} { Point{1}; Layers{10}; }\n"
                            "Extrude {0,120,0} { Line{1}; Layers{10}; Recombine; }\n"
                            "s[] = Surface{:};\nExtrude {0,0,50} { Surface{s[]}; Layers{4}; Recombine; }\n"
                            "Physical Volume(\"pad\") = Volume{:};\n"
                            "Physical Surface(\"base\") = Surface In BoundingBox{-61,-61,-0.1,61,61,0.1};\n"
                            "Physical Surface(\"top\") = Surface In BoundingBox{-61,-61,49.9,61,61,50.1};\n";

static const char CASE[] =
    "geometry: { file = \"block.geo\"; missile_file = \"sharp.geo\"; length_unit = \"mm\"; };\n"
    "material: {\n@include \"materials/eva35.cfg\"\n};\n"
    "missile: { mass = \"1 kg\"; velocity = \"3 m/s\"; shape = \"surface\"; };\n"
    "pad: { mesh_error_limit = 10.0; };\n"
    "solver: { end_time = \"30 ms\"; };\n"
    "output: { frame_interval = \"2 ms\"; };\n";

/* The missiles; each is turned about z by 17 degrees, so that its edges follow no line of the mesh. */
#define SHARP(solid, size)                                                                                        \
    "SetFactory(\"OpenCASCADE\");\n" solid "Rotate {{0,0,1}, {0,0,0}, 17*Pi/180} { Volume{:}; }\n"                \
    "Physical Volume(\"missile\") = Volume{:}; Physical Surface(\"missile_surface\") = Boundary{ Volume{:}; };\n" \
    "Mesh.MeshSizeMin = " size "; Mesh.MeshSizeMax = " size ";\n"

static const char WEDGE[] =
    SHARP("Box(1) = {-30,0,0, 60,60,60}; Rotate {{1,0,0}, {0,0,0}, Pi/4} { Volume{:}; }\n", "30");
static const char BAR[] = SHARP("Box(1) = {-9,-45,0, 18,90,40};\n", "25");
static const char CUBE[] =
    SHARP("Box(1) = {0,0,0, 60,60,60}; Rotate {{0,0,1}, {0,0,0}, Pi/4} { Volume{:}; }\n"
          "Rotate {{1,0,0}, {0,0,0}, Atan(Sqrt(2))} { Volume{:}; }\n",
          "60");

typedef struct figures {
    double depth, energy, momentum, angular, friction; /* mm, -, -, -, J */
} figures;

static figures drop(const program_place *p, const char *geo, const char *words) {
    program_write_text(p, "sharp.geo", geo);
    program_succeed(p, "pre", "case.cfg -o m.h5 --force %s", words);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force -t 1");
    program_succeed(p, "post", "r.h5 -o out --force");
    double cut = program_file_number(p, "out/summary.json", "rim_depth_mm"),
           deep = program_history_largest(p, "penetration_mm");
    figures f = {cut > deep ? cut : deep, program_history_largest(p, "energy_error_1"),
                 program_history_largest(p, "momentum_error_space_1"),
                 program_history_largest(p, "angular_momentum_error_1"),
                 program_history_largest(p, "energy_friction_J")};
    print_message(
        "depth %.4f mm at the peak, %.4f mm at most; indentation %.1f mm, energy error %.1e, momenta %.1e and "
        "%.1e, friction %.3f J: %s\n",
        cut, deep, program_file_number(p, "out/summary.json", "max_indentation_mm"), f.energy, f.momentum,
        f.angular, f.friction, words);
    return f;
}

static void check(figures f) {
    assert_true(f.depth < 0.01 * SPACING);
    assert_true(f.energy < 2e-3);
    assert_true(f.momentum < 1e-12 && f.angular < 1e-12);
}

static void press(const program_place *p, const char *shape, bool rough) {
    figures f;
    program_write_text(p, "block.geo", BLOCK);
    program_write_text(p, "case.cfg", CASE);
    check(f = drop(p, shape, rough ? "--set missile.freedom='\"free\"' --set missile.friction=0.4" : ""));
    assert_true(f.friction > 0 || !rough);
}

static void a_rough_bar_presses_the_faces_between_nodes(void **state) {
    press(*state, BAR, true);
}

static void sharp_missiles_press_the_faces_between_nodes(void **state) {
    press(*state, WEDGE, false);
    press(*state, WEDGE, true);
    press(*state, BAR, false);
    press(*state, CUBE, false);
    press(*state, CUBE, true);
}

/* A run in two parts on two threads has the bits of one on one thread. */
static void threads_and_a_restart_change_no_bit(void **state) {
    const program_place *p = *state;
    program_write_text(p, "block.geo", BLOCK);
    program_write_text(p, "case.cfg", CASE);
    program_write_text(p, "sharp.geo", BAR);
    program_succeed(p, "pre", "case.cfg -o m.h5 --force --set missile.friction=0.4");
    program_succeed(p, "solve", "m.h5 -o one.h5 --force -t 1 --end-time '12 ms'");
    program_succeed(p, "solve", "m.h5 -o two.h5 --force -t 2 --end-time '5 ms'");
    program_succeed(p, "solve", "m.h5 --restart two.h5 -t 2 --end-time '12 ms'");
    program_succeed(p, "post", "one.h5 -o one --force");
    program_succeed(p, "post", "two.h5 -o two --force");
    assert_int_equal(program_shell(p, "cmp one/history.csv two/history.csv").code, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rough_bar_presses_the_faces_between_nodes),
        cmocka_unit_test(threads_and_a_restart_change_no_bit),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(sharp_missiles_press_the_faces_between_nodes),
    };
    return check_slow() ? cmocka_run_group_tests(slow, program_group_example, program_group_tear_down)
                        : cmocka_run_group_tests(tests, program_group_example, program_group_tear_down);
}
