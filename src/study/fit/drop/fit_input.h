/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The input of `softfall-fit drop` (docs/identification.md): start material, drops with what was measured,
 * unknown parameters with their priors, and drops to predict. */
#ifndef SF_FIT_DROP_INPUT_H
#define SF_FIT_DROP_INPUT_H

#include "study/batch.h"
#include "study/fit/drop/drop_input.h"
#include "study/fit/drop/joint.h"
#include "study/fit/drop/parameters.h"
#include "study/fit/space_mapping.h"

enum { SF_FIT_MAX_MODELS = 16 };
enum { SF_FIT_MAX_DROPS = 24, SF_FIT_MAX_UNKNOWNS = 20 };

typedef struct sf_fit_input {
    char *text;                           /* the file as it is; owned */
    char material_name[SF_FIT_NAME_SIZE]; /* of its files */
    char title[160];                      /* first line of its files */
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

#endif
