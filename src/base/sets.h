/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdint.h>

#include "base/error.h"

/* Lists and disjoint sets of numbers.
 *
 * Disjoint sets of the numbers from 0 on: `parent` leads from each to the lowest of its set. */

/* [count] each number alone; owned by the caller, NULL on failure. `what`: for the sentence. */
static inline int64_t *sf_sets_alone(int64_t count, const char *what, sf_error *err) {
    int64_t *parent = sf_alloc(err, (unsigned long)count, sizeof *parent, what);
    for (int64_t k = 0; parent && k < count; k++)
        parent[k] = k;
    return parent;
}

/* Returns the lowest of the set of `k`; the paths are halved on the way. */
static inline int64_t sf_sets_find(int64_t *parent, int64_t k) {
    while (parent[k] != k)
        k = parent[k] = parent[parent[k]];
    return k;
}

static inline void sf_sets_join(int64_t *parent, int64_t a, int64_t b) {
    a = sf_sets_find(parent, a);
    b = sf_sets_find(parent, b);
    parent[a > b ? a : b] = a > b ? b : a;
}

/* Compares two numbers of type int32_t, for qsort. */
static inline int sf_by_number(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}
