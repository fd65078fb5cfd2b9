/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The part of the posterior in the output of `softfall-fit drop`: sections of report.html, "inference" of
 * fit.json, posterior.csv, lines of the material file and of the terminal. */
#ifndef SF_FIT_DROP_INFERENCE_REPORT_H
#define SF_FIT_DROP_INFERENCE_REPORT_H

#include "study/fit/drop/average.h"
#include "report/row.h"
#include "io/staging.h"

sf_status sf_inference_html(FILE *page, const sf_drop_average *average, sf_error *err);
sf_status sf_inference_json(sf_json *json, const sf_drop_average *average, sf_error *err);
/* posterior.csv: the draws of the folder posterior/, one a line. */
sf_status sf_inference_csv(const sf_drop_average *average, const sf_staging *output, sf_error *err);
/* Comment lines: the weights of the models. */
void sf_inference_comment(FILE *file, const sf_drop_average *average);
/* One line when the chains of a model have ended. */
void sf_inference_print_chains(FILE *file, const sf_drop_inference *inference);
sf_status sf_inference_print(FILE *file, const sf_drop_average *average, sf_error *err);

#endif
