/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a .geo file, cut as gmsh cuts it. */
#ifndef SF_PRE_MESH_GEO_TEXT_H
#define SF_PRE_MESH_GEO_TEXT_H

#include <stdbool.h>
#include <stddef.h>

typedef enum sf_geo_kind { SF_GEO_END, SF_GEO_WORD, SF_GEO_TEXT, SF_GEO_MARK } sf_geo_kind;

typedef struct sf_geo_token {
    sf_geo_kind kind;
    const char *begin; /* in the text; of a quoted one without its quotes */
    size_t length;
} sf_geo_token;

/* Words (names and numbers), texts in quotes, and single marks; comments vanish. Moves `*text` on. */
sf_geo_token sf_geo_next(const char **text);
bool sf_geo_is(sf_geo_token t, const char *text);

#endif
