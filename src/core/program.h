/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For the programs alone: printing, and exit codes from status codes. No library calls this. */
#ifndef SF_CORE_PROGRAM_H
#define SF_CORE_PROGRAM_H

#include "core/error.h"
#include "core/sink.h"

/* Ignores SIGPIPE, so that a closed standard output (`softfall-pre ... | head -1`) does not end the program
 * in the middle of its files; sf_error_report reports the failed output. main calls it first. */
void sf_error_ignore_closed_pipe(void);

/* Prints "program: sentence" (and the source line when SOFTFALL_DEBUG is set in the environment) to stderr. A
 * standard output that could not be written counts as a failure. Returns the process exit code that belongs
 * to the status. */
int sf_error_report(const sf_error *err, const char *program);

/* A sink that prints "program: warning: sentence" (or "note:") to stderr; `program` is borrowed. */
sf_sink sf_program_sink(const char *program);

#endif
