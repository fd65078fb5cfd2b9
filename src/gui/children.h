/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command lines of softfall-pre, softfall-solve, softfall-post and softfall-new, begun as children
 * (io/child.h). */
#ifndef SF_GUI_PROGRAMS_H
#define SF_GUI_PROGRAMS_H

#include "study/run_folder.h"
#include "io/child.h"

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
