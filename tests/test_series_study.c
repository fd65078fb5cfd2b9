/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Series of drops on one pad in the studies: a sweep and a critical height against the same drops by hand,
 * after an interruption, judged by other drops, with drops that fail, and what is refused. */
#include "extreme.h"
#include "model_fixture.h"
#include "program_fixture.h"
#include "post_check.h"
#include "run_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/series/case.cfg";

/* The example on a coarse pad with two drops, and the speeds of its rows. */
static void write_plan(const program_place *p, const char *name, const char *set, const char *more) {
    char text[2048];
    snprintf(text, sizeof text,
             "case = \"%s\";\nset = [\"geometry.parameters.fine_spacing=20.0\", "
             "\"geometry.parameters.outer_spacing=20.0\", \"geometry.missile_parameters.element_size=20.0\", "
             "\"pad.mesh_error_limit=1\"%s];\n"
             "factors = ( { key = \"missile.velocity\"; values = [\"3 m/s\", \"4 m/s\"]; } );\n%s",
             fixture_source(EXAMPLE), set, more);
    program_write_text(p, name, text);
}

static int set_up(void **state) {
    int result = program_group_folder(state);
    const program_place *p = *state;
    write_plan(p, "plan.cfg", ", \"series.drops=2\"", "");
    write_plan(p, "three.cfg", "", "");
    return result;
}

/* Runs a row of a plan by hand: NAME.h5, NAME-2.h5, ... */
static void run_by_hand(const program_place *p, const char *name, const char *set) {
    program_succeed(p, "pre", "'%s' -o model-%s.h5 %s %s", fixture_source(EXAMPLE), name, program_coarse(20),
                    set);
    program_succeed(p, "solve", "model-%s.h5 -o %s.h5 --threads 2", name, name);
}

/* Returns a cell of a table by the number of its row, from 1, and its column; NaN if it is no number. */
static double cell(const program_place *p, const char *file, int row, const char *column) {
    program_result r =
        program_shell(p, "python3 -c \"import csv; print(list(csv.DictReader(open('%s')))[%d]['%s'])\"", file,
                      row - 1, column);
    char *end = NULL;
    double value = strtod(r.out, &end);
    return r.code == 0 && end > r.out ? value : NAN;
}

/* The history of drop `drop` of the row, in the folder of the row, is that of a run by hand. */
static void assert_same_history(const program_place *p, const char *out, int row, int drop,
                                const char *hand) {
    sf_error err = SF_ERROR_INIT;
    char path[600];
    program_result r = program_shell(
        p,
        "python3 -c \"import csv; print(list(csv.DictReader(open('%s/runs.csv')))[%d]['folder'], end='')\"",
        out, row - 1);
    snprintf(path, sizeof path, drop > 1 ? "%s/runs/%.60s/results-%d.h5" : "%s/runs/%.60s/results.h5", out,
             r.out, drop);
    sf_h5 *a = program_open_h5(p, path), *b = program_open_h5(p, hand);
    run_assert_same_group(a, b, "/history");
    sf_h5_close(&a, &err);
    sf_h5_close(&b, &err);
}

static void a_row_is_the_series_by_hand(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "sweep", "plan.cfg -o out --jobs 2");
    assert_non_null(strstr(r.out, "2 runs: 2 done, 0 failed, 0 open"));
    assert_non_null(strstr(r.out, "judged by drop 2 of 2"));
    run_by_hand(p, "slow", "--set series.drops=2 --set missile.velocity='3 m/s'");
    run_by_hand(p, "fast", "--set series.drops=2 --set missile.velocity='4 m/s'");
    assert_same_history(p, "out", 1, 1, "slow.h5");
    assert_same_history(p, "out", 1, 2, "slow-2.h5");
    assert_same_history(p, "out", 2, 1, "fast.h5");
    assert_same_history(p, "out", 2, 2, "fast-2.h5");
    program_succeed(p, "post", "fast.h5 -o fast");
    program_succeed(p, "post", "fast-2.h5 -o fast-2");
    double first = program_file_number(p, "fast/summary.json", "a_max_g"),
           second = program_file_number(p, "fast-2/summary.json", "a_max_g");
    assert_true(second > 1.05 * first);
    assert_relative(cell(p, "out/runs.csv", 2, "a_max_g"), second, 1e-8);
    assert_relative(cell(p, "out/drops.csv", 3, "a_max_g"), first, 1e-8);
    assert_relative(cell(p, "out/drops.csv", 4, "a_max_g"), second, 1e-8);
    assert_relative(cell(p, "out/runs.csv", 2, "steps"),
                    cell(p, "out/drops.csv", 3, "steps") + cell(p, "out/drops.csv", 4, "steps"), 0);
    program_assert_page(p, "out/report.html", "judged by drop 2 of 2");
    assert_int_equal(
        program_shell(p, "find out/runs -name '*.restart' -o -name 'model*.h5' | grep -q .").code, 1);
}

/* The drops that count may change: no drop is simulated again, and the table follows. */
static void other_drops_may_count(void **state) {
    const program_place *p = *state;
    program_succeed(p, "sweep", "three.cfg -o three --jobs 2");
    double of[4] = {0};
    for (int k = 1; k <= 3; k++)
        of[k] = cell(p, "three/drops.csv", 3 + k, "hic");
    assert_true(of[1] < of[2] && of[2] < of[3]);
    assert_relative(cell(p, "three/runs.csv", 2, "hic"), 0.5 * (of[2] + of[3]), 1e-8);
    write_plan(p, "three.cfg", ", \"series.counted=[1, 2, 3]\"", "");
    program_result r = program_succeed(p, "sweep", "three.cfg -o three --jobs 2 --force");
    assert_non_null(strstr(r.out, "\n0 drops simulated, 2 were there"));
    assert_relative(cell(p, "three/runs.csv", 2, "hic"), (of[1] + of[2] + of[3]) / 3, 1e-8);
}

/* In the case itself, which the hash of the plan does not know. */
static void a_case_that_counts_other_drops_is_looked_at_again(void **state) {
    const program_place *p = *state;
    char text[2048];
    program_shell(p, "sed -e 's|\\.\\./\\.\\./geo|%s|' -e 's|\\.\\./materials|%s|' '%s' > own.cfg",
                  fixture_source("geo"), fixture_source("examples/materials"), fixture_source(EXAMPLE));
    snprintf(text, sizeof text,
             "case = \"own.cfg\";\nset = [\"geometry.parameters.fine_spacing=20.0\", "
             "\"geometry.parameters.outer_spacing=20.0\", \"geometry.missile_parameters.element_size=20.0\", "
             "\"pad.mesh_error_limit=1\", \"series.drops=2\"];\n"
             "factors = ( { key = \"missile.velocity\"; values = [\"3 m/s\"]; } );\n");
    program_write_text(p, "own-plan.cfg", text);
    program_succeed(p, "sweep", "own-plan.cfg -o own");
    double last = cell(p, "own/runs.csv", 1, "hic"), first = cell(p, "own/drops.csv", 1, "hic");
    program_shell(p, "sed -i 's/drops = 3;/drops = 3; counted = [1, 2];/' own.cfg");
    program_result r = program_succeed(p, "sweep", "own-plan.cfg -o own");
    assert_non_null(strstr(r.out, "0 drops simulated, 1 were there"));
    assert_relative(cell(p, "own/runs.csv", 1, "hic"), 0.5 * (first + last), 1e-8);
}

/* Interrupted in the second drop, and killed there with the solver left at work. */
static void an_interrupted_series_goes_on(void **state) {
    const program_place *p = *state;
    static const char *const how[] = {"TERM", "KILL"};
    for (int k = 0; k < 2; k++) {
        program_result r = program_shell(
            p,
            "rm -rf broken; '%s/softfall-sweep' plan.cfg -o broken --jobs 1 > log 2>&1 & for k in $(seq 6000); do "
            "ls broken/runs/drop-*/results-2.h5.run >/dev/null 2>&1 && break; sleep 0.005; done; kill -%s $!; wait $!",
            getenv("SF_BIN_DIR"), how[k]);
        assert_int_not_equal(r.code, 0);
        assert_int_equal(program_shell(p, "test -e broken/report.html").code, 1);
        r = program_succeed(p, "sweep", "plan.cfg -o broken --jobs 1");
        assert_non_null(strstr(r.out, "2 runs: 2 done, 0 failed, 0 open"));
        assert_same_history(p, "broken", 1, 1, "slow.h5");
        assert_same_history(p, "broken", 1, 2, "slow-2.h5");
        assert_same_history(p, "broken", 2, 2, "fast-2.h5");
    }
}

/* A list of drops, of which the second reaches the anvil: the row has failed, and says which drop. */
static void a_drop_that_fails_is_named(void **state) {
    const program_place *p = *state;
    write_plan(p, "list.cfg", ", \"series.drops=( { }, { velocity = \\\"25 m/s\\\"; } )\"", "");
    program_result r = program_succeed(p, "sweep", "list.cfg -o list --jobs 2");
    assert_non_null(strstr(r.out, "2 runs: 0 done, 2 failed, 0 open"));
    if (!strstr(r.out, "failed: drop 2 of 2: softfall-solve: "))
        fail_msg("%s", r.out);
    r = program_succeed(p, "sweep", "list.cfg -o list --jobs 2");
    assert_non_null(strstr(r.out, "\n0 drops simulated"));
    write_plan(p, "list.cfg", ", \"series.drops=( { }, { velocity = \\\"3.5 m/s\\\"; } )\"", "");
    program_succeed(p, "sweep", "list.cfg -o list --jobs 2 --force");
    assert_relative(cell(p, "list/drops.csv", 4, "v0_m_s"), 3.5, 1e-3);
    assert_int_equal(program_shell(p, "ls list/runs/*/model*.h5").code, 2);
}

/* The height of the mean: a series from it has the limit as the mean of drops 2 and 3, its first drop less.
 */
static void the_critical_height_is_that_of_the_drops_that_count(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "cfh", "'%s' -o cfh -t 2 --limit-hic 1e6 --height '1.3 m' %s",
                                       fixture_source(EXAMPLE), program_coarse(20));
    assert_non_null(strstr(r.out, "of free fall, by the mean of drops 2, 3 of 3: a_max reaches 200 g first"));
    program_assert_page(p, "cfh/report.html", "by the mean of drops 2, 3 of 3");
    double speed = program_file_number(p, "cfh/cfh.json", "speed_m_s");
    char set[64];
    snprintf(set, sizeof set, "--set missile.velocity='%.9g m/s'", speed);
    run_by_hand(p, "at", set);
    program_succeed(p, "post", "series at.h5 -o at");
    double of[4] = {0};
    for (int k = 1; k <= 3; k++)
        of[k] = cell(p, "at/series.csv", k, "a_max_g");
    assert_relative(0.5 * (of[2] + of[3]), 200, 0.01);
    assert_true(of[1] < 0.97 * 200);
    r = program_succeed(p, "cfh", "'%s' -o cfh -t 1 --force --limit-hic 1e6 --height '1.3 m' %s",
                        fixture_source(EXAMPLE), program_coarse(20));
    assert_non_null(strstr(r.out, "\n0 drops simulated"));
}

static void expect(program_result r, const char *words) {
    if (r.code != 2 || !strstr(r.err, words))
        fail_msg("exit code %d, expected \"%s\", said: %s", r.code, words, r.err);
}

static void what_a_study_cannot_judge_is_refused(void **state) {
    const program_place *p = *state;
    const char *series = fixture_source(EXAMPLE);
    static const struct {
        const char *set, *words;
    } sets[] = {{"series.counted=[]", "expected an array"},
                {"series.counted=[2, 2]", "item 2 is not the number of another drop"},
                {"series.counted=[2.5, 3.0]", "item 1 is not the number of another drop"},
                {"series.counted=[0, 3]", "item 1 is not the number of another drop"},
                {"series.counted=[1, 2]", "is not the last of the series"},
                {"series.counted=[3, 4]", "is not the last of the series"},
                {"material.memory={ reload = 0.0; }", "the foam has no material.memory"},
                {"series.drops=( { }, { mass = \"3 kg\"; } )", "drop 2 has own keys"}};
    for (size_t k = 0; k < sizeof sets / sizeof *sets; k++)
        expect(program_run(p, "cfh", "'%s' -o none %s --set '%s'", series, program_coarse(20), sets[k].set),
               sets[k].words);
    expect(program_run(p, "cfh", "'%s' -o none %s --posterior .", series, program_coarse(20)), "--posterior");
    write_plan(p, "wrong.cfg", "", "figures = ( { key = \"hic\"; limit = 1000.0; accuracy = 0.02; } );\n");
    expect(program_run(p, "sweep", "wrong.cfg -o none"), "leave `accuracy` out");
    write_plan(p, "wrong.cfg", ", \"series.counted=[4]\"", "");
    expect(program_run(p, "sweep", "wrong.cfg -o none"), "is not the last of the series");
    write_plan(p, "wrong.cfg", ", \"material.memory={ reload = 0.0; }\"", "");
    expect(program_run(p, "sweep", "wrong.cfg -o none"), "the foam has no material.memory");
    program_write_text(
        p, "fit.cfg",
        "name = \"foam\"; material = \"foam.cfg\"; drops = ( { name = \"one\"; case = \"series.cfg\"; "
        "a_max_g = 90.0; a_max_sd = 0.01; } );");
    program_shell(
        p,
        "cp '%s' foam.cfg && cp '%s' . && sed -e 's|\\.\\./\\.\\./geo|%s|' -e 's|\\.\\./materials/||' '%s' > "
        "series.cfg",
        fixture_source("examples/materials/eva35.cfg"), fixture_source("examples/materials/eva35.csv"),
        fixture_source("geo"), fixture_source(EXAMPLE));
    expect(program_run(p, "fit", "drop fit.cfg -o none"), "say which of them it is by its number");
    assert_int_equal(program_shell(p, "test -e none").code, 1);
}

/* The page of a row with all fields is that of its drops. */
static void the_view_of_a_row_is_the_page_of_its_drops(void **state) {
    const program_place *p = *state;
    program_succeed(p, "sweep", "plan.cfg -o out --jobs 2 --views 2");
    assert_int_equal(
        program_shell(p, "grep -q 'views/drop-[0-9a-f]*/report/report.html' out/report.html").code, 0);
    assert_int_equal(
        program_shell(p, "grep -q 'Drops of the series' out/views/drop-*/report/report.html").code, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_row_is_the_series_by_hand),
        cmocka_unit_test(other_drops_may_count),
        cmocka_unit_test(a_case_that_counts_other_drops_is_looked_at_again),
        cmocka_unit_test(an_interrupted_series_goes_on),
        cmocka_unit_test(a_drop_that_fails_is_named),
        cmocka_unit_test(the_critical_height_is_that_of_the_drops_that_count),
        cmocka_unit_test(what_a_study_cannot_judge_is_refused),
        cmocka_unit_test(the_view_of_a_row_is_the_page_of_its_drops),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
