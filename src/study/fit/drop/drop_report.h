/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The output of `softfall-fit drop`: report.html, fit.json, fit.png with its data, and the material file. */
#ifndef SF_FIT_DROP_REPORT_H
#define SF_FIT_DROP_REPORT_H

#include "study/fit/drop/average.h"
#include "study/fit/drop/drop_fit.h"
#include "io/staging.h"

/* Writes everything into the staging directory; `fit` is that of the material, `average` the posterior of all
 * models (NULL: none); `command`: the words of the command; `warning` (size bytes) says why there is no
 * picture, or is
 * "". */
sf_status sf_drop_report_write(const sf_drop_fit *fit, const sf_drop_average *average, const char *input_path,
                               const char *command, const sf_staging *output, char *warning, size_t size,
                               sf_error *err);

/* The short form, for the terminal. */
void sf_drop_report_print(const sf_drop_fit *fit, FILE *file);

#endif
