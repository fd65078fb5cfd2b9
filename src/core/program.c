/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/program.h"

#include <errno.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void sf_error_ignore_closed_pipe(void) {
    signal(SIGPIPE, SIG_IGN);
}

int sf_error_report(const sf_error *err, const char *program) {
    sf_error last = *err;
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout))
        SF_FAIL(&last, SF_ERR_IO, "the standard output cannot be written%s%s", errno ? ": " : "",
                errno ? strerror(errno) : "");
    if (last.status == SF_OK)
        return 0;
    if (getenv("SOFTFALL_DEBUG"))
        fprintf(stderr, "%s: [%s:%d] %s\n", program, last.where, last.line, last.text);
    else
        fprintf(stderr, "%s: %s\n", program, last.text);
    return (int)last.status;
}

static void print(void *user, sf_severity severity, const char *sentence) {
    const char *program = user;
    fprintf(stderr, "%s: %s: %s\n", program, severity == SF_WARNING ? "warning" : "note", sentence);
}

sf_sink sf_program_sink(const char *program) {
    return (sf_sink){print, (void *)(uintptr_t)program};
}
