/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plans with `refine`: rows and drops with twice their spacings, extrapolated to ever finer meshes. */
#include "model_fixture.h"
#include "program_fixture.h"

#include "study/sweep/runs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Two speeds of a pad with a spacing of 10 mm in the zone and 20 mm outside. */
static void write_plan(const program_place *p, const char *name, const char *keys) {
    char text[2048];
    snprintf(text, sizeof text,
             "case = \"case.cfg\";\n%s\n"
             "factors = ( { key = \"missile.velocity\"; values = [\"3 m/s\", \"4 m/s\"]; } );\n",
             keys);
    program_write_text(p, name, text);
}

#define SET(more)                                                                                            \
    "set = [\"geometry.parameters.fine_spacing=10.0\", \"geometry.parameters.outer_spacing=20.0\"" more "];\n"
#define REFINE "refine = \"richardson\";\n"

static int set_up(void **state) {
    int result = program_group_folder(state);
    const program_place *p = *state;
    program_shell(p, "sed 's|\"\\.\\./\\.\\./geo/|\"%s/|; s|\"\\.\\./materials/|\"%s/|' '%s' > case.cfg",
                  fixture_source("geo"), fixture_source("examples/materials"),
                  fixture_source("examples/eva50-v4.5/case.cfg"));
    write_plan(p, "plan.cfg", SET("") REFINE);
    return result;
}

static void rows_are_refined_by_drops_with_twice_the_spacing(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, "Coarse drops, from which the rows are refined: 2 open runs of about "));
    assert_non_null(strstr(r.out, "\n2 coarse drops simulated, 0 were there\n"));
    assert_non_null(strstr(r.out, "rebound (m/s)"));
    if (strstr(r.out, "nan"))
        fail_msg("%s", r.out);
    program_assert_page(p, "out/report.html", "Figures for ever finer meshes");
    program_write_text(
        p, "check.py",
        "import csv, json\nfine, coarse = (list(csv.DictReader(open('out/%sruns.csv' % d))) for d in ('', 'coarse/'))\n"
        "told = json.load(open('out/sweep.json'))['refined']\n"
        "for f, c, t in zip(fine, coarse, told, strict=True):\n"
        "    assert float(f['cells']) > 4 * float(c['cells']) and not f['refined_note'] and t['refined_note'] is None\n"
        "    assert 'a_max_g_refined' not in c\n"
        "    for key in ('a_max_g', 'hic', 'max_indentation_mm', 'v_rebound_m_s'):\n"
        "        a, b = float(f[key]), float(c[key])\n        step = (a - b) / (2**1.3 - 1)\n"
        "        value, error = float(f[key + '_refined']), float(f[key + '_refined_error'])\n"
        "        assert a != b and abs(value - a - step) < 1e-6 * a and abs(error - max(abs(step), 0.005 * a)) < 1e-6 * a\n"
        "        assert abs(t[key + '_refined'] - value) < 1e-5 * a and abs(t[key + '_refined_error'] - error) < 1e-5 * a\n");
    r = program_shell(p, "python3 check.py");
    if (r.code != 0)
        fail_msg("%s", r.err);
}

/* Goes on from the folder of the test before. */
static void both_meshes_resume(void **state) {
    const program_place *p = *state;
    program_shell(p, "cp out/runs.csv before.csv");
    program_result r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, "\n0 coarse drops simulated, 0 were there\n"));
    assert_non_null(strstr(r.out, "\n0 drops simulated, 0 were there\n"));
    assert_int_equal(program_shell(p, "cmp out/runs.csv before.csv").code, 0);
    program_shell(p, "rm -r $(ls -d out/coarse/runs/drop-* | head -1)");
    r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, "\n1 coarse drops simulated, 0 were there\n"));
    assert_int_equal(program_shell(p, "cmp out/runs.csv before.csv && python3 check.py").code, 0);
    write_plan(p, "plain.cfg", SET(""));
    r = program_succeed(p, "sweep", "plain.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, "\n0 drops simulated, 2 were there\n"));
    assert_int_equal(program_shell(p, "grep -q refined out/runs.csv out/report.html").code, 1);
    write_plan(p, "other.cfg", SET(", \"pad.symmetry=[\\\"symmetry_x\\\", \\\"symmetry_y\\\"]\"") REFINE);
    r = program_run(p, "sweep", "other.cfg -o out");
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "holds the runs of another plan"));
}

/* The rows of the same factors by coarse drops of the key `coarse` are another plan's. */
static void a_folder_of_other_coarse_drops_is_refused(void **state) {
    const program_place *p = *state;
    write_plan(p, "predicted.cfg",
               SET("") "coarse = [\"geometry.parameters.fine_spacing=20.0\"];\n"
                       "figures = ( { key = \"a_max_g\"; accuracy = 0.1; } );\n");
    program_result r = program_run(p, "sweep", "predicted.cfg -o out");
    assert_int_not_equal(r.code, 0);
    assert_non_null(strstr(r.err, "out/coarse holds the runs of another plan"));
}

static void plans_that_cannot_be_refined_are_refused(void **state) {
    static const char *const wrong[][2] = {
        {SET("") "refine = \"newton\";\n", "it must be one of richardson"},
        {SET("") REFINE "figures = ( { key = \"hic\"; accuracy = 0.02; } );\n",
         "refine: a row that is predicted has no mesh"},
        {SET("") REFINE "coarse = [\"geometry.parameters.fine_spacing=20.0\"];\n",
         "coarse drops are for plans that predict rows"},
        {SET(", \"series.drops=2\", \"series.interval=\\\"60 s\\\"\"") REFINE,
         "only first drops are refined; leave `refine` out"},
        {SET(", \"geometry.spacing_factor=0.5\"") REFINE,
         "wrong.cfg:3: geometry.spacing_factor is set by `refine`, for the coarse drops: leave it out"},
        {SET(", \"geometry.parameters.thickness=30.0\"") REFINE,
         "refine: with 2 times its spacings the first row has no model: the nodal spacing under the missile is"},
        {SET(", \"geometry.parameters.thickness=30.0\", \"pad.mesh_error_limit=9.0\"") REFINE,
         "over pad.mesh_error_limit (12.5 %)"}};
    const program_place *p = *state;
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        write_plan(p, "wrong.cfg", wrong[k][0]);
        program_result r = program_run(p, "sweep", "wrong.cfg -o wrong --dry-run");
        if (r.code == 0 || !strstr(r.err, wrong[k][1]))
            fail_msg("%d, not \"%s\": %s", r.code, wrong[k][1], r.err);
    }
    assert_int_equal(program_shell(p, "test -e wrong").code, 1);
}

/* Runs softfall-sweep on the plan after the change of `sed`, and asserts that it is refused with these words.
 */
static void assert_refused(const program_place *p, const char *sed, const char *words) {
    program_shell(p, "sed '%s' plan.cfg > wrong.cfg", sed);
    program_result r = program_run(p, "sweep", "wrong.cfg -o wrong --dry-run");
    if (r.code == 0 || !strstr(r.err, words))
        fail_msg("%s: %d, not \"%s\": %s", sed, r.code, words, r.err);
}

#define MORE(key) "s|^factors = (|&{key = \"" key "\"; values = [1.0, 1.5];},|"

static void keys_of_refine_are_its_own(void **state) {
    const program_place *p = *state;
    assert_refused(
        p, MORE("pad.mesh_error_limit"),
        "wrong.cfg:5: pad.mesh_error_limit is set by `refine`, for the coarse drops: leave it out");
    assert_refused(
        p, MORE("geometry.spacing_factor"),
        "wrong.cfg:5: geometry.spacing_factor is set by `refine`, for the coarse drops: leave it out");
    program_shell(p, "sed 's|^geometry: {|&spacing_factor = 0.5;|' case.cfg > scaled.cfg");
    assert_refused(p, "s|case.cfg|scaled.cfg|", "wrong.cfg:3: geometry.spacing_factor is set by `refine`");
}

/* The lines of softfall-pre that tell the mesh. */
static void write_mesh(const program_place *p, const char *name, const char *arguments) {
    program_result r = program_succeed(p, "pre", "%s -o %s.h5 --force", arguments, name);
    program_write_text(p, name, r.out);
    program_shell(p, "grep -E '^(nodes|cells|nodal spacing|mesh hash) ' %s > %s.mesh", name, name);
    assert_int_equal(program_shell(p, "test $(wc -l < %s.mesh) = 4", name).code, 0);
}

/* `left.cfg` leaves both spacings to own.geo, `half.cfg` one of them. */
static void spacings_of_the_geometry_are_doubled_too(void **state) {
    const program_place *p = *state;
    program_shell(
        p,
        "cp '%s' own.geo; sed 's|\"[^\"]*/pad.geo|\"own.geo|; s/ outer_spacing[^;]*;//' case.cfg > half.cfg; "
        "sed 's/ fine_spacing[^;]*;//' half.cfg > left.cfg",
        fixture_source("geo/pad.geo"));
    assert_int_equal(program_shell(p, "grep -q spacing left.cfg").code, 1);
    write_mesh(p, "given",
               "case.cfg --set geometry.parameters.fine_spacing=10.0 "
               "--set geometry.parameters.outer_spacing=20.0");
    write_mesh(p, "half", "half.cfg --set geometry.spacing_factor=2");
    write_mesh(p, "left", "left.cfg --set geometry.spacing_factor=2");
    write_mesh(p, "plain", "left.cfg");
    program_shell(p, "echo 'half_spacing = 0.5*fine_spacing;' >> own.geo"); /* follows one that is doubled */
    write_mesh(p, "derived", "left.cfg --set geometry.spacing_factor=2");
    assert_int_equal(program_shell(p, "cmp given.mesh half.mesh && cmp given.mesh left.mesh && "
                                      "cmp given.mesh derived.mesh")
                         .code,
                     0);
    assert_int_equal(program_shell(p, "cmp -s given.mesh plain.mesh").code, 1);
}

/* Goes on from the files of the test before. */
static void spacings_that_cannot_be_doubled_are_refused(void **state) {
    static const char *const wrong[][2] = {
        {"s/outer_spacing = {10,/outer_spacing = {2 * 5,/",
         "wrong.cfg:3: refine: ./own.geo: geometry.spacing_factor needs a number, in geometry.parameters or in a "
         "DefineConstant of this file, for outer_spacing"},
        {"1i cell_spacing = 5;", "for cell_spacing"},
        {"1i cell_spacing = 5*mm; // spacing", "for cell_spacing"},
        {"1i cell_spacing = DefineNumber[5, Name \"Pad/spacing\"];", "for cell_spacing"},
        {"s/fine_spacing/fine/g; s/outer_spacing/outer/g", "for a parameter with \"spacing\" in its name"}};
    const program_place *p = *state;
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        program_shell(p, "sed '%s' '%s' > own.geo", wrong[k][0], fixture_source("geo/pad.geo"));
        assert_refused(p, "s/case.cfg/left.cfg/; s/^set.*//", wrong[k][1]);
    }
    program_shell(p, "cp '%s' part.geo; echo 'Include \"part.geo\";' > own.geo",
                  fixture_source("geo/pad.geo"));
    assert_refused(
        p, "s/case.cfg/left.cfg/; s/^set.*//",
        "refine: with 2 times its spacings the first row has no model: ./own.geo: geometry.spacing_factor needs a number, in geometry.parameters or in a DefineConstant of this file, for fine_spacing");
}

/* ---- pairs ---- */

static void set_row(sf_runs *r, int64_t row, sf_grade grade, double cells, double a_max, double hic) {
    sf_error err = SF_ERROR_INIT;
    double *place = sf_runs_place(r, row);
    place[sf_runs_figure("cells")] = cells;
    place[sf_runs_figure("a_max_g")] = a_max;
    place[sf_runs_figure("hic")] = hic;
    place[sf_runs_figure("max_indentation_mm")] = 30;
    sf_runs_done(r, row, grade, "drop", grade == SF_GRADE_VALID ? NULL : "do not use: energy", &err);
}

static void assert_note(const sf_runs *r, int64_t row, int values, const char *words) {
    const sf_runs_pair pair = sf_runs_refine(r, row);
    int count = 0;
    for (int k = 0; k < SF_REFINED; k++) {
        assert_int_equal(isnan(pair.figure[k][0]), isnan(pair.figure[k][1]));
        count += !isnan(pair.figure[k][0]);
    }
    if (count != values || !strstr(pair.note, words))
        fail_msg("%d values: %s", count, pair.note);
}

static void pairs_that_tell_no_value_have_a_note(void **state) {
    static sf_plan plan;
    sf_runs fine, coarse;
    sf_error err = SF_ERROR_INIT;
    (void)state;
    plan = (sf_plan){.rows = 6, .refine = true, .figure_count = 1, .figure = {{"a_max_g", 200, 0}}};
    assert_int_equal(sf_runs_create(&plan, &fine, &err), SF_OK);
    assert_int_equal(sf_runs_create(&plan, &coarse, &err), SF_OK);
    assert_note(&fine, 0, 0, "its drop: not simulated");
    for (int64_t row = 0; row < 6; row++) {
        set_row(&fine, row, row == 1 ? SF_GRADE_DO_NOT_USE : SF_GRADE_VALID, 8000, 100, 500);
        set_row(&coarse, row, row == 2 ? SF_GRADE_DO_NOT_USE : SF_GRADE_VALID, row == 4 ? 2000 : 1000, 98,
                row == 5 ? 400 : 490);
    }
    sf_runs_failed(&coarse, 3, "the missile reached the anvil", &err);
    assert_note(&fine, 0, 0, "its coarse drop: not simulated"); /* none is known yet */
    fine.coarse = &coarse;
    assert_note(&fine, 0, 3, "v_rebound_m_s: nan, and nan with 2 times");
    assert_note(&fine, 1, 0, "its drop: do not use: energy");
    assert_note(&fine, 2, 0, "its coarse drop: do not use: energy");
    assert_note(&fine, 3, 0, "its coarse drop: the missile reached the anvil");
    assert_note(&fine, 4, 0, "with 2 times the spacing: parts of the mesh are no coarser");
    assert_note(&fine, 5, 2, "hic: 500, and 400 with 2 times the spacing: too far");
    assert_true(fabs(sf_runs_refine(&fine, 0).figure[0][0] - 100 - 2 / (pow(2, 1.3) - 1)) < 1e-9);
    assert_true(fabs(sf_runs_refine(&fine, 0).figure[2][1] - 0.15) < 1e-9); /* equal by chance */
    sf_runs_free(&fine);
    sf_runs_free(&coarse);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_refined_by_drops_with_twice_the_spacing),
        cmocka_unit_test(both_meshes_resume),
        cmocka_unit_test(a_folder_of_other_coarse_drops_is_refused),
        cmocka_unit_test(plans_that_cannot_be_refined_are_refused),
        cmocka_unit_test(keys_of_refine_are_its_own),
        cmocka_unit_test(spacings_of_the_geometry_are_doubled_too),
        cmocka_unit_test(spacings_that_cannot_be_doubled_are_refused),
        cmocka_unit_test(pairs_that_tell_no_value_have_a_note),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
