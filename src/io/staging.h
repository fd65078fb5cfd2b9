/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The output directory. Files are first written in a hidden directory inside it and moved to their places
 * when all of them are complete: a run that fails leaves the files of an earlier run as they were. The hidden
 * directory bears the process's number; that of a run that was killed is removed by the next one. */
#pragma once
#include "base/error.h"

typedef struct sf_staging {
    const char *const *names; /* every file that the program may write, in the order in which they are moved;
                                 ends with NULL; borrowed */
    char *directory;          /* where the files will be */
    char *aside;              /* where they are written */
    bool created;             /* the directory did not exist before */
} sf_staging;

/* Checks that this can be the output directory, before anything is computed or made. SF_ERR_INPUT: the
 * name is empty or too long, there is no folder of that name, or it holds one of the files without
 * `force`, or one that cannot be replaced (io/replace.h: a folder, a pipe, a device, an input). The other
 * functions check again. */
sf_status sf_staging_check(const char *directory, const char *const *names, bool force, sf_error *err);

/* Makes the directory if need be. SF_ERR_INPUT if it holds one of the named files already and `force` is
 * false. */
sf_status sf_staging_begin(const char *directory, const char *const *names, bool force, sf_staging *output,
                           sf_error *err);

/* "staging/name"; from malloc, owned by the caller; NULL on failure. */
char *sf_staging_path(const sf_staging *output, const char *name, sf_error *err);

/* A text file of that name in the staging directory; NULL on failure. sf_staging_close reports writes that
 * failed. */
FILE *sf_staging_open(const sf_staging *output, const char *name, sf_error *err);
sf_status sf_staging_close(FILE *file, const char *name, sf_error *err);

/* Removes a file from the staging directory. */
void sf_staging_remove(const sf_staging *output, const char *name);

/* True if the file has been written in this run. */
bool sf_staging_has(const sf_staging *output, const char *name);

/* Moves every file to its place and removes those of an earlier run that have no successor. */
sf_status sf_staging_commit(sf_staging *output, sf_error *err);

/* Removes what was not committed (and the directory, if this run made it and it is empty); releases. Always
 * safe. */
void sf_staging_end(sf_staging *output);

/* A new folder with files and folders in it, that is there as a whole or not at all: it is made under another
 * name and moved. */

typedef struct sf_tree {
    char *path;  /* where it will be */
    char *aside; /* where it is made, on the same file system; NULL: moved or removed */
    bool there;  /* `path` is an empty folder already, which stays */
    int count;
    char **made; /* [count] files and folders in `aside`, relative, each after the folder that holds it */
} sf_tree;

/* SF_ERR_INPUT: `path` is empty, is no folder, or a folder that is not empty. SF_ERR_IO: its folder is
 * missing or cannot be written in. sf_tree_end belongs to it, also on failure. */
sf_status sf_tree_begin(const char *path, sf_tree *tree, sf_error *err);

/* Writes a file; the folders of its name ("geo/parts/a.geo", without "..") are made. */
sf_status sf_tree_put(sf_tree *tree, const char *name, const char *text, size_t size, sf_error *err);

/* Moves it to its place, on the disk (fsync). */
sf_status sf_tree_commit(sf_tree *tree, sf_error *err);

/* Removes what was not committed; releases. Always safe. */
void sf_tree_end(sf_tree *tree);
