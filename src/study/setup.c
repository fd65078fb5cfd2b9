/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/setup.h"

#include "io/folder.h"
#include "io/plain_file.h"
#include "io/process.h"
#include <gsl/gsl_errno.h>
#include <omp.h>

enum { LAST_GROUP = 9 };

static const sf_option common[] = {
    {"output", 'o', "DIR", "write everything there (required); drops stay in DIR/runs",
     .member = offsetof(sf_study, directory)},
    {"force", 'f', NULL,
     "replace the files of an earlier command in DIR; drops that are finished are used again",
     .member = offsetof(sf_study, force)},
    {0},
};

static const sf_option batches[] = {
    {"threads", 't', "N", "threads of all drops together (default: every processor, or OMP_NUM_THREADS)",
     .member = offsetof(sf_study, threads), .low = 1, .high = SF_MOST_THREADS, .group = LAST_GROUP},
    {"jobs", 'j', "N",
     "drops side by side, 64 at most, each with at least one thread (default: as many as threads); the same "
     "results",
     .member = offsetof(sf_study, jobs), .low = 1, .high = SF_PROCESS_JOBS, .group = LAST_GROUP},
    {"engine", 0, "NAME", "what runs the drops: local (default) or snakemake",
     .member = offsetof(sf_study, engine.name), .group = LAST_GROUP},
    {"profile", 0, "PROFILE",
     "with --engine snakemake: a profile of Snakemake; slurm: the one that comes with softfall",
     .member = offsetof(sf_study, engine.profile), .group = LAST_GROUP},
    {"per-job", 0, "N", "with --engine snakemake: drops of a job (default 1)",
     .member = offsetof(sf_study, engine.per_job), .low = 1, .high = 100000, .group = LAST_GROUP},
    {"retry", 0, NULL, "simulate drops again that failed earlier", .member = offsetof(sf_study, engine.retry),
     .group = LAST_GROUP},
    {0},
};

static const char *find_fault(const sf_command *command) {
    static char text[128];
    const sf_study *s = command->list[0].values;
    snprintf(text, sizeof text, "give %.*s, and the output directory with -o",
             (int)strcspn(command->operands, " "), command->operands);
    return s->input && s->directory ? NULL : text;
}

static sf_status parse_command(int argc, char **argv, const sf_study_program *program, sf_study *study,
                               void *own, sf_error *err) {
    SF_PRINTED(operands, 64, "%s -o DIR", program->argument);
    SF_PRINTED(second, 96, "one %s at a time: \"%%s\" is one too many", program->argument);
    const sf_command command = {
        .program = program->name,
        .operands = operands,
        .meaning = program->doc,
        .second = second,
        .operand = offsetof(sf_study, input),
        .fault = find_fault,
        .list = {{common, study}, {program->options, own}, {program->drops ? batches : NULL, study}}};
    return sf_command_parse(&command, argc, argv, err);
}

int sf_study_main(int argc, char **argv, const sf_study_program *program, void *own) {
    static char name[64]; /* "softfall-fit drop" */
    SF_OWNED char *words = sf_command_line(argc, argv);
    sf_error err = SF_ERROR_INIT;
    sf_study study = {.lock = -1, .sink = sf_program_sink(program->name)};
    gsl_set_error_handler_off(); /* statuses are looked at */
    sf_process_handle_signals();
    if (!words || asprintf(&study.command, "%s%s%s", program->word ? program->name : "",
                           program->word ? " " : "", words) < 0)
        SF_NO_MEMORY(&err, "the command line");
    else if (!program->word)
        sf_program_begin(argv, &err);
    if (program->word) {
        snprintf(name, sizeof name, "%s %s", program->name, program->word);
        argv[0] = name;
    }
    if (err.status == SF_OK && parse_command(argc, argv, program, &study, own, &err) == SF_OK)
        program->run(&study, own, &err);
    sf_staging_end(&study.output);
    free(study.command);
    return sf_error_report(&err, program->name);
}

sf_status sf_study_check(sf_study *s, const char *const *names, sf_error *err) {
    SF_TRY(sf_engine_check(&s->engine, err));
    SF_TRY(sf_path_print(s->runs, sizeof s->runs - 64, err, "%s/runs", s->directory));
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
    sf_log_print(stdout, "Written: %s/%s\n", s->directory, files);
    if (*warning)
        sf_sink_tell(&s->sink, SF_WARNING, "%s", warning);
}
