/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a file in libconfig syntax with its includes put in place, and where each of its lines comes
 * from; looked over by case/grammar.h. libconfig's own @include takes no absolute paths beside relative ones,
 * and its scanner ends the process on a folder. */
#ifndef SF_CASE_SOURCE_H
#define SF_CASE_SOURCE_H

#include "base/error.h"

enum { SF_CASE_WHERE_SIZE = 512 /* of a text that says where a setting stands */ };

/* Where the lines of a case's text come from, as its includes are put in place before libconfig reads it:
 * from line `first` of the text on, they are those of the file `path` from `line` on. */
typedef struct sf_case_piece {
    int first, line;
    char *path; /* owned */
} sf_case_piece;

typedef struct sf_case_source {
    int count, capacity;
    sf_case_piece *piece; /* [count] ascending in `first` */
} sf_case_source;

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
