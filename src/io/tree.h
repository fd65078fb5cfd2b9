/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A new folder with files and folders in it, that is there as a whole or not at all: it is made under another
 * name and moved. */
#ifndef SF_IO_TREE_H
#define SF_IO_TREE_H

#include "base/error.h"
#include <stdbool.h>
#include <stddef.h>

typedef struct sf_tree {
    char *path;  /* where it will be */
    char *aside; /* where it is made, on the same file system; NULL: moved or removed */
    bool there;  /* `path` is an empty folder already, which stays */
    int count, capacity;
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

#endif
