/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The input of `softfall-fit compression`: a libconfig file that names the tests (docs/identification.md). */
#pragma once
#include "study/config.h"
#include "study/fit/compression/compression_test.h"

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
    bool thermal;   /* the tests have temperatures of their own, and one rate */
    int middle;     /* the test that E is of: the slowest, or that nearest to 23 degC */
    int test_count;
    sf_compression_test test[SF_COMPRESSION_TESTS]; /* ascending rate or temperature; owned */
} sf_compression_config;

/* Names of sf_rate_model. */
extern const char *const sf_rate_model_names[];

/* Reads the file and the tests that it names (paths relative to it). SF_ERR_INPUT names file, line and value:
 * unknown or missing keys, units of another kind, values out of bounds, rates that are equal, and what
 * sf_compression_test_read refuses. On failure `*config` is zeroed. */
sf_status sf_compression_config_read(const char *path, sf_compression_config *config, sf_error *err);
void sf_compression_config_free(sf_compression_config *config);
