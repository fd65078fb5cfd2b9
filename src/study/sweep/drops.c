/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/drops.h"

#include "study/engine.h"
#include "io/process.h"
#include <stdlib.h>
#include <string.h>

typedef struct piece {
    int count;
    sf_runner_drop *drop; /* its overrides are from malloc */
    sf_runner_result *result;
    sf_error *failure;
} piece;

static sf_status take_overrides(const sf_plan *plan, int64_t row, sf_runner_drop *d, sf_error *err) {
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    int count = sf_plan_overrides(plan, row, text);
    for (int i = 0; i < count && err->status == SF_OK; i++) {
        d->overrides[i] = strdup(text[i]);
        if (!d->overrides[i])
            SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the drops");
        d->override_count = i + 1;
    }
    return err->status;
}

static sf_status begin_piece(piece *p, const sf_plan *plan, int count, const int64_t *row, sf_error *err) {
    unsigned long n = (unsigned long)count;
    *p = (piece){.count = count,
                 .drop = sf_alloc(err, n, sizeof *p->drop, "drops"),
                 .result = sf_alloc(err, n, sizeof *p->result, "drops"),
                 .failure = sf_alloc(err, n, sizeof *p->failure, "drops")};
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        p->drop[k] = (sf_runner_drop){.label = SF_SWEEP_LABEL, .case_path = plan->case_path};
        take_overrides(plan, row[k], &p->drop[k], err);
    }
    return err->status;
}

static void end_piece(piece *p) {
    for (int k = 0; k < p->count && p->drop; k++)
        for (int i = 0; i < p->drop[k].override_count; i++)
            free((char *)p->drop[k].overrides[i]);
    for (int k = 0; k < p->count && p->result; k++)
        sf_runner_result_free(&p->result[k]);
    free(p->drop);
    free(p->result);
    free(p->failure);
}

/* "drop-0123456789abcdef" of ".../drop-0123456789abcdef/results.h5". */
static void folder_name(const char *path, char *out, size_t size) {
    const char *end = strrchr(path, '/'), *begin = end;
    while (begin && begin > path && begin[-1] != '/')
        begin--;
    snprintf(out, size, "%.*s", end ? (int)(end - begin) : 0, end ? begin : "");
}

static sf_status take_result(sf_runs *runs, int64_t row, const sf_runner_result *result, sf_error *err) {
    char folder[256];
    folder_name(result->path, folder, sizeof folder);
    sf_runs_take(runs, row, result->figure, result->status);
    return sf_runs_done(runs, row, result->grade, folder,
                        result->grade == SF_GRADE_VALID ? NULL : result->verdict, err);
}

/* Not the drop's own, as a disk that is full, or a process that was killed: it ends the campaign. */
static bool is_of_the_machine(const sf_error *failure) {
    return failure->status == SF_ERR_IO || failure->status == SF_ERR_MEMORY ||
           failure->status == SF_INTERRUPTED || strstr(failure->text, SF_PROCESS_KILLED);
}

static sf_status take_row(const piece *p, int k, sf_runs *runs, int64_t row, int *fresh, sf_error *err) {
    const sf_error *failure = &p->failure[k];
    if (failure->status == SF_OK) {
        *fresh += !p->result[k].reused;
        return take_result(runs, row, &p->result[k], err);
    }
    *fresh += 1;
    if (is_of_the_machine(failure))
        return SF_FAIL(err, failure->status, "run %lld: %s", (long long)row + 1, failure->text);
    return sf_runs_failed(runs, row, failure->text, err);
}

/* Some rows of the piece may be of the files before, others of those after. */
static void open_changed(const piece *p, sf_runs *runs, const int64_t *row) {
    bool changed = false;
    for (int k = 0; k < p->count; k++)
        changed |= p->failure[k].status != SF_OK && strstr(p->failure[k].text, SF_RUNNER_CHANGED);
    for (int k = 0; k < p->count && changed; k++)
        sf_runs_open(runs, row[k]);
}

static sf_status run(void *context, sf_runs *runs, int count, const int64_t *row, int *fresh, sf_error *err) {
    sf_runner *runner = context;
    piece p;
    *fresh = 0;
    if (begin_piece(&p, runs->plan, count, row, err) == SF_OK &&
        sf_runner_run_each(runner, count, p.drop, p.result, p.failure, err) == SF_OK) {
        sf_error first = SF_ERROR_INIT;
        for (int k = 0; k < count; k++) {
            sf_error own = SF_ERROR_INIT;
            if (take_row(&p, k, runs, row[k], fresh, &own) != SF_OK && first.status == SF_OK)
                first = own;
        }
        open_changed(&p, runs, row);
        *err = first;
    }
    end_piece(&p);
    return err->status;
}

static bool is_current(void *context, const sf_runs *runs, int64_t row) {
    piece p;
    sf_runner_state state = SF_DROP_OPEN;
    sf_error failure = SF_ERROR_INIT, err = SF_ERROR_INIT;
    if (begin_piece(&p, runs->plan, 1, &row, &err) == SF_OK)
        sf_runner_find_status(context, &p.drop[0], &state, &failure, &err);
    end_piece(&p);
    return state == SF_DROP_DONE;
}

sf_sweep_engine sf_sweep_drops(sf_runner *runner, int jobs) {
    runner->figures_only = true;
    int abreast = jobs < 1 ? 1 : jobs < SF_PROCESS_JOBS ? jobs : SF_PROCESS_JOBS;
    return (sf_sweep_engine){.run = run,
                             .is_current = is_current,
                             .context = runner,
                             .piece = sf_engine_is_local(&runner->engine) ? SF_SWEEP_PIECE * abreast
                                                                          : SF_SWEEP_ELSEWHERE};
}
