/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For the programs alone: printing, and exit codes from status codes. No library calls this. */
#ifndef SF_BASE_PROGRAM_H
#define SF_BASE_PROGRAM_H

#include "base/error.h"

enum { SF_MOST_THREADS = 1024 };

/* main calls it first. Ignores SIGPIPE and SIGXFSZ, so that a closed standard output (`softfall-pre ... |
 * head -1`) and a limit of file sizes become failed writes with their sentences, and do not end the program
 * in the middle of its files. SF_ERR_INPUT if the environment has an impossible value for OpenMP,
 * SF_ERR_MEMORY if the stack is limited to less than 1 MB; if only the soft limit is, the program starts
 * itself again with more. */
sf_status sf_program_begin(char **argv, sf_error *err);

/* Can `threads` threads run at once? SF_ERR_MEMORY if not: OpenMP would end the program without a sentence of
 * ours. */
sf_status sf_program_try_threads(int threads, sf_error *err);

/* The number after --threads: 1 to SF_MOST_THREADS. */
sf_status sf_program_read_threads(const char *text, int *threads, sf_error *err);

/* The limit after `option`: a finite number above 0. */
sf_status sf_program_read_limit(const char *option, const char *text, double *limit, sf_error *err);

/* Prints "program: sentence" (and the source line when SOFTFALL_DEBUG is set in the environment) to stderr. A
 * standard output that could not be written counts as a failure. Returns the process exit code that belongs
 * to the status. */
int sf_error_report(const sf_error *err, const char *program);

/* A sink that prints "program: warning: sentence" (or "note:") to stderr; `program` is borrowed. */
sf_sink sf_program_sink(const char *program);

#endif
