/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/setup.h"

#include "base/program.h"
#include "build_info.h"
#include "io/folder.h"
#include "io/process.h"
#include "io/provenance.h"
#include "study/engine.h"
#include <gsl/gsl_errno.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

enum { KEY_ENGINE = 0x7001, KEY_PROFILE, KEY_RETRY, KEY_PER_JOB, LAST_GROUP = 9, OPTIONS = 40 };

static const struct argp_option common[] = {
    {"output", 'o', "DIR", 0, "write everything there (required); drops stay in DIR/runs", 0},
    {"force", 'f', NULL, 0,
     "replace the files of an earlier command in DIR; drops that are finished are used again", 0},
    {0},
};

static const struct argp_option batches[] = {
    {"threads", 't', "N", 0, "threads of all drops together (default: every processor, or OMP_NUM_THREADS)",
     LAST_GROUP},
    {"jobs", 'j', "N", 0,
     "drops side by side, 64 at most, each with at least one thread (default: as many as threads); the same "
     "results",
     LAST_GROUP},
    {"engine", KEY_ENGINE, "NAME", 0, "what runs the drops: local (default) or snakemake", LAST_GROUP},
    {"profile", KEY_PROFILE, "PROFILE", 0,
     "with --engine snakemake: a profile of Snakemake; slurm: the one that comes with softfall", LAST_GROUP},
    {"per-job", KEY_PER_JOB, "N", 0,
     "with --engine snakemake: drops of a job (default 1; of softfall-sweep as many as take three minutes, "
     "within bounds)",
     LAST_GROUP},
    {"retry", KEY_RETRY, NULL, 0, "simulate drops again that failed earlier", LAST_GROUP},
    {0},
};

typedef struct parser {
    const sf_study_program *program;
    sf_study *study;
    void *own;
    sf_error *err;
} parser;

static void read_per_job(const char *text, int *per_job, sf_error *err) {
    char *end = NULL;
    *per_job = (int)strtol(text, &end, 10);
    if (end == text || *end || *per_job < 1 || *per_job > 100000)
        SF_FAIL(err, SF_ERR_INPUT, "--per-job %s: not a number from 1 to 100000", text);
}

static void read_jobs(const char *text, int *jobs, sf_error *err) {
    sf_error ignored = SF_ERROR_INIT;
    if (sf_program_read_threads(text, jobs, &ignored) != SF_OK || *jobs > SF_PROCESS_JOBS)
        SF_FAIL(err, SF_ERR_INPUT, "--jobs takes a number from 1 to %d, not \"%s\"", SF_PROCESS_JOBS, text);
}

static error_t parse(int key, char *text, struct argp_state *state) {
    parser *p = state->input;
    sf_study *s = p->study;
    switch (key) {
    case 'o':
        s->directory = text;
        return 0;
    case 'f':
        s->force = true;
        return 0;
    case 't':
        sf_program_read_threads(text, &s->threads, p->err);
        return 0;
    case 'j':
        read_jobs(text, &s->jobs, p->err);
        return 0;
    case KEY_ENGINE:
        s->engine.name = text;
        return 0;
    case KEY_PROFILE:
        s->engine.profile = text;
        return 0;
    case KEY_PER_JOB:
        read_per_job(text, &s->engine.per_job, p->err);
        return 0;
    case KEY_RETRY:
        s->engine.retry = true;
        return 0;
    case ARGP_KEY_ARG:
        if (s->input)
            argp_error(state, "one %s at a time: \"%s\" is one too many", p->program->argument, text);
        s->input = text;
        return 0;
    case ARGP_KEY_END:
        if (!s->input || !s->directory)
            argp_error(state, "give %s, and the output directory with -o", p->program->argument);
        return 0;
    default:
        if (key >= ARGP_KEY_NO_ARGS || key == ARGP_KEY_ARG)
            return ARGP_ERR_UNKNOWN;
        p->program->take(key, text, p->own, p->err);
        return 0;
    }
}

static void append(struct argp_option *list, int *count, const struct argp_option *more) {
    while (more && (more->name || more->key) && *count < OPTIONS - 1)
        list[(*count)++] = *more++;
}

static sf_status parse_command(int argc, char **argv, parser *p, sf_error *err) {
    struct argp_option list[OPTIONS] = {0};
    char words[64];
    int count = 0;
    append(list, &count, common);
    append(list, &count, p->program->options);
    if (p->program->drops)
        append(list, &count, batches);
    snprintf(words, sizeof words, "%s -o DIR", p->program->argument);
    const struct argp known = {.options = list, .parser = parse, .args_doc = words, .doc = p->program->doc};
    if (argp_parse(&known, argc, argv, 0, NULL, p) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "the command line cannot be read");
    return err->status;
}

/* "softfall-fit drop" of a program and its word. */
static void name_command(const sf_study_program *p, char *text, size_t size) {
    snprintf(text, size, "%s%s%s", p->name, p->word ? " " : "", p->word ? p->word : "");
}

static char *command_of(int argc, char **argv, const sf_study_program *program, sf_error *err) {
    char *words = sf_command_line(argc, argv), *text = NULL;
    if (!words ||
        asprintf(&text, "%s%s%s", program->word ? program->name : "", program->word ? " " : "", words) < 0) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the command line");
        text = NULL;
    }
    free(words);
    return text;
}

int sf_study_main(int argc, char **argv, const sf_study_program *program, void *own) {
    static char version[128], name[64];
    sf_error err = SF_ERROR_INIT;
    sf_study study = {.lock = -1, .sink = sf_program_sink(program->name)};
    parser p = {program, &study, own, &err};
    gsl_set_error_handler_off(); /* statuses are looked at */
    sf_process_handle_signals();
    snprintf(version, sizeof version, "%s " SF_VERSION " (" SF_GIT_REVISION ")", program->name);
    argp_program_version = version;
    study.command = command_of(argc, argv, program, &err);
    if (err.status == SF_OK && !program->word)
        sf_program_begin(argv, &err);
    if (program->word) {
        name_command(program, name, sizeof name);
        argv[0] = name;
    }
    if (err.status == SF_OK && parse_command(argc, argv, &p, &err) == SF_OK)
        program->run(&study, own, &err);
    sf_staging_end(&study.output);
    free(study.command);
    return sf_error_report(&err, program->name);
}

sf_status sf_study_check(sf_study *s, const char *const *names, sf_error *err) {
    SF_TRY(sf_engine_check(&s->engine, err));
    if ((size_t)snprintf(s->runs, sizeof s->runs, "%s/runs", s->directory) >= sizeof s->runs - 64)
        return SF_FAIL(err, SF_ERR_INPUT, "the path of the output directory is too long");
    return sf_staging_check(s->directory, names, s->force, err);
}

sf_status sf_study_begin(sf_study *s, const char *const *names, sf_error *err) {
    SF_TRY(sf_staging_begin(s->directory, names, s->force, &s->output, err));
    SF_TRY(sf_folder_lock(s->directory, &s->lock, err));
    if (s->threads == 0)
        s->threads = omp_get_max_threads();
    s->runner = (sf_runner){
        .folder = s->runs, .threads = s->threads, .jobs = s->jobs, .log = stdout, .engine = s->engine};
    s->runner.engine.lock = &s->lock;
    return SF_OK;
}

void sf_study_run_apart(sf_study *s) {
    if (!sf_engine_is_local(&s->engine) && s->runner.engine.per_job == 0)
        s->runner.engine.per_job = 1;
}

void sf_study_close(const sf_study *s, const char *files, const char *warning) {
    if (s->runner.folder)
        printf("%lld drops simulated, %lld were there\n", (long long)s->runner.simulated,
               (long long)s->runner.reused);
    printf("Written: %s/%s\n", s->directory, files);
    fflush(stdout);
    if (*warning)
        sf_sink_tell(&s->sink, SF_WARNING, "%s", warning);
}
