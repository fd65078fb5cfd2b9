/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Campaigns of which the drops are replaced by a formula, and what is computed of their rows. */
#include "model_fixture.h"
#include "program_fixture.h"
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

/* ---- campaigns, with a formula in place of the drops ---- */

typedef struct formula {
    int64_t calls;    /* rows so far */
    int64_t stop_at;  /* interrupted before that many; 0: not */
    int64_t fails;    /* this row fails; -1: none */
    bool changed;     /* what was there is of other files, until that was found out */
    int64_t other;    /* the same from this row on; 0: of none */
    int64_t dies_at;  /* the process ends after that many; 0: not */
    int64_t edits_at; /* the inputs change after that many; 0: not */
    int64_t stale;    /* this row is no longer what its geometry's files give; 0: none */
} formula;

static uint64_t present_inputs;

static sf_status look_at_inputs(const sf_plan *plan, uint64_t *hash, sf_error *err) {
    (void)plan;
    *hash = present_inputs;
    return err->status;
}

static sf_status evaluate(void *context, sf_runs *runs, int count, const int64_t *row, int *fresh,
                          sf_error *err) {
    formula *f = context;
    *fresh = 0;
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        if (f->stop_at > 0 && f->calls == f->stop_at)
            return SF_FAIL(err, SF_INTERRUPTED, "interrupted");
        f->calls++;
        *fresh += 1;
        if (f->dies_at > 0 && f->calls == f->dies_at)
            _exit(0);
        if (f->edits_at > 0 && f->calls == f->edits_at)
            present_inputs = 99;
        if (row[k] == f->fails) {
            sf_runs_failed(runs, row[k], "it failed, and said \"no\"; see log", err);
            continue;
        }
        double *place = sf_runs_place(runs, row[k]), x = sf_plan_value(runs->plan, 0, row[k]);
        place[sf_runs_figure("a_max_g")] = 100 * sqrt(x) + sf_plan_value(runs->plan, 1, row[k]) / 3;
        place[sf_runs_figure("hic")] = 900 + 100 * x / 3;
        place[sf_runs_figure("hic_scatter")] = 0.01;
        char folder[32];
        snprintf(folder, sizeof folder, "drop-%lld", (long long)row[k] % 6);
        sf_runs_done(runs, row[k], SF_GRADE_VALID, folder, NULL, err);
    }
    return err->status;
}

static bool is_current(void *context, const sf_runs *runs, int64_t row) {
    formula *f = context;
    bool changed = f->changed || (f->other > 0 && row >= f->other);
    if (changed) {
        f->changed = false;
        f->other = 0;
    }
    return runs->state[row] == SF_SWEEP_DONE && !changed && (f->stale == 0 || row != f->stale);
}

static const char *const GRID = "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 10; },"
                                "{ key = \"a.y\"; uncertain = true; values = (1, 2, 3, 4, 5, 6); }";

/* Runs the campaign by the formula, in pieces of seven rows; sf_runs_free in any case. */
static sf_status run_campaign(const sf_sweep_campaign *c, formula *f, sf_runs *runs, sf_error *err) {
    const sf_sweep_engine engine = {evaluate, f, 7, is_current};
    *err = (sf_error)SF_ERROR_INIT;
    f->calls = 0;
    if (sf_runs_create(c->plan, runs, err) == SF_OK)
        sf_sweep_campaign_run(c, &engine, runs, err);
    return err->status;
}

static sf_status campaign(const program_place *p, const sf_plan *plan, formula *f, bool retry,
                          uint64_t inputs, sf_runs *runs, sf_error *err) {
    const sf_sweep_campaign c = {
        .plan = plan, .folder = p->folder, .inputs = inputs, .look = look_at_inputs, .retry = retry};
    present_inputs = inputs;
    return run_campaign(&c, f, runs, err);
}

static int64_t rows_done(const program_place *p, const sf_plan *plan, formula *f, bool retry,
                         uint64_t inputs) {
    sf_runs runs;
    sf_error err;
    if (campaign(p, plan, f, retry, inputs, &runs, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_runs_free(&runs);
    return f->calls;
}

/* A plan of which nothing is done. */
static void begin_plan(const program_place *p, const char *factors, sf_plan *plan) {
    sweep_read_plan(p, factors, plan);
    program_shell(p, "rm -f runs.csv sweep.key");
}

/* A campaign of GRID that is finished. */
static void finish_grid(const program_place *p, sf_plan *plan, formula *f) {
    begin_plan(p, GRID, plan);
    rows_done(p, plan, f, false, 1);
}

/* The rows of a plan by the formula, of which row `fails` fails (-1: none), and what is computed of them. */
typedef struct evaluated {
    sf_plan plan;
    sf_runs runs;
    sf_analysis a;
} evaluated;

static void evaluate_plan(const program_place *p, const char *factors, int64_t fails, evaluated *e) {
    formula f = {.fails = fails};
    sf_error err;
    begin_plan(p, factors, &e->plan);
    if (campaign(p, &e->plan, &f, false, 1, &e->runs, &err) != SF_OK ||
        sf_analysis_make(&e->runs, &e->a, &err) != SF_OK)
        fail_msg("%s", err.text);
}

static void free_evaluated(evaluated *e) {
    sf_analysis_free(&e->a);
    sf_runs_free(&e->runs);
    sf_plan_free(&e->plan);
}

static void an_interrupted_campaign_goes_on_with_the_same_table(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    sf_runs runs;
    sf_error err;
    formula f = {.fails = 3};
    begin_plan(p, GRID, &plan);
    assert_int_equal(rows_done(p, &plan, &f, false, 1), 60);
    program_bytes whole = program_read_file(program_path(p, "runs.csv"));
    program_shell(p, "rm -f runs.csv sweep.key");
    f.stop_at = 25;
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_INTERRUPTED);
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
    formula f = {.fails = 3};
    finish_grid(p, &plan, &f);
    f.fails = -1;
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
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
    formula f = {.fails = -1};
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
    formula f = {.fails = -1};
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
        assert_int_equal(run_campaign(&c, &f, &runs, &err), steps[k].other ? SF_INTERRUPTED : SF_OK);
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
    formula f = {.fails = -1};
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
        assert_int_equal(run_campaign(&c, &f, &runs, &err), steps[k].status);
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
        formula f = {.fails = -1};
        begin_plan(p, "{ key = \"geometry.x\"; values = [1, 2, 3]; }, { key = \"a.y\"; values = [1, 2]; }",
                   &plan);
        rows_done(p, &plan, &f, false, 1);
        const sf_sweep_campaign c = {.plan = &plan,
                                     .folder = p->folder,
                                     .inputs = 1,
                                     .look = k == 1 ? look_at_inputs : NULL,
                                     .report = report};
        f = (formula){.fails = -1, .changed = k == 0, .stop_at = k == 0 ? 1 : 0};
        present_inputs = k == 1 ? 99 : 1;
        program_shell(p, "touch report.html");
        assert_int_equal(run_campaign(&c, &f, &runs, &err), k == 0 ? SF_INTERRUPTED : SF_ERR_IO);
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
    formula f = {.fails = 3};
    finish_grid(p, &plan, &f);
    f.fails = -1;
    f.changed = true;
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
    assert_int_equal(runs.state[3], SF_SWEEP_DONE);
    assert_int_equal(sf_runs_count(&runs, SF_SWEEP_DONE), 60);
    sf_runs_free(&runs);
    sf_plan_free(&plan);
}

/* There is no finished run by which a change of its files would show. */
static void failed_runs_of_a_geometry_without_a_finished_one_are_looked_at_again(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    formula f = {.fails = 1};
    begin_plan(p,
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
        formula f = {.fails = 3, .edits_at = 25, .stop_at = stop_at};
        begin_plan(p, GRID, &plan);
        assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), stop_at ? SF_INTERRUPTED : SF_ERR_IO);
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
        formula f = {.fails = 11, .stale = steps[k].stale};
        const sf_sweep_campaign c = {.plan = &plan, .folder = p->folder, .inputs = 1, .report = report};
        sf_runs runs;
        sf_error err = SF_ERROR_INIT;
        program_shell(p, "rm -f runs.csv sweep.key; touch report.html");
        assert_int_equal(run_campaign(&c, &f, &runs, &err), steps[k].status);
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
        formula f = {.fails = -1};
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
static void run_in_child(const program_place *p, const sf_plan *plan, formula f, uint64_t inputs,
                         rlim_t most) {
    pid_t child = fork();
    if (child == 0) {
        const struct rlimit limit = {most, most};
        sf_runs runs;
        sf_error err;
        signal(SIGXFSZ, SIG_IGN);
        if (most > 0)
            setrlimit(RLIMIT_FSIZE, &limit);
        campaign(p, plan, &f, false, inputs, &runs, &err);
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
    sweep_read_plan(p, GRID, &plan);
    for (int dies_at = 1; dies_at < 3; dies_at++) {
        program_shell(p, "rm -f runs.csv sweep.key");
        formula f = {.fails = -1};
        rows_done(p, &plan, &f, false, 1);
        run_in_child(p, &plan, (formula){.fails = -1, .changed = true, .dies_at = dies_at}, 1, 0);
        assert_int_equal(rows_done(p, &plan, &f, false, 1), 60);
    }
    sf_plan_free(&plan);
}

/* The key of new inputs is small enough for the disk, the table is not. */
static void a_table_that_cannot_be_written_is_not_that_of_new_inputs(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    run_in_child(p, &plan, f, 2, 400);
    assert_int_equal(rows_done(p, &plan, &f, false, 2), 60);
    sf_plan_free(&plan);
}

/* Only 64 were looked at. */
static void each_geometry_is_looked_at(void **state) {
    const program_place *p = *state;
    sf_plan plan;
    formula f = {.fails = -1};
    begin_plan(p,
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
    formula f = {.fails = -1};
    finish_grid(p, &plan, &f);
    sf_plan_free(&plan);
    program_bytes before = program_read_file(program_path(p, "runs.csv"));
    sweep_read_plan(p, "{ key = \"a.x\"; values = [1.0, 2.0]; }, { key = \"a.y\"; values = [1]; }", &plan);
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "holds the runs of another plan"));
    sf_runs_free(&runs);
    sf_plan_free(&plan);
    program_assert_unchanged(program_path(p, "runs.csv"), &before);
}

/* Counts: below at x <= 3 (hic 1000 at 3), all of y alike. */
static void the_probability_is_over_what_is_uncertain(void **state) {
    evaluated done;
    const sf_analysis *a = &done.a;
    evaluate_plan(*state, GRID, 3, &done);
    assert_int_equal(a->probability.cells, 10);
    for (int k = 0; k < 10; k++) {
        const sf_probability *hic = &a->probability.cell[a->probability.cells + k];
        double x = 1 + 3 * k / 9.0;
        assert_int_equal(hic->unknown, k == 0);
        assert_int_equal(hic->below, x < 3 - 1e-9 ? 6 - (k == 0) : 0);
        assert_int_equal(hic->above, x < 3 - 1e-9 ? 0 : 6);
        assert_int_equal(hic->within, k >= 5 && k <= 7 ? 6 : 0); /* from 981 to 1020 */
    }
    free_evaluated(&done);
    /* whole, so that means are over the same rows: a_max moves by 100 with x, by 5/3 with y */
    evaluate_plan(*state, GRID, -1, &done);
    assert_relative(a->effect[0][0].last - a->effect[0][0].first, 100, 1e-8);
    assert_relative(a->effect[0][1].high - a->effect[0][1].low, 5.0 / 3, 1e-6);
    assert_true(a->surface[1].fit.q2 > 0.999999); /* hic is linear */
    free_evaluated(&done);
}

/* Of 40,000 rows every second one would be of the same level of the factor that changes fastest. */
static void a_surface_of_very_many_rows_has_every_level(void **state) {
    evaluated done;
    evaluate_plan(
        *state,
        "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 20000; }, { key = \"a.y\"; values = [1, 2]; }", -1,
        &done);
    const sf_sweep_surface *surface = &done.a.surface[1];
    assert_string_equal(surface->fit.problem, "");
    assert_int_equal(surface->rows, SF_SURFACE_ROWS);
    assert_int_equal(surface->of, 40000);
    assert_true(surface->fit.q2 > 0.999999); /* hic is linear */
    free_evaluated(&done);
}

static const char *const SAMPLED_DRAWS = "{ sample = \"latin_hypercube\"; count = 40; of = ("
                                         "{ key = \"a.x\"; low = 1.0; high = 4.0; },"
                                         "{ key = \"a.y\"; values = [1, 2]; },"
                                         "{ key = \"material\"; posterior = \"ten\"; } ); }";

/* Twenty rows, each of other numbers: no mean of one row is an effect. a_max = 100 sqrt(x) + y / 3 has 100
 * from x and 3 from y between 0 and 9, the surface is off by 1 or so; z does nothing. */
static void numbers_that_are_sampled_have_the_effect_of_the_surface(void **state) {
    evaluated done;
    evaluate_plan(
        *state,
        "{ sample = \"latin_hypercube\"; count = 20; of = ( { key = \"a.x\"; low = 1.0; high = 4.0; },"
        "{ key = \"a.y\"; low = 0.0; high = 9.0; }, { key = \"a.z\"; low = 0.0; high = 1.0; } ); }",
        -1, &done);
    assert_true(done.a.surface[0].fit.q2 > 0.99);
    const sf_effect *e = done.a.effect[0];
    const double expected[3] = {100 * (sqrt(4) - sqrt(1)), 3, 0};
    for (int k = 0; k < 3; k++) {
        const double *value = done.plan.factor[k].value;
        double range = k == 0 ? 3 : k == 1 ? 9 : 1, least = INFINITY, greatest = -INFINITY;
        for (int row = 0; row < 20; row++) {
            least = value[row] < least ? value[row] : least;
            greatest = value[row] > greatest ? value[row] : greatest;
        }
        assert_close(e[k].last - e[k].first, expected[k] * (greatest - least) / range, 4);
        assert_true(e[k].low <= e[k].first && e[k].high >= e[k].last);
    }
    free_evaluated(&done);
}

/* A run of x = 1 fails: without it the mean of its y would be that of greater x, 22 more than that of the
 * other y. */
static void main_effects_are_over_combinations_that_are_whole(void **state) {
    evaluated done;
    evaluate_plan(*state, GRID, 3, &done);
    const sf_effect *x = &done.a.effect[0][0], *y = &done.a.effect[0][1];
    assert_int_equal(x->used, 5);
    assert_int_equal(x->of, 6);
    assert_int_equal(y->used, 9);
    assert_int_equal(y->of, 10);
    assert_relative(x->last - x->first, 100, 1e-8);
    assert_relative(y->high - y->low, 5.0 / 3, 1e-6);
    free_evaluated(&done);
}

static void draws_that_are_sampled_with_others_have_no_main_effect(void **state) {
    evaluated done;
    sweep_make_posterior(*state);
    evaluate_plan(*state, SAMPLED_DRAWS, -1, &done);
    assert_true(isnan(done.a.effect[0][2].low) && isnan(done.a.effect[0][2].high));
    assert_true(done.a.effect[0][0].high > done.a.effect[0][0].low);
    assert_true(sf_effect_is_scatter(&done.plan, 2));
    done.plan.block[done.plan.block_of[2]].rows =
        SF_EFFECT_RUNS * done.plan.factor[2].count; /* so many have a mean */
    assert_false(sf_effect_is_scatter(&done.plan, 2));
    done.plan.block[done.plan.block_of[2]].rows = 40;
    free_evaluated(&done);
    evaluate_plan(*state, "{ key = \"a.x\"; values = [1, 2]; }, { key = \"material\"; posterior = \"ten\"; }",
                  -1, &done); /* crossed: a_max moves by 9/3 with the index of the draw */
    assert_relative(done.a.effect[0][1].high - done.a.effect[0][1].low, 0.9 * 3, 1e-6);
    free_evaluated(&done);
}

/* Ten draws in 40 rows are ten foams. */
static void draws_that_are_sampled_count_once_in_the_interval(void **state) {
    evaluated done;
    sweep_make_posterior(*state);
    evaluate_plan(*state, SAMPLED_DRAWS, -1, &done);
    assert_int_equal(done.a.probability.cells, 1);
    sf_probability ten = done.a.probability.cell[1];
    assert_int_equal(ten.below + ten.above, 40);
    sf_probability_judge(&ten, 10);
    assert_close(done.a.probability.cell[1].low, ten.low, 1e-12);
    assert_close(done.a.probability.cell[1].high, ten.high, 1e-12);
    free_evaluated(&done);
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
    formula f = {.fails = 3};
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

/* Six rows of three words. */
static void a_word_that_a_zip_repeats_is_one_level(void **state) {
    evaluated done;
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    evaluate_plan(*state,
                  "{ zip = ( { key = \"a.x\"; values = [1, 1, 1, 4, 4, 4]; },"
                  "{ key = \"pad.base\"; values = [\"glued\", \"glued\", \"smooth\", \"smooth\", \"glued\","
                  " \"resting\"]; } ); }",
                  -1, &done);
    static const int level[] = {0, 0, 1, 1, 0, 2};
    assert_int_equal(done.plan.rows, 6);
    assert_int_equal(done.plan.factor[1].count, 3);
    for (int64_t row = 0; row < 6; row++)
        assert_int_equal((int)sf_plan_value(&done.plan, 1, row), level[row]);
    sf_plan_overrides(&done.plan, 5, text);
    assert_string_equal(text[1], "pad.base=\"resting\"");
    /* of a_max: glued 100, 100, 200; smooth 100 + 1/3, 200 + 1/3; resting 200 + 2/3 */
    assert_relative(done.a.effect[0][1].low, 400.0 / 3, 1e-8);
    assert_relative(done.a.effect[0][1].high, 200 + 2.0 / 3, 1e-8);
    free_evaluated(&done);
}

/* Scripts and pictures of a campaign, beside runs.csv. */
static void draw(const program_place *p, const sf_analysis *a) {
    static const char *const names[] = {"factors.gp",     "factors.png",     "curves.gp",  "curves.png",
                                        "effects.gp",     "effects.png",     "surface.gp", "surface.png",
                                        "probability.gp", "probability.png", NULL};
    char warning[320];
    sf_staging output = {0};
    sf_error err = SF_ERROR_INIT;
    if (sf_staging_begin(program_path(p, "drawn"), names, true, &output, &err) != SF_OK ||
        sf_sweep_plot(&output, a, p->folder, warning, sizeof warning, &err) != SF_OK ||
        sf_staging_commit(&output, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_staging_end(&output);
    assert_string_equal(warning, "");
}

/* Of one run there is no effect, and a figure may be of no run: gnuplot ends where all of a panel is NaN. */
static void panels_without_data_are_left_out(void **state) {
    const program_place *p = *state;
    evaluated done;
    evaluate_plan(p, "{ key = \"a.x\"; values = [1]; }, { key = \"a.y\"; values = [1]; }", -1, &done);
    draw(p, &done.a);
    assert_int_equal(program_shell(p, "test -s drawn/factors.png && test ! -e drawn/effects.gp").code, 0);
    free_evaluated(&done);
    static const char *const chosen[] = {"", "{ key = \"a.z\"; values = [1, 2]; },"}; /* intervals, a map */
    for (int k = 0; k < 2; k++) {
        char factors[512];
        snprintf(
            factors, sizeof factors,
            "{ key = \"a.x\"; values = [1, 2, 3]; }, %s { key = \"a.y\"; uncertain = true; values = [1, 2]; } );"
            "figures = ( { key = \"peak_stress_kPa\"; limit = 9.0; }, { key = \"hic\"; limit = 1000.0; }",
            chosen[k]);
        evaluate_plan(p, factors, -1, &done);
        draw(p, &done.a);
        assert_int_equal(program_shell(p,
                                       "test -s drawn/factors.png && test -s drawn/effects.png && "
                                       "test -s drawn/probability.png && ! grep peak_stress drawn/effects.gp")
                             .code,
                         0);
        free_evaluated(&done);
    }
}

/* Every 14th of 40,000 rows would be of the first level of the factor that changes fastest. */
static void the_points_of_a_picture_are_of_every_level(void **state) {
    const program_place *p = *state;
    evaluated done;
    evaluate_plan(
        p, "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 20000; }, { key = \"a.y\"; values = [1, 2]; }", -1,
        &done);
    draw(p, &done.a);
    /* The second panel is the first figure against a.y. */
    int of_one = atoi(program_shell(p, "sed -n '/^$d1_/,/^EOD/p' drawn/factors.gp | grep -c '^1,'").out),
        of_two = atoi(program_shell(p, "sed -n '/^$d1_/,/^EOD/p' drawn/factors.gp | grep -c '^2,'").out);
    if (of_one + of_two < 2900 || of_one + of_two > 3100 || abs(of_one - of_two) > 300)
        fail_msg("%d and %d points", of_one, of_two);
    free_evaluated(&done);
}

/* A factor of one number is as good as one of the case. */
static void a_factor_of_one_value_is_not_in_the_surface(void **state) {
    evaluated done;
    char term[100];
    evaluate_plan(*state,
                  "{ key = \"a.z\"; from = 1.0; to = 4.0; count = 10; }, { key = \"a.y\"; values = [5]; },"
                  "{ key = \"a.x\"; values = [1, 2, 3]; }",
                  -1, &done);
    const sf_quadratic *fit = &done.a.surface[1].fit;
    assert_string_equal(fit->problem, "");
    assert_int_equal(fit->d, 2);
    assert_true(fit->q2 > 0.999999); /* hic is linear */
    sf_analysis_term(&done.a, fit, 2, term, sizeof term);
    assert_string_equal(term, "a.x");
    free_evaluated(&done);
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
    formula f = {.fails = 77, .stop_at = 50000};
    struct rusage usage;
    begin_plan(p,
               "{ key = \"a.x\"; from = 1.0; to = 4.0; count = 100; },"
               "{ sample = \"sobol\"; count = 1000; of = ( { key = \"a.y\"; low = 0.0; high = 9.0; },"
               "{ key = \"a.z\"; low = \"1 mm\"; high = \"2 mm\"; } ); }",
               &plan);
    assert_int_equal(plan.rows, 100000);
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_INTERRUPTED);
    sf_runs_free(&runs);
    f.stop_at = 0;
    assert_int_equal(campaign(p, &plan, &f, false, 1, &runs, &err), SF_OK);
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
        cmocka_unit_test(the_probability_is_over_what_is_uncertain),
        cmocka_unit_test(a_surface_of_very_many_rows_has_every_level),
        cmocka_unit_test(numbers_that_are_sampled_have_the_effect_of_the_surface),
        cmocka_unit_test(main_effects_are_over_combinations_that_are_whole),
        cmocka_unit_test(draws_that_are_sampled_with_others_have_no_main_effect),
        cmocka_unit_test(draws_that_are_sampled_count_once_in_the_interval),
        cmocka_unit_test(an_estimate_counts_the_rows_that_are_done_again),
        cmocka_unit_test(a_word_that_a_zip_repeats_is_one_level),
        cmocka_unit_test(panels_without_data_are_left_out),
        cmocka_unit_test(the_points_of_a_picture_are_of_every_level),
        cmocka_unit_test(a_factor_of_one_value_is_not_in_the_surface),
        cmocka_unit_test(a_disk_that_is_too_small_is_refused),
        cmocka_unit_test(a_hundred_thousand_runs_take_less_than_a_minute_and_a_gigabyte),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
