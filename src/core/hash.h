/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FNV-1a over words of 64 bits: tells whether data are the same. Every change of one word changes the hash;
 * it is no defence against intent. */
#ifndef SF_CORE_HASH_H
#define SF_CORE_HASH_H

#include <stddef.h>
#include <stdint.h>

#define SF_HASH_START UINT64_C(14695981039346656037)

/* The hash continued over `size` bytes; a last incomplete word is filled with zeros. */
uint64_t sf_hash(uint64_t hash, const void *data, size_t size);

#endif
