/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The key of a drop: equal for equal inputs. */
#ifndef SF_CAMPAIGN_KEY_H
#define SF_CAMPAIGN_KEY_H

#include "case/case.h"
#include <stdbool.h>
#include <stdint.h>

/* A hash of the values of every key of the case, the points of its curves and motion, its geometry files and
 * the programs that simulate it; the names of files do not count. What a geometry includes or merges is known
 * only after it was read: sf_campaign_geometry_is_same. */
sf_status sf_campaign_key(const sf_case *c, uint64_t *key, sf_error *err);

/* Why two geometry files of one text in two folders are refused. */
#define SF_CAMPAIGN_SAME_TEXT                                                                                \
    "the same text in different folders: they may merge different files; make a difference in their text, "  \
    "a comment for example"

/* The part of it that is of the case alone, without geometry files and programs. */
uint64_t sf_campaign_case_hash(const sf_case *c);

/* Has every file that the geometries read, by the list at `text` of the HDF5 file `path` (docs/formats.md,
 * geometry_files), the content that it had? `folder`: of the pad's and the missile's geometry, where paths in
 * the list begin; "" without a geometry of the missile. `unlisted`: the answer if there is no such file or
 * list. */
bool sf_campaign_geometry_is_same(const char *const folder[2], const char *path, const char *text,
                                  bool unlisted);
/* That list, from malloc; NULL if there is none. */
char *sf_campaign_geometry_list(const char *path, const char *text);

#endif
