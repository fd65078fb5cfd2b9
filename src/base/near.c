/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/near.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { NEAR_MAX = 40, NEAR_EDITS = 2, NEAR_BEGIN = 4 /* letters of an abbreviation */ };

/* Levenshtein distance; capitals are as small letters. */
static size_t edit_distance(const char *a, size_t na, const char *b, size_t nb) {
    size_t row[NEAR_MAX + 1];
    if (na > NEAR_MAX || nb > NEAR_MAX)
        return NEAR_MAX;
    for (size_t j = 0; j <= nb; j++)
        row[j] = j;
    for (size_t i = 1; i <= na; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= nb; j++) {
            size_t above = row[j];
            size_t best = diagonal + (strncasecmp(a + i - 1, b + j - 1, 1) != 0);
            best = above + 1 < best ? above + 1 : best;
            best = row[j - 1] + 1 < best ? row[j - 1] + 1 : best;
            diagonal = above;
            row[j] = best;
        }
    }
    return row[nb];
}

sf_near sf_near_begin(const char *wanted) {
    return (sf_near){wanted, NULL, 0, NEAR_EDITS + 1};
}

void sf_near_offer(sf_near *near, const char *name, size_t length) {
    size_t typed = strlen(near->wanted);
    bool begins = typed >= NEAR_BEGIN && typed < length && strncasecmp(near->wanted, name, typed) == 0;
    size_t distance = begins ? 1 : edit_distance(near->wanted, typed, name, length);
    if (distance < near->distance && distance < length)
        *near = (sf_near){near->wanted, name, length, distance};
}

const char *sf_near_hint(const sf_near *near, char out[SF_NEAR_HINT]) {
    *out = '\0';
    if (near->name)
        snprintf(out, SF_NEAR_HINT, " (did you mean \"%.*s\"?)", (int)near->length, near->name);
    return out;
}
