/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a geometry lies does not change a drop: a pad on a wall with pad.up, gravity across the blow, and a
 * STEP file in another unit. */
#include "check.h"
#include "program_fixture.h"

#include "base/mat3.h"
#include "base/units.h"
#include "pre/mesher/work.h"
#include "post/figures/figures.h"
#include <gmshc.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const char TURN[] = "Rotate {{0, 1, 0}, {0, 0, 0}, -Pi/2} { Volume{:}; }\n";
#define UPRIGHT                                                                                              \
    " --set geometry.file='\"wall.geo\"' --set geometry.missile_file='\"blow.geo\"'"                         \
    " --set 'pad.up=[-1.0, 0.0, 0.0]' --set 'missile.direction=[1.0, 0.0, 0.0]'"
#define FREE                                                                                                 \
    " --set geometry.parameters.quarter=0 --set geometry.missile_parameters.quarter=0"                       \
    " --set geometry.parameters.zone_side=160.0 --set geometry.parameters.side=240.0 --set missile.freedom=free"

static int set_up(void **state) {
    program_group_case(state);
    char text[256];
    const program_place *p = *state;
    snprintf(text, sizeof text, "Include \"geo/pad.geo\";\n%s", TURN);
    program_write_text(p, "wall.geo", text);
    snprintf(text, sizeof text, "Include \"geo/hemisphere.geo\";\n%s", TURN);
    program_write_text(p, "blow.geo", text);
    return 0;
}

static void run(const program_place *p, const char *way, sf_results *results, sf_figures *figures) {
    sf_error err = SF_ERROR_INIT;
    program_succeed(p, "pre", "good.cfg -o m.h5 --force %s%s", program_coarse(25), way);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force");
    if (sf_results_open(program_path(p, "r.h5"), results, &err) != SF_OK ||
        sf_figures_compute(results, 1000, figures, &err) != SF_OK)
        fail_msg("%s", err.text);
}

static double peak_of(const program_place *p, const char *way) {
    sf_results results;
    sf_figures figures;
    run(p, way, &results, &figures);
    double peak = figures.injury.a_max_g;
    assert_true(figures.rebounded && figures.energy_error < 1e-3);
    sf_figures_free(&figures);
    sf_results_close(&results);
    return peak;
}

/* Gravity across the blow does nothing to a guided missile. */
static void a_wall_is_a_pad_that_lies(void **state) {
    double weightless = peak_of(*state, " --set missile.gravity='\"0 m/s2\"'");
    assert_relative(peak_of(*state, UPRIGHT), weightless, 1e-3);
    assert_relative(peak_of(*state, " --set 'missile.gravity_direction=[1.0, 0.0, 0.0]'"), weightless, 1e-12);
    assert_true(peak_of(*state, "") > 1.02 * weightless);
}

/* A free missile falls along the wall while it meets it: in the model's axes along -x. */
static void gravity_across_the_blow_moves_a_free_missile(void **state) {
    double peak[2];
    for (int upright = 0; upright < 2; upright++) {
        sf_results r;
        sf_figures f;
        run(*state, upright ? FREE UPRIGHT : FREE " --set 'missile.gravity_direction=[-1.0, 0.0, 0.0]'", &r,
            &f);
        assert_close(r.gravity[0], -SF_STANDARD_GRAVITY, 1e-12);
        assert_close(r.gravity_along, 0, 1e-12);
        assert_true(f.rebounded && f.energy_error < 1e-3);
        peak[upright] = f.injury.a_max_g;
        sf_figures_free(&f);
        sf_results_close(&r);
    }
    assert_relative(peak[1], peak[0], 1e-3);
}

static void faces_and_directions_are_checked(void **state) {
    static const struct {
        const char *options, *sentence;
    } cases[] = {
        {"--set 'missile.direction=[1.0, 0.0, 0.0]'",
         "does not point to the pad, whose face looks along [0, 0, 1]"},
        {"--set 'missile.direction=[1.0, 0.0, -0.01]'",
         "from the normal of the pad's face (pad.up) and grazes it"},
        {"--set 'pad.up=[0.0, 0.0, 0.0]'", "must have a length"},
        {"--set 'missile.gravity_direction=[0.0, 0.0, 0.0]'", "must have a length"},
        {"--set 'pad.up=[1.0, 0.0, 0.0]'", "does not point to the pad, whose face looks along [1, 0, 0]"},
        {"--set 'pad.up=[-1.0, 0.0, 0.0]' --set 'missile.direction=[1.0, 0.0, 0.0]' --set pad.base=resting",
         "a resting pad lies on the ground"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        program_result r = program_run(*state, "pre", "good.cfg -o bad.h5 %s", cases[k].options);
        if (r.code == 0 || !strstr(r.err, cases[k].sentence))
            fail_msg("%s: %s", cases[k].options, r.err);
    }
}

static void rotations_take_the_face_upwards(void **state) {
    (void)state;
    static const double up[4][3] = {{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {0.36, 0.48, -0.8}};
    for (int k = 0; k < 4; k++) {
        double turn[9], v[3], s[6] = {1, 2, 4, 0.1, 0.2, 0.3};
        const double trace = s[0] + s[1] + s[2];
        sf_turn_to_z(up[k], turn);
        memcpy(v, up[k], sizeof v);
        sf_mat3_apply(turn, v);
        assert_close(v[0], 0, 1e-15);
        assert_close(v[1], 0, 1e-15);
        assert_close(v[2], 1, 1e-15);
        assert_close(sf_triple3(turn, turn + 3, turn + 6), 1, 1e-15);
        double along[3] = {0, 0, 0}, norm = sf_sym3_largest(s);
        const int place[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                along[i] += s[place[3 * i + j]] * up[k][j];
        double expected = sf_dot3(along, up[k]); /* up . s up stands at zz afterwards */
        sf_sym3_turn(turn, s);
        assert_close(s[2], expected, 1e-14);
        assert_close(s[0] + s[1] + s[2], trace, 1e-14);
        assert_close(sf_sym3_largest(s), norm, 1e-13);
    }
}

/* A STEP file knows its unit; the case says in which one its numbers are wanted. */
static void step_files_come_in_the_unit_of_the_case(void **state) {
    const program_place *p = *state;
    int error = 0;
    assert_int_equal(sf_work_begin(), 0);
    gmshOptionSetNumber("General.Terminal", 0, &error);
    gmshModelOccAddBox(-100, -100, 0, 200, 200, 50, -1, &error);
    gmshModelOccSynchronize(&error);
    gmshWrite(program_path(p, "box.step"), &error);
    gmshFinalize(&error);
    assert_int_equal(error, 0);
    program_write_text(
        p, "box.geo",
        "Merge \"box.step\";\n"
        "b() = BoundingBox Volume{1}; d = (b(5) - b(2)) / 1000;\n"
        "Physical Volume(\"pad\") = {1};\n"
        "Physical Surface(\"base\") = Surface In BoundingBox{b(0) - d, b(1) - d, b(2) - d, b(3) + d, "
        "b(4) + d, b(2) + d};\n"
        "Physical Surface(\"top\") = Surface In BoundingBox{b(0) - d, b(1) - d, b(5) - d, b(3) + d, "
        "b(4) + d, b(5) + d};\n"
        "Mesh.CharacteristicLengthMin = (b(5) - b(2)) / 3;\n"
        "Mesh.CharacteristicLengthMax = (b(5) - b(2)) / 3;\n");
    static const struct {
        const char *unit, *diameter, *size;
    } units[] = {{"mm", "160.0", "20.0"}, {"m", "0.16", "0.02"}, {"cm", "16.0", "2.0"}};
    for (size_t k = 0; k < sizeof units / sizeof *units; k++) {
        char text[1024];
        snprintf(
            text, sizeof text,
            "geometry: { file = \"box.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"%s\";\n"
            "  missile_parameters = { diameter = %s; element_size = %s; quarter = 0; }; };\n"
            "pad: { mesh_error_limit = 1.0; };\n"
            "material: {\n@include \"materials/eva35_first.cfg\"\n};\n"
            "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\n"
            "solver: { end_time = \"40 ms\"; };\n",
            units[k].unit, units[k].diameter, units[k].size);
        program_write_text(p, "step.cfg", text);
        program_shell(p, "cp \"$SF_SOURCE_DIR/tests/materials/\"* materials/");
        program_result r = program_run(p, "pre", "step.cfg -o step.h5 --force");
        if (r.code != 0 || !strstr(r.out, "pad 200 x 200 x 50 mm"))
            fail_msg("%s: %s%s", units[k].unit, r.err, r.out);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gravity_across_the_blow_moves_a_free_missile),
        cmocka_unit_test(faces_and_directions_are_checked),
        cmocka_unit_test(rotations_take_the_face_upwards),
        cmocka_unit_test(step_files_come_in_the_unit_of_the_case),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_wall_is_a_pad_that_lies),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
