/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-sweep PLAN.cfg -o DIR: many drops of one case, by a plan. */
#include "build_info.h"
#include "study/engine.h"
#include "study/manifest.h"
#include "base/program.h"
#include "base/units.h"
#include "io/folder.h"
#include "io/process.h"
#include "io/provenance.h"
#include "study/sweep/cost.h"
#include "study/sweep/drops.h"
#include "study/sweep/inputs.h"
#include "study/sweep/sweep_plot.h"
#include "study/sweep/sweep_report.h"

#include <argp.h>
#include <gsl/gsl_errno.h>
#include <limits.h>
#include <malloc.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { KEY_DRY = 256, KEY_YES, KEY_RETRY, TABLE_ROWS = 10 };
/* Bytes. Larger blocks are not of the heap, where what is kept of each of very many rows would lie between
 * them: with 100,000 rows it grew to many times what was in use. */
enum { LARGE_BLOCK = 16384 };

typedef struct options {
    const char *plan, *directory;
    bool dry, yes, retry, force;
    int jobs, threads; /* 0: not given */
    sf_runner_engine engine;
    sf_error err;
} options;

static error_t parse(int key, char *text, struct argp_state *state) {
    options *o = state->input;
    switch (key) {
    case 'o':
        o->directory = text;
        return 0;
    case 'f':
        o->force = true;
        return 0;
    case 'y':
        o->yes = true;
        return 0;
    case KEY_DRY:
        o->dry = true;
        return 0;
    case KEY_RETRY:
        o->retry = o->engine.retry = true;
        return 0;
    case 't':
        sf_program_read_threads(text, &o->threads, &o->err);
        return 0;
    case 'j':
        if (sf_program_read_threads(text, &o->jobs, &o->err) != SF_OK || o->jobs > SF_PROCESS_JOBS)
            argp_error(state, "--jobs takes a number from 1 to %d, not \"%s\"", SF_PROCESS_JOBS, text);
        return 0;
    case ARGP_KEY_ARG:
        if (o->plan)
            argp_error(state, "one plan at a time: \"%s\" is one too many", text);
        o->plan = text;
        return 0;
    case ARGP_KEY_END:
        if (!o->plan || !o->directory)
            argp_error(state, "give a plan, and the output directory with -o");
        return 0;
    default:
        return sf_engine_option(key, text, &o->engine, &o->err) ? 0 : ARGP_ERR_UNKNOWN;
    }
}

static void print_version(FILE *stream, struct argp_state *state) {
    (void)state;
    fputs("softfall-sweep " SF_VERSION " (" SF_GIT_REVISION ")\n", stream);
}

static sf_status parse_command(int argc, char **argv, options *o, sf_error *err) {
    static const struct argp_option known[] = {
        {"output", 'o', "DIR", 0, "write everything there (required); the drops stay in DIR/runs", 0},
        {"dry-run", KEY_DRY, NULL, 0, "print the table and what it will take, and end", 0},
        {"yes", 'y', NULL, 0,
         "take a plan of more than a million runs, and begin although the estimate says that the disk is too small",
         0},
        {"retry", KEY_RETRY, NULL, 0, "do the runs that failed again", 0},
        {"force", 'f', NULL, 0, "replace what DIR holds of another plan; finished drops are used again", 0},
        {"jobs", 'j', "N", 0, "drops side by side, 64 at most (default: as many as processors)", 0},
        {"threads", 't', "N", 0, "threads of all drops together (default: one for each)", 0},
        SF_ENGINE_OPTIONS(1),
        {0}};
    static const struct argp parser = {
        .options = known,
        .parser = parse,
        .args_doc = "PLAN.cfg -o DIR",
        .doc =
            "Simulates a case for many values of its keys.\vWrites runs.csv, sweep.json, pictures and report.html. "
            "After an interruption run the same command again to resume. docs/campaigns.md explains plans. Figures are "
            "indicative, not a certification."};
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    *o = (options){.err = SF_ERROR_INIT};
    argp_program_version_hook = print_version;
    if (argp_parse(&parser, argc, argv, 0, NULL, o) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "the command line cannot be read");
    if (o->jobs == 0)
        o->jobs = processors > SF_PROCESS_JOBS ? SF_PROCESS_JOBS : (int)processors;
    if (o->threads == 0)
        o->threads = o->jobs;
    if (o->err.status != SF_OK)
        *err = o->err;
    return err->status;
}

/* ---- the work ---- */

typedef struct job {
    sf_plan plan;
    sf_runs runs;
    sf_analysis analysis;
    sf_staging output;
    sf_sweep_campaign campaign;
    char *command;
    char folder[PATH_MAX]; /* DIR/runs */
    double drop_seconds;   /* sf_sweep_cost.seconds */
    char names[24][32];    /* of the pictures */
    const char *list[24 + 3];
    int lock;
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
    j->list[n] = NULL;
}

static sf_status write_report(job *j, sf_error *err) {
    char warning[320];
    const sf_sweep_report report = {&j->plan, &j->runs, &j->analysis, j->command};
    if (sf_analysis_make(&j->runs, &j->analysis, err) != SF_OK ||
        sf_sweep_plot(&j->output, &j->analysis, j->folder, warning, sizeof warning, err) != SF_OK ||
        sf_sweep_write_page(&j->output, &report, err) != SF_OK ||
        sf_sweep_write_json(&j->output, &report, err) != SF_OK || sf_staging_commit(&j->output, err) != SF_OK)
        return err->status;
    sf_sweep_print(stdout, &report);
    printf("Written: %s/report.html, runs.csv, sweep.json\n", j->campaign.folder);
    fflush(stdout);
    const sf_sink sink = sf_program_sink("softfall-sweep");
    if (*warning)
        sf_sink_tell(&sink, SF_WARNING, "%s", warning);
    return SF_OK;
}

/* Before anything is made. */
static sf_status check(const options *o, job *j, bool *known, sf_error *err) {
    if (sf_plan_read(o->plan, o->yes, &j->plan, err) != SF_OK ||
        sf_sweep_check_inputs(&j->plan, &j->campaign.inputs, err) != SF_OK)
        return err->status;
    j->campaign.plan = &j->plan;
    j->campaign.look = sf_sweep_check_inputs;
    j->campaign.folder = o->directory;
    j->campaign.drops = j->folder;
    j->campaign.report = j->list;
    j->campaign.retry = o->retry;
    j->campaign.force = o->force;
    name_output(j);
    if ((size_t)snprintf(j->folder, sizeof j->folder, "%s/runs", o->directory) >= sizeof j->folder - 64)
        return SF_FAIL(err, SF_ERR_INPUT, "the path of the output directory is too long");
    static const char *const table[] = {"runs.csv", NULL}; /* of something else if no campaign knows it */
    if (sf_sweep_campaign_check(&j->campaign, known, err) != SF_OK ||
        sf_staging_check(o->directory, table, o->force || *known, err) != SF_OK)
        return err->status;
    return sf_staging_check(o->directory, j->list, o->force || *known, err);
}

static sf_status estimate(const options *o, job *j, sf_error *err) {
    sf_sweep_cost cost;
    sf_error small = SF_ERROR_INIT;
    const bool elsewhere = o->engine.profile != NULL;
    int64_t open = 0;
    if (sf_runs_create(&j->plan, &j->runs, err) != SF_OK ||
        sf_sweep_campaign_status(&j->campaign, &j->runs, &open, err) != SF_OK ||
        sf_sweep_cost_estimate(&j->runs, open, j->folder, &cost, err) != SF_OK)
        return err->status;
    sf_sweep_print_table(stdout, &j->plan, TABLE_ROWS);
    sf_sweep_cost_print(stdout, &cost, elsewhere ? 0 : o->jobs);
    fflush(stdout);
    j->drop_seconds = cost.seconds;
    int abreast = !elsewhere ? o->jobs : open < SF_MANIFEST_GROUPS ? (int)open : SF_MANIFEST_GROUPS;
    if (sf_sweep_cost_check_disk(&cost, o->directory, abreast, &small) == SF_OK)
        return SF_OK;
    const sf_sink sink = sf_program_sink("softfall-sweep");
    if (o->yes)
        sf_sink_tell(&sink, SF_WARNING, "%s", small.text);
    else
        SF_FAIL(err, small.status, "%s (--yes begins all the same)", small.text);
    return err->status;
}

static sf_status run(const options *o, job *j, sf_error *err) {
    bool known = false;
    if (sf_engine_check(&o->engine, err) != SF_OK || check(o, j, &known, err) != SF_OK ||
        estimate(o, j, err) != SF_OK || o->dry)
        return err->status;
    sf_runs_free(&j->runs);
    if (sf_staging_begin(o->directory, j->list, o->force || known, &j->output, err) != SF_OK ||
        sf_folder_lock(o->directory, &j->lock, err) != SF_OK ||
        sf_runs_create(&j->plan, &j->runs, err) != SF_OK)
        return err->status;
    sf_runner runner = {
        .folder = j->folder, .threads = o->threads, .jobs = o->jobs, .log = stdout, .engine = o->engine};
    runner.engine.lock = &j->lock;
    runner.engine.drop_seconds = j->drop_seconds;
    const sf_sweep_engine engine = sf_sweep_drops(&runner, o->jobs);
    j->campaign.log = stdout;
    if (sf_sweep_campaign_run(&j->campaign, &engine, &j->runs, err) != SF_OK)
        return err->status;
    printf("%lld drops simulated, %lld were there\n", (long long)runner.simulated, (long long)runner.reused);
    return write_report(j, err);
}

int main(int argc, char **argv) {
    options o;
    sf_error err = SF_ERROR_INIT;
    job *j = sf_alloc(&err, 1, sizeof *j, "the plan");
    char *command = sf_command_line(argc, argv);
    mallopt(M_MMAP_THRESHOLD, LARGE_BLOCK);
    gsl_set_error_handler_off(); /* statuses are looked at */
    sf_process_handle_signals();
    if (sf_program_begin(argv, &err) == SF_OK && parse_command(argc, argv, &o, &err) == SF_OK) {
        j->lock = -1;
        j->command = command;
        if (sf_units_hold(&err) == SF_OK) { /* of very many cases */
            run(&o, j, &err);
            sf_units_let_go();
        }
        sf_staging_end(&j->output);
        sf_analysis_free(&j->analysis);
        sf_runs_free(&j->runs);
        sf_plan_free(&j->plan);
    }
    free(command);
    free(j);
    return sf_error_report(&err, "softfall-sweep");
}
