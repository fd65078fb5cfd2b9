/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-sweep PLAN.cfg -o DIR: many drops of one case, by a plan. */
#include "io/folder.h"
#include "io/plain_file.h"
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

/* The drops of a plan, or its coarse ones. */
typedef struct level {
    sf_plan plan;
    sf_runs runs;
    sf_sweep_campaign campaign;
    sf_sweep_adaptive *adaptive; /* NULL: all rows are simulated */
    double drop_seconds;         /* sf_sweep_cost.seconds */
} level;

typedef struct job {
    bool dry, yes; /* options */
    const char *view_words;
    sf_sweep_views views;
    level fine, coarse;                     /* the second is zero where the plan asks for none */
    char folder[PATH_MAX], drops[PATH_MAX]; /* of the coarse ones: DIR/coarse and DIR/coarse/runs */
    sf_analysis analysis;
    char names[24][32]; /* of the pictures */
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
    const sf_plan *plan = &j->fine.plan;
    const sf_runs *runs = &j->fine.runs;
    const int64_t coarse = sf_runs_count(&j->coarse.runs, SF_SWEEP_DONE);
    const sf_sweep_report report = {plan, runs, &j->analysis, study->command, &j->views, series, coarse};
    const bool of_series = sf_sweep_series_text(plan, series, sizeof series);
    SF_TRY(sf_analysis_make(runs, &j->analysis, err));
    if (j->view_words && sf_sweep_views_choose(j->view_words, plan, runs, &j->views, err) == SF_OK)
        sf_sweep_views_make(plan, study->directory, study->threads, &j->views, err);
    SF_TRY(err->status);
    SF_TRY(sf_sweep_plot(&study->output, &j->analysis, study->runs, warning, sizeof warning, err));
    SF_TRY(sf_sweep_write_page(&study->output, &report, err));
    SF_TRY(sf_sweep_write_json(&study->output, &report, err));
    if (of_series)
        SF_TRY(sf_sweep_write_drops(&study->output, runs, study->runs, err));
    SF_TRY(sf_staging_commit(&study->output, err));
    sf_sweep_print(stdout, &report);
    sf_study_close(study,
                   of_series ? "report.html, runs.csv, drops.csv, sweep.json"
                             : "report.html, runs.csv, sweep.json",
                   warning);
    return SF_OK;
}

/* Sets up the campaign of a plan, and looks at its folder. `*known`: it has a table of this plan. */
static sf_status check_level(const sf_study *study, level *l, bool *known, sf_error *err) {
    SF_TRY(sf_sweep_check_inputs(&l->plan, &l->campaign.inputs, err));
    l->campaign.plan = &l->plan;
    l->campaign.look = sf_sweep_check_inputs;
    l->campaign.retry = study->engine.retry;
    l->campaign.force = study->force;
    return sf_sweep_campaign_check(&l->campaign, known, err);
}

static sf_status check_coarse(const sf_study *study, job *j, sf_error *err) {
    bool known;
    SF_TRY(sf_path_print(j->folder, sizeof j->folder, err, "%s/coarse", study->directory));
    SF_TRY(sf_path_print(j->drops, sizeof j->drops - 64, err, "%s/runs", j->folder));
    SF_TRY(sf_plan_read(study->input, j->yes, true, &j->coarse.plan, err));
    j->coarse.campaign.folder = j->folder;
    j->coarse.campaign.drops = j->drops;
    SF_TRY(check_level(study, &j->coarse, &known, err));
    if (j->coarse.campaign.inputs == j->fine.campaign.inputs)
        SF_REFUSE(err, "%s: coarse changes nothing of the drops: give them a larger spacing",
                  j->coarse.plan.set_where);
    return err->status;
}

/* Before anything is made. A table of this plan is replaced without --force. */
static sf_status check(sf_study *study, job *j, sf_error *err) {
    static const char *const table[] = {"runs.csv", NULL}; /* of something else if no campaign knows it */
    bool known = false;
    level *l = &j->fine;
    SF_TRY(sf_plan_read(study->input, j->yes, false, &l->plan, err));
    if (j->view_words)
        SF_TRY(sf_sweep_views_choose(j->view_words, &l->plan, NULL, &j->views, err));
    name_output(j);
    l->campaign.folder = study->directory;
    l->campaign.drops = study->runs;
    l->campaign.report = j->list;
    SF_TRY(check_level(study, l, &known, err));
    if (l->plan.coarse)
        SF_TRY(check_coarse(study, j, err));
    study->force |= known;
    SF_TRY(sf_staging_check(study->directory, table, study->force, err));
    return sf_study_check(study, j->list, err);
}

static sf_status estimate(const sf_study *study, const job *j, level *l, sf_error *err) {
    sf_sweep_cost cost;
    sf_error small = SF_ERROR_INIT;
    const bool elsewhere = study->engine.profile != NULL;
    int64_t open = 0;
    SF_TRY(sf_runs_create(&l->plan, &l->runs, err));
    SF_TRY(sf_sweep_campaign_status(&l->campaign, &l->runs, &open, err));
    SF_TRY(sf_sweep_cost_estimate(&l->runs, open, l->campaign.drops, &cost, err));
    if (l == &j->coarse && j->fine.plan.refine && isnan(cost.seconds))
        return SF_REFUSE(err, "refine: with %d times its spacings %s", SF_SWEEP_RATIO, cost.basis);
    sf_sweep_cost_print(stdout, &cost, elsewhere ? 0 : study->jobs);
    if (sf_plan_is_adaptive(&l->plan)) {
        int64_t first = sf_sweep_adaptive_design(&l->plan);
        printf(
            "  (at most: %lld rows are simulated first, then those without which the others are not predicted as "
            "accurately as %s%s)\n",
            (long long)first, l == &j->coarse ? "half of what the plan asks" : "the plan asks",
            !l->plan.coarse && sf_sweep_is_beyond_columns(&l->plan)
                ? "; no columns stand for this pad, so that more of them are needed"
                : "");
        cost.open = first < cost.open ? first : cost.open; /* for which the disk must have room */
    }
    fflush(stdout);
    l->drop_seconds = cost.seconds;
    int abreast = open < SF_MANIFEST_GROUPS ? (int)open : SF_MANIFEST_GROUPS;
    if (!elsewhere)
        abreast = study->jobs;
    if (sf_sweep_cost_check_disk(&cost, study->directory, abreast, &small) == SF_OK)
        return SF_OK;
    if (j->yes)
        sf_sink_tell(&study->sink, SF_WARNING, "%s", small.text);
    else
        SF_FAIL(err, small.status, "%s (--yes begins all the same)", small.text);
    return err->status;
}

/* Prints what will be run, the coarse drops first. */
static sf_status estimate_all(const sf_study *study, job *j, sf_error *err) {
    sf_sweep_print_table(stdout, &j->fine.plan, TABLE_ROWS);
    if (j->fine.plan.coarse) {
        printf("Coarse drops, from which the rows are %s: ", j->fine.plan.refine ? "refined" : "predicted");
        SF_TRY(estimate(study, j, &j->coarse, err));
    }
    return estimate(study, j, &j->fine, err);
}

/* Sets as many drops side by side as there are processors, each with one thread. */
static void choose_jobs(sf_study *study) {
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (study->jobs == 0)
        study->jobs = processors > SF_PROCESS_JOBS ? SF_PROCESS_JOBS : (int)processors;
    if (study->threads == 0)
        study->threads = study->jobs;
}

/* Runs all rows, or those that a plan with wishes for its accuracy needs. `coarse`: NULL: there are none. */
static sf_status run_level(const sf_study *study, level *l, const level *coarse, sf_runner *runner,
                           sf_error *err) {
    sf_sweep_chooser chooser;
    sf_runs_free(&l->runs);
    SF_TRY(sf_runs_create(&l->plan, &l->runs, err));
    l->runs.coarse = coarse ? &coarse->runs : NULL;
    runner->engine.drop_seconds = l->drop_seconds;
    const sf_sweep_engine engine = sf_sweep_drops(runner, study->jobs);
    l->campaign.log = stdout;
    if (sf_plan_is_adaptive(&l->plan)) {
        l->adaptive = sf_sweep_adaptive_new(&l->plan, l->campaign.drops, study->jobs, stdout, err);
        SF_TRY(err->status);
        if (coarse)
            sf_sweep_adaptive_correct(l->adaptive, coarse->adaptive, &coarse->runs);
        chooser = sf_sweep_adaptive_chooser(l->adaptive);
        l->campaign.chooser = &chooser;
    }
    sf_sweep_campaign_run(&l->campaign, &engine, &l->runs, err);
    l->campaign.chooser = NULL;
    return err->status;
}

static sf_status run_coarse(const sf_study *study, job *j, sf_error *err) {
    sf_runner runner = study->runner;
    runner.folder = j->drops;
    SF_TRY(sf_folder_own(j->folder, err));
    SF_TRY(run_level(study, &j->coarse, NULL, &runner, err));
    printf("%lld coarse drops simulated, %lld were there\n", (long long)runner.simulated,
           (long long)runner.reused);
    return SF_OK;
}

static sf_status run_campaign(sf_study *study, job *j, sf_error *err) {
    choose_jobs(study);
    SF_TRY(sf_engine_check(&study->engine, err));
    if (check(study, j, err) != SF_OK || estimate_all(study, j, err) != SF_OK || j->dry)
        return err->status;
    SF_TRY(sf_study_begin(study, j->list, err));
    const level *coarse = j->fine.plan.coarse ? &j->coarse : NULL;
    if (coarse)
        SF_TRY(run_coarse(study, j, err));
    SF_TRY(run_level(study, &j->fine, coarse, &study->runner, err));
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
    level *const levels[] = {&j->fine, &j->coarse};
    for (int k = 0; k < 2; k++) {
        sf_sweep_adaptive_free(levels[k]->adaptive);
        sf_runs_free(&levels[k]->runs);
        sf_plan_free(&levels[k]->plan);
    }
    return code;
}
