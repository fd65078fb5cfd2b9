/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures by gnuplot from a script that stays beside them. */
#ifndef SF_IO_GNUPLOT_H
#define SF_IO_GNUPLOT_H

#include "io/staging.h"

/* Runs `script` in the staging directory, silently, which should make `picture`. If gnuplot is absent or
 * fails, `warning` (size bytes) says so in a sentence; otherwise it is "". */
void sf_gnuplot_draw(const sf_staging *output, const char *script, const char *picture, char *warning,
                     size_t size);

#endif
