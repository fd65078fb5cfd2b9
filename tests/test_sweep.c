/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campaigns of which the drops are replaced by a formula. */
#include "sweep_fixture.h"

#include "study/sweep/analysis.h"
#include "study/sweep/campaign.h"
#include "study/sweep/sweep_report.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

#include "post_check.h"

static int64_t rows_done(const program_place *p, const sf_plan *plan, sweep_formula *f, bool retry,
                         uint64_t inputs) {
    sf_runs runs;
    sf_error err;
    if (sweep_campaign(p, plan, f, retry, inputs, &runs, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_runs_free(&runs);
    return f->calls;
}

/* A campaign of SWEEP_GRID that is finished. */
static void finish_grid(const program_place *p, sf_plan *plan, sweep_formula *f) {
    sweep_begin_plan(p, SWEEP_GRID, plan);
    rows_done(p, plan, f, false, 1);
}

static void an_interrupted_campaign_goes_on_with_the_same_table(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    sweep_formula f = {.fails = 3};
    sweep_begin_plan(p, SWEEP_GRID, &plan);
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 60);
    program_bytes whole = program_read_file(program_path(p, "runs.csv"));
    program_shell(p, "rm -f runs.csv sweep.key");
    f.stop_at = 25;
    assert_int_equal(sweep_campaign(p, &plan, &f, false, 1, &runs, &err), SF_INTERRUPTED);
    sf_runs_free(&runs);
    f.stop_at = 0;
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 35);
    program_assert_unchanged(program_path(p, "runs.csv"), &whole);
    sf_plan_free(&plan);
}

static void a_failed_run_keeps_its_sentence_and_is_done_again_on_request(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    sweep_formula f = {.fails = 3};
    finish_grid(p, &plan, &f);
    f.fails = -1;
    assert_int_equal(sweep_campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(f.calls, 0);
    assert_int_equal(runs.state[3], SF_SWEEP_FAILED);
    assert_string_equal(runs.message[3], "it failed, and said \"no\"; see log");
    sf_runs_free(&runs);
    assert_int_equal(rows_done(p, &plan, &f, true, 1), 1);
    assert_int_equal(rows_done(p, &plan, &f, true, 1), 0);
    sf_plan_free(&plan);
}

static void runs_are_looked_at_again_when_what_they_read_has_changed(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sweep_formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 60); /* contents of a file */
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 0);
    f.changed = true; /* what only the engine sees */
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 60);
    sf_plan_free(&plan);
}

/* The report of the rows as they were goes before the table turns to other inputs or another plan, or begins
 * anew, also if the campaign is then interrupted; it stays while nothing changes. */
static void an_old_report_does_not_stand_beside_another_table(void **state) {
    const program_place *p = *state;
    static const char *const report[] = {"report.html", "sweep.json", NULL};
    static const struct {
        const char *removed;
        uint64_t inputs;
        bool other, stays;
        int64_t calls;
    } steps[] = {
        {"", 1, false, true, 0},           {"", 2, false, false, 60},          {"", 2, false, true, 0},
        {"runs.csv", 2, false, false, 60}, {"sweep.key", 2, false, false, 60}, {"", 2, true, false, 1}};
    sf_plan plan, other;
    sweep_formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    sweep_read_plan(p, "{ key = \"a.x\"; values = [1, 2]; }, { key = \"a.y\"; values = [1]; }", &other);
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        sf_runs runs;
        sf_error err;
        const sf_sweep_campaign c = {.plan = steps[k].other ? &other : &plan,
                                     .folder = p->folder,
                                     .inputs = steps[k].inputs,
                                     .report = report,
                                     .force = steps[k].other};
        f.stop_at = steps[k].other ? 1 : 0;
        program_shell(p, "touch report.html sweep.json; rm -f ./%s", steps[k].removed);
        assert_int_equal(sweep_run_campaign(&c, &f, &runs, &err), steps[k].other ? SF_INTERRUPTED : SF_OK);
        assert_int_equal(f.calls, steps[k].calls);
        for (int r = 0; r < 2; r++)
            assert_int_equal(access(program_path(p, report[r]), F_OK) == 0, steps[k].stays);
        sf_runs_free(&runs);
    }
    sf_plan_free(&other);
    sf_plan_free(&plan);
}

/* Of the sixth folder, which ten rows name; without all of them nothing begins. */
static void results_that_were_removed_are_made_again(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *made;
        sf_status status;
        int64_t calls;
    } steps[] = {{"0 1 2 3 4 5", SF_OK, 0}, {"0 1 2 3 4", SF_OK, 10}, {"", SF_ERR_INPUT, 0}};
    sf_plan plan;
    sweep_formula f = {.fails = -1};
    char drops[600];
    snprintf(drops, sizeof drops, "%s/drops", p->folder);
    finish_grid(p, &plan, &f);
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        const sf_sweep_campaign c = {.plan = &plan, .folder = p->folder, .inputs = 1, .drops = drops};
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        program_shell(
            p,
            "rm -rf drops; for d in %s; do mkdir -p drops/drop-$d; touch drops/drop-$d/results.h5; done; mkdir -p drops",
            steps[k].made);
        assert_int_equal(sweep_run_campaign(&c, &f, &runs, &err), steps[k].status);
        assert_true(!err.text[0] || strstr(err.text, "drops has the results of none of them"));
        assert_int_equal(f.calls, steps[k].calls);
        sf_runs_free(&runs);
    }
    sf_plan_free(&plan);
}

/* One row could be simulated, the second could not: neither the other rows nor the report are those of the
 * files as they are. The same if the inputs change while the campaign runs: then not even one is. */
static void a_campaign_that_ends_early_after_a_change_leaves_no_row_and_no_report(void **state) {
    const program_place *p = *state;
    static const char *const report[] = {"report.html", NULL};
    for (int k = 0; k < 2; k++) {
        sf_plan plan;
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        sweep_formula f = {.fails = -1};
        sweep_begin_plan(
            p, "{ key = \"geometry.x\"; values = [1, 2, 3]; }, { key = \"a.y\"; values = [1, 2]; }", &plan);
        rows_done(p, &plan, &f, false, 1);
        const sf_sweep_campaign c = {.plan = &plan,
                                     .folder = p->folder,
                                     .inputs = 1,
                                     .look = k == 1 ? sweep_look_at_inputs : NULL,
                                     .report = report};
        f = (sweep_formula){.fails = -1, .changed = k == 0, .stop_at = k == 0 ? 1 : 0};
        sweep_present_inputs = k == 1 ? 99 : 1;
        program_shell(p, "touch report.html");
        assert_int_equal(sweep_run_campaign(&c, &f, &runs, &err), k == 0 ? SF_INTERRUPTED : SF_ERR_IO);
        assert_int_equal(sf_runs_count(&runs, SF_SWEEP_OPEN), k == 0 ? 5 : 6);
        assert_int_equal(access(program_path(p, "report.html"), F_OK), -1);
        assert_int_equal(program_shell(p, "grep -c ',open,' runs.csv").out[0], k == 0 ? '5' : '6');
        sf_runs_free(&runs);
        sf_plan_free(&plan);
    }
}

/* A run that failed may have read what has changed, too. */
static void a_failed_run_is_looked_at_again_when_what_only_the_geometry_reads_has_changed(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    sweep_formula f = {.fails = 3};
    finish_grid(p, &plan, &f);
    f.fails = -1;
    f.changed = true;
    assert_int_equal(sweep_campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(runs.state[3], SF_SWEEP_DONE);
    assert_int_equal(sf_runs_count(&runs, SF_SWEEP_DONE), 60);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* There is no finished run by which a change of its files would show. */
static void failed_runs_of_a_geometry_without_a_finished_one_are_looked_at_again(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sweep_formula f = {.fails = 1};
    sweep_begin_plan(p,
                     "{ key = \"geometry.parameters.thickness\"; values = [40, 50, 60]; },"
                     "{ key = \"a.y\"; values = [1]; }",
                     &plan);
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 3);
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 1);
    f.fails = -1;
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 1);
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 0);
    sf_plan_free(&plan);
}

/* Rows before and after the change are not mixed, also where the inputs are put back before the next start,
 * and where the campaign was interrupted meanwhile. */
static void inputs_that_change_while_it_runs_leave_no_row(void **state) {
    const program_place *p = *state;
    for (int64_t stop_at = 0; stop_at < 80; stop_at += 40) {
        sf_plan plan;
        sf_runs runs;
        sf_error err;
        sweep_formula f = {.fails = 3, .edits_at = 25, .stop_at = stop_at};
        sweep_begin_plan(p, SWEEP_GRID, &plan);
        assert_int_equal(sweep_campaign(p, &plan, &f, false, 1, &runs, &err),
                         stop_at ? SF_INTERRUPTED : SF_ERR_IO);
        if (!stop_at)
            assert_non_null(strstr(err.text, "the inputs of the campaign changed while it ran"));
        assert_int_equal(sf_runs_count(&runs, SF_SWEEP_OPEN), 60);
        sf_runs_free(&runs);
        f.edits_at = f.stop_at = 0;
        assert_int_equal(rows_done(p, &plan, &f, false, 1), 60);
        sf_plan_free(&plan);
    }
}

/* As a spreadsheet saves it: rows in another order, a figure or a level with fewer digits. */
/* Of each geometry the first and the last row that is done: a failed one is none. */
static void a_geometry_that_changes_while_it_runs_leaves_no_row(void **state) {
    const program_place *p = *state;
    static const char *const report[] = {"report.html", NULL};
    static const struct {
        int64_t stale;
        sf_status status;
    } steps[] = {{0, SF_OK}, {6, SF_ERR_IO}, {10, SF_ERR_IO}, {11, SF_OK}, {8, SF_OK}};
    sf_plan plan;
    sweep_read_plan(p,
                    "{ key = \"geometry.parameters.x\"; from = 1.0; to = 4.0; count = 10; },"
                    "{ key = \"a.y\"; uncertain = true; values = (1, 2, 3, 4, 5, 6); }",
                    &plan);
    for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
        sweep_formula f = {.fails = 11, .stale = steps[k].stale};
        const sf_sweep_campaign c = {.plan = &plan, .folder = p->folder, .inputs = 1, .report = report};
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        program_shell(p, "rm -f runs.csv sweep.key; touch report.html");
        assert_int_equal(sweep_run_campaign(&c, &f, &runs, &err), steps[k].status);
        assert_true(!err.text[0] || strstr(err.text, "includes or merges, or its result, changed while"));
        assert_int_equal(sf_runs_count(&runs, SF_SWEEP_OPEN), err.text[0] ? 60 : 0);
        assert_int_not_equal(access(program_path(p, "report.html"), F_OK), 0);
        sf_runs_free(&runs);
    }
    sf_plan_free(&plan);
}

static void a_table_that_was_edited_is_not_believed(void **state) {
    const program_place *p = *state;
    static const char *const edits[] = {
        "(head -1 runs.csv; tail -n +2 runs.csv | sort -r) > new", "sed '5s/933.333333/933/' runs.csv > new",
        "sed '8s/1.33333333333/1.33/' runs.csv > new", "sed '$d' runs.csv > new"};
    for (size_t k = 0; k < sizeof edits / sizeof edits[0]; k++) {
        sf_plan plan;
        sweep_formula f = {.fails = -1};
        finish_grid(p, &plan, &f);
        program_bytes whole = program_read_file(program_path(p, "runs.csv"));
        assert_int_equal(program_shell(p, "%s && ! cmp new runs.csv && mv new runs.csv", edits[k]).code, 0);
        if (rows_done(p, &plan, &f, false, 1) != 60)
            fail_msg("after %s rows are believed", edits[k]);
        program_assert_unchanged(program_path(p, "runs.csv"), &whole);
        sf_plan_free(&plan);
    }
}

/* Few drops for each job would leave processors idle at the end of each piece. */
static void a_piece_has_as_many_rows_for_each_job(void **state) {
    (void)state;
    sf_runner runner = {.threads = 1};
    assert_int_equal(sf_sweep_drops(&runner, 1).piece, 32);
    assert_int_equal(sf_sweep_drops(&runner, 64).piece, 64 * 32);
}

/* In a process of its own, which may write files of so many bytes (0: any). */
static void run_in_child(const program_place *p, const sf_plan *plan, sweep_formula f, uint64_t inputs,
                         rlim_t most) {
    pid_t child = fork();
    if (child == 0) {
        const struct rlimit limit = {most, most};
        sf_runs runs;
        sf_error err;
        signal(SIGXFSZ, SIG_IGN);
        if (most > 0)
            setrlimit(RLIMIT_FSIZE, &limit);
        sweep_campaign(p, plan, &f, false, inputs, &runs, &err);
        _exit(0);
    }
    waitpid(child, NULL, 0);
}

/* A spreadsheet computes a cell that begins with one of = + - @: an apostrophe stands before such a text. */
static void no_cell_is_a_formula(void **state) {
    const program_place *p = *state;
    static const char *const texts[] = {"=1+2", "+cmd|x", "-rm \"a\"", "@SUM(A1)", "'quoted", "-5.5"};
    enum { COUNT = sizeof texts / sizeof *texts };
    sf_plan plan;
    sf_runs runs, again;
    sf_error err = SF_ERROR_INIT;
    uint64_t hash = 0;
    sweep_read_plan(p, "{ key = \"a.y\"; values = [1, 2, 3, 4, 5, 6]; }", &plan);
    assert_int_equal(sf_runs_create(&plan, &runs, &err), SF_OK);
    for (int k = 0; k < COUNT; k++)
        assert_int_equal(sf_runs_failed(&runs, k, texts[k], &err), SF_OK);
    assert_int_equal(sf_runs_write(&runs, program_path(p, "cells.csv"), &hash, &err), SF_OK);
    assert_int_equal(program_shell(p, "grep -c \"\\\"'[=+@-]\" cells.csv").out[0], '4');
    assert_int_equal(sf_runs_create(&plan, &again, &err), SF_OK);
    assert_int_equal(sf_runs_read(&again, program_path(p, "cells.csv"), hash, &err), SF_OK);
    for (int k = 0; k < COUNT; k++)
        assert_string_equal(again.message[k], texts[k]);
    sf_runs_free(&runs);
    sf_runs_free(&again);
    sf_plan_free(&plan);
}

/* Killed after it has found that what only the engine sees has changed: no row is believed any more. */
static void a_killed_look_leaves_no_old_figures(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sweep_read_plan(p, SWEEP_GRID, &plan);
    for (int dies_at = 1; dies_at < 3; dies_at++) {
        program_shell(p, "rm -f runs.csv sweep.key");
        sweep_formula f = {.fails = -1};
        rows_done(p, &plan, &f, false, 1);
        run_in_child(p, &plan, (sweep_formula){.fails = -1, .changed = true, .dies_at = dies_at}, 1, 0);
        assert_int_equal(rows_done(p, &plan, &f, false, 1), 60);
    }
    sf_plan_free(&plan);
}

/* The key of new inputs is small enough for the disk, the table is not. */
static void a_table_that_cannot_be_written_is_not_that_of_new_inputs(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sweep_formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    run_in_child(p, &plan, f, 2, 400);
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 60);
    sf_plan_free(&plan);
}

/* Only 64 were looked at. */
static void each_geometry_is_looked_at(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sweep_formula f = {.fails = -1};
    sweep_begin_plan(p,
                     "{ key = \"geometry.parameters.thickness\"; from = 40.0; to = 60.0; count = 90; },"
                     "{ key = \"a.y\"; values = [1, 2]; }",
                     &plan);
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 180);
    f.other = 178;
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 180);
    f.other = 180;
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 0);
    sf_plan_free(&plan);
}

static void the_folder_of_another_plan_is_refused(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    sweep_formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    sf_plan_free(&plan);
    program_bytes before = program_read_file(program_path(p, "runs.csv"));
    sweep_read_plan(p, "{ key = \"a.x\"; values = [1.0, 2.0]; }, { key = \"a.y\"; values = [1]; }", &plan);
    assert_int_equal(sweep_campaign(p, &plan, &f, false, 1, &runs, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "holds the runs of another plan"));
    sf_runs_free(&runs);
    sf_plan_free(&plan);
    program_assert_unchanged(program_path(p, "runs.csv"), &before);
}

/* What an estimate counts: rows of other inputs and, on request, those that failed. */
static void an_estimate_counts_the_rows_that_are_done_again(void **state) {
    const program_place *p = *state;
    static const struct {
        uint64_t inputs;
        bool retry;
        int64_t open;
    } cases[] = {{1, false, 0}, {1, true, 1}, {2, false, 60}};
    sf_plan plan;
    sweep_formula f = {.fails = 3};
    finish_grid(p, &plan, &f);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const sf_sweep_campaign c = {
            .plan = &plan, .folder = p->folder, .inputs = cases[k].inputs, .retry = cases[k].retry};
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        int64_t open = -1;
        if (sf_runs_create(&plan, &runs, &err) != SF_OK ||
            sf_sweep_campaign_status(&c, &runs, &open, &err) != SF_OK)
            fail_msg("%s", err.text);
        assert_int_equal(open, cases[k].open);
        assert_int_equal(sf_runs_count(&runs, SF_SWEEP_DONE), 59); /* they tell the time of a run */
        sf_runs_free(&runs);
    }
    sf_plan_free(&plan);
}

static void a_disk_that_is_too_small_is_refused(void **state) {
    const program_place *p = *state;
    sf_sweep_cost cost = {.seconds = 1, .bytes = 1e6, .work_bytes = 1e7, .open = 10};
    sf_error err = SF_ERROR_INIT;
    char folder[600];
    snprintf(folder, sizeof folder, "%s/not/there/yet", p->folder);
    assert_int_equal(sf_sweep_cost_check_disk(&cost, folder, 2, &err), SF_OK);
    cost.open = INT64_C(1000000000000);
    assert_int_equal(sf_sweep_cost_check_disk(&cost, folder, 2, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the runs need about 1e+09 GB and the disk of "));
    err = (sf_error)SF_ERROR_INIT;
    cost.there = cost.open - 10; /* they may be drops of another plan */
    assert_int_equal(sf_sweep_cost_check_disk(&cost, folder, 2, &err), SF_ERR_INPUT);
    err = (sf_error)SF_ERROR_INIT;
    cost = (sf_sweep_cost){.bytes = 1, .work_bytes = 1e18, .open = 1}; /* each job has a drop at work */
    assert_int_equal(sf_sweep_cost_check_disk(&cost, folder, 3, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the runs need about 3e+09 GB"));
}

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Plans, runs, interrupts, resumes and evaluates; the drops themselves cost nothing. */
static void a_hundred_thousand_runs_take_less_than_a_minute_and_a_gigabyte(void **state) {
    const program_place *p = *state;
    double begin = seconds();
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
    sf_error err;
    sweep_formula f = {.fails = 77, .stop_at = 50000};
    struct rusage usage;
    sweep_begin_plan(p,
                     "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 100; },"
                     "{ sample = \"sobol\"; count = 1000; of = ( { key = \"a.y\"; low = 0.0; high = 9.0; },"
                     "{ key = \"a.z\"; low = \"1 mm\"; high = \"2 mm\"; } ); }",
                     &plan);
    assert_int_equal(plan.rows, 100000);
    assert_int_equal(sweep_campaign(p, &plan, &f, false, 1, &runs, &err), SF_INTERRUPTED);
    sf_runs_free(&runs);
    f.stop_at = 0;
    assert_int_equal(sweep_campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(f.calls, 50000);
    assert_int_equal(sf_analysis_make(&runs, &a, &err), SF_OK);
    assert_int_equal(a.done, 99999);
    assert_int_equal(a.probability.cells, 100);
    getrusage(RUSAGE_SELF, &usage);
    print_message("100000 runs: %.1f s, %.0f MB\n", seconds() - begin, (double)usage.ru_maxrss / 1e3);
    assert_true(seconds() - begin < 60);
    assert_true(usage.ru_maxrss < 1000000);
    sf_analysis_free(&a);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_interrupted_campaign_goes_on_with_the_same_table),
        cmocka_unit_test(a_failed_run_keeps_its_sentence_and_is_done_again_on_request),
        cmocka_unit_test(runs_are_looked_at_again_when_what_they_read_has_changed),
        cmocka_unit_test(an_old_report_does_not_stand_beside_another_table),
        cmocka_unit_test(results_that_were_removed_are_made_again),
        cmocka_unit_test(a_campaign_that_ends_early_after_a_change_leaves_no_row_and_no_report),
        cmocka_unit_test(a_failed_run_is_looked_at_again_when_what_only_the_geometry_reads_has_changed),
        cmocka_unit_test(failed_runs_of_a_geometry_without_a_finished_one_are_looked_at_again),
        cmocka_unit_test(inputs_that_change_while_it_runs_leave_no_row),
        cmocka_unit_test(a_geometry_that_changes_while_it_runs_leaves_no_row),
        cmocka_unit_test(a_table_that_was_edited_is_not_believed),
        cmocka_unit_test(a_piece_has_as_many_rows_for_each_job),
        cmocka_unit_test(no_cell_is_a_formula),
        cmocka_unit_test(a_killed_look_leaves_no_old_figures),
        cmocka_unit_test(a_table_that_cannot_be_written_is_not_that_of_new_inputs),
        cmocka_unit_test(each_geometry_is_looked_at),
        cmocka_unit_test(the_folder_of_another_plan_is_refused),
        cmocka_unit_test(an_estimate_counts_the_rows_that_are_done_again),
        cmocka_unit_test(a_disk_that_is_too_small_is_refused),
        cmocka_unit_test(a_hundred_thousand_runs_take_less_than_a_minute_and_a_gigabyte),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
