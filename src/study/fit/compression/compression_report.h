/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes report.html into the staging directory, after fit.gp, whose picture it takes in. `path`: FIT.cfg, as
 * given; `command`: the words of the command. */
#ifndef SF_FIT_COMPRESSION_REPORT_H
#define SF_FIT_COMPRESSION_REPORT_H

#include "study/fit/compression/fit_check.h"
#include "io/staging.h"

sf_status sf_compression_write_report(const sf_staging *output, const sf_compression_fit *fit,
                                      const sf_compression_check *check, const char *path,
                                      const char *command, sf_error *err);

#endif
