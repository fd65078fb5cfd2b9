/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The set-up that all programs of studies share: `PROGRAM INPUT -o DIR` with its options, the output
 * directory that is staged and locked, the runner with its engine, warnings and closing lines. */
#pragma once
#include "base/program.h"
#include "study/runner.h"

typedef struct sf_study {
    const char *input, *directory; /* as given; borrowed from argv */
    char *command;                 /* the whole command line, for reports; owned */
    sf_sink sink;                  /* warnings, on stderr */
    bool force;
    int threads, jobs; /* 0: not given */
    sf_runner_engine engine;

    char runs[PATH_MAX]; /* DIR/runs: the drops' folders; from sf_study_check on */
    sf_staging output;   /* from sf_study_begin on, as the runner */
    sf_runner runner;
    int lock; /* of DIR, until the program ends; -1: none */
} sf_study;

/* A program of studies; static storage. */
typedef struct sf_study_program {
    const char *name;         /* "softfall-fit", in messages */
    const char *word;         /* its word of the command line, "drop"; NULL: it has none */
    const char *argument;     /* of the command line, "FIT.cfg" */
    const char *doc;          /* of --help, as in struct argp */
    bool drops;               /* it runs drops: --threads, --jobs, --engine and what belongs to them */
    const sf_option *options; /* further ones, of the values `own` of sf_study_main; NULL: none */
    sf_status (*run)(sf_study *study, void *own, sf_error *err);
} sf_study_program;

/* The whole program between the arguments and the exit code, which it returns; what `own` holds is the
 * caller's to release. Of a program with a word argv[0] is that word, and sf_program_begin was called. */
int sf_study_main(int argc, char **argv, const sf_study_program *program, void *own);

/* Before anything is computed or made. SF_ERR_INPUT: the engine cannot be used, or the directory holds one of
 * the files `names` (NULL at the end) without --force, or one that cannot be replaced. */
sf_status sf_study_check(sf_study *study, const char *const *names, sf_error *err);

/* Makes and locks the directory, and sets the runner up. `names` as for sf_staging_begin. */
sf_status sf_study_begin(sf_study *study, const char *const *names, sf_error *err);

/* A runner whose batches are a few drops each: an engine runs every drop as a job of its own, so that they
 * are side by side. */
void sf_study_run_apart(sf_study *study);

/* Prints what was simulated and which files were written ("report.html, fit.json"); `warning`: "" or a
 * sentence for the sink. */
void sf_study_close(const sf_study *study, const char *files, const char *warning);
