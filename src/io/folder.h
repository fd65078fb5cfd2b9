/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdint.h>

#include "base/error.h"

/* Folders that softfall keeps for itself: those of runs and drops, and what is being written. Such a folder
 * holds a mark (a file of that name and text); softfall removes and replaces files only where that stands. */

/* Makes the folder, or takes an empty one or one with the mark; several processes may do so at once.
 * SF_ERR_INPUT: it holds files but no mark, or is no folder. */
sf_status sf_folder_own(const char *path, sf_error *err);

/* True if an open folder has the mark of softfall. */
bool sf_folder_is_own(int handle);

/* Opens it: -1 with errno on failure. */
int sf_folder_open(const char *path);

/* Checks the files in an open folder whose names are `known`: SF_ERR_INPUT if one is not softfall's
 * (sf_replace_is_ours) or was read by this process. Removes the others but the one named `kept` (NULL:
 * none). */
sf_status sf_folder_check(int handle, const char *path, bool (*known)(const char *name), sf_error *err);
void sf_folder_remove_known(int handle, bool (*known)(const char *name), const char *kept);

/* Locks an existing folder against a second program that does so, until this process ends, its copies and the
 * program that holds the descriptor (sf_process). `*handle` is for the caller to close, -1 on failure.
 * SF_ERR_INPUT: another program has it locked for longer than copies of a killed one take to end. */
sf_status sf_folder_lock(const char *path, int *handle, sf_error *err);

/* Removes the mark and the folder if nothing else is in it. */
void sf_folder_leave(const char *path);

/* The number of names in the folder that begin with `prefix`; -1: it cannot be read. */
int64_t sf_folder_count(const char *path, const char *prefix);

/* A folder of intermediate results that are found again by a key of everything they follow from: a file
 * KIND-<key, 16 hexadecimal digits>.bin each, written aside and renamed, with a checksum. A file that is
 * damaged or of another key counts as absent, and one that cannot be kept is not: the store saves time, and
 * nothing else. */

/* The folder of SOFTFALL_SHARE if that is set, or else the given one. */
const char *sf_store_folder(const char *given);

/* Begins the key of a value that follows from the code: a hash of the program, of the library that this is in
 * where a program such as Python has loaded it, and of the revision, as the library's file may have been
 * replaced since. False: one cannot be read. */
bool sf_store_begin_key(uint64_t *key);

/* Before the files would take more bytes than this, all are removed. */
#define SF_STORE_MOST (UINT64_C(1) << 30)

typedef struct sf_store_part {
    const void *data;
    size_t size; /* bytes */
} sf_store_part;

/* A value of the store. `data` is aligned for 64 bits; release `block` with free(). */
typedef struct sf_stored {
    void *block;
    const char *data;
    size_t size;
} sf_stored;

/* False: there is none; `*out` is empty. `folder` NULL: no store. */
bool sf_store_find(const char *folder, const char *kind, uint64_t key, sf_stored *out);
/* Keeps the parts, one after another. */
void sf_store_keep(const char *folder, const char *kind, uint64_t key, int count, const sf_store_part *part);
