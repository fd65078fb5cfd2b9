/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "study/fit/drop/drop_fit.h"
#include "study/fit/posterior/posterior.h"

/* The posterior of one fitted model by Markov chain Monte Carlo (docs/theory.md, section "Inference"): of its
 * unknown parameters and of the sizes tau and kappa of two discrepancies, on the corrected surrogate.
 *
 * The data's logarithms are y = s(u) + offset + J delta + G x + e. delta is the logarithm of the true loading
 * curve over the form's at SF_DISCREPANCY_PLACES strains, a Gaussian process of standard deviation tau and
 * correlation length 0.12; J are the columns' derivatives at the maximum. x are the model's other errors
 * (rate, unloading, surrogate): of every drop and number, and one of each number that all drops share, with
 * standard deviations of kappa times model_sd (model/drop_kind.h). e are the measurements' errors and those
 * of the speeds, whose effect is taken as linear. So delta, x and the speeds are integrated in closed form,
 * and drawn where predictions need them. */

enum { SF_DISCREPANCY_PLACES = 20 }; /* strains 0, 0.05, ..., 0.95 */

/* A number of a predicted drop: quantity of the chains, in logarithms. */
typedef struct sf_drop_quantity {
    int drop;
    int kind; /* sf_drop_kind */
} sf_drop_quantity;

typedef struct sf_drop_inference {
    const sf_drop_fit *fit; /* borrowed */
    int parameters;         /* unknowns of the foam, then z of tau and z of kappa (sf_half_normal) */
    int data;
    double prior_norm; /* ln; of the priors, cut at the parameters' bounds */
    int *data_row;     /* [data] response that was measured; owned */
    double *offset;    /* [responses] of all drops, at u = 0 speeds; owned */
    double *jacobian;  /* [responses][SF_DISCREPANCY_PLACES] J; owned */
    bool steep; /* J of a predicted figure is not known, as its columns fail nearby: they take delta itself */
    double *base;                                  /* [data][data] covariance of e; owned */
    sf_discrepancy all, without[SF_FIT_MAX_DROPS]; /* of all data; without those of one measured drop */
    int quantities;
    sf_drop_quantity quantity[3 * SF_FIT_MAX_DROPS];

    sf_chains chains;
    sf_evidence evidence;
    sf_left_out left_out[SF_FIT_MAX_DROPS]; /* measured drops; none if there is only one */
} sf_drop_inference;

typedef struct sf_inference_options {
    sf_chains_options chains;
    sf_leave_options without; /* posteriors without a drop */
    int evidence_draws;
    bool leave_one_out;
} sf_inference_options;

/* Returns the options of `softfall-fit drop`. */
sf_inference_options sf_inference_defaults(uint64_t seed);

/* Samples the posterior of a finished fit, which outlives the inference. Release with sf_drop_inference_free,
 * also on failure. */
sf_status sf_drop_infer(const sf_drop_fit *fit, const sf_inference_options *options,
                        sf_drop_inference *inference, sf_error *err);
void sf_drop_inference_free(sf_drop_inference *inference);

/* The sizes of the discrepancies of a state of the chains. */
sf_discrepancy_size sf_drop_inference_size(const sf_drop_inference *inference, const double *u);
/* Name and value of an element of a state: an unknown in SI units, tau, kappa. */
const char *sf_drop_inference_name(const sf_drop_inference *inference, int parameter);
double sf_drop_inference_value(const sf_drop_inference *inference, int parameter, double u);
/* delta [SF_DISCREPANCY_PLACES], the errors of the responses that all drops share and, if `own` is not NULL,
 * those of the drops to predict, [input drops][SF_FIT_SAMPLES], the shared ones in them, given a state of the
 * chains and the data. False: the columns fail there. */
bool sf_drop_inference_draw(const sf_drop_inference *inference, const double *u, uint64_t seed, double *delta,
                            sf_response_error *error, double *own);
/* The card of a state with its curve times exp(delta), linear between the places; a curve that would fall is
 * held. Owned by the caller. */
sf_status sf_drop_inference_card(const sf_drop_inference *inference, const double *u, const double *delta,
                                 sf_foam_card *card, sf_error *err);

/* Several models of one foam, compared and averaged. The weights are those of the leave-one-out predictive
 * densities (posterior/posterior.h), or of the evidence where only one drop was measured. */

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

/* In place of a model: all of them by their weights, with the foam as it is known; the same of a single pad
 * and drop, with the scatter of its thickness and speed (sf_drop_fit_scatter). */
enum { SF_ALL_MODELS = -1, SF_SINGLE_DROP = -2 };

/* Quantiles of a predicted number (index of the inference's quantities), in its unit, of one model, or of
 * SF_ALL_MODELS or SF_SINGLE_DROP. A draw whose foam collapses counts as above every value of a
 * number that is `above_all` (model/drop_kind.h), and a quantile among these is INFINITY; of the other
 * numbers the quantiles are those of the draws that have a value. NaN if none counts, or the scatter is not
 * known. */
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
