/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "io/replace.h"
#include "study/fit/compression/compression_fit.h"

/* Fits the tests of a file, and writes material.cfg, fit.json, fit.csv and loading_curve.csv into the folder.
 * `log`: gets the summary, NULL: nobody; `sink`: gets warnings, NULL: nobody. */
sf_status sf_compression_command(const char *path, const char *directory, bool force, FILE *log,
                                 const sf_sink *sink, sf_error *err);
