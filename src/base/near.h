/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The known name that is nearest to an unknown one: "did you mean ...?". */
#pragma once
#include <stddef.h>

enum { SF_NEAR_HINT = 96 }; /* bytes of a hint */

typedef struct sf_near {
    const char *wanted; /* unknown name; borrowed */
    const char *name; /* nearest known name so far, borrowed; NULL: none is within two edits, or begins so */
    size_t length, distance; /* of `name`: bytes, edits */
} sf_near;

/* Begins a search: offer each known name to sf_near_offer, then ask for the hint. */
sf_near sf_near_begin(const char *wanted);

/* Takes a known name of `length` bytes if it is nearer than those before. */
void sf_near_offer(sf_near *near, const char *name, size_t length);

/* Writes " (did you mean \"NAME\"?)", or "" without a near name; returns `out`. */
const char *sf_near_hint(const sf_near *near, char out[SF_NEAR_HINT]);
