/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <signal.h>
#include <sys/types.h>

#include "base/error.h"

/* Other programs, run to their end. */

/* The path of one of softfall's own programs: in SF_BIN_DIR if that is set, else in the folder of the running
 * program. SF_ERR_IO if it is not there. */
sf_status sf_process_find(const char *name, char *path, size_t size, sf_error *err);

/* A file or folder that comes with softfall: share/softfall/`name` beside the folder of the programs, or of
 * the library. SF_ERR_IO if it is not there. */
sf_status sf_process_find_shared(const char *name, char *path, size_t size, sf_error *err);

/* True if there is a program of this name in PATH. */
bool sf_process_is_in_path(const char *name);

typedef struct sf_process {
    const char *const *arguments; /* the program, a path or a name to look for in PATH, and its arguments;
                                     ends with NULL */
    const char *folder;           /* in which it runs; NULL: the present one */
    const char *log; /* file to which its output is appended, not through a link; NULL: dropped */
    bool stoppable;  /* signals are passed on to it, see sf_process_handle_signals */
    bool apart; /* in a process group of its own, which a terminal does not reach: passed on, each signal is
                   SIGINT to the whole group. Only one such program at a time */
    const int *held; /* a descriptor that it keeps open while it runs: a lock of this process's folder that
                        outlives this process; NULL or *held < 0: none */
    void (*tick)(void *context); /* called every ten seconds while it runs; NULL: not */
    void *context;
} sf_process;

/* Runs the program with nothing to read. Returns 0 and its exit code (128 + the signal that ended it), or the
 * errno value that says why it cannot be run. From then on SIGCHLD is not ignored. */
int sf_process_run(const sf_process *process, int *exit_code);

/* After this call SIGINT and SIGTERM do not end this process but are passed on to the stoppable program
 * that runs; one that is started later gets SIGTERM at once. Returns the flag that is not 0 from then on. */
const volatile sig_atomic_t *sf_process_handle_signals(void);
/* True once such a signal has come. */
bool sf_process_stopped(void);

enum { SF_PROCESS_JOBS = 64 }; /* side by side, at most */
/* So begins the sentence of a copy that a signal ended; its number follows. */
#define SF_PROCESS_KILLED "its process was ended by signal"

/* Work that sf_process_pool has done in a process of its own. */
typedef sf_status (*sf_process_work)(void *context, int index, sf_error *err);

/* Called in this process each time that a copy has ended; `ended` of `count` have so far. */
typedef void (*sf_process_watch)(void *context, int index, int ended, const sf_error *result);

/* Calls `work` for every index below `count`, `jobs` at a time (at most SF_PROCESS_JOBS), each in a copy
 * of this process that ends with the call: its changes of the memory are lost, its failure comes back in
 * result[index] (the source line apart); a copy that a signal ended gives SF_ERR_LIBRARY with
 * SF_PROCESS_KILLED. Signals are passed on to the copies and by these to their stoppable programs; after a
 * signal no more is begun (SF_INTERRUPTED). A copy ends when this process does. The call waits for all of
 * them. `err`: a copy cannot be made. */
sf_status sf_process_pool(int count, int jobs, sf_process_work work, sf_process_watch watch, void *context,
                          sf_error *result, sf_error *err);

/* Seconds on a clock that only goes forward. */
double sf_process_now(void);
