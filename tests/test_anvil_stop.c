/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A missile that reaches the anvil ends the run, by whole programs: through a hole of 120 mm in a pad of 20
 * mm it fell as far as the end time, and the report said 4.46 g. */
#include "check.h"
#include "program_fixture.h"
#include "run_fixture.h"

#include "base/units.h"
#include "io/h5_data.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double SPEED = 4.5;

/* A quarter of a pad of 200 mm, 20 mm thick, in millimetres. */
static const char cored[] =
    "DefineConstant[ hole = {120}, clamped = {0} ];\nSetFactory(\"OpenCASCADE\");\n"
    "Box(1) = {0, 0, 0, 100, 100, 20};\nCylinder(2) = {0, 0, -1, 0, 0, 22, hole / 2};\n"
    "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
    "base() = Surface In BoundingBox{-1, -1, -0.1, 101, 101, 0.1};\n"
    "top() = Surface In BoundingBox{-1, -1, 19.9, 101, 101, 20.1};\n"
    "sides() = Surface In BoundingBox{99.9, -1, -1, 100.1, 101, 21};\n"
    "symmetry_x() = Surface In BoundingBox{-0.1, -1, -1, 0.1, 101, 21};\n"
    "symmetry_y() = Surface In BoundingBox{-1, -0.1, -1, 101, 0.1, 21};\n"
    "Physical Volume(\"pad\") = {3};\nPhysical Surface(\"base\") = base();\nPhysical Surface(\"top\") = top();\n"
    "Physical Surface(\"symmetry_x\") = symmetry_x();\nPhysical Surface(\"symmetry_y\") = symmetry_y();\n"
    "Physical Surface(\"sides\") = sides();\n"
    "Mesh.MeshSizeMin = 10;\nMesh.MeshSizeMax = 10;\nMesh.Algorithm3D = 1;\n";

static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    program_result made =
        program_shell(p, "cp -r \"$SF_SOURCE_DIR/geo\" \"$SF_SOURCE_DIR/examples/materials\" .");
    assert_int_equal(made.code, 0);
    program_write_text(p, "cored.geo", cored);
    program_write_text(
        p, "case.cfg",
        "geometry: { file = \"cored.geo\"; length_unit = \"mm\"; missile_file = \"geo/hemisphere.geo\";\n"
        "  missile_parameters = { diameter = 240.0; element_size = 10.0; quarter = 1; }; };\n"
        "material: {\n@include \"materials/eva35.cfg\"\n};\n"
        "pad: { mesh_error_limit = 100.0; };\n"
        "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\nsolver: { end_time = \"40 ms\"; };\n");
    return 0;
}

typedef struct drop {
    program_result solve;
    double depth, time, velocity; /* m, s, m/s: the last row */
} drop;

static double last_of(const program_place *p, const char *name) {
    sf_error err = SF_ERROR_INIT;
    int64_t rows = -1;
    double *column = NULL, last;
    sf_h5 *file = program_open_h5(p, "r.h5");
    assert_int_equal(sf_h5_read(file, name, SF_H5_F64, 1, &rows, (void **)&column, &err), SF_OK);
    last = column[rows - 1];
    free(column);
    sf_h5_close(&file, &err);
    return last;
}

static drop run(const program_place *p, const char *options) {
    program_succeed(p, "pre", "case.cfg -o m.h5 --force %s", options);
    drop d = {.solve = program_run(p, "solve", "m.h5 -o r.h5 --force --threads 1")};
    d.depth = last_of(p, "/history/indentation");
    d.time = last_of(p, "/history/time");
    d.velocity = last_of(p, "/history/velocity");
    return d;
}

static void assert_stopped(const program_place *p, const drop *d) {
    char sentence[96];
    snprintf(sentence, sizeof sentence, "the missile reached the anvil at t = %.6g ms", 1e3 * d->time);
    assert_int_equal(d->solve.code, 5);
    assert_non_null(strstr(d->solve.err, sentence));
    assert_true(d->depth >= 0.02 * (1 - 1e-12) && d->depth < 0.02 + 2.5e-4); /* within a step */
    program_result post = program_run(p, "post", "r.h5 -o out --force --strict");
    assert_int_equal(post.code, 9);
    assert_non_null(strstr(post.out, "Verdict: do not use"));
    assert_non_null(strstr(post.out, sentence));
    program_bytes summary = program_read_file(program_path(p, "out/summary.json"));
    assert_non_null(strstr(summary.data, sentence));
    assert_non_null(strstr(summary.data, "\"grade\": \"do not use\""));
    free(summary.data);
}

/* A sphere of 240 mm touches the rim of a hole of 120 mm when it is 16 mm below the top, 4 mm above the
 * anvil. */
static void through_a_hole_it_ends_on_the_anvil(void **state) {
    const program_place *p = *state;
    const char *const rows[] = {"", "--set missile.shape=surface", "--set pad.base=resting",
                                "--set pad.base=smooth --set missile.gap='2 mm'"};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        drop d = run(p, rows[k]);
        assert_stopped(p, &d);
        assert_true(d.velocity > 3 && d.velocity < SPEED + 0.1);
    }
}

static double fall_time(double way) {
    const double g = SF_STANDARD_GRAVITY;
    return (sqrt(SPEED * SPEED + 2 * g * way) - SPEED) / g;
}

/* One of 160 mm would be 27 mm deep when it touches the rim: it meets the anvil before, and starts at the
 * height of the pad's top. */
static void a_missile_that_meets_the_anvil_first_ends_there(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *options;
        double gap;
    } rows[] = {{"", 0},
                {"--set missile.shape=surface --set pad.base=resting", 0},
                {"--set missile.gap='20 mm'", 0.02}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        char options[160];
        snprintf(options, sizeof options, "--set geometry.missile_parameters.diameter=160.0 %s",
                 rows[k].options);
        drop d = run(p, options);
        assert_stopped(p, &d);
        const double g = SF_STANDARD_GRAVITY, fall = fall_time(0.02);
        double flight = (SPEED - sqrt(SPEED * SPEED - 2 * g * rows[k].gap)) / g; /* to the top, at SPEED */
        assert_close(d.time, flight + fall, 4e-5);                               /* a step */
        assert_close(d.velocity, SPEED + g * fall, 1e-3);                        /* it touches nothing else */
    }
}

/* Rim and anvil at nearly the same time: a start at the touch would be a run of two rows, and no report. */
static void a_touch_just_above_the_anvil_has_a_report(void **state) {
    const program_place *p = *state;
    /* the sagitta of the hole is 20 mm at R = (60^2 + 20^2) / 40 = 100 mm */
    drop d = run(p, "--set geometry.missile_parameters.diameter=200.2");
    assert_stopped(p, &d);
    assert_close(d.time, fall_time(0.02), 4e-5); /* a step */
}

/* No key places it below the anvil. */
static void a_start_below_the_anvil_is_refused(void **state) {
    const program_place *p = *state;
    program_result pre = program_run(p, "pre",
                                     "case.cfg -o m.h5 --force --set missile.gap='-30 mm' --set "
                                     "geometry.missile_parameters.diameter=160.0");
    assert_int_equal(pre.code, 2);
    assert_non_null(strstr(pre.err, "missile.gap"));
}

static void a_resumed_run_ends_there_again(void **state) {
    const program_place *p = *state;
    drop d = run(p, "");
    program_result again = program_run(p, "solve", "--restart r.h5 --end-time '50 ms' --threads 1");
    assert_int_equal(again.code, 5);
    assert_non_null(strstr(again.err, "the missile reached the anvil"));
    assert_true(last_of(p, "/history/time") == d.time);
}

/* A resting pad in two parts, on other numbers of threads. */
static void a_resting_pad_resumes_with_the_same_bits(void **state) {
    const program_place *p = *state;
    program_succeed(p, "pre",
                    "case.cfg -o m.h5 --force --set pad.base=resting --set geometry.parameters.hole=40 "
                    "--set missile.velocity='2 m/s' --set output.frame_interval='1 ms'");
    program_succeed(p, "solve", "m.h5 -o full.h5 --force --threads 1 --end-time '4 ms'");
    program_succeed(p, "solve", "m.h5 -o parts.h5 --force --threads 2 --end-time '1.7 ms'");
    program_succeed(p, "solve", "--restart parts.h5 --threads 1 --end-time '4 ms'");
    run_assert_same(p, "full.h5", "parts.h5");
}

/* Held at its sides alone the pad has nothing below it. */
static void a_pad_that_hangs_has_no_anvil(void **state) {
    const program_place *p = *state;
    drop d = run(p, "--set pad.fixed='[\"sides\"]' --set solver.end_time='10 ms'");
    assert_int_equal(d.solve.code, 0);
    assert_true(d.depth > 0.021);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_missile_that_meets_the_anvil_first_ends_there),
        cmocka_unit_test(a_touch_just_above_the_anvil_has_a_report),
        cmocka_unit_test(a_start_below_the_anvil_is_refused),
        cmocka_unit_test(a_resumed_run_ends_there_again),
        cmocka_unit_test(a_resting_pad_resumes_with_the_same_bits),
        cmocka_unit_test(a_pad_that_hangs_has_no_anvil),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(through_a_hole_it_ends_on_the_anvil),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
