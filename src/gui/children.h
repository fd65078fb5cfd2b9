/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_GUI_CHILDREN_H
#define SF_GUI_CHILDREN_H
#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "io/process.h"
#include "study/run_folder.h"

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

/* Watches what this process has read from entry `first` of the register on (io/plain_file.h), as it is now.
 */
void sf_watch_register(sf_watch *watch, size_t first);
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
#endif
