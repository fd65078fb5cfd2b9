/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks at a text in libconfig syntax before libconfig does, and refuses what libconfig would drop or cut
 * without a word: comments and strings that do not end, numbers that are none or do not fit, unknown escapes,
 * text beside an @include, and more text than a case can need (libconfig's time grows with the square of the
 * number of settings). */
#ifndef SF_CASE_SCAN_H
#define SF_CASE_SCAN_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>

/* One text, with everything that it includes. Begin with zeros; `path` and `line` are those of the line that
 * follows, for the sentences. */
typedef struct sf_case_scan {
    const char *path;
    int line;
    bool open; /* within a comment that began on `open_line` */
    int open_line;
    int comments; /* so far, like the next */
    int words;    /* names, numbers and strings */
    int depth;    /* of brackets */
} sf_case_scan;

/* A piece of a line, not terminated. */
typedef struct sf_case_slice {
    const char *text; /* NULL: none */
    size_t length;
} sf_case_slice;

/* Reads one line (`length` characters, without its line end). `include` receives the file name of an
 * `@include "name"`. */
sf_status sf_case_scan_line(sf_case_scan *scan, const char *line, size_t length, sf_case_slice *include,
                            sf_error *err);

/* At the end of a file: an open comment is refused. */
sf_status sf_case_scan_end(const sf_case_scan *scan, sf_error *err);

/* The same for a value on one line of its own, without a comment; `name` stands before the sentence. */
sf_status sf_case_scan_value(const char *name, const char *text, sf_error *err);

#endif
