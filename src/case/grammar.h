/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_CASE_GRAMMAR_H
#define SF_CASE_GRAMMAR_H
#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

/* Looks at a text in libconfig syntax before libconfig does, and refuses what libconfig would drop or cut
 * without a word: comments and strings that do not end, numbers that are none or do not fit, unknown escapes,
 * text beside an @include, and more text than a case can need (libconfig's time grows with the square of the
 * number of settings). */

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

/* Returns what libconfig says of a text, with a hint where its words leave the user alone: "mismatched
 * element type in array". */
const char *sf_case_syntax_phrase(const char *libconfig_text);

/* The text of a file in libconfig syntax with its includes put in place, and where each of its lines comes
 * from; looked over by case/grammar.h. libconfig's own @include takes no absolute paths beside relative ones,
 * and its scanner ends the process on a folder. */

enum { SF_CASE_WHERE_SIZE = 512 /* of a text that says where a setting stands */ };

/* A piece of a case's text, whose includes are put in place before libconfig reads it: from line `first`
 * of the text on, the lines are those of the file `path` from `line` on. */
typedef struct sf_case_piece {
    int first, line;
    char *path; /* owned */
} sf_case_piece;

typedef struct sf_case_source {
    int count, capacity;
    sf_case_piece *piece; /* [count] ascending in `first` */
} sf_case_source;

/* The only walk over a file and its includes, in the order of the text. `begin` and `end` frame the lines of
 * a file; `include` receives a line with an @include before its file begins, `resume` the next line of the
 * outer file after it has ended. Members may be NULL, except `line`. `ended`: the line has a line end. */
typedef struct sf_case_visitor {
    void *context;
    sf_status (*begin)(void *context, const char *path, const sf_case_slice *included_as, sf_error *err);
    sf_status (*line)(void *context, const char *text, size_t length, bool ended, sf_error *err);
    sf_status (*include)(void *context, const char *text, size_t length, bool ended,
                         const sf_case_slice *name, sf_error *err);
    sf_status (*resume)(void *context, const char *path, int line, sf_error *err);
    sf_status (*end)(void *context, sf_error *err);
} sf_case_visitor;

/* Refuses includes that are missing or no plain files, nested or many beyond reason, and what the scan
 * refuses. */
sf_status sf_case_walk(const char *path, const sf_case_visitor *visitor, sf_error *err);

/* The text of the case with its includes put in place and the overrides as comments; from malloc. Includes
 * that are missing or no plain files are refused. `source` (may be NULL) is filled. */
char *sf_case_load_text(const char *path, int count, const char *const *overrides, sf_case_source *source,
                        sf_error *err);
/* File and line of a line of the text. */
const char *sf_case_source_find(const sf_case_source *source, int line, int *file_line);
void sf_case_source_free(sf_case_source *source);

/* The folder part of a path, "." if there is none; from malloc. */
char *sf_case_folder_of(const char *path, sf_error *err);

/* The file of a text "group=@file" or "materials.NAME=@file", NULL for "group.key=value". Relative to the
 * working directory. */
const char *sf_case_override_file(const char *text);
#endif
