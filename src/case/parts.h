/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files that a case's text is made of, to be changed and written at another place: their lines stay as
 * they are but for the values of --set texts and the names of files.
 *
 * A file that is included twice is two parts: a --set text changes what it says, and nothing else. Only of
 * cases that sf_case_read took with the same texts; what is odd in another case is left as it is. */
#ifndef SF_CASE_PARTS_H
#define SF_CASE_PARTS_H

#include "case/settings.h"
#include "base/error.h"
#include <stdbool.h>

/* Release with sf_case_parts_free, also on failure. */
sf_status sf_case_parts_read(const char *path, sf_case_parts *parts, sf_error *err);
/* Puts a --set text, "group.key=value" or "group=@file", where it belongs. */
sf_status sf_case_parts_set(sf_case_parts *parts, const char *text, sf_error *err);

/* True if the value of "group.key" names a file. */
bool sf_case_key_is_file(const char *key);

/* A file that the case names: what it is, and how. */
typedef struct sf_case_file {
    enum { SF_CASE_FILE_PART, SF_CASE_FILE_DATA, SF_CASE_FILE_GEOMETRY } kind;
    const char *path;   /* where it stands, from / */
    const char *wanted; /* where it would go with its present name; NULL: outside of the new folder */
    const char *text;   /* of a part; NULL: of another file */
} sf_case_file;

/* The file's name in the new folder, borrowed from the caller's context; NULL: err says why not. */
typedef const char *(*sf_case_place)(void *context, const sf_case_file *file, sf_error *err);

/* Asks for the place of every file that the case needs, the case file (part 0, whose `name` the caller has
 * set) excepted, and puts these names into the texts. */
sf_status sf_case_parts_finish(sf_case_parts *parts, sf_case_place place, void *context, sf_error *err);
void sf_case_parts_free(sf_case_parts *parts);

#endif
