/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs of softfall-solve that are disturbed, and their results against those of one run. */
#ifndef SF_TESTS_RUN_FIXTURE_H
#define SF_TESTS_RUN_FIXTURE_H

#include "program_fixture.h"
#include <stdbool.h>
#include <sys/types.h>
#include <time.h>

/* Starts softfall-solve in the folder with up to 15 words, the last NULL; "log" and "errors" get its words.
 */
pid_t run_start(const program_place *place, const char *const *words);
void run_sleep(double seconds);
/* Is there a file folder/name? */
bool run_is_there(const program_place *place, const char *name);

/* Fails unless history, frames, peak and summary are the same bit by bit, and there are more than one frame.
 */
void run_assert_same(const program_place *place, const char *first, const char *second);
/* The same of all that the group holds. */
void run_assert_same_group(const sf_h5 *a, const sf_h5 *b, const char *path);

/* How often a run was resumed. */
int64_t run_restarts(const program_place *place, const char *name);

/* When the file was written, 0: it is not there. */
struct timespec run_written_at(const char *folder, const char *name);
/* Is `b` there, and another file than `a`? */
bool run_is_other(struct timespec a, struct timespec b);

#endif
