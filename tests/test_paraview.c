/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state for ParaView that softfall-post writes, pad_paraview.py: what it knows of a drop, what it shows,
 * the film, and tools/draw_pad.py, which draws with it. What needs ParaView is skipped without it. */
#include "check.h"
#include "io/replace.h"
#include "base/error.h"
#include "model_fixture.h"
#include "program_fixture.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <hdf5.h>

/* NAME.h5 into NAME_results.h5 and the folder NAME. */
static void simulate(const program_place *p, const char *name) {
    program_succeed(p, "solve", "%s.h5 -o %s_results.h5 -t 1", name, name);
    program_succeed(p, "post", "%s_results.h5 -o %s", name, name);
}

/* The coarse example with a full model, hit beside its middle; a compression test,
 * half a pad hit at its edge, and a flat missile, for a few steps. */
static int set_up(void **state) {
    program_group_example(state);
    const program_place *p = *state;
    program_succeed(
        p, "pre",
        "good.cfg -o full.h5 %s --set solver.end_time='1.5 ms' --set geometry.parameters.quarter=0 "
        "--set geometry.missile_parameters.quarter=0 --set 'missile.position=[\"40 mm\",\"-30 mm\"]'",
        program_coarse(25));
    simulate(p, "full");
    program_succeed(p, "pre",
                    "'%s' -o pressed.h5 --set geometry.parameters.spacing=25 --set 'solver.end_time=5 ms'",
                    fixture_source("examples/compression/case.cfg"));
    simulate(p, "pressed");
    /* Half a pad that is hit at an edge: the middle of the whole missile is an end of the pad along x too. */
    program_succeed(
        p, "pre",
        "good.cfg -o half.h5 %s --set solver.end_time='0.5 ms' --set 'pad.symmetry=[\"symmetry_y\"]' "
        "--set geometry.missile_parameters.quarter=0 --set 'missile.position=[\"0 mm\", \"0 mm\"]'",
        program_coarse(25));
    simulate(p, "half");
    program_succeed(
        p, "pre",
        "'%s' -o flat.h5 --set geometry.parameters.fine_spacing=20 --set geometry.parameters.outer_spacing=20 --set pad.mesh_error_limit=1 "
        "--set geometry.missile_parameters.element_size=15 --set solver.end_time='0.5 ms'",
        fixture_source("examples/flat-disc/case.cfg"));
    simulate(p, "flat");
    return 0;
}

/* Python that has the facts of out/pad_paraview.py as `d` and must not fail. */
static void assert_facts(const program_place *p, const char *folder, const char *condition) {
    program_result r = program_shell(
        p,
        "python3 -c \"import ast\n"
        "t = ast.parse(open('%s/pad_paraview.py').read())\n"
        "d = [ast.literal_eval(n.value) for n in t.body if isinstance(n, ast.Assign) and getattr(n.targets[0], 'id', '') == 'DROP'][0]\n"
        "assert %s, d\"",
        folder, condition);
    if (r.code != 0)
        fail_msg("%s: %s", folder, r.err);
}

static void the_state_knows_symmetry_missile_and_peak(void **state) {
    const program_place *p = *state;
    assert_facts(
        p, "out",
        "[m[0] for m in d['mirrors']] == ['X', 'Y'] and max(abs(m[1]) for m in d['mirrors']) < 1e-9 and "
        "max(abs(a) for a in d['axis']) < 1e-9 and abs(d['sphere'] - 0.08) < 1e-6 and d['missile'] and not "
        "d['driven'] and d['array'] == 'von_mises_Pa' and d['largest'] > 1000 and 0 < d['peak'] <= 0.0011");
    assert_facts(
        p, "full",
        "d['mirrors'] == [] and abs(d['axis'][0] - 0.04) < 0.002 and abs(d['axis'][1] + 0.03) < 0.002");
    /* A whole platen on a quarter of a specimen. */
    assert_facts(p, "pressed",
                 "d['mirrors'] == [['X', 0], ['Y', 0]] and d['sphere'] is None and d['driven'] and "
                 "'prescribed' in d['title']");
}

static void the_state_reflects_at_the_planes_of_the_model_only(void **state) {
    const program_place *p = *state;
    assert_facts(p, "half", "d['mirrors'] == [['Y', 0]] and abs(d['axis'][0]) < 1e-9 and d['axis'][1] == 0");
}

/* Of a flat missile, too, whose lowest points lie all around its axis. */
static void the_section_lies_under_the_axis(void **state) {
    const program_place *p = *state;
    assert_facts(p, "flat", "max(abs(a) for a in d['axis']) < 1e-9");
    program_result r = program_shell(
        p,
        "awk -F, '$1 == \"axis\" { n++; far += $3^2 + $4^2 > 1e-12 } END { print n, far + 0 }' flat/section.csv");
    assert_string_equal(r.out, "41 0\n");
}

static void forget_planes(const program_place *p, const char *name) {
    hid_t file = H5Fopen(program_path(p, name), H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(H5Ldelete(file, "/model/symmetry_x", H5P_DEFAULT) >= 0);
    assert_true(H5Ldelete(file, "/model/symmetry_y", H5P_DEFAULT) >= 0);
    H5Fclose(file);
    assert_int_equal(sf_seal_add(program_path(p, name), SF_IGNORED), SF_OK);
}

/* Results of earlier versions do not name the planes: what cannot be told is not guessed. */
static void a_plane_that_cannot_be_told_is_no_mirror(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "half.h5 -o old_half.h5 -t 1");
    forget_planes(p, "old_half.h5");
    program_result r = program_succeed(p, "post", "old_half.h5 -o old_half");
    assert_non_null(strstr(r.err, "pad_paraview.py shows the modelled part of the pad only"));
    assert_facts(p, "old_half", "d['mirrors'] == []");
    program_shell(p, "cp results.h5 old.h5");
    forget_planes(p, "old.h5");
    r = program_succeed(p, "post", "old.h5 -o old");
    assert_null(strstr(r.err, "modelled part"));
    assert_facts(p, "old", "[m[0] for m in d['mirrors']] == ['X', 'Y']");
}

static void planes_that_contradict_the_factor_are_refused(void **state) {
    const program_place *p = *state;
    const double place = 0;
    program_shell(p, "cp half_results.h5 contradiction.h5");
    hid_t file = H5Fopen(program_path(p, "contradiction.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t set = H5Dopen2(file, "/model/symmetry_x", H5P_DEFAULT);
    assert_true(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &place) >= 0);
    H5Dclose(set);
    H5Fclose(file);
    program_result r = program_run(p, "post", "contradiction.h5 -o contradiction");
    assert_int_equal(r.code, SF_ERR_IO);
    assert_non_null(
        strstr(r.err, "/model/symmetry_factor is 2, /model/symmetry_x and symmetry_y tell 2 planes"));
}

static void a_state_without_its_template_is_a_warning(void **state) {
    const program_place *p = *state;
    program_result r = program_shell(p, "SF_BIN_DIR=/nonexistent '%s/softfall-post' results.h5 -o bare",
                                     getenv("SF_BIN_DIR"));
    assert_int_equal(r.code, 0);
    assert_non_null(strstr(r.err, "warning: there is no pad_paraview.py: "));
    assert_non_null(strstr(r.err, "which comes with softfall, is missing"));
    assert_int_equal(program_shell(p, "test -e bare/pad.xdmf && ! test -e bare/pad_paraview.py").code, 0);
}

static void assert_no_film(const program_place *p, const char *path, const char *option, const char *words) {
    program_result r = program_shell(p, "env -u DISPLAY PATH='%s' '%s/softfall-post' results.h5 -o none %s",
                                     path, getenv("SF_BIN_DIR"), option);
    if (r.code != SF_ERR_INPUT || !strstr(r.err, words))
        fail_msg("exit code %d, expected \"%s\": %s", r.code, words, r.err);
    assert_int_equal(program_shell(p, "test -e none").code, 1);
}

static void a_film_without_its_programs_names_the_package(void **state) {
    const program_place *p = *state;
    assert_no_film(p, "/nonexistent", "--film", "--film needs pvbatch");
    assert_no_film(p, "/nonexistent", "--film", "install the package paraview");
    program_shell(
        p,
        "mkdir some && printf '#!/bin/sh\\nprintf \"\\\\033[31mno \\\\033[0;1mpictures today\\\\033[0m\\\\n\"\\nexit 7\\n' > some/pvbatch && "
        "chmod +x some/pvbatch");
    assert_no_film(p, "some", "--film", "install the package ffmpeg");
    program_shell(p, "cp some/pvbatch some/ffmpeg");
    assert_no_film(p, "some", "--film=gif", "install the packages xvfb and xauth");
    assert_no_film(p, "some", "--film=avi", "--film=avi: a film is mp4 or gif");
    /* One that fails: its own words, and no output at all. */
    program_result r =
        program_shell(p, "DISPLAY=:7 PATH=\"$PWD/some:$PATH\" '%s/softfall-post' results.h5 -o none --film",
                      getenv("SF_BIN_DIR"));
    assert_int_equal(r.code, SF_ERR_LIBRARY);
    assert_non_null(strstr(r.err, "the film was not made: pvbatch ended with code 7: no pictures today"));
    assert_int_equal(program_shell(p, "test -e none").code, 1);
}

/* ---- with ParaView ---- */

/* One missile, where it is; the peak's frame; nothing cut off. */
static void the_state_shows_a_missile_beside_the_middle_once(void **state) {
    const program_place *p = *state;
    check_programs("pvbatch xvfb-run");
    program_result peak = program_shell(p, "sed -n 's/ *\"peak\": \\(.*\\),/1e3*\\1/p' full/pad_paraview.py");
    program_result r = program_shell(
        p,
        "xvfb-run -a -n $((1000 + $$ %% 30000)) -s '-noreset -screen 0 1280x1024x24' pvbatch --force-offscreen-rendering '%s' full full.png $(python3 -c 'print(%s)') "
        "-200,200,-200,200 -40,120,-110,50 2>&1",
        fixture_source("tests/check_scene.py"), peak.out);
    if (r.code != 0 || !strstr(r.out, "scene is right") || strstr(r.out, "Failed to evaluate"))
        fail_msg("%s", r.out);
}

static void a_state_file_has_the_view_and_its_camera(void **state) {
    const program_place *p = *state;
    check_programs("pvbatch xvfb-run");
    program_result r = program_shell(
        p,
        "xvfb-run -a -n $((1000 + $$ %% 30000)) -s -noreset pvbatch full/pad_paraview.py --state full.pvsm 2>&1 && "
        "python3 '%s' full.pvsm 2>&1",
        fixture_source("tests/check_state.py"));
    if (r.code != 0)
        fail_msg("%s", r.out);
}

static void draw_pad_draws_a_prescribed_motion(void **state) {
    const program_place *p = *state;
    check_programs("pvbatch xvfb-run");
    program_result r = program_shell(
        p,
        "xvfb-run -a -n $((1000 + $$ %% 30000)) -s '-noreset -screen 0 1280x1024x24' pvbatch --force-offscreen-rendering '%s' pressed/pad.xdmf pressed.png 2>&1",
        fixture_source("tools/draw_pad.py"));
    if (r.code != 0 || !strstr(r.out, "pressed.png") || strstr(r.out, "Traceback"))
        fail_msg("%s", r.out);
    assert_int_equal(program_shell(p, "test -s pressed.png").code, 0);
}

static void a_film_and_its_picture_stand_beside_the_figures(void **state) {
    const program_place *p = *state;
    check_programs("pvbatch xvfb-run ffmpeg");
    setenv("DISPLAY", ":77", 1); /* there is none */
    program_succeed(p, "post", "results.h5 -o filmed --film=gif");
    unsetenv("DISPLAY");
    assert_int_equal(program_shell(p, "head -c 6 filmed/pad.gif | grep -q GIF89a").code, 0);
    assert_int_equal(program_shell(p, "test -e filmed/pad.png && ! test -e filmed/film.log").code, 0);
    program_succeed(p, "post", "results.h5 -o filmed --force"); /* a film of another run would lie */
    assert_int_equal(program_shell(p, "! test -e filmed/pad.gif && ! test -e filmed/pad.png").code, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_state_knows_symmetry_missile_and_peak),
        cmocka_unit_test(the_state_reflects_at_the_planes_of_the_model_only),
        cmocka_unit_test(the_section_lies_under_the_axis),
        cmocka_unit_test(a_plane_that_cannot_be_told_is_no_mirror),
        cmocka_unit_test(planes_that_contradict_the_factor_are_refused),
        cmocka_unit_test(a_state_without_its_template_is_a_warning),
        cmocka_unit_test(a_film_without_its_programs_names_the_package),
        cmocka_unit_test(a_state_file_has_the_view_and_its_camera),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(draw_pad_draws_a_prescribed_motion),
        cmocka_unit_test(a_film_and_its_picture_stand_beside_the_figures),
        cmocka_unit_test(the_state_shows_a_missile_beside_the_middle_once),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
