/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/session.h"

#include "base/hash.h"
#include "io/folder.h"
#include "io/plain_file.h"
#include "io/replace.h"

#include <inttypes.h>
#include <sys/stat.h>

static const struct {
    const char *name;
    sf_activity done, stopped;
} activities[] = {
#define ACTIVITY(constant, name, done, stopped) {name, SF_##done, SF_##stopped},
    SF_ACTIVITIES(ACTIVITY)
#undef ACTIVITY
};

const char *sf_activity_name(sf_activity activity) {
    return activities[activity].name;
}

bool sf_activity_is_busy(sf_activity a) {
    return activities[a].done != a;
}

sf_activity sf_activity_next(sf_activity a, sf_event event) {
    bool busy = sf_activity_is_busy(a);
    switch (event) {
    case SF_PRESS_MESH:
        return busy ? a : SF_MESHING;
    case SF_PRESS_RUN:
        return busy ? a : a == SF_DONE ? SF_REPORTING : SF_PREPARING;
    case SF_PRESS_SAVE:
        return busy ? a : SF_SAVING;
    case SF_PRESS_STOP:
        return activities[a].stopped;
    case SF_CHILD_DONE:
        return activities[a].done;
    case SF_CHILD_INTERRUPTED:
        return busy ? SF_STOPPED : a;
    case SF_CHILD_FAILED:
        return a == SF_STOPPING || a == SF_CANCELLING ? SF_STOPPED : busy ? SF_FAILED : a;
    case SF_EDIT:
        return busy ? a : SF_IDLE;
    default:
        return a;
    }
}

/* ---- files that change, and programs ---- */

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

void sf_watch_add(sf_watch *w, const char *path) {
    if (w->count == SF_WATCHED || is_watched(w, path))
        return;
    snprintf(w->file[w->count].path, sizeof w->file[w->count].path, "%s", path);
    w->file[w->count].stamp = sf_watch_stamp_of(path);
    w->count++;
}

void sf_watch_register(sf_watch *w, size_t first) {
    for (size_t k = first; k < sf_plain_count(); k++)
        sf_watch_add(w, sf_plain_get(k).path);
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

/* ---- the folder of runs ---- */

static sf_status find(char *path, size_t size, sf_error *err) {
    const char *given = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    bool cache = given && *given == '/';
    if (!cache && !(home && *home == '/'))
        return SF_FAIL(err, SF_ERR_IO,
                       "there is no place for runs: neither XDG_CACHE_HOME nor HOME names a folder");
    SF_TRY(sf_path_print(path, size, err, cache ? "%s" : "%s/.cache", cache ? given : home));
    mkdir(path, 0700); /* a folder of the user's programs, not of softfall alone: without its mark */
    SF_TRY(
        sf_path_print(path, size, err, cache ? "%s/softfall" : "%s/.cache/softfall", cache ? given : home));
    return sf_folder_own(path, err);
}

sf_status sf_cache_find(char *path, size_t size, sf_error *err) {
    *path = '\0';
    if (find(path, size, err) != SF_OK)
        *path = '\0'; /* no run may go where it is not allowed to */
    return err->status;
}

void sf_cache_wrap(const char *cache, const char *geometry, char *wrap, size_t size) {
    char whole[PATH_MAX];
    sf_replacement out;
    sf_error none = SF_ERROR_INIT;
    *wrap = '\0';
    if (!*cache || !realpath(geometry, whole) || strpbrk(whole, "\"\\\n"))
        return;
    uint64_t hash = sf_hash_bytes(SF_HASH_START, whole, strlen(whole));
    snprintf(wrap, size, "%s/window-%016" PRIx64 ".geo", cache, hash);
    if (sf_replace_open(wrap, &out, &none)) {
        fprintf(out.file, "Merge \"%s\";\n", whole);
        sf_replace_close(&out, &none);
    }
    if (none.status != SF_OK)
        *wrap = '\0';
}
