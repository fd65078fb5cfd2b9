/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FNV-1a of 64 bits: tells whether data are the same. It is no defence against intent. Both functions
 * continue a hash that begins with SF_HASH_START. */
#ifndef SF_CORE_HASH_H
#define SF_CORE_HASH_H

#include <stddef.h>
#include <stdint.h>

#define SF_HASH_START UINT64_C(14695981039346656037)

/* Over words of 64 bits, for large data: `size` bytes, a last incomplete word filled with zeros. Every change
 * of one word changes the hash. */
uint64_t sf_hash(uint64_t hash, const void *data, size_t size);

/* Over bytes, as FNV-1a is published: the same for data in one piece or in several. */
uint64_t sf_hash_bytes(uint64_t hash, const void *data, size_t size);

#endif
