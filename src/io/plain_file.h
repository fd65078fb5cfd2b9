/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <limits.h>
#include <stdint.h>
#include <sys/types.h>

#include "base/error.h"

/* The gate: the only code that opens a file for reading (tools/gate.py, a test, holds the short list of
 * exceptions). It takes plain files only, from file systems that store files: no folder, pipe, socket or
 * device, and nothing of proc, sysfs and the like, whose "files" may be endless or wait for ever. It never
 * waits for another process, and reads no more than it was told.
 *
 * `what` is the word for the file in the sentences, "curve" for "the curve PATH cannot be read: ..."; NULL:
 * the path alone. SF_ERR_INPUT: the file is missing, not permitted, not plain or too large; SF_ERR_IO:
 * reading failed, or the file changed meanwhile.
 *
 * Every file that passed is entered in the register of this process: an output is never one of them,
 * and a key can be made of their contents. */

/* Largest text that somebody would write or measure, in bytes. */
#define SF_PLAIN_TEXT (UINT64_C(1) << 28)
#define SF_PLAIN_ANY UINT64_MAX
/* Far beyond a geometry whose mesh has room in a machine. */
#define SF_PLAIN_GEOMETRY (UINT64_C(1) << 32)

/* The whole content, at most `largest` bytes. `*text` ends with a zero byte that `*size` does not count; from
 * malloc, owned by the caller, NULL on failure. `size` may be NULL. Registered. */
sf_status sf_plain_read(const char *path, const char *what, uint64_t largest, char **text, size_t *size,
                        sf_error *err);

/* The same without the content: only its hash (sf_hash_bytes from SF_HASH_START). */
sf_status sf_plain_hash(const char *path, const char *what, uint64_t largest, uint64_t *hash, sf_error *err);

/* The same of a file of at most SF_PLAIN_GEOMETRY bytes that is asked for again and again: it is not read
 * again while it is the same file (device, inode, size, times of its modification and of its last change) as
 * when this function read it, unless it had been changed within the second before, which the clock of a file
 * system may not tell from another change. */
sf_status sf_plain_hash_kept(const char *path, uint64_t *hash, sf_error *err);

/* Opens for reading (O_CLOEXEC), for a reader that needs the descriptor. `*handle` is owned by the caller
 * (close), -1 on failure; `size` may be NULL. Registered. */
sf_status sf_plain_open(const char *path, const char *what, int *handle, uint64_t *size, sf_error *err);

/* Opens and closes: the sentence for a file that will be read later, here or in another process. Registered.
 */
sf_status sf_plain_check(const char *path, const char *what, sf_error *err);

/* A file that was read. */
typedef struct sf_plain_record {
    const char *path; /* as it was named; owned by the register */
    uint64_t device, inode;
} sf_plain_record;

/* The number of entries, in the order of reading; a file that is read twice has two. The entries from a count
 * taken earlier on are those of the reading since. */
size_t sf_plain_count(void);
/* Entry `index` < sf_plain_count(). Its path is valid until sf_plain_clear. */
sf_plain_record sf_plain_get(size_t index);
/* The name under which the file of this device and inode was read and still is; NULL: it was not. */
const char *sf_plain_name(uint64_t device, uint64_t inode);
/* Empties the register. */
void sf_plain_clear(void);

/* Paths as texts: nothing is looked up but the working directory, and links are not followed. */

/* Writes a path into a buffer of `size` bytes; refuses one that has no room there. */
sf_status sf_path_print(char *path, size_t size, sf_error *err, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Returns the absolute path without ".", ".." and double slashes; a relative path begins at `folder`
 * (NULL: the working directory). From malloc, NULL on failure. */
char *sf_path_whole(const char *folder, const char *path, sf_error *err);

/* The part of whole paths below `folder`; NULL: `path` is not below it. Points into `path`. */
const char *sf_path_below(const char *folder, const char *path);

/* Returns the kind of file, such as "a folder"; NULL for a plain file. */
const char *sf_plain_kind(mode_t mode);

/* The length of the folder part of a path, without the slash but of "/"; 0: none. */
size_t sf_path_folder_length(const char *path);
/* Writes the folder of a path, with the slash, or "."; returns the last part of the path. */
const char *sf_path_split(const char *path, char folder[PATH_MAX]);
/* The last part. */
const char *sf_path_name(const char *path);

/* Returns the name of the file `to` relative to the folder of `from`; both from the same folder, without
 * "." and "..". From malloc, NULL on failure. */
char *sf_path_between(const char *from, const char *to, sf_error *err);
