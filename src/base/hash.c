/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/hash.h"

#include <string.h>

static const uint64_t FNV_PRIME = UINT64_C(1099511628211);

uint64_t sf_hash(uint64_t hash, const void *data, size_t size) {
    const char *byte = data;
    for (size_t k = 0; k < size; k += sizeof hash) {
        uint64_t word = 0;
        memcpy(&word, byte + k, size - k < sizeof word ? size - k : sizeof word);
        hash = (hash ^ word) * FNV_PRIME;
    }
    return hash;
}

uint64_t sf_hash_bytes(uint64_t hash, const void *data, size_t size) {
    const unsigned char *byte = data;
    for (size_t k = 0; k < size; k++)
        hash = (hash ^ byte[k]) * FNV_PRIME;
    return hash;
}
