/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Several models of one foam, compared and averaged. The weights are those of the leave-one-out predictive
 * densities (posterior/weights.h), or of the evidence where only one drop was measured. */
#pragma once
#include "io/staging.h"
#include "report/row.h"
#include "study/fit/drop/inference.h"

enum { SF_POSTERIOR_DRAWS = 200 };

/* A model without a fit. */
typedef struct sf_failed_model {
    const char *label; /* of its input; borrowed */
    char sentence[512];
} sf_failed_model;

typedef struct sf_drop_average {
    int models;
    const sf_drop_inference *model[SF_FIT_MAX_MODELS]; /* of the same drops; borrowed */
    double weight[SF_FIT_MAX_MODELS];                  /* sum 1 */
    double evidence_weight[SF_FIT_MAX_MODELS];         /* what the evidence alone would give; sum 1 */
    double predictive[SF_FIT_MAX_MODELS]; /* sum of the leave-one-out log densities; NaN: one drop */
    bool by_evidence;
    uint64_t seed;
    int failed; /* models that are not among them; filled by the caller */
    sf_failed_model failure[SF_FIT_MAX_MODELS];
} sf_drop_average;

sf_status sf_drop_average_build(int models, const sf_drop_inference *const *model, uint64_t seed,
                                sf_drop_average *average, sf_error *err);

/* The model with the largest weight. */
int sf_drop_average_best(const sf_drop_average *average);
/* True if the criteria of the weights were reached: by the chains of every model, and by the densities of
 * the left-out drops or, with weights by it, the evidence. */
bool sf_drop_average_reached(const sf_drop_average *average);

/* Quantiles of a predicted number (index of the inference's quantities), in its unit, over all models by
 * their weights; of one model with `model` >= 0. A draw whose foam collapses counts as above every value of a
 * number that is `above_all` (drop_kinds.h), and a quantile among these is INFINITY; of the other numbers the
 * quantiles are those of the draws that have a value. NaN if none counts. */
sf_status sf_drop_average_quantiles(const sf_drop_average *average, int model, int quantity, int count,
                                    const double *probability, double *value, sf_error *err);
/* Weight of the draws that have no value of it: the foam of the columns collapses, or there are none. */
double sf_drop_average_missing(const sf_drop_average *average, int quantity);
/* False: the drop's simulation failed before the pad was touched, so nothing was predicted. */
bool sf_drop_average_has_columns(const sf_drop_average *average, int quantity);
/* Quantiles of a parameter of one model, as the chains have it. */
sf_status sf_drop_parameter_quantiles(const sf_drop_inference *inference, int parameter, int count,
                                      const double *probability, double *value, sf_error *err);

/* Draws of equal weight over the models: of which model, and which state of its chains. */
typedef struct sf_posterior_draw {
    int model, state;
} sf_posterior_draw;
void sf_drop_average_draw(const sf_drop_average *average, sf_posterior_draw draw[SF_POSTERIOR_DRAWS]);
/* Draws the discrepancy for draw `k` (from 0) beside its state: delta [SF_DISCREPANCY_PLACES] and the
 * errors of the responses; the same in every call. SF_ERR_NUMERIC: the foam of the columns collapses. */
sf_status sf_drop_average_discrepancy(const sf_drop_average *average, int k, const sf_posterior_draw *draw,
                                      double *delta, sf_response_error *error, sf_error *err);

/* Writes draw-001.cfg ... with their curves, delta in them, and response_error into a folder that is
 * softfall's own; a file of an earlier run is replaced. From the last to the first: a folder without
 * draw-001.cfg is not complete. */
sf_status sf_drop_average_write(const sf_drop_average *average, const char *folder, sf_error *err);

/* ---- inference_report.c ---- */

/* The part of the posterior in the output of `softfall-fit drop`: sections of report.html, "inference" of
 * fit.json, posterior.csv, lines of the material file and of the terminal. */
sf_status sf_inference_html(FILE *page, const sf_drop_average *average, sf_error *err);
sf_status sf_inference_json(sf_json *json, const sf_drop_average *average, sf_error *err);
/* posterior.csv: the draws of the folder posterior/, one a line. */
sf_status sf_inference_csv(const sf_drop_average *average, const sf_staging *output, sf_error *err);
/* Comment lines: the weights of the models. */
void sf_inference_comment(FILE *file, const sf_drop_average *average);
/* One line when the chains of a model have ended. */
void sf_inference_print_chains(FILE *file, const sf_drop_inference *inference);
sf_status sf_inference_print(FILE *file, const sf_drop_average *average, sf_error *err);
