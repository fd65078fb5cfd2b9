/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sweep_fixture.h"

#include "model_fixture.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

sf_status sweep_try_plan(const program_place *p, const char *factors, bool huge, sf_plan *plan,
                         sf_error *err) {
    static char path[600];
    char text[4096];
    *err = (sf_error)SF_ERROR_INIT;
    snprintf(text, sizeof text, "case = \"%s\";\nfactors = ( %s );\n",
             fixture_source("examples/eva50-v4.5/case.cfg"), factors);
    snprintf(path, sizeof path, "%s", program_write_text(p, "plan.cfg", text));
    return sf_plan_read(path, huge, false, plan, err);
}

void sweep_read_plan(const program_place *p, const char *factors, sf_plan *plan) {
    sf_error err;
    if (sweep_try_plan(p, factors, false, plan, &err) != SF_OK)
        fail_msg("%s", err.text);
}

void sweep_make_posterior(const program_place *p) {
    program_shell(p,
                  "mkdir -p ten && for k in 01 02 03 04 05 06 07 08 09 10; do sed 's|eva35.csv|%s|' '%s' > "
                  "ten/draw-0$k.cfg; done",
                  "../eva35.csv", fixture_source("examples/materials/eva35.cfg"));
    program_shell(p, "cp '%s' eva35.csv", fixture_source("examples/materials/eva35.csv"));
}

/* ---- campaigns, with a formula in place of the drops ---- */

uint64_t sweep_present_inputs;

sf_status sweep_look_at_inputs(const sf_plan *plan, uint64_t *hash, sf_error *err) {
    (void)plan;
    *hash = sweep_present_inputs;
    return err->status;
}

static sf_status evaluate(void *context, sf_runs *runs, int count, const int64_t *row, int *fresh,
                          sf_error *err) {
    sweep_formula *f = context;
    *fresh = 0;
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        if (f->stop_at > 0 && f->calls == f->stop_at)
            return SF_FAIL(err, SF_INTERRUPTED, "interrupted");
        f->calls++;
        *fresh += 1;
        if (f->dies_at > 0 && f->calls == f->dies_at)
            _exit(0);
        if (f->edits_at > 0 && f->calls == f->edits_at)
            sweep_present_inputs = 99;
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
    sweep_formula *f = context;
    bool changed = f->changed || (f->other > 0 && row >= f->other);
    if (changed) {
        f->changed = false;
        f->other = 0;
    }
    return runs->state[row] == SF_SWEEP_DONE && !changed && (f->stale == 0 || row != f->stale);
}

sf_status sweep_run_campaign(const sf_sweep_campaign *c, sweep_formula *f, sf_runs *runs, sf_error *err) {
    const sf_sweep_engine engine = {evaluate, f, 7, is_current};
    *err = (sf_error)SF_ERROR_INIT;
    f->calls = 0;
    if (sf_runs_create(c->plan, runs, err) == SF_OK)
        sf_sweep_campaign_run(c, &engine, runs, err);
    return err->status;
}

sf_status sweep_campaign(const program_place *p, const sf_plan *plan, sweep_formula *f, bool retry,
                         uint64_t inputs, sf_runs *runs, sf_error *err) {
    const sf_sweep_campaign c = {
        .plan = plan, .folder = p->folder, .inputs = inputs, .look = sweep_look_at_inputs, .retry = retry};
    sweep_present_inputs = inputs;
    return sweep_run_campaign(&c, f, runs, err);
}

void sweep_begin_plan(const program_place *p, const char *factors, sf_plan *plan) {
    sweep_read_plan(p, factors, plan);
    program_shell(p, "rm -f runs.csv sweep.key");
}

void sweep_evaluate_plan(const program_place *p, const char *factors, int64_t fails, sweep_evaluated *e) {
    sweep_formula f = {.fails = fails};
    sf_error err;
    sweep_begin_plan(p, factors, &e->plan);
    if (sweep_campaign(p, &e->plan, &f, false, 1, &e->runs, &err) != SF_OK ||
        sf_analysis_make(&e->runs, &e->a, &err) != SF_OK)
        fail_msg("%s", err.text);
}

void sweep_free_evaluated(sweep_evaluated *e) {
    sf_analysis_free(&e->a);
    sf_runs_free(&e->runs);
    sf_plan_free(&e->plan);
}
