/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/children.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "gui/fields.h"
#include "io/plain_file.h"
#include "io/process.h"

sf_watch_stamp sf_watch_stamp_of(const char *path) {
    struct stat info;
    if (stat(path, &info) != 0)
        return (sf_watch_stamp){0};
    return (sf_watch_stamp){info.st_mtim.tv_sec, info.st_mtim.tv_nsec, info.st_size, info.st_ino};
}

bool sf_watch_same(const sf_watch_stamp *a, const sf_watch_stamp *b) {
    return a->seconds == b->seconds && a->nanoseconds == b->nanoseconds && a->size == b->size &&
           a->inode == b->inode;
}

static bool is_watched(const sf_watch *w, const char *path) {
    for (int k = 0; k < w->count; k++)
        if (strcmp(w->file[k].path, path) == 0)
            return true;
    return false;
}

void sf_watch_register(sf_watch *w, size_t first) {
    for (size_t k = first; k < sf_plain_count(); k++) {
        const char *path = sf_plain_get(k).path;
        if (w->count == SF_WATCHED || is_watched(w, path))
            continue;
        snprintf(w->file[w->count].path, sizeof w->file[w->count].path, "%s", path);
        w->file[w->count].stamp = sf_watch_stamp_of(path);
        w->count++;
    }
}

const char *sf_watch_changed(sf_watch *w) {
    for (int k = 0; k < w->count; k++) {
        sf_watch_stamp now = sf_watch_stamp_of(w->file[k].path);
        if (now.inode != 0 && !sf_watch_same(&now, &w->file[k].stamp)) { /* an editor may be replacing it */
            w->file[k].stamp = now;
            return w->file[k].path;
        }
    }
    return NULL;
}

enum { ARGUMENTS = 8 + 2 * SF_FIELD_OVERRIDES };

/* Adds the overrides to `n` arguments. */
static void add_overrides(const char *arguments[ARGUMENTS], int n, int count, const char *const *overrides) {
    for (int k = 0; k < count; k++) {
        arguments[n++] = "--set";
        arguments[n++] = overrides[k];
    }
    arguments[n] = NULL;
}

sf_status sf_programs_pre(sf_child *child, const char *case_path, const sf_run_folder *at, const char *cache,
                          int count, const char *const *overrides, FILE *log, sf_error *err) {
    char program[PATH_MAX], share[SF_RUN_PATH_SIZE];
    const char *arguments[ARGUMENTS] = {program, case_path, "-o", at->model, "--force", "--share", share};
    snprintf(share, sizeof share, "%s/" SF_RUN_SHARED, cache);
    add_overrides(arguments, 7, count, overrides);
    SF_TRY(sf_process_find("softfall-pre", program, sizeof program, err));
    return sf_child_start(child, arguments, log, err);
}

sf_status sf_programs_save(sf_child *child, const char *case_path, const char *folder, int count,
                           const char *const *overrides, FILE *log, sf_error *err) {
    char program[PATH_MAX];
    const char *slash = strchr(case_path, '/') ? "" : "./"; /* a name alone is an example's */
    char from[PATH_MAX + 8];
    const char *arguments[ARGUMENTS] = {program, folder, "--from", from};
    snprintf(from, sizeof from, "%s%s", slash, case_path);
    add_overrides(arguments, 4, count, overrides);
    SF_TRY(sf_process_find("softfall-new", program, sizeof program, err));
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
