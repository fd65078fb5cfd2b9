/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closed parts of a surface of triangles: which of them lie within others. */
#pragma once
#include <stdint.h>

#include "base/error.h"

typedef struct sf_closed_parts {
    int64_t node_count;
    const double *position; /* [node_count][3] m, borrowed */
    int64_t triangle_count;
    const int32_t *triangle; /* [triangle_count][3], borrowed */
    const int64_t
        *part; /* [triangle_count] lowest triangle of its closed part, -1 in an open one; borrowed */
} sf_closed_parts;

/* Sets `depth` [triangle_count], at the lowest triangle of a part, to the number of closed parts that the
 * part lies within; at an odd depth it bounds a cavity, however its triangles are turned. Parts side by side
 * may touch. If two parts pass through each other, coincide, or touch from inside, `overlap` becomes
 * SF_ERR_MODEL and every depth 0. */
sf_status sf_closed_parts_nest(const sf_closed_parts *s, int32_t *depth, sf_error *overlap, sf_error *err);
