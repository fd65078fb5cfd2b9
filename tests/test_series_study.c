/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Series of drops on one pad in the studies: a critical height against the same drops by hand, and what is
 * refused. */
#include "extreme.h"
#include "model_fixture.h"
#include "program_fixture.h"
#include "post_check.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/series/case.cfg";

/* Runs the series: NAME.h5, NAME-2.h5, ... */
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_critical_height_is_that_of_the_drops_that_count),
        cmocka_unit_test(what_a_study_cannot_judge_is_refused),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
