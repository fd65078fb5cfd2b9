/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/campaign.h"

#include "io/folder.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "pre/make.h"
#include "pre/model_report.h"

#include <gsl/gsl_sort.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* ---- the engine ---- */

typedef struct piece {
    int count;
    sf_runner_drop *drop; /* its overrides are from malloc */
    sf_runner_result *result;
    sf_error *failure;
} piece;

static sf_status take_overrides(const sf_plan *plan, int64_t row, sf_runner_drop *d, sf_error *err) {
    char text[SF_RUNNER_OVERRIDES][SF_SWEEP_OVERRIDE_SIZE];
    int count = sf_plan_overrides(plan, row, text, NULL);
    for (int i = 0; i < count && err->status == SF_OK; i++)
        if (!(d->overrides[d->override_count++] = strdup(text[i])))
            SF_NO_MEMORY(err, "the drops");
    return err->status;
}

static sf_status begin_piece(piece *p, const sf_plan *plan, int count, const int64_t *row, sf_error *err) {
    *p = (piece){.count = count,
                 .drop = sf_alloc(err, count, sizeof *p->drop, "drops"),
                 .result = sf_alloc(err, count, sizeof *p->result, "drops"),
                 .failure = sf_alloc(err, count, sizeof *p->failure, "drops")};
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
    SF_FREE(p->drop, p->result, p->failure);
}

static sf_status take_result(sf_runs *runs, int64_t row, const sf_runner_result *result, sf_error *err) {
    char folder[PATH_MAX]; /* "drop-0123456789abcdef" of ".../drop-0123456789abcdef/results.h5" */
    snprintf(folder, sizeof folder, "%.*s", (int)sf_path_folder_length(result->path), result->path);
    sf_runs_take(runs, row, result->figure, result->status);
    return sf_runs_done(runs, row, result->grade, sf_path_name(folder),
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
        for (int k = 0; k < count; k++) /* all: the first failure is kept */
            take_row(&p, k, runs, row[k], fresh, err);
        open_changed(&p, runs, row);
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

/* ---- the drops of series ---- */

bool sf_sweep_series_text(const sf_plan *plan, char *text, size_t size) {
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    bool varies = false;
    for (int f = 0; f < plan->factor_count; f++)
        varies |= strcmp(plan->factor[f].key, "series.drops") == 0 ||
                  strcmp(plan->factor[f].key, "series.counted") == 0;
    *text = '\0';
    if (sf_sweep_read_case(plan, 0, &c, SF_IGNORED) == SF_OK)
        sf_run_counted_text((int)c.drops, c.counted, text, size);
    if (varies)
        snprintf(text, size, "the mean of the drops of series.counted");
    return *text;
}

/* A line of drops.csv; without a record of its figures their cells are empty. */
static void put_drop(sf_csv *csv, int64_t row, int drop, const sf_run_folder *at) {
    SF_OWNED_BY(sf_run_record_free) sf_run_record r = {0};
    bool there = sf_run_record_read(at->figures, at->results, &r);
    sf_csv_print(csv, "%lld,%d,%s,%s", (long long)row + 1, drop, at->counted >> (drop - 1) & 1 ? "yes" : "no",
                 there ? sf_verdict_phrase(r.grade) : "");
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        if (there && sf_figure_at[k].row.type == SF_ROW_TEXT)
            sf_csv_print(csv, "%s", r.status);
        else
            SF_CSV_NUMBERS(csv, there ? r.figure[k] : NAN);
    sf_csv_end(csv);
}

sf_status sf_sweep_write_drops(const sf_staging *output, const sf_runs *r, const char *folder,
                               sf_error *err) {
    SF_CSV_FILE(csv, output, "drops.csv", err);
    sf_csv_print(&csv, "id,drop,counted,grade");
    sf_figure_csv_keys(&csv);
    sf_csv_end(&csv);
    for (int64_t row = 0; row < r->count && err->status == SF_OK; row++) {
        SF_OWNED_BY(sf_case_free) sf_case c = {0};
        sf_run_folder at;
        if (r->state[row] != SF_SWEEP_DONE || !r->folder[row] ||
            strncmp(r->folder[row], SF_SWEEP_LABEL "-", strlen(SF_SWEEP_LABEL "-")) != 0 ||
            sf_sweep_read_case(r->plan, row, &c, err) != SF_OK)
            continue;
        const char *key = r->folder[row] + strlen(SF_SWEEP_LABEL "-");
        sf_run_folder_name_key(folder, SF_SWEEP_LABEL, strtoull(key, NULL, 16), &at);
        at.counted = c.counted;
        for (int k = 1; k <= (int)c.drops; k++) {
            const sf_run_folder drop = sf_run_folder_of_drop(&at, k);
            put_drop(&csv, row, k, &drop);
        }
    }
    return sf_csv_close(&csv, err);
}

/* ---- cost ---- */

/* Measured of examples/sweep (docs/campaigns.md): results.h5 without fields, and what a run has on disk while
 * it is at work, per node; with log and folder. */
static const double NODE_BYTES = 300, RUN_BYTES = 1e6, NODE_WORK_BYTES = 4000;
/* s, of softfall-pre with a mesh that is there, of the starts of the programs and of the files. */
static const double SETUP_SECONDS = 0.2;

/* Bytes of the results of all drops of a run. */
static double size_of(const char *folder, const char *name) {
    char first[PATH_MAX], path[PATH_MAX];
    double bytes = 0;
    sf_error none = SF_ERROR_INIT;
    snprintf(first, sizeof first, "%s/%s/results.h5", folder, name);
    for (int drop = 1; drop <= SF_SERIES_MOST && none.status == SF_OK; drop++) {
        int handle = -1;
        uint64_t size = 0;
        sf_model_series_file(first, drop, path, sizeof path);
        if (sf_plain_open(path, NULL, &handle, &size, &none) == SF_OK)
            close(handle);
        bytes += (double)size;
    }
    return bytes;
}

/* Measures the cost by the median of wall_s x threads; 0: no run is done. */
static sf_status measure(const sf_runs *r, double *seconds, int64_t *done, sf_error *err) {
    SF_OWNED double *value = sf_alloc(err, r->count, sizeof *value, "run times");
    size_t wall = sf_runs_figure("wall_s"), threads = sf_runs_figure("threads"), n = 0;
    for (int64_t row = 0; row < r->count && value; row++) {
        const double *place = sf_runs_place(r, row);
        if (r->state[row] == SF_SWEEP_DONE && place[wall] * place[threads] >= 0)
            value[n++] = place[wall] * place[threads];
    }
    *done = (int64_t)n;
    if (n > 0)
        gsl_sort(value, 1, n);
    *seconds = n > 0 ? SETUP_SECONDS + value[n / 2] : 0;
    return err->status;
}

static void from_runs(const sf_runs *r, const char *folder, int64_t done, sf_sweep_cost *c) {
    for (int64_t row = 0; row < r->count && c->bytes <= 0; row++)
        if (r->state[row] == SF_SWEEP_DONE && r->folder[row])
            c->bytes = size_of(folder, r->folder[row]) + 1e4;
    c->work_bytes = 20 * c->bytes;
    snprintf(
        c->basis, sizeof c->basis,
        "from %lld finished run%s: the median of the solver's wall time and its threads, and what else a run takes",
        (long long)done, done > 1 ? "s" : "");
}

static sf_status from_model(const sf_plan *p, sf_sweep_cost *c, sf_error *err) {
    SF_OWNED_BY(sf_case_free) sf_case first = {0};
    sf_model model;
    sf_build_report report;
    char libraries[SF_LIBRARIES_SIZE];
    sf_error refused = SF_ERROR_INIT;
    SF_TRY(sf_sweep_read_case(p, 0, &first, err));
    if (sf_model_make(&first, &model, &report, libraries, NULL, NULL, &refused) == SF_OK) {
        double nodes = first.drops * (double)model.node_count;
        c->seconds = SETUP_SECONDS + 2 * first.drops * sf_report_seconds(&model, &report); /* of two cores */
        c->bytes = RUN_BYTES + NODE_BYTES * nodes;
        c->work_bytes = c->bytes + NODE_WORK_BYTES * nodes;
        snprintf(c->basis, sizeof c->basis,
                 "the estimate of softfall-pre for the first row, to a factor of 2; no run is finished yet");
        sf_model_free(&model);
    } else if (refused.status == SF_ERR_INPUT ||
               refused.status == SF_ERR_MODEL) { /* it will be a failed run */
        c->seconds = NAN;
        snprintf(c->basis, sizeof c->basis, "the first row has no model: %.480s", refused.text);
    } else {
        *err = refused;
    }
    return err->status;
}

sf_status sf_sweep_cost_estimate(const sf_runs *r, int64_t open, const char *folder, sf_sweep_cost *c,
                                 sf_error *err) {
    int64_t done = 0, kept = sf_runs_count(r, SF_SWEEP_DONE);
    *c = (sf_sweep_cost){.open = open};
    SF_TRY(measure(r, &c->seconds, &done, err));
    kept = kept < r->count - open ? kept : r->count - open;
    int64_t more = sf_folder_count(folder, SF_SWEEP_LABEL "-") - kept;
    c->there = more < 0 ? 0 : more < c->open ? more : c->open;
    if (done == 0)
        return from_model(r->plan, c, err);
    from_runs(r, folder, done, c);
    return SF_OK;
}

/* The file system of the folder, or of the nearest one above it that exists. */
static double free_bytes(const char *folder) {
    struct statvfs info;
    SF_PRINTED(path, PATH_MAX, "%s", folder);
    while (statvfs(path, &info) != 0) {
        char *slash = strrchr(path, '/');
        if (strcmp(path, "/") == 0 || strcmp(path, ".") == 0)
            return INFINITY;
        if (slash && slash > path)
            *slash = '\0';
        else
            snprintf(path, sizeof path, slash ? "/" : ".");
    }
    return (double)info.f_bavail * (double)info.f_frsize;
}

sf_status sf_sweep_cost_check_disk(const sf_sweep_cost *c, const char *folder, int jobs, sf_error *err) {
    double need = c->bytes * (double)c->open + c->work_bytes * jobs, there = free_bytes(folder);
    if (need <= there)
        return SF_OK;
    return SF_REFUSE(err,
                     "the runs need about %.3g GB and the disk of %s has %.3g GB: give another directory",
                     need / 1e9, folder, there / 1e9);
}

void sf_sweep_cost_print(FILE *out, const sf_sweep_cost *c, int jobs) {
    double hours = c->seconds * (double)c->open / 3600, size = c->bytes * (double)c->open / 1e9;
    fprintf(out, "%lld open runs", c->open);
    if (isnan(c->seconds))
        fputs("; what they cost is not known", out);
    else if (jobs > 0)
        fprintf(out, " of about %.3g s of one core: about %.3g h with %d at a time, %.3g GB", c->seconds,
                hours / jobs, jobs, size);
    else
        fprintf(out,
                " of about %.3g s of one core like those of this machine: about %.3g core hours, %.3g GB",
                c->seconds, hours, size);
    fprintf(out, "\n  (%s)\n", c->basis);
    if (c->there > 0)
        fprintf(
            out,
            "  (up to %lld of them may be there already: the folder has drops that runs.csv does not list, or lists with earlier inputs)\n",
            (long long)c->there);
}
