/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Everything that a compression fit writes: the material file, the figures (fit.json), the report, the tables
 * and the picture. */
#ifndef SF_FIT_COMPRESSION_OUTPUT_H
#define SF_FIT_COMPRESSION_OUTPUT_H

#include "base/error.h"
#include "study/fit/compression/cube.h"
#include "study/fit/compression/table_fit.h"
#include <stdbool.h>

/* Checks that this can be the directory of the output (sf_staging_check). */
sf_status sf_compression_output_check(const char *directory, bool force, sf_error *err);

/* Writes into `directory` (sf_staging), and the summary to cube->log; warnings go to `sink`. `path`: FIT.cfg,
 * as given; `command`: the words of the command. Simulates the tests first if `cube` names a case. */
sf_status sf_compression_output(const sf_compression_fit *fit, const char *path, const char *command,
                                const char *directory, bool force, const sf_cube_options *cube,
                                const sf_sink *sink, sf_error *err);

#endif
