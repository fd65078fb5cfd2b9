/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/error.h"

#include <errno.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

sf_status sf_error_set(sf_error *err, sf_status status, const char *where, int line, const char *format,
                       ...) {
    if (err->status != SF_OK)
        return err->status;
    err->status = status;
    err->where = where;
    err->line = line;
    va_list args;
    va_start(args, format);
    vsnprintf(err->text, sizeof err->text, format, args);
    va_end(args);
    /* Texts of files stand in the sentence: their line ends and escapes must not reach the terminal. */
    for (char *c = err->text; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 127)
            *c = ' ';
    return status;
}

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

/* Large blocks ask for large pages: a step reads them from end to end, and address translation of small pages
 * costs a few percent of it. */
static void *allocate(unsigned long bytes) {
    static const unsigned long large = 2UL << 20;
    void *block = NULL;
    if (posix_memalign(&block, bytes < large ? 64 : large, bytes) != 0)
        return NULL;
    if (bytes >= large)
        madvise(block, bytes, MADV_HUGEPAGE); /* advice: nothing depends on it */
    return block;
}

void *sf_alloc(sf_error *err, unsigned long count, unsigned long size, const char *what) {
    if (size != 0 && count > (SIZE_MAX - 64) / size) {
        SF_FAIL(err, SF_ERR_MEMORY, "%s: %lu items of %lu bytes exceed the address space", what, count, size);
        return NULL;
    }
    unsigned long bytes = (count * size + 63) / 64 * 64;
    void *block = allocate(bytes ? bytes : 64);
    if (!block) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for %s (%.1f MB)", what, (double)bytes / 1e6);
        return NULL;
    }
    memset(block, 0, bytes ? bytes : 64);
    return block;
}
