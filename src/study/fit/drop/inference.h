/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The posterior of one fitted model by Markov chain Monte Carlo (docs/theory.md, section "Inference"): of its
 * unknown parameters and of the sizes tau and kappa of two discrepancies, on the corrected surrogate.
 *
 * The data's logarithms are y = s(u) + offset + J delta + G x + e. delta is the logarithm of the true loading
 * curve over the form's at SF_DISCREPANCY_PLACES strains, a Gaussian process of standard deviation tau and
 * correlation length 0.12; J are the columns' derivatives at the maximum. x are the model's other errors
 * (rate, unloading, surrogate): of every drop and number, and one of each number that all drops share, with
 * standard deviations of kappa times model_sd (kinds.h). e are the measurements' errors and those of the
 * speeds, whose effect is taken as linear. So delta, x and the speeds are integrated in closed form, and
 * drawn where predictions need them. */
#pragma once
#include "study/fit/drop/drop_fit.h"
#include "study/fit/posterior/chains.h"
#include "study/fit/posterior/discrepancy.h"
#include "study/fit/posterior/leave_one_out.h"

enum { SF_DISCREPANCY_PLACES = 20 }; /* strains 0, 0.05, ..., 0.95 */

/* A number of a predicted drop: quantity of the chains, in logarithms. */
typedef struct sf_drop_quantity {
    int drop;
    int kind; /* kinds.h */
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
