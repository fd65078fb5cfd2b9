/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FNV-1a of 64 bits: tells whether data are the same. It is no defence against intent. All functions
 * continue a hash that begins with SF_HASH_START. */
#pragma once
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define SF_HASH_START UINT64_C(14695981039346656037)
#define SF_HASH_PRIME UINT64_C(1099511628211)

static inline uint64_t sf_hash_word(const char *byte, size_t left) {
    uint64_t word = 0;
    memcpy(&word, byte, left < sizeof word ? left : sizeof word);
    return word;
}

/* Over words of 64 bits, for the damage of large data: `size` bytes, a last incomplete word filled with
 * zeros. Every change of one word changes the hash; two words that differ in their highest bits alone, such
 * as two doubles of few digits, may cancel. */
static inline uint64_t sf_hash(uint64_t hash, const void *data, size_t size) {
    const char *byte = data;
    for (size_t k = 0; k < size; k += sizeof hash) {
        hash = (hash ^ sf_hash_word(byte + k, size - k)) * SF_HASH_PRIME;
    }
    return hash;
}

/* The same with every word mixed into all bits of the hash: for the identity of inputs. The multiplier is
 * that of MurmurHash3's last step. */
static inline uint64_t sf_hash_identity(uint64_t hash, const void *data, size_t size) {
    const char *byte = data;
    for (size_t k = 0; k < size; k += sizeof hash) {
        hash = (hash ^ sf_hash_word(byte + k, size - k)) * UINT64_C(0xff51afd7ed558ccd);
        hash ^= hash >> 32;
    }
    return hash;
}

/* Over bytes, as FNV-1a is published: the same for data in one piece or in several. */
static inline uint64_t sf_hash_bytes(uint64_t hash, const void *data, size_t size) {
    const unsigned char *byte = data;
    for (size_t k = 0; k < size; k++)
        hash = (hash ^ byte[k]) * SF_HASH_PRIME;
    return hash;
}
