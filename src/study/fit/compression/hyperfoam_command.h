/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit compression with law = "hyperfoam" in its file (docs/identification.md). */
#ifndef SF_FIT_COMPRESSION_HYPERFOAM_COMMAND_H
#define SF_FIT_COMPRESSION_HYPERFOAM_COMMAND_H

#include "base/error.h"
#include <stdbool.h>
#include <stdio.h>

/* True if the file asks for the hyperfoam. */
sf_status sf_hyperfoam_fit_asked(const char *path, bool *asked, sf_error *err);

/* Reads the file and its test, fits, and writes material.cfg, fit.json and fit.csv into `directory`; prints
 * the result to `log`, and warns of a fit that does not describe the test. */
sf_status sf_hyperfoam_fit_file(const char *path, const char *directory, bool force, FILE *log,
                                const sf_sink *sink, sf_error *err);

#endif
