/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/error.h"

/* Looks at a text in libconfig syntax before libconfig does, and refuses what libconfig would drop or cut
 * without a word: comments and strings that do not end, numbers that are none or do not fit, unknown escapes,
 * text beside an @include, and more text than a case can need (libconfig's time grows with the square of the
 * number of settings). */

/* Refuses a value on one line of its own likewise, and one with a comment; the sentence begins with `name`.
 */
sf_status sf_case_scan_value(const char *name, const char *text, sf_error *err);

/* Returns what libconfig says of line `line` of a text, with a hint where its words leave the user alone: a
 * value with a unit without quotation marks, "mismatched element type in array". */
const char *sf_case_syntax_phrase(const char *libconfig_text, const char *text, int line);

/* The text of a file in libconfig syntax with its includes put in place, and where each of its lines comes
 * from; looked over as above. libconfig's own @include takes no absolute paths beside relative ones,
 * and its scanner ends the process on a folder. */

enum { SF_CASE_WHERE_SIZE = 512 /* of a text that says where a setting stands */ };

/* A piece of a case's text, whose includes are put in place before libconfig reads it: from line `first`
 * of the text on, the lines are those of the file `path` from `line` on. */
typedef struct sf_case_piece {
    int first, line;
    char *path; /* owned */
} sf_case_piece;

typedef struct sf_case_source {
    int count;
    sf_case_piece *piece; /* [count] ascending in `first` */
} sf_case_source;

/* The text of the case with its includes put in place and the overrides as comments; from malloc. Includes
 * that are missing or no plain files are refused. `of_case`: the file is a case, in which a line `material =
 * "NAME";` stands for the file of that foam; others are left as they are. `source` (may be NULL) is filled.
 */
char *sf_case_load_text(const char *path, bool of_case, int count, const char *const *overrides,
                        sf_case_source *source, sf_error *err);
/* The text of a case file for case/edit.c: two marks, comments on lines of their own, frame the text of an
 * included file: "#" and SF_CASE_BEGIN with the line of the include behind them, "#" and SF_CASE_END. No
 * other line holds these characters. `whole`: the includes are named from / on. From malloc, NULL on failure.
 */
#define SF_CASE_BEGIN '\001'
#define SF_CASE_END '\002'
#define SF_CASE_MARKS "\001\002"
char *sf_case_load_marked(const char *path, bool whole, sf_error *err);

/* File and line of a line of the text. */
const char *sf_case_source_find(const sf_case_source *source, int line, int *file_line);
void sf_case_source_free(sf_case_source *source);

/* The folder part of a path, "." if there is none; from malloc. */
char *sf_case_folder_of(const char *path, sf_error *err);

/* The file of a text "group=@file" or "materials.NAME=@file", NULL for "group.key=value". Relative to the
 * working directory. */
const char *sf_case_override_file(const char *text);
