/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drops one after the other on the same pad: a series, the same drops run one by one, resumed, with other
 * threads, and what is refused. */
#include "model_fixture.h"
#include "program_fixture.h"
#include "run_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";

/* A coarse model of a foam that remembers. */
static program_result make_model(const program_place *p, const char *name, const char *more) {
    char coarse[512];
    snprintf(coarse, sizeof coarse, "%s", program_coarse(20));
    return program_run(
        p, "pre",
        "'%s' -o %s --force %s --set material=@'%s' --set material.HU=0.05 --set material.ALPHA=0.5 "
        "--set material.memory.reload=0.4 --set material.memory.drift=0.2 "
        "--set material.memory.recovery=0.1 --set material.memory.permanent=0.2 %s",
        fixture_source(EXAMPLE), name, coarse, fixture_source("tests/materials/eva35_first.cfg"), more);
}

static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    assert_int_equal(make_model(p, "series.h5", "--set series.drops=3 --set series.interval='\"90 s\"'").code,
                     0);
    assert_int_equal(make_model(p, "single.h5", "").code, 0);
    program_succeed(p, "solve", "series.h5 -o s.h5 --threads 1");
    return 0;
}

static double number(const char *text, int row, int column) {
    for (; row > 0 && text; row--)
        text = strchr(text, '\n') + 1;
    for (; column > 0; column--)
        text = strchr(text, ',') + 1;
    return strtod(text, NULL);
}

/* The second drop is harder by the softening, and by less after a longer pause. */
static void later_drops_are_harder(void **state) {
    const program_place *p = *state;
    program_succeed(p, "post", "series s.h5 -o series");
    program_bytes csv = program_read_file(program_path(p, "series/series.csv"));
    double first = number(csv.data, 1, 2), second = number(csv.data, 2, 2), third = number(csv.data, 3, 2);
    assert_true(second > 1.05 * first && third > second && third < 3 * first);
    assert_true(fabs(number(csv.data, 4, 2) / (0.5 * (second + third)) - 1) < 1e-6);
    assert_true(fabs(number(csv.data, 2, 3) - (second / first - 1)) < 1e-4);
    free(csv.data);
    program_assert_page(p, "series/report.html", "Drops of the series");
    program_succeed(p, "solve", "single.h5 -o rested.h5 --start-from s.h5 --pause '8 hour' --threads 1");
    program_succeed(p, "post", "rested.h5 -o rested");
    double rested = program_file_number(p, "rested/summary.json", "a_max_g");
    assert_true(rested > 1.01 * first && rested < 0.99 * second);
}

/* But for what the summary says of the series. */
static void assert_same_drop(const program_place *p, const char *first, const char *second) {
    sf_error err = SF_ERROR_INIT;
    sf_h5 *a = program_open_h5(p, first), *b = program_open_h5(p, second);
    run_assert_same_group(a, b, "/history");
    run_assert_same_group(a, b, "/peak");
    sf_h5_close(&a, &err);
    sf_h5_close(&b, &err);
}

static void bits_are_those_of_single_runs(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "single.h5 -o one.h5 --threads 2");
    program_succeed(p, "solve",
                    "single.h5 -o two.h5 --start-from one.h5 --pause '90 s' --threads 2 --end-time '4 ms'");
    program_succeed(p, "solve", "--restart two.h5 --end-time '40 ms' --threads 1");
    program_succeed(p, "solve", "single.h5 -o three.h5 --start-from two.h5 --pause '90 s' --threads 2");
    assert_same_drop(p, "s.h5", "one.h5");
    assert_same_drop(p, "s-2.h5", "two.h5");
    assert_same_drop(p, "s-3.h5", "three.h5");
    program_succeed(p, "post", "series one.h5 two.h5 three.h5 -o again");
}

static void a_series_goes_on_where_it_was(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "series.h5 -o r.h5 --threads 1");
    program_shell(p, "rm r-3.h5 r-3.h5.restart; cp r-2.h5 kept.h5");
    program_succeed(p, "solve", "--restart r.h5 --threads 2");
    run_assert_same(p, "s-3.h5", "r-3.h5");
    program_shell(p, "rm r-2.h5 r-2.h5.restart r-3.h5 r-3.h5.restart");
    program_succeed(p, "solve", "--restart r.h5 --threads 1");
    run_assert_same(p, "s-2.h5", "r-2.h5");
    run_assert_same(p, "s-3.h5", "r-3.h5");
}

static void expect(program_result r, const char *words) {
    if (r.code == 0 || !strstr(r.err, words))
        fail_msg("exit code %d, expected \"%s\", said: %s", r.code, words, r.err);
}

static void wrong_series_are_refused(void **state) {
    const program_place *p = *state;
    expect(make_model(p, "x.h5", "--set series.drops=2.5 --set series.interval='\"90 s\"'"), "whole number");
    expect(make_model(p, "x.h5", "--set series.drops=2"), "needs series.interval");
    expect(make_model(p, "x.h5", "--set series.interval='\"90 s\"'"), "belongs to a series");
    expect(make_model(p, "x.h5", "--set series.drops=2 --set series.interval='\"0 s\"'"), "series.interval");
    expect(make_model(
               p, "x.h5",
               "--set series.drops=2 --set series.interval='\"9 s\"' --set solver.stop_after_rebound=false"),
           "stop_after_rebound");
    expect(make_model(p, "x.h5", "--set material.HU=1"), "memory.reload");
    expect(make_model(p, "x.h5", "--set material.memory.reload=1.5"), "memory.reload");
    expect(program_run(p, "solve", "series.h5 -o x.h5 --no-checkpoint"), "--no-checkpoint");
    expect(program_run(p, "solve", "series.h5 -o s.h5"), "exists");
    expect(program_run(p, "solve", "single.h5 -o x.h5 --start-from s.h5"), "--pause");
    expect(program_run(p, "solve", "single.h5 -o x.h5 --start-from nowhere.h5 --pause '9 s'"),
           "is not there");
}

static void another_pad_is_refused(void **state) {
    const program_place *p = *state;
    assert_int_equal(make_model(p, "other.h5", "--set geometry.parameters.thickness=60.0").code, 0);
    expect(program_run(p, "solve", "other.h5 -o x.h5 --start-from s.h5 --pause '9 s'"), "is another one");
    assert_int_equal(
        make_model(p, "other.h5", "--set material.memory.reload=0.0 --set material.memory.recovery=0.0").code,
        0);
    expect(program_run(p, "solve", "other.h5 -o x.h5 --start-from s.h5 --pause '9 s'"),
           "remembers other things");
    program_succeed(p, "solve", "other.h5 -o plain.h5 --threads 1");
    program_succeed(p, "solve", "other.h5 -o plain-2.h5 --start-from plain.h5 --pause '9 s' --threads 1");
    assert_non_null(
        strstr(program_succeed(p, "post", "plain-2.h5 -o plain").err, "loads along its unloading path"));
    assert_null(strstr(program_succeed(p, "post", "s-2.h5 -o second").err, "loads along its unloading path"));
    program_succeed(p, "solve", "single.h5 -o short.h5 --end-time '9 ms'");
    expect(program_run(p, "solve", "single.h5 -o x.h5 --start-from short.h5 --pause '9 s'"),
           "points in contact");
    assert_int_not_equal(access(program_path(p, "x.h5"), F_OK), 0);
    expect(program_run(p, "post", "series one.h5 -o x"), "is no series");
    expect(program_run(p, "post", "series s.h5 s-3.h5 -o x"), "not drop 2");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(later_drops_are_harder),        cmocka_unit_test(bits_are_those_of_single_runs),
        cmocka_unit_test(a_series_goes_on_where_it_was), cmocka_unit_test(wrong_series_are_refused),
        cmocka_unit_test(another_pad_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
