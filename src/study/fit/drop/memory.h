/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cache of a fit between its drops, in a file of its folder, so that a run that was killed does not
 * compute it again: numbers by a key of everything that they depend on. Each record is written at once and
 * has a checksum; a record that was cut or has changed, and all behind it, is computed again. A record:
 * key (u64), number of values (u64), values (f64), hash of these (u64, base/hash.h), in the machine's byte
 * order. */
#ifndef SF_FIT_DROP_MEMORY_H
#define SF_FIT_DROP_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct sf_fit_memory {
    uint64_t program; /* hash of softfall-fit: begins every key, as another version computes otherwise */
    int file;         /* open and locked; -1: nothing more is remembered */
    char *text;       /* the records that were there; owned */
    size_t size;      /* bytes of them */
    size_t next;      /* byte after the record found last, where the next one is expected */
    size_t end;       /* bytes of the file's whole records */
} sf_fit_memory;

/* Opens or makes the file. If that fails, the disk is full later, or another run has the file, nothing is
 * remembered and nothing found. Release with sf_fit_memory_close, which keeps the file. */
void sf_fit_memory_open(const char *path, sf_fit_memory *memory);
void sf_fit_memory_close(sf_fit_memory *memory);

/* True if `value` [count] was filled. `memory` may be NULL: nothing is found. */
bool sf_fit_memory_find(sf_fit_memory *memory, uint64_t key, size_t count, double *value);
void sf_fit_memory_add(sf_fit_memory *memory, uint64_t key, size_t count, const double *value);

#endif
