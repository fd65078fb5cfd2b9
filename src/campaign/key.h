/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The key of a drop: equal for equal inputs. */
#ifndef SF_CAMPAIGN_KEY_H
#define SF_CAMPAIGN_KEY_H

#include "case/case.h"
#include <stdint.h>

/* A hash of the values of every key of the case, the points of its curves and motion, its geometry files and
 * the programs that simulate it; the names of files do not count. */
sf_status sf_campaign_key(const sf_case *c, uint64_t *key, sf_error *err);

#endif
