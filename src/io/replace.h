/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are complete at any instant: written under another name on the same file system, synchronised
 * (fsync) and renamed. After a failure in between, the earlier file remains. Model, results, checkpoint and
 * reports all go through here: the only code that makes files.
 *
 * The other name, "path.partial-<process>-<8 digits>", is always a new file: what has that name is neither
 * followed nor overwritten. */
#pragma once
#include "base/error.h"

enum { SF_PATH_SIZE = 4096 };

/* Checks that an output of this name can be written, before anything is computed or made. SF_ERR_INPUT:
 * the name is empty or too long (also with the endings that are appended to it), or stands for a folder,
 * pipe, socket or device, or for a file that this process has read (io/plain_file.h). SF_ERR_IO: its
 * folder is missing or cannot be written in. */
sf_status sf_replace_check(const char *path, sf_error *err);

/* The last part of that: the folder in which `path` would be. */
sf_status sf_replace_check_folder(const char *path, sf_error *err);

/* Something of this name is there, even if it is a link to nothing. */
bool sf_replace_exists(const char *path);

/* The name to write under; nothing is made. */
sf_status sf_replace_begin(const char *path, char partial[SF_PATH_SIZE], sf_error *err);

/* Makes a file of this very name for writing; NULL on failure, also if the name is taken. The caller closes
 * it. */
FILE *sf_replace_create(const char *path, sf_error *err);

/* A text file on its way to its name. */
typedef struct sf_replacement {
    FILE *file;
    char path[SF_PATH_SIZE], partial[SF_PATH_SIZE];
} sf_replacement;

/* Begins and creates: a file, or NULL. sf_replace_close closes it, reports writes that failed, and commits.
 */
FILE *sf_replace_open(const char *path, sf_replacement *out, sf_error *err);
sf_status sf_replace_close(sf_replacement *out, sf_error *err);

/* Opens a file for reading and writing that this process has made, for a last change or fsync: not through a
 * link, only a plain file. -1 with errno on failure. */
int sf_replace_reopen(const char *path);

/* Makes the closed file `partial` the file `path`, both on the disk (fsync of the file and of the folder);
 * removes it on failure, also after an earlier one. A folder, pipe, socket or device of the name `path`
 * stays: SF_ERR_IO. */
sf_status sf_replace_commit(const char *partial, const char *path, sf_error *err);

/* The name of a file or folder that was made is on the disk (fsync of the folder that holds it). */
void sf_replace_sync_name(const char *path);

/* True if `name` is that of a partial file of `of`; `*process`, if not NULL: of which process. */
bool sf_replace_is_partial(const char *name, const char *of, int *process);

/* Removes the partial files of `path` whose process has ended: plain files of that name that are empty or of
 * HDF5, and that no program has open. */
void sf_replace_clean(const char *path);

/* The file of that name in the open folder is plain, and empty or of HDF5. */
bool sf_replace_is_ours(int folder, const char *name);

/* Says whether --force may replace a file by one of the kind that is written there: by HDF5 a plain file
 * (also behind a link) that is empty, of HDF5 or sealed; by a page one that is empty, or a text that names
 * softfall, as its pages and summaries do. True if there is no file. */
bool sf_replace_is_hdf5(const char *path);
bool sf_replace_is_page(const char *path);

/* A checksum at the end of a file, behind the part that its own format (HDF5) reads: 8 bytes "SFSEAL01", the
 * length of the file before it (u64) and its hash (u64, base/hash.h), in the machine's byte order. */

sf_status sf_seal_add(const char *path, sf_error *err);

typedef enum sf_seal_state {
    SF_SEAL_SOUND,
    SF_SEAL_BROKEN,  /* the file has changed */
    SF_SEAL_NONE,    /* the file was cut, or another program has written it */
    SF_SEAL_NO_FILE, /* there is no such file */
} sf_seal_state;

/* The state of a file; fails if it is not known, as the system refused to open or read the file. */
sf_status sf_seal_examine(const char *path, sf_seal_state *state, sf_error *err);

/* SF_ERR_INPUT if the file is not plain; SF_ERR_IO: it is missing, not readable, or not as it was made. */
sf_status sf_seal_check(const char *path, sf_error *err);
