/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the programs alone do: print, and turn a status into an exit code. No library calls this. */
#ifndef SF_CORE_PROGRAM_H
#define SF_CORE_PROGRAM_H

#include "core/error.h"
#include "core/sink.h"

/* A reader of the standard output that goes away (`softfall-pre ... | head -1`) shall not end the program in
 * the middle of its files: the signal is ignored, and sf_error_report finds that the output failed. To be
 * called first in main. */
void sf_error_ignore_closed_pipe(void);

/* Prints "program: sentence" (and the source line when SOFTFALL_DEBUG is set in the environment) to stderr.
 * Without a failure it is one if the standard output could not be written. Returns the process exit code that
 * belongs to the status. */
int sf_error_report(const sf_error *err, const char *program);

/* A sink that prints "program: warning: sentence" (or "note:") to stderr; `program` is borrowed. */
sf_sink sf_program_sink(const char *program);

#endif
