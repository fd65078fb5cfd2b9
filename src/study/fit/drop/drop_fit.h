/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "post/figures/reference.h"
#include "study/column.h"
#include "study/fit/form/form.h"
#include "study/fit/space_mapping.h"
#include "study/runner.h"

/* The input of `softfall-fit drop` (docs/identification.md): start material, drops with what was measured,
 * unknown parameters with their priors, and drops to predict. */

/* ---- joint.c ---- */

/* Data of a foam beside its drops that need no simulation: compression tests, at the material point of the
 * law, and cushion curves (ASTM D1596: peak deceleration against static stress), each point one column of
 * foam under a flat mass. Their responses stand before those of the drops, and are exact: space mapping
 * corrects nothing there.
 *
 * Responses: nominal stress over the largest measured one, at strains 0.05 apart (neighbours closer than that
 * deviate alike), loading then unloading; ln of a cushion's peak deceleration in g (F/m, CFC 1000). */

enum { SF_JOINT_MOST = 8, SF_JOINT_POINTS = 48, SF_FIT_NAME_SIZE = 64, SF_JOINT_INTERPRETATION = 768 };

typedef struct sf_joint_test {
    char name[SF_FIT_NAME_SIZE];
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
    char name[SF_FIT_NAME_SIZE];
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

/* Reads the key `name` of data; without it they are called by the usual word and their number: `usual` is
 * "compression " of "compression 2". */
sf_status sf_fit_name_read(const sf_config *config, sf_config_item *entry, const char *usual, int number,
                           char name[SF_FIT_NAME_SIZE], sf_error *err);
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
enum { SF_FIT_CURVE_SAMPLES = 200 };

/* A drop that was measured, or (predicted) is only to be simulated with the identified material. */
typedef struct sf_fit_drop {
    char name[SF_FIT_NAME_SIZE];
    char *case_path; /* owned */
    bool predicted;
    int number;                   /* of the drop in the series of its case, from 1; 0: the case has none */
    double pause[SF_SERIES_MOST]; /* [number - 1] s, after each of the drops before it */
    double value[SF_FIT_SAMPLES]; /* measured, in the unit of its key (model/drop_kind.h); NaN: not */
    double sd[SF_FIT_SAMPLES];    /* relative standard deviations */
    double speed;                 /* m s-1, of the case; 0: a machine drives the missile */
    double speed_sd;              /* its relative standard deviation; 0: it is known */
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

/* Identification of a foam from drops: responses, surrogate and simulation of a sf_fit_input for space
 * mapping, and the conclusions from the result.
 *
 * Scaled variables: u = ln(value / SI unit) of the unknown parameters; responses per drop: logarithms
 * of the numbers of model/drop_kind.h, then the samples of a measured curve over its peak, then the logarithm
 * of the largest indentation over the thickness, which is no datum but bounded. Measured or not, every drop
 * has the numbers; one that is not defined (no rebound within the end time) and was not measured is NaN. */

/* The cache of a fit between its drops, in a file of its folder, so that a run that was killed does not
 * compute it again: numbers by a key of everything that they depend on. Each record is written at once and
 * has a checksum; a record that was cut or has changed, and all behind it, is computed again. A record:
 * key (u64), number of values (u64), values (f64), hash of these (u64, base/hash.h), in the machine's byte
 * order. */
typedef struct sf_fit_memory {
    uint64_t program; /* hash of softfall-fit: begins every key, as another version computes otherwise */
    int file;         /* open and locked; -1: nothing more is remembered */
    char *text;       /* the records that were there; owned */
    size_t size;      /* bytes of them */
    size_t next;      /* byte after the record found last, where the next one is expected */
    size_t end;       /* bytes of the file's whole records */
} sf_fit_memory;

/* Opens or makes the file. If that fails, the disk is full later, or another run has the file, nothing is
 * remembered and nothing found. Release with sf_fit_memory_close, which keeps the file. */
void sf_fit_memory_open(const char *path, sf_fit_memory *memory);
void sf_fit_memory_close(sf_fit_memory *memory);

/* True if `value` [count] was filled. `memory` may be NULL: nothing is found. */
bool sf_fit_memory_find(sf_fit_memory *memory, uint64_t key, size_t count, double *value);
void sf_fit_memory_add(sf_fit_memory *memory, uint64_t key, size_t count, const double *value);

enum { SF_FIT_STRAIN_BINS = 19 }; /* SF_FIT_BIN_WIDTH wide, from 0 to 0.95 */
#define SF_FIT_BIN_WIDTH 0.05

/* The last simulation of each drop. */
typedef struct sf_fit_simulated {
    double max_local_strain, energy_error;
    double scatter[2]; /* of ln a_max and ln HIC, standard deviation from drop to drop; NaN: not known */
    sf_grade grade;
    char verdict[SF_VERDICT_LINE_SIZE]; /* its sentence */
    /* of a predicted drop whose simulation ended without a result that may be used: why; its responses are
     * NaN. Empty: none */
    char failure[512];
    sf_columns_figures figures; /* of the missile, not through the chain */
    sf_series curve;            /* s, g; owned */
} sf_fit_simulated;

typedef struct sf_drop_fit {
    const sf_fit_input *input;
    sf_runner *runner;
    const char *folder; /* for the materials of the iterates; borrowed */
    FILE *log;          /* progress; NULL: silent */
    /* a finished fit of another model to the same data, whose correction the first iterate takes; NULL: none
     */
    const struct sf_drop_fit *earlier;
    sf_fit_memory *memory; /* of the columns' responses; borrowed; NULL: none */

    /* out */
    uint64_t inputs; /* hash of what all responses of columns depend on */
    /* first response of each drop, and their number; before them those of the joint data, then measured
     * drops */
    int row[SF_FIT_MAX_DROPS + 1];
    int measured_drops;
    int parameters;              /* unknown parameters of the foam, then those of the chain, then speeds */
    int chain[SF_SIGNAL_CHAIN];  /* index of the chain's numbers among them; -1: it is known */
    int speed[SF_FIT_MAX_DROPS]; /* index of the drop's speed among them; -1: it is known */
    double *measured, *sd;       /* [responses] scaled; sd INFINITY where nothing was measured */
    double *bound_sd;            /* [responses] of sf_mapping_problem */
    sf_columns columns[SF_FIT_MAX_DROPS];
    bool borrowed[SF_FIT_MAX_DROPS]; /* columns of the coarse drop, until the drop itself was simulated */
    sf_fit_simulated simulated[SF_FIT_MAX_DROPS];
    bool coarse;                        /* now: the drops have the input's coarse_set */
    bool rigid;                         /* now: a mount that is unknown is left out */
    sf_signal_chain chain_now;          /* through which the simulated drops are read */
    double speed_now[SF_FIT_MAX_DROPS]; /* factor on the drop's speed in its simulation; 0: as given */
    bool speeds_fitted; /* `y` and `simulated` have the speeds of the fit, as the given ones have no result */
    int coarse_iterations; /* of the first part; 0: there was none */
    int iteration;
    sf_mapping_result result; /* of the measured drops */
    double *y; /* [responses] of the simulations with the result; owned, with all others [responses] behind
                  it */
    double *gradient; /* [responses][parameters] by the parameters: corrected columns, for predictions plain;
                         owned */
    double *response_sd; /* [responses] standard deviation by the parameters */
    /* [responses] each measured drop predicted by the others; NaN if there are none */
    double *without;
    /* information of the drops about the curve, by strain bin: sum over the data of (d response / d ln sigma
     * / sd)^2 */
    double information[SF_FIT_STRAIN_BINS];
    double curve_sd[SF_FIT_STRAIN_BINS];       /* of ln sigma in the bin's middle */
    double curve_prior_sd[SF_FIT_STRAIN_BINS]; /* the same before the data */
} sf_drop_fit;

/* Standard deviation of the logarithm of a number from drop to drop (a_max_scatter, hic_scatter of the last
 * simulation); NaN: not known, as of every other number. */
double sf_drop_fit_scatter(const sf_drop_fit *fit, int drop, int kind);

/* The accelerometer's chain with its numbers in `u`; NULL: as given. */
sf_signal_chain sf_drop_fit_chain(const sf_drop_fit *fit, const double *u);

/* Fits. `fit` holds input, runner, folder, log and memory. Release with sf_drop_fit_free, also on failure. */
sf_status sf_drop_fit_run(sf_drop_fit *fit, sf_error *err);
void sf_drop_fit_free(sf_drop_fit *fit);

/* Responses of drops `first` to `last` - 1 by columns of this foam into y [responses]; `u` has the speeds
 * and the chain, NULL: as given. Reads the fit only: for several threads at a time. */
sf_status sf_drop_fit_respond(const sf_drop_fit *fit, int first, int last, const sf_foam_card *card,
                              const double *u, double *y, sf_error *err);

/* The card of scaled parameters u, for every other parameter the start. */
sf_status sf_drop_fit_card(const sf_fit_input *input, const double *u, sf_foam_card *card, sf_error *err);

/* ---- internal: drop_response.c ---- */

/* Bounds of number `k` of u: those of its parameter, of HU the lower one; infinite of speeds and the chain.
 */
void sf_drop_fit_bounds(const sf_fit_input *input, int k, double *low, double *high);
/* Lists parameters and responses, with what was measured; needs `input` and `memory`. */
sf_status sf_drop_fit_list(sf_drop_fit *fit, sf_error *err);
/* Scaled responses of one drop from its figures, its curve, which has CFC 1000, as the chain reads it, and
 * its indentation over the thickness. SF_ERR_NUMERIC: a measured number is not defined; `by`: the source that
 * does not give it, `remedy`: the action of the user. */
sf_status sf_drop_fit_read(const sf_fit_drop *drop, const sf_signal_chain *chain,
                           const sf_columns_figures *figures, const sf_series *curve, const char *by,
                           const char *remedy, double *y, sf_error *err);
/* Responses of drops `first` to `last` - 1 by columns, from the cache if they are there. The curve is that of
 * u, or as a fine table raised by SF_FIT_RAISE in a bin, or nowhere. */
enum { SF_FIT_AS_GIVEN = -2, SF_FIT_NOWHERE = -1 }; /* in place of a bin */
#define SF_FIT_RAISE 0.05
sf_status sf_drop_fit_columns(const sf_drop_fit *fit, int first, int last, int bin, const double *u,
                              double *y, sf_error *err);
