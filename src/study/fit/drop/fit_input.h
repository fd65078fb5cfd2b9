/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The input of `softfall-fit drop` (docs/identification.md): start material, drops with what was measured,
 * unknown parameters with their priors, and drops to predict. */
#pragma once
#include "material/laws.h"
#include "study/batch.h"
#include "model/good_run.h"
#include "post/figures/compare.h"
#include "study/column.h"
#include "study/config.h"
#include "study/fit/form/form.h"

/* ---- joint.c ---- */

/* Data of a foam beside its drops that need no simulation: compression tests, at the material point of the
 * law, and cushion curves (ASTM D1596: peak deceleration against static stress), each point one column of
 * foam under a flat mass. Their responses stand before those of the drops, and are exact: space mapping
 * corrects nothing there.
 *
 * Responses: nominal stress over the largest measured one, at strains 0.05 apart (neighbours closer than that
 * deviate alike), loading then unloading; ln of a cushion's peak deceleration in g (F/m, CFC 1000). */

enum { SF_JOINT_MOST = 8, SF_JOINT_POINTS = 48, SF_JOINT_NAME = 64, SF_JOINT_INTERPRETATION = 768 };

typedef struct sf_joint_test {
    char name[SF_JOINT_NAME];
    uint64_t file;                                /* hash of its text */
    double rate;                                  /* s-1, nominal */
    double turn;                                  /* -, largest strain */
    int count, loading;                           /* points; the first of them are loading */
    double strain[SF_JOINT_POINTS];               /* in the order of the test */
    double stress[SF_JOINT_POINTS];               /* Pa */
    double scale;                                 /* Pa, the largest measured stress */
    double sd;                                    /* relative; at low stress of 2 % of the scale */
    char interpretation[SF_JOINT_INTERPRETATION]; /* how the file was read; "": no file */
} sf_joint_test;

typedef struct sf_joint_cushion {
    char name[SF_JOINT_NAME];
    uint64_t file;            /* hash of its text; 0: no file */
    double thickness, height; /* m; of free fall */
    int count;
    double static_stress[SF_JOINT_POINTS]; /* Pa, weight over area */
    double peak_g[SF_JOINT_POINTS];
    double sd; /* relative */
    char interpretation[SF_JOINT_INTERPRETATION];
} sf_joint_cushion;

typedef struct sf_joint {
    int test_count, cushion_count;
    sf_joint_test test[SF_JOINT_MOST];
    sf_joint_cushion cushion[SF_JOINT_MOST];
    int rows; /* of all */
} sf_joint;

/* The lists `compressions` and `cushions` of a fit file; absent: none. SF_ERR_INPUT names file, line and
 * key; data that are there twice are refused. */
sf_status sf_joint_read(const sf_config *config, sf_config_item *root, sf_joint *joint, sf_error *err);

/* Data and their standard deviations, [rows] each. */
void sf_joint_data(const sf_joint *joint, double *measured, double *sd);
/* Responses [rows] of a foam. SF_ERR_NUMERIC: it collapses. */
sf_status sf_joint_respond(const sf_joint *joint, const sf_material_law *law, double *y, sf_error *err);
/* Hashes everything that the responses depend on. */
uint64_t sf_joint_hash(uint64_t hash, const sf_joint *joint);

/* Root mean square of the deviations of a branch, over the largest stress; `first`: its first row. NaN
 * without points. */
double sf_joint_rms(const sf_joint_test *test, bool unloading, const double *y);

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

/* Reads it into drop[count], after `count` others: refused is one that is there already. Release with
 * sf_drop_input_free, also on failure. */
sf_status sf_drop_input_read(const sf_config *config, sf_config_item *group, bool predicted, int count,
                             sf_fit_drop *drop, sf_error *err);
void sf_drop_input_free(sf_fit_drop *drop);
