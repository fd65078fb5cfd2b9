/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/programs.h"

#include "gui/fields.h"
#include "io/process.h"
#include <stdio.h>

sf_status sf_programs_pre(sf_child *child, const char *case_path, const sf_run_folder *at, const char *cache,
                          int count, const char *const *overrides, FILE *log, sf_error *err) {
    char program[PATH_MAX], share[SF_RUN_PATH_SIZE];
    const char *arguments[8 + 2 * SF_FIELD_OVERRIDES] = {program,   case_path, "-o", at->model,
                                                         "--force", "--share", share};
    int n = 7;
    snprintf(share, sizeof share, "%s/" SF_RUN_SHARED, cache);
    for (int k = 0; k < count; k++) {
        arguments[n++] = "--set";
        arguments[n++] = overrides[k];
    }
    SF_TRY(sf_process_find("softfall-pre", program, sizeof program, err));
    return sf_child_start(child, arguments, log, err);
}

sf_status sf_programs_solve(sf_child *child, const sf_run_folder *at, bool resume, int threads, FILE *log,
                            sf_error *err) {
    char program[PATH_MAX], number[16];
    const char *arguments[8] = {program, at->model, "-o", at->results, "--force"};
    int n = 5;
    if (resume) {
        arguments[1] = "--restart";
        arguments[2] = at->results;
        arguments[3] = at->model;
        n = 4;
    }
    snprintf(number, sizeof number, "%d", threads);
    if (threads > 0) {
        arguments[n++] = "-t";
        arguments[n++] = number;
    }
    arguments[n] = NULL;
    SF_TRY(sf_process_find("softfall-solve", program, sizeof program, err));
    return sf_child_start(child, arguments, log, err);
}

sf_status sf_programs_post(sf_child *child, const sf_run_folder *at, FILE *log, sf_error *err) {
    char program[PATH_MAX], directory[SF_RUN_PATH_SIZE + 16];
    const char *arguments[] = {program, at->results, "-o", directory, "--force", NULL};
    snprintf(directory, sizeof directory, "%s/report", at->path);
    SF_TRY(sf_process_find("softfall-post", program, sizeof program, err));
    return sf_child_start(child, arguments, log, err);
}
