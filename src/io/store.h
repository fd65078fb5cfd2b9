/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder of intermediate results that are found again by a key of everything they follow from: a file
 * KIND-<key, 16 hexadecimal digits>.bin each, written aside and renamed, with a checksum. A file that is
 * damaged or of another key counts as absent, and one that cannot be kept is not: the store saves time, and
 * nothing else. */
#ifndef SF_IO_STORE_H
#define SF_IO_STORE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Beyond this many bytes in the folder nothing more is kept. */
#define SF_STORE_MOST (UINT64_C(1) << 30)

typedef struct sf_store_part {
    const void *data;
    size_t size; /* bytes */
} sf_store_part;

/* What was kept. `data` is aligned for 64 bits; release `block` with free(). */
typedef struct sf_stored {
    void *block;
    const char *data;
    size_t size;
} sf_stored;

/* False: there is none; `*out` is empty. `folder` NULL: no store. */
bool sf_store_find(const char *folder, const char *kind, uint64_t key, sf_stored *out);
/* Keeps the parts, one after another. */
void sf_store_keep(const char *folder, const char *kind, uint64_t key, int count, const sf_store_part *part);

#endif
