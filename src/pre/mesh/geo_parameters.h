/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "case/case.h"
#include "pre/mesh/broker.h"

/* The parameters that a .geo file offers: gmsh itself accepts a value for any name without a message, so that
 * a misspelt parameter would keep its default unnoticed. */

/* The text of a .geo file, cut as gmsh cuts it: words (names and numbers), texts in quotes, and single marks;
 * comments vanish. */
typedef struct sf_geo_token {
    enum { SF_GEO_END, SF_GEO_WORD, SF_GEO_TEXT, SF_GEO_MARK } kind;
    const char *begin; /* in the text; of a quoted one without its quotes */
    size_t length;
} sf_geo_token;

/* Returns the next token and moves `*text` behind it. */
sf_geo_token sf_geo_token_next(const char **text);
/* True if it is that word or mark, or the content of a text in quotes. */
bool sf_geo_token_is(sf_geo_token token, const char *text);

/* Multiplies the spacings of the source, the parameters with "spacing" in their names, by its factor: those
 * that it gives, and those that it leaves to defaults which are plain numbers of its .geo file. */
sf_status sf_geo_parameters_scale(const sf_geo_source *source, sf_geo_source *scaled, sf_error *err);

/* Refuses a parameter of the source that no DefineConstant of the texts that the geometry read defines; the
 * sentence lists those that exist. Refuses one that is none of the Choices of its DefineConstant. Refuses a
 * factor that a spacing does not follow, or that has none, too. `complete`: `read` holds all texts; else the
 * named file is read here, and the others are not. `read` NULL: nothing is meshed yet, and only of .geo files
 * that include and merge no other anything is said. */
sf_status sf_geo_parameters_check(const sf_geo_source *source, const sf_broker *read, bool complete,
                                  sf_error *err);
