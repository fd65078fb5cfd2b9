/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report.html of the fit of tables, with its picture. */
#ifndef SF_FIT_COMPRESSION_TABLE_REPORT_H
#define SF_FIT_COMPRESSION_TABLE_REPORT_H

#include "study/fit/compression/table_result.h"

/* fit.gp, fit.png and report.html. */
sf_status sf_table_report_write(const sf_staging *output, const sf_table_result *result, const char *path,
                                const char *command, char *warning, size_t size, sf_error *err);

#endif
