/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes fit.png into the staging directory. `warning` (size bytes) says why there is no picture, "" if there
 * is one. */
#ifndef SF_FIT_COMPRESSION_PLOT_H
#define SF_FIT_COMPRESSION_PLOT_H

#include "study/fit/compression/table_fit.h"
#include "io/staging.h"

sf_status sf_compression_write_plot(const sf_staging *output, const sf_compression_fit *fit, char *warning,
                                    size_t size, sf_error *err);

#endif
