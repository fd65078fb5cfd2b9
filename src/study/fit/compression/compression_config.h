/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The input of `softfall-fit compression`: a libconfig file that names the tests (docs/identification.md). */
#pragma once
#include "study/fit/form/form.h"
#include "study/fit/compression/compression_test.h"

/* The keys of the file of `softfall-fit compression` that belong to one law: those of a form of the loading
 * curve (fit/form), which are its start values, its unknown parameters and the rate dependence, and those of
 * the hyperfoam, which are its terms and the lateral strain of its test. */

enum { SF_FORM_UNKNOWNS = 16 };

typedef struct sf_form_request {
    sf_foam_form form; /* its curve is NULL: none was asked for; the base has no curves */
    sf_form_rate rate;
    double start[SF_PARAMETER_COUNT]; /* SI */
    int unknown_count;
    sf_foam_parameter unknown[SF_FORM_UNKNOWNS];
} sf_form_request;

/* Keys of a file with law = "hyperfoam". */
#define SF_HYPERFOAM_REQUEST_KEYS "law|name|density|tests|DAMP|terms|nu"

typedef struct sf_hyperfoam_request {
    int terms;                    /* 0: the hyperfoam was not asked for */
    double nu;                    /* of every term, if no lateral strain was measured */
    int lateral_count;            /* 0: no lateral strain was measured */
    double *lateral_at, *lateral; /* [lateral_count] -, axial strain, ascending, and lateral strain, positive
                                     outwards; owned */
} sf_hyperfoam_request;

/* Reads terms, nu and the only test. SF_ERR_INPUT also where nu is both given and measured, or neither. */
sf_status sf_hyperfoam_request_read(const sf_config *file, sf_config_item *root,
                                    sf_hyperfoam_request *request, sf_compression_test *test, sf_error *err);
void sf_hyperfoam_request_free(sf_hyperfoam_request *request);

enum { SF_CYCLES = 16 /* in a record at most */, SF_CYCLE_RECORDS = 4 };

/* A record of several cycles of compression of one specimen, with its time: what a foam remembers is in the
 * cycles after the first (theory, section "Memory"). A time of rest without load in which nothing was
 * recorded is a pause. */
typedef struct sf_cycle_record {
    char *path;            /* owned, as the next three */
    int count;             /* points; 0: there is no record */
    double *time;          /* [count] s */
    double *strain;        /* [count] -, not below 0 */
    double *stress;        /* [count] Pa */
    double largest_stress; /* Pa */
    int cycles;            /* loadings, each with its unloading */
    int turn[2 * SF_CYCLES +
             1]; /* first point, that of the largest strain of cycle 1, of the least after it, ... */
    int pauses;
    int fitted; /* cycles, from the first on; the others are predicted */
} sf_cycle_record;

enum { SF_COMPRESSION_TESTS = 8, SF_COMPRESSION_NAME = 64 };

/* Candidates of the rate dependence; "auto" lets the data choose. */
typedef enum sf_rate_model {
    SF_RATE_NONE,
    SF_RATE_LOG,
    SF_RATE_MAXWELL,
    SF_RATE_CURVES,
    SF_RATE_MODELS,
    SF_RATE_AUTO = SF_RATE_MODELS
} sf_rate_model;

typedef enum sf_rule_choice { SF_RULE_AUTO, SF_RULE_H1, SF_RULE_H1_AUTOMATIC, SF_RULE_H2 } sf_rule_choice;

/* A cuboid or a cylinder; 0: not said. */
typedef struct sf_compression_specimen {
    double side, width; /* m, edges of the pressed face; width 0: square */
    double diameter;    /* m */
    double area;        /* m2, from the others unless given */
    double thickness;   /* m, along the load */
} sf_compression_specimen;

typedef struct sf_compression_config {
    char name[SF_COMPRESSION_NAME];   /* of the material; begins a heading */
    double density;                   /* kg m-3 */
    double damp;                      /* -, DAMP, written through */
    double modulus_range;             /* -, E is the slope below this strain */
    double densification_start;       /* -, strain from which the densification law holds; 0 = chosen */
    double confidence;                /* -, of the intervals */
    sf_compression_specimen specimen; /* of the tests without one of their own */
    bool toe;                         /* correct the toe of the tests that do not say otherwise */
    sf_rate_model rate_model;
    sf_rule_choice rule;
    bool specimens; /* of a form: tests of several specimens may have one rate */
    bool thermal;   /* the tests have temperatures of their own, and one rate */
    int middle;     /* the test that E is of: the slowest, or that nearest to 23 degC */
    int test_count;
    sf_compression_test test[SF_COMPRESSION_TESTS]; /* ascending rate or temperature; owned */
    sf_form_request form;           /* which form of the loading curve; its curve is NULL: a free spline */
    sf_hyperfoam_request hyperfoam; /* its terms are 0: another law */
    int record_count;               /* of cycles; of a form */
    sf_cycle_record cycles[SF_CYCLE_RECORDS];            /* several cycles of one specimen each */
    int predicted_count;                                 /* tests that a form is to predict, not fitted */
    sf_compression_test predicted[SF_COMPRESSION_TESTS]; /* owned */
} sf_compression_config;

/* Names of sf_rate_model. */
extern const char *const sf_rate_model_names[];

/* Reads the file and the tests that it names (paths relative to it). SF_ERR_INPUT names file, line and value:
 * unknown or missing keys, units of another kind, values out of bounds, rates that are equal, and what
 * sf_compression_test_read refuses. On failure `*config` is zeroed. */
sf_status sf_compression_config_read(const char *path, sf_compression_config *config, sf_error *err);
void sf_compression_config_free(sf_compression_config *config);

/* The keys of one test beside its file, for other files with such tests; `path` is the caller's. */
#define SF_COMPRESSION_SOURCE_KEYS "rate|specimen|cycle|contact_force|toe_correction|invert"
/* Reads them; `specimen` and `source->toe` are those of tests without their own. */
sf_status sf_compression_source_read(const sf_config *file, sf_config_item *entry,
                                     sf_compression_specimen specimen, sf_compression_source *source,
                                     sf_error *err);

/* ---- cycle_fit.c ---- */

/* Reads the key `cycles`, { file = "cycles.csv"; fitted = 3; } or a list of these, if it is there.
 * SF_ERR_INPUT also where a file has no two cycles, one does not return, or time goes back. Release each with
 * sf_cycle_record_free. */
sf_status sf_cycle_records_read(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                                sf_error *err);
void sf_cycle_record_free(sf_cycle_record *record);
