/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The activity of the window, and the next one that a button or the end of a program leads to. */
#pragma once
#include "base/error.h"
#include "io/process.h"
#include "study/run_folder.h"
#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Lists each activity with its shown name and the activities that follow the success of its program and Stop.
 * An activity that success does not change is not busy. Only a run leaves results. */
#define SF_ACTIVITIES(X)                                                                                     \
    X(IDLE, "ready", IDLE, IDLE)                                                                             \
    X(MESHING, "meshing", MESHED, CANCELLING) /* softfall-pre for the checks */                              \
    X(MESHED, "meshed", MESHED, MESHED)                                                                      \
    X(PREPARING, "meshing before the run", RUNNING, CANCELLING) /* softfall-pre for a run */                 \
    X(RUNNING, "running", REPORTING, STOPPING)                  /* softfall-solve */                         \
    X(STOPPING, "stopping", DONE, STOPPING)                     /* a run was asked to end */                 \
    X(CANCELLING, "cancelling", STOPPED, CANCELLING)   /* softfall-pre or Save case was asked to end */      \
    X(STOPPED, "stopped", STOPPED, STOPPED)            /* a run can be resumed */                            \
    X(REPORTING, "writing the report", DONE, STOPPING) /* softfall-post */                                   \
    X(SAVING, "saving the case", SAVED, CANCELLING)                                                          \
    X(SAVED, "saved", SAVED, SAVED)                                                                          \
    X(DONE, "done", DONE, DONE)                                                                              \
    X(FAILED, "failed", FAILED, FAILED)

#define SF_ACTIVITY_CONSTANT(constant, ...) SF_##constant,
typedef enum sf_activity { SF_ACTIVITIES(SF_ACTIVITY_CONSTANT) SF_ACTIVITY_COUNT } sf_activity;
#undef SF_ACTIVITY_CONSTANT

typedef enum sf_event {
    SF_PRESS_MESH,
    SF_PRESS_RUN, /* of what is done: its report */
    SF_PRESS_STOP,
    SF_PRESS_SAVE,
    SF_CHILD_DONE,        /* the program ended well */
    SF_CHILD_INTERRUPTED, /* it ended because it was asked to */
    SF_CHILD_FAILED,
    SF_EDIT, /* a value or a file has changed */
    SF_EVENT_COUNT
} sf_event;

/* "ready", ...; static. */
const char *sf_activity_name(sf_activity activity);
/* A program is at work. */
bool sf_activity_is_busy(sf_activity activity);
/* The activity after the event; the same one where the event means nothing. */
sf_activity sf_activity_next(sf_activity activity, sf_event event);

/* Notices that files change. */

enum { SF_WATCHED = 64 };

/* Two stamps of a file that is as it was are equal. */
typedef struct sf_watch_stamp {
    int64_t seconds, nanoseconds, size;
    uint64_t inode; /* 0: there is no file */
} sf_watch_stamp;

typedef struct sf_watch {
    int count;
    struct {
        char path[PATH_MAX];
        sf_watch_stamp stamp;
    } file[SF_WATCHED];
} sf_watch;

sf_watch_stamp sf_watch_stamp_of(const char *path);
bool sf_watch_same(const sf_watch_stamp *a, const sf_watch_stamp *b);

/* Watches what this process has read from entry `first` of the register on (io/plain_file.h), as it is. */
void sf_watch_register(sf_watch *watch, size_t first);
void sf_watch_add(sf_watch *watch, const char *path);
/* The first file that is not as it was; NULL: none. From now on it is watched as it is now. */
const char *sf_watch_changed(sf_watch *watch);

/* The command lines of softfall-pre, softfall-solve, softfall-post and softfall-new, begun as children
 * (io/process.h). */

/* The case with its overrides -> at->model; meshes are shared among the runs in `cache`. */
sf_status sf_programs_pre(sf_child *child, const char *case_path, const sf_run_folder *at, const char *cache,
                          int count, const char *const *overrides, FILE *log, sf_error *err);
/* at->model -> at->results, or on from at->checkpoint. `threads` 0: as the program chooses. */
sf_status sf_programs_solve(sf_child *child, const sf_run_folder *at, bool resume, int threads, FILE *log,
                            sf_error *err);
/* at->results -> at->path/report. */
sf_status sf_programs_post(sf_child *child, const sf_run_folder *at, FILE *log, sf_error *err);
/* The case with its overrides -> a folder of its own, by softfall-new. */
sf_status sf_programs_save(sf_child *child, const char *case_path, const char *folder, int count,
                           const char *const *overrides, FILE *log, sf_error *err);

/* The folder in which the window keeps its runs: $XDG_CACHE_HOME/softfall, or ~/.cache/softfall. Nothing is
 * written anywhere else but by Save case. */

/* Makes it if need be. SF_ERR_IO: there is no home folder, or it cannot be made; SF_ERR_INPUT: it is not
 * softfall's own (io/folder.h). On failure the path is "". */
sf_status sf_cache_find(char *path, size_t size, sf_error *err);

/* Writes the file that gmsh opens in place of a geometry, into that folder: it merges the geometry. What
 * gmsh's menus rename, delete or append to is that file. `wrap` is "" if it cannot be written. */
void sf_cache_wrap(const char *cache, const char *geometry, char *wrap, size_t size);
