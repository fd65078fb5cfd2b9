/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-sweep PLAN.cfg -o DIR: many drops of one case, by a plan. */
#include "io/process.h"
#include "study/setup.h"
#include "study/sweep/adaptive.h"
#include "study/sweep/sweep_report.h"

#include <malloc.h>
#include <unistd.h>

enum { TABLE_ROWS = 10 };
/* Bytes. Larger blocks are not of the heap, where what is kept of each of very many rows would lie between
 * them: with 100,000 rows it grew to many times what was in use. */
enum { LARGE_BLOCK = 16384 };

typedef struct job {
    bool dry, yes; /* options */
    const char *view_words;
    sf_sweep_views views;
    sf_plan plan;
    sf_runs runs;
    sf_analysis analysis;
    sf_sweep_campaign campaign;
    double drop_seconds; /* sf_sweep_cost.seconds */
    char names[24][32];  /* of the pictures */
    const char *list[24 + 4];
} job;

/* Pictures with their scripts; runs.csv and sweep.key go their own way. */
static void name_output(job *j) {
    int n = 0;
    for (const sf_sweep_picture *p = sf_sweep_pictures(); p->name; p++) {
        snprintf(j->names[n], sizeof j->names[n], "%s.gp", p->name);
        snprintf(j->names[n + 1], sizeof j->names[n], "%s.png", p->name);
        n += 2;
    }
    for (int k = 0; k < n; k++)
        j->list[k] = j->names[k];
    j->list[n++] = "report.html";
    j->list[n++] = "sweep.json";
    j->list[n++] = "drops.csv";
    j->list[n] = NULL;
}

static sf_status write_report(sf_study *study, job *j, sf_error *err) {
    char warning[320], series[SF_RUNNER_COUNTED];
    const sf_sweep_report report = {&j->plan, &j->runs, &j->analysis, study->command, &j->views, series};
    const bool of_series = sf_sweep_series_text(&j->plan, series, sizeof series);
    SF_TRY(sf_analysis_make(&j->runs, &j->analysis, err));
    if (j->view_words && sf_sweep_views_choose(j->view_words, &j->plan, &j->runs, &j->views, err) == SF_OK)
        sf_sweep_views_make(&j->plan, study->directory, study->threads, &j->views, err);
    SF_TRY(err->status);
    SF_TRY(sf_sweep_plot(&study->output, &j->analysis, study->runs, warning, sizeof warning, err));
    SF_TRY(sf_sweep_write_page(&study->output, &report, err));
    SF_TRY(sf_sweep_write_json(&study->output, &report, err));
    if (of_series)
        SF_TRY(sf_sweep_write_drops(&study->output, &j->runs, study->runs, err));
    SF_TRY(sf_staging_commit(&study->output, err));
    sf_sweep_print(stdout, &report);
    sf_study_close(study,
                   of_series ? "report.html, runs.csv, drops.csv, sweep.json"
                             : "report.html, runs.csv, sweep.json",
                   warning);
    return SF_OK;
}

/* Before anything is made. A table of this plan is replaced without --force. */
static sf_status check(sf_study *study, job *j, sf_error *err) {
    bool known = false;
    SF_TRY(sf_plan_read(study->input, j->yes, &j->plan, err));
    if (j->view_words)
        SF_TRY(sf_sweep_views_choose(j->view_words, &j->plan, NULL, &j->views, err));
    SF_TRY(sf_sweep_check_inputs(&j->plan, &j->campaign.inputs, err));
    j->campaign.plan = &j->plan;
    j->campaign.look = sf_sweep_check_inputs;
    j->campaign.folder = study->directory;
    j->campaign.drops = study->runs;
    j->campaign.report = j->list;
    j->campaign.retry = study->engine.retry;
    j->campaign.force = study->force;
    name_output(j);
    SF_TRY(sf_sweep_campaign_check(&j->campaign, &known, err));
    study->force |= known;
    static const char *const table[] = {"runs.csv", NULL}; /* of something else if no campaign knows it */
    SF_TRY(sf_study_check(study, table, err));
    return sf_staging_check(study->directory, j->list, study->force, err);
}

static sf_status estimate(const sf_study *study, job *j, sf_error *err) {
    sf_sweep_cost cost;
    sf_error small = SF_ERROR_INIT;
    const bool elsewhere = study->engine.profile != NULL;
    int64_t open = 0;
    SF_TRY(sf_runs_create(&j->plan, &j->runs, err));
    SF_TRY(sf_sweep_campaign_status(&j->campaign, &j->runs, &open, err));
    SF_TRY(sf_sweep_cost_estimate(&j->runs, open, study->runs, &cost, err));
    sf_sweep_print_table(stdout, &j->plan, TABLE_ROWS);
    sf_sweep_cost_print(stdout, &cost, elsewhere ? 0 : study->jobs);
    if (sf_plan_is_adaptive(&j->plan)) {
        int64_t first = sf_sweep_adaptive_design(&j->plan);
        printf(
            "  (at most: %lld rows are simulated first, then those without which the others are not predicted as "
            "accurately as the plan asks%s)\n",
            (long long)first,
            sf_sweep_is_beyond_columns(&j->plan)
                ? "; no columns stand for this pad, so that more of them are needed"
                : "");
        cost.open = first < cost.open ? first : cost.open; /* for which the disk must have room */
    }
    fflush(stdout);
    j->drop_seconds = cost.seconds;
    int abreast = !elsewhere ? study->jobs : open < SF_MANIFEST_GROUPS ? (int)open : SF_MANIFEST_GROUPS;
    if (sf_sweep_cost_check_disk(&cost, study->directory, abreast, &small) == SF_OK)
        return SF_OK;
    if (j->yes)
        sf_sink_tell(&study->sink, SF_WARNING, "%s", small.text);
    else
        SF_FAIL(err, small.status, "%s (--yes begins all the same)", small.text);
    return err->status;
}

/* Sets as many drops side by side as there are processors, each with one thread. */
static void choose_jobs(sf_study *study) {
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (study->jobs == 0)
        study->jobs = processors > SF_PROCESS_JOBS ? SF_PROCESS_JOBS : (int)processors;
    if (study->threads == 0)
        study->threads = study->jobs;
}

/* Runs all rows, or those that a plan with wishes for its accuracy needs. */
static sf_status run_rows(sf_study *study, job *j, const sf_sweep_engine *engine, sf_error *err) {
    if (!sf_plan_is_adaptive(&j->plan))
        return sf_sweep_campaign_run(&j->campaign, engine, &j->runs, err);
    sf_sweep_adaptive *adaptive = sf_sweep_adaptive_new(&j->plan, study->runs, study->jobs, stdout, err);
    SF_TRY(err->status);
    const sf_sweep_chooser chooser = sf_sweep_adaptive_chooser(adaptive);
    j->campaign.chooser = &chooser;
    sf_sweep_campaign_run(&j->campaign, engine, &j->runs, err);
    j->campaign.chooser = NULL;
    sf_sweep_adaptive_free(adaptive);
    return err->status;
}

static sf_status run_campaign(sf_study *study, job *j, sf_error *err) {
    choose_jobs(study);
    SF_TRY(sf_engine_check(&study->engine, err));
    if (check(study, j, err) != SF_OK || estimate(study, j, err) != SF_OK || j->dry)
        return err->status;
    sf_runs_free(&j->runs);
    SF_TRY(sf_study_begin(study, j->list, err));
    SF_TRY(sf_runs_create(&j->plan, &j->runs, err));
    study->runner.engine.drop_seconds = j->drop_seconds;
    const sf_sweep_engine engine = sf_sweep_drops(&study->runner, study->jobs);
    j->campaign.log = stdout;
    SF_TRY(run_rows(study, j, &engine, err));
    return write_report(study, j, err);
}

static sf_status run(sf_study *study, void *own, sf_error *err) {
    SF_TRY(sf_units_hold(err)); /* of very many cases */
    run_campaign(study, own, err);
    sf_units_let_go();
    return err->status;
}

static const sf_option options[] = {
    {"dry-run", 0, NULL, "print the table and what it will take, and end", .member = offsetof(job, dry),
     .group = 1},
    {"yes", 'y', NULL,
     "take a plan of more than a million runs, and begin although the estimate says that the disk is too small",
     .member = offsetof(job, yes), .group = 1},
    {"views", 0, "RUNS",
     "afterwards simulate some runs with all fields, and link their report.html and view.html: worst, limit (nearest "
     "to it), all, or ids, with commas between them",
     .member = offsetof(job, view_words), .group = 1},
    {0}};

static const sf_study_program program = {
    .name = "softfall-sweep",
    .argument = "PLAN.cfg",
    .doc =
        "Simulates a case for many values of its keys.\vWrites runs.csv, sweep.json, pictures and report.html. "
        "After an interruption run the same command again to resume. docs/campaigns.md explains plans. Figures are "
        "indicative, not a certification.",
    .drops = true,
    .options = options,
    .run = run};

int main(int argc, char **argv) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED job *j = sf_alloc(&err, 1, sizeof *j, "the plan");
    if (!j)
        return sf_error_report(&err, program.name);
    mallopt(M_MMAP_THRESHOLD, LARGE_BLOCK);
    int code = sf_study_main(argc, argv, &program, j);
    sf_analysis_free(&j->analysis);
    sf_runs_free(&j->runs);
    sf_plan_free(&j->plan);
    return code;
}
