/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The verdict on a run: its rows from figures at and beyond their bounds, and softfall-post as it shows them
 * on synthetic results. */
#include "check.h"
#include "post/figures/verdict.h"
#include "post_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"
#include "program_fixture.h"

/* A sound run with its figures, to be changed. */
typedef struct sound_run {
    sf_results results;
    sf_figures figures;
    sf_verdict verdict;
} sound_run;

static void write_fixture(program_place *p, fixture_options options) {
    sf_error err = SF_ERROR_INIT;
    if (fixture_write(program_path(p, "results.h5"), &options, &err) != SF_OK)
        fail_msg("%s", err.text);
}

static sound_run open_run(program_place *p, fixture_options options) {
    sound_run run = {0};
    sf_error err = SF_ERROR_INIT;
    write_fixture(p, options);
    if (sf_results_open(program_path(p, "results.h5"), &run.results, &err) != SF_OK ||
        sf_figures_compute(&run.results, 1000, &run.figures, &err) != SF_OK)
        fail_msg("%s", err.text);
    return run;
}

static void close_run(sound_run *run) {
    sf_figures_free(&run->figures);
    sf_results_close(&run->results);
}

static sf_grade judge(sound_run *run) {
    const sf_limits limits = SF_DEFAULT_LIMITS;
    sf_verdict_compute(&run->results, &run->figures, &limits, &run->verdict);
    return run->verdict.grade;
}

static const sf_check *row(const sound_run *run, const char *key) {
    for (int k = 0; k < run->verdict.count; k++)
        if (strcmp(run->verdict.rows[k].key, key) == 0)
            return &run->verdict.rows[k];
    fail_msg("the verdict has no row %s", key);
    return NULL;
}

static int set_up(void **state) {
    return program_group_folder(state);
}

static void a_sound_run_is_valid_in_every_row(void **state) {
    sound_run run = open_run(*state, (fixture_options){0});
    sf_grade grade = judge(&run);
    char line[1024];
    sf_verdict_line(&run.verdict, line, sizeof line);
    if (grade != SF_GRADE_VALID || strcmp(line, "valid") != 0)
        fail_msg("%s", line);
    assert_close(row(&run, "energy_error")->value, 0.002, 1e-8);
    close_run(&run);
}

/* Each figure at its bounds, and just beyond. */
static void a_figure_beyond_its_bound_is_a_remark_and_far_beyond_not_to_be_used(void **state) {
    sound_run run = open_run(*state, (fixture_options){0});
    const struct {
        const char *key;
        double *figure;
    } cases[] = {
        {"energy_error", &run.figures.energy_error},
        {"momentum", &run.figures.momentum_error},
        {"momentum", &run.figures.momentum_error_space},
        {"momentum", &run.figures.angular_momentum_error},
        {"stabilisation", &run.figures.stabilisation_energy_fraction},
        {"contact", &run.figures.contact_energy_fraction},
        {"anvil", &run.figures.max_mean_strain},
        {"informed", &run.figures.energy_beyond_data},
        {"local_collapse", &run.figures.local_collapse},
        {"mesh", &run.figures.a_max_mesh_error},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        double sound = *cases[k].figure;
        judge(&run);
        assert_int_equal(row(&run, cases[k].key)->grade, SF_GRADE_VALID);
        double remark = row(&run, cases[k].key)->bound, use = row(&run, cases[k].key)->use_bound;
        assert_true(!(sound > remark) && remark < use && isfinite(use)); /* sound may be unknown */
        *cases[k].figure = remark;
        assert_int_equal(judge(&run), SF_GRADE_VALID);
        *cases[k].figure = 1.01 * remark;
        assert_int_equal(judge(&run), SF_GRADE_REMARKS);
        assert_int_equal(row(&run, cases[k].key)->grade, SF_GRADE_REMARKS);
        *cases[k].figure = 1.01 * use;
        assert_int_equal(judge(&run), SF_GRADE_DO_NOT_USE);
        *cases[k].figure = sound;
    }
    assert_int_equal(judge(&run), SF_GRADE_VALID);
    close_run(&run);
}

static void a_raw_peak_beyond_the_filtered_one_is_a_remark(void **state) {
    sound_run run = open_run(*state, (fixture_options){0});
    run.figures.injury_raw.a_max_g = 1.1 * run.figures.injury.a_max_g;
    assert_int_equal(judge(&run), SF_GRADE_REMARKS);
    assert_close(row(&run, "filter")->value, 0.1, 1e-9);
    assert_non_null(strstr(row(&run, "filter")->text, "10 %"));
    close_run(&run);
}

static void a_local_strain_below_the_mean_shows_a_coarse_mesh(void **state) {
    sound_run run = open_run(*state, (fixture_options){0});
    run.figures.local_strain_excess = -0.05;
    assert_int_equal(judge(&run), SF_GRADE_REMARKS);
    assert_close(row(&run, "coarse")->value, 0.05, 1e-12);
    close_run(&run);
}

static void a_run_that_ends_on_the_way_down_is_not_to_be_used(void **state) {
    sound_run run = open_run(*state, (fixture_options){.end_time = 0.4 * FIXTURE_DURATION});
    assert_int_equal(judge(&run), SF_GRADE_DO_NOT_USE);
    assert_close(row(&run, "ended_in_contact")->value, 1, 0.05); /* the peak lies ahead */
    close_run(&run);
}

static void a_run_that_ends_late_in_the_rebound_has_a_remark(void **state) {
    sound_run run = open_run(*state, (fixture_options){.end_time = 0.95 * FIXTURE_DURATION});
    assert_int_equal(judge(&run), SF_GRADE_REMARKS);
    assert_close(row(&run, "ended_in_contact")->value, sin(M_PI * 0.95), 0.01);
    close_run(&run);
}

static void failed_interrupted_and_untouched_runs_are_graded(void **state) {
    const struct {
        fixture_options options;
        sf_grade grade;
        const char *says;
    } cases[] = {
        {{.status = "domain 12 collapsed"}, SF_GRADE_DO_NOT_USE, "failed"},
        {{.status = "interrupted"}, SF_GRADE_REMARKS, "interrupted"},
        {{.no_summary = true}, SF_GRADE_REMARKS, "no end"},
        {{.untouched = true}, SF_GRADE_DO_NOT_USE, "never touched"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sound_run run = open_run(*state, cases[k].options);
        char line[2048];
        assert_int_equal(judge(&run), cases[k].grade);
        sf_verdict_line(&run.verdict, line, sizeof line);
        if (!strstr(line, cases[k].says))
            fail_msg("\"%s\" is missing in: %s", cases[k].says, line);
        close_run(&run);
    }
}

static void what_the_solver_noted_is_a_remark(void **state) {
    sound_run run =
        open_run(*state, (fixture_options){.notes = "the forces did not settle\nanother sentence\n"});
    assert_int_equal(run.results.note_count, 2);
    assert_string_equal(run.results.notes[1], "another sentence");
    assert_int_equal(judge(&run), SF_GRADE_REMARKS);
    assert_close(row(&run, "notes")->value, 2, 0);
    assert_non_null(strstr(row(&run, "notes")->text, "the forces did not settle"));
    close_run(&run);
}

/* How the run ended is a row of its own; the notes still list it. */
static void a_note_that_repeats_the_ending_is_not_counted(void **state) {
    static const fixture_options ended[] = {
        {.status = "interrupted"},
        {.no_summary = true},
        {.untouched = true, .notes = "the missile never touched the pad\n", .status = "finished"}};
    for (size_t k = 0; k < sizeof ended / sizeof ended[0]; k++) {
        sound_run run = open_run(*state, ended[k]);
        judge(&run);
        assert_int_equal(run.results.note_count, 1);
        assert_close(row(&run, "notes")->value, 0, 0);
        assert_int_equal(row(&run, "notes")->grade, SF_GRADE_VALID);
        assert_int_not_equal(row(&run, "ending")->grade, SF_GRADE_VALID);
        close_run(&run);
    }
    sound_run run = open_run(*state, (fixture_options){.status = "interrupted", .no_peak = true});
    sf_results_note(&run.results, "something else");
    judge(&run);
    assert_non_null(strstr(row(&run, "notes")->text, "first: something else"));
    close_run(&run);
}

/* The note is cut at 200 bytes, in the middle of a character. */
static void a_long_note_is_not_cut_inside_a_character(void **state) {
    sound_run run = open_run(*state, (fixture_options){0});
    char note[400] = "x";
    for (int k = 0; k < 150; k++)
        strcat(note, "\xc3\xa4");
    sf_results_note(&run.results, "%s", note);
    judge(&run);
    const char *text = row(&run, "notes")->text;
    assert_int_equal(strlen(strchr(text, 'x')), 199);
    assert_int_equal((unsigned char)text[strlen(text) - 1], 0xa4);
    close_run(&run);
}

static void the_line_names_three_findings_the_worst_first(void **state) {
    sound_run run = open_run(*state, (fixture_options){0});
    char line[SF_VERDICT_LINE_SIZE];
    run.figures.energy_error = 0.03;
    run.figures.stabilisation_energy_fraction = 0.03;
    run.figures.contact_energy_fraction = 0.03;
    judge(&run);
    sf_verdict_line(&run.verdict, line, sizeof line);
    assert_null(strstr(line, "more"));
    run.figures.max_mean_strain = 0.99;
    run.figures.raw_peak_rows = 1;
    assert_int_equal(judge(&run), SF_GRADE_DO_NOT_USE);
    sf_verdict_line(&run.verdict, line, sizeof line);
    const char *first = "do not use: indentation over the thickness 0.99", *last = "; and 2 more";
    if (strncmp(line, first, strlen(first)) != 0 || strcmp(line + strlen(line) - strlen(last), last) != 0 ||
        strstr(line, "contact energy"))
        fail_msg("%s", line);
    close_run(&run);
}

static void a_raw_peak_of_a_single_step_is_told_without_numbers(void **state) {
    sound_run run = open_run(*state, (fixture_options){0});
    run.figures.raw_peak_rows = 1;
    assert_int_equal(judge(&run), SF_GRADE_REMARKS);
    assert_string_equal(row(&run, "step_artefact")->text, "the raw peak is one or two time steps long");
    close_run(&run);
}

/* Nodes 0 to 9 of the fixture are compressed by more than 0.6905, and hold 2000 to 2090 J m-3 at the peak. */
static void strain_beyond_the_data_is_the_share_of_its_energy(void **state) {
    sound_run run = open_run(*state, (fixture_options){.informed_strain = 0.6905});
    double all = 0, beyond = 0;
    for (int i = 0; i < FIXTURE_NODES; i++) {
        all += 2000 + 10 * i;
        beyond += i < 10 ? 2000 + 10 * i : 0;
    }
    assert_int_equal(judge(&run), SF_GRADE_REMARKS);
    assert_close(row(&run, "informed")->value, beyond / all, 1e-9);
    close_run(&run);
    run = open_run(*state, (fixture_options){.informed_strain = 0.75});
    assert_int_equal(judge(&run), SF_GRADE_VALID);
    assert_close(row(&run, "informed")->value, 0, 0);
    close_run(&run);
}

static void what_a_run_does_not_define_is_not_judged(void **state) {
    sound_run run = open_run(*state, (fixture_options){0});
    run.figures.max_mean_strain = NAN;
    assert_int_equal(judge(&run), SF_GRADE_VALID);
    assert_non_null(strstr(row(&run, "anvil")->text, "not defined"));
    close_run(&run);
}

/* The fixture's base stays 50 mm below the top, in every frame. */
static void foam_below_the_anvil_is_a_remark_and_far_below_not_to_be_used(void **state) {
    const struct {
        double anvil, value;
        sf_grade grade;
    } cases[] = {{0.05, 0, SF_GRADE_VALID},
                 {0.045, 0.1, SF_GRADE_REMARKS},
                 {0.035, 0.3, SF_GRADE_DO_NOT_USE},
                 {0, NAN, SF_GRADE_VALID}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sound_run run = open_run(*state, (fixture_options){.anvil_depth = cases[k].anvil});
        assert_int_equal(judge(&run), cases[k].grade);
        assert_int_equal(row(&run, "below_anvil")->grade, cases[k].grade);
        assert_true(isnan(cases[k].value) == isnan(row(&run, "below_anvil")->value));
        if (!isnan(cases[k].value))
            assert_close(row(&run, "below_anvil")->value, cases[k].value, 1e-9);
        close_run(&run);
    }
}

static void limits_pass_and_fail_beside_the_verdict(void **state) {
    sound_run run = open_run(*state, (fixture_options){0}); /* 100 g, HIC 1658 */
    assert_int_equal(judge(&run), SF_GRADE_VALID);
    assert_int_equal(run.verdict.limit_count, 2);
    assert_true(run.verdict.limits[0].passed);
    assert_false(run.verdict.limits[1].passed);
    const sf_limits limits = {99, 1700};
    sf_verdict_compute(&run.results, &run.figures, &limits, &run.verdict);
    assert_false(run.verdict.limits[0].passed);
    assert_true(run.verdict.limits[1].passed);
    close_run(&run);
}

/* 100 g until the end on the anvil is no drop that keeps 200 g. */
static void limits_of_a_run_that_ended_early_are_not_judged(void **state) {
    const fixture_options early[] = {
        {.status = "the missile reached the anvil at t = 20 ms"},
        {.status = "the step is too small"},
        {.no_summary = true, .end_time = 0.7 * FIXTURE_DURATION},
        {.status = "interrupted", .end_time = 0.99 * FIXTURE_DURATION},
        {.status = "finished", .end_time = 0.5 * FIXTURE_DURATION},
        {.untouched = true},
    };
    for (size_t k = 0; k < sizeof early / sizeof early[0]; k++) {
        sound_run run = open_run(*state, early[k]);
        judge(&run);
        for (int l = 0; l < SF_LIMITS; l++) {
            assert_false(run.verdict.limits[l].judged);
            assert_false(run.verdict.limits[l].passed);
            assert_string_equal(sf_limit_phrase(&run.verdict.limits[l]), "not judged");
        }
        close_run(&run);
    }
    sound_run run = open_run(*state, (fixture_options){.status = "interrupted"}); /* after the rebound */
    judge(&run);
    assert_true(run.verdict.limits[0].judged && run.verdict.limits[0].passed);
    close_run(&run);
}

/* ---- softfall-post ---- */

static void assert_prints(program_place *p, const char *expression, const char *expected) {
    program_result r = program_shell(p,
                                     "python3 -c \"import json; s = json.load(open('out/summary.json')); "
                                     "v = s['verdict']; c = {r['key']: r for r in v['checks']}; print(%s)\"",
                                     expression);
    r.out[strcspn(r.out, "\n")] = '\0';
    if (r.code != 0 || strcmp(r.out, expected) != 0)
        fail_msg("%s: \"%s\", expected \"%s\" %s", expression, r.out, expected, r.err);
}

static void softfall_post_shows_the_verdict_first_and_in_summary_json(void **state) {
    program_place *p = *state;
    write_fixture(p, (fixture_options){.end_time = 0.95 * FIXTURE_DURATION});
    program_result r = program_succeed(p, "post", "results.h5 -o out --force --limit-hic=1700 --limit-g=50");
    const char *first = "Verdict: valid with remarks: deceleration left at the end";
    if (strncmp(r.out, first, strlen(first)) != 0)
        fail_msg("%s", r.out);
    assert_non_null(strstr(r.out, sf_good_run_rule_get(SF_CHECK_ended_in_contact)->why));
    assert_non_null(strstr(r.out, "limit of a_max     50: failed (100)"));
    assert_prints(p, "v['grade']", "valid with remarks");
    assert_prints(p, "c['ended_in_contact']['grade'], c['energy_error']['grade']",
                  "valid with remarks valid");
    assert_prints(p, "c['energy_error']['bound'], c['energy_error']['use_bound'], c['notes']['use_bound']",
                  "0.01 0.05 None");
    assert_prints(p, "all(r['why'] and r['unit'] and r['finding'] for r in v['checks'])", "True");
    assert_prints(p, "[(l['key'], l['bound'], l['passed']) for l in v['limits']]",
                  "[('a_max_g', 50, False), ('hic', 1700, True)]");
}

static void softfall_post_does_not_judge_the_limits_of_a_run_that_ended_on_the_anvil(void **state) {
    program_place *p = *state;
    write_fixture(p, (fixture_options){.status = "the missile reached the anvil at t = 20 ms"});
    program_result r = program_succeed(p, "post", "results.h5 -o out --force");
    assert_non_null(strstr(r.out, "limit of a_max    200: not judged (100)"));
    assert_null(strstr(r.out, ": passed"));
    assert_prints(p, "[l['passed'] for l in v['limits']]", "[None, None]");
}

/* The only thing to say of such a run is its own sentence. */
static void softfall_post_refuses_a_run_of_two_rows_with_the_sentence_of_its_end(void **state) {
    program_place *p = *state;
    write_fixture(p, (fixture_options){.status = "the missile reached the anvil at t = 20 ms", .nan_row = 2});
    program_result r = program_run(p, "post", "results.h5 -o out --force");
    assert_int_equal(r.code, 3);
    assert_non_null(strstr(r.err, "the missile reached the anvil at t = 20 ms"));
    assert_non_null(strstr(r.err, "2 usable rows"));
}

static void the_exit_status_of_strict_is_the_verdict(void **state) {
    program_place *p = *state;
    const struct {
        fixture_options options;
        int code;
    } cases[] = {
        {{0}, 0}, {{.end_time = 0.95 * FIXTURE_DURATION}, 8}, {{.end_time = 0.4 * FIXTURE_DURATION}, 9}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        write_fixture(p, cases[k].options);
        program_shell(p, "rm -rf out");
        assert_int_equal(program_run(p, "post", "results.h5 -o out --strict").code, cases[k].code);
        assert_int_equal(program_shell(p, "test -s out/summary.json -a -s out/history.csv").code, 0);
        assert_int_equal(program_run(p, "post", "results.h5 -o out --force").code, 0);
    }
}

/* The whole way from the solver's warning to the row, with a run that ends before contact. */
static void a_warning_of_softfall_solve_reaches_the_verdict(void **state) {
    program_place *p = *state;
    program_succeed(p, "pre",
                    "\"$SF_SOURCE_DIR/examples/eva50-v4.5/case.cfg\" -o m.h5 %s --set missile.gap='3 mm'",
                    program_coarse(25));
    program_result r =
        program_succeed(p, "solve", "m.h5 -o results.h5 --force -t 1 --no-checkpoint --end-time='0.3 ms'");
    assert_non_null(strstr(r.err, "never touched"));
    program_shell(p, "rm -rf out");
    assert_int_equal(program_run(p, "post", "results.h5 -o out --strict").code, 9);
    assert_prints(p, "s['notes']", "['the missile never touched the pad']");
    assert_prints(p, "c['notes']['value'], c['notes']['grade']", "0 valid");
    assert_prints(p, "c['ending']['value'], c['ending']['grade']", "2 do not use");
}

static double collapse_of_drop(program_place *p, const char *set) {
    program_succeed(p, "pre",
                    "\"$SF_SOURCE_DIR/examples/eva70-v6.2/case.cfg\" -o m.h5 --force %s "
                    "--set output.fields='[\"displacement\"]' --set solver.end_time='24 ms' %s",
                    program_coarse(25), set);
    program_succeed(p, "solve", "m.h5 -o results.h5 --force -t 1 --no-checkpoint");
    program_succeed(p, "post", "results.h5 -o out --force");
    program_result r = program_shell(p, "python3 -c \"import json; print(json.load(open('out/summary.json'))"
                                        "['local_collapse'])\"");
    return strtod(r.out, NULL);
}

/* A thick pad is strained three times more at its top than in the mean, and sound; a missile that a single
 * column of nodes carries is not. */
static void local_collapse_does_not_depend_on_the_thickness(void **state) {
    double bound = sf_good_run_limits()->local_collapse;
    assert_true(collapse_of_drop(*state, "") < bound);
    assert_true(collapse_of_drop(*state, "--set geometry.parameters.thickness=200.0") < bound);
    assert_true(collapse_of_drop(
                    *state,
                    "--set pad.mesh_error_limit=5 "
                    "--set geometry.missile_parameters.diameter=40.0 --set missile.mass='1 kg' "
                    "--set geometry.missile_parameters.element_size=5.0 --set missile.velocity='4.5 m/s'") >
                2 * bound);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sound_run_is_valid_in_every_row),
        cmocka_unit_test(a_figure_beyond_its_bound_is_a_remark_and_far_beyond_not_to_be_used),
        cmocka_unit_test(a_raw_peak_beyond_the_filtered_one_is_a_remark),
        cmocka_unit_test(a_local_strain_below_the_mean_shows_a_coarse_mesh),
        cmocka_unit_test(a_run_that_ends_on_the_way_down_is_not_to_be_used),
        cmocka_unit_test(a_run_that_ends_late_in_the_rebound_has_a_remark),
        cmocka_unit_test(failed_interrupted_and_untouched_runs_are_graded),
        cmocka_unit_test(what_the_solver_noted_is_a_remark),
        cmocka_unit_test(a_note_that_repeats_the_ending_is_not_counted),
        cmocka_unit_test(a_long_note_is_not_cut_inside_a_character),
        cmocka_unit_test(the_line_names_three_findings_the_worst_first),
        cmocka_unit_test(a_raw_peak_of_a_single_step_is_told_without_numbers),
        cmocka_unit_test(strain_beyond_the_data_is_the_share_of_its_energy),
        cmocka_unit_test(what_a_run_does_not_define_is_not_judged),
        cmocka_unit_test(foam_below_the_anvil_is_a_remark_and_far_below_not_to_be_used),
        cmocka_unit_test(limits_pass_and_fail_beside_the_verdict),
        cmocka_unit_test(limits_of_a_run_that_ended_early_are_not_judged),
        cmocka_unit_test(softfall_post_does_not_judge_the_limits_of_a_run_that_ended_on_the_anvil),
        cmocka_unit_test(softfall_post_refuses_a_run_of_two_rows_with_the_sentence_of_its_end),
        cmocka_unit_test(softfall_post_shows_the_verdict_first_and_in_summary_json),
        cmocka_unit_test(the_exit_status_of_strict_is_the_verdict),
        cmocka_unit_test(a_warning_of_softfall_solve_reaches_the_verdict),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(local_collapse_does_not_depend_on_the_thickness),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
