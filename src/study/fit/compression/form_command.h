/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `softfall-fit compression` with a form of the loading curve (docs/identification.md): report and files. */
#ifndef SF_FIT_COMPRESSION_FORM_COMMAND_H
#define SF_FIT_COMPRESSION_FORM_COMMAND_H

#include "base/error.h"
#include "study/fit/compression/compression_config.h"
#include <stdio.h>

/* SF_ERR_INPUT if `directory` cannot be the output directory, before anything is computed. */
sf_status sf_form_fit_check(const char *directory, bool force, sf_error *err);

/* Fits the form of the configuration and writes material.cfg, material.csv, fit.json and fit.csv into
 * `directory`. */
sf_status sf_form_fit_write(const sf_compression_config *config, const char *directory, bool force, FILE *log,
                            const sf_sink *sink, sf_error *err);

#endif
