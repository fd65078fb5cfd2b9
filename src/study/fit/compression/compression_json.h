/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes fit.json into the staging directory. `path`: FIT.cfg, as given. */
#ifndef SF_FIT_COMPRESSION_JSON_H
#define SF_FIT_COMPRESSION_JSON_H

#include "study/fit/compression/fit_check.h"
#include "io/staging.h"

sf_status sf_compression_write_json(const sf_staging *output, const sf_compression_fit *fit,
                                    const sf_compression_check *check, const char *path, sf_error *err);

#endif
