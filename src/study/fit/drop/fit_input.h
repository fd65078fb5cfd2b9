/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The input of `softfall-fit drop` (docs/identification.md): start material, drops with what was measured,
 * unknown parameters with their priors, and drops to predict. */
#pragma once
#include "study/batch.h"
#include "model/good_run.h"
#include "post/figures/compare.h"
#include "study/column.h"
#include "study/config.h"
#include "study/fit/drop/joint.h"
#include "study/fit/form/form.h"
#include "study/fit/space_mapping.h"

/* One entry of the lists `drops` and `predict`: a case, and what was measured. */
enum { SF_FIT_NAME_SIZE = 64, SF_FIT_CURVE_SAMPLES = 200 };

/* A drop that was measured, or (predicted) is only to be simulated with the identified material. */
typedef struct sf_fit_drop {
    char name[SF_FIT_NAME_SIZE];
    char *case_path; /* owned */
    bool predicted;
    double value[SF_FIT_SAMPLES]; /* measured, in the unit of its key (kinds.h); NaN: not */
    double sd[SF_FIT_SAMPLES];    /* relative standard deviations */
    double speed_sd;              /* relative standard deviation of the case's speed; 0: it is known */
    char *curve_path;             /* of the measured curve; NULL: none; owned */
    char interpretation[SF_REFERENCE_INTERPRETATION]; /* how it was read */
    int samples;                                      /* of it; 0: none */
    double *sample_time;                              /* [samples] s after contact; owned */
    double *sample_value;                             /* [samples] g; owned */
    double sample_sd;                                 /* of a sample, relative to the measured peak */
    double sample_scale;                              /* g, that peak */
    double sample_class; /* of the filter that both curves have; 0: the file's own */
} sf_fit_drop;

enum { SF_FIT_MAX_MODELS = 16 };
enum { SF_FIT_MAX_DROPS = 24, SF_FIT_MAX_UNKNOWNS = 20 };

typedef struct sf_fit_input {
    char *text;                           /* the file as it is; owned */
    char material_name[SF_FIT_NAME_SIZE]; /* of its files */
    char title[160];                      /* first line of its files */
    char label[96];                       /* "gas_solid, Maxwell branch": form and rate terms of the model */
    char *material_path;                  /* start material; owned */
    int model, model_count;               /* which of the file's `forms` this is; 0 of 1 without a list */
    bool posterior;                       /* Markov chains after the fit */
    uint64_t seed;                        /* of them */
    sf_foam_form form;
    int drop_count; /* measured ones first */
    sf_fit_drop drop[SF_FIT_MAX_DROPS];
    int coarse_count;                  /* 0: no coarse iterations */
    char *coarse[SF_RUNNER_OVERRIDES]; /* "group.key=value" of the first iterations; owned */
    sf_joint joint;                    /* compression tests and cushion curves */
    sf_signal_chain chain;             /* of the accelerometer, medians of the priors; zeros: none */
    double chain_sd[SF_SIGNAL_CHAIN];  /* of the logarithms; 0: known */
    double start[SF_PARAMETER_COUNT];  /* SI, every parameter */
    int unknown_count;
    sf_foam_parameter unknown[SF_FIT_MAX_UNKNOWNS];
    double prior[SF_FIT_MAX_UNKNOWNS];    /* SI, median */
    double prior_sd[SF_FIT_MAX_UNKNOWNS]; /* of the logarithm */
} sf_fit_input;

/* Reads and checks everything, the cases and the measured curves too; of several `forms` that of the number
 * `model`, which is below model_count of number 0. Release with sf_fit_input_free, also on failure. */
sf_status sf_fit_input_read(const char *path, int model, sf_fit_input *input, sf_error *err);
void sf_fit_input_free(sf_fit_input *input);

/* ---- drop_input.c ---- */

/* Logarithms of the values in the units of the keys; NaN where a value is not defined. */
void sf_drop_values_scale(const sf_columns_figures *values, double y[SF_FIT_SAMPLES]);

/* Reads it into drop[count], after `count` others: refused is one that is there already. Release with
 * sf_drop_input_free, also on failure. */
sf_status sf_drop_input_read(const sf_config *config, sf_config_item *group, bool predicted, int count,
                             sf_fit_drop *drop, sf_error *err);
void sf_drop_input_free(sf_fit_drop *drop);
