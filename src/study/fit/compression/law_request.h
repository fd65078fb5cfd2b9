/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The keys of the file of `softfall-fit compression` that belong to one law: those of a form of the loading
 * curve (fit/form), which are its start values, its unknown parameters and the rate dependence, and those of
 * the hyperfoam, which are its terms and the lateral strain of its test. */
#pragma once
#include "study/config.h"
#include "study/fit/compression/compression_test.h"
#include "study/fit/form/form.h"

/* Keys of the file that belong to forms, and rate_model. */
#define SF_FORM_REQUEST_KEYS "curve_form|solid_density|start|unknown|rate_model|rate_reference|predict"

enum { SF_FORM_UNKNOWNS = 16 };

/* Bits: the law has a factor on the curve, a Maxwell branch. */
typedef enum sf_form_rate {
    SF_FORM_RATE_NONE,
    SF_FORM_RATE_FACTOR,
    SF_FORM_RATE_MAXWELL,
    SF_FORM_RATE_BOTH
} sf_form_rate;

typedef struct sf_form_request {
    sf_foam_form form; /* its curve is NULL: none was asked for; the base has no curves */
    sf_form_rate rate;
    double start[SF_PARAMETER_COUNT]; /* SI */
    int unknown_count;
    sf_foam_parameter unknown[SF_FORM_UNKNOWNS];
} sf_form_request;

/* Names of sf_form_rate. */
extern const char *const sf_form_rate_names[];

/* True if the file names a form other than "free". SF_ERR_INPUT: it names one that does not exist, or
 * "table". */
sf_status sf_form_request_asked(const sf_config *file, sf_config_item *root, bool *asked, sf_error *err);

/* Reads the keys of a form. E begins as the slope of the slowest test's first points, up to the strain
 * `range`. `predicted` are compared only. SF_ERR_INPUT also where the data cannot decide: a start value of a
 * rate that the model does not have, a reference rate at or above the fastest test, two solid fractions, a
 * test at the curve's pole or beyond, nothing unknown. */
sf_status sf_form_request_read(const sf_config *file, sf_config_item *root, double density, double damp,
                               double range, int test_count, const sf_compression_test *test,
                               int predicted_count, const sf_compression_test *predicted,
                               sf_form_request *request, sf_error *err);

/* Keys of a file with law = "hyperfoam". */
#define SF_HYPERFOAM_REQUEST_KEYS "law|name|density|tests|DAMP|terms|nu"

typedef struct sf_hyperfoam_request {
    int terms;                    /* 0: the hyperfoam was not asked for */
    double nu;                    /* of every term, if no lateral strain was measured */
    int lateral_count;            /* 0: no lateral strain was measured */
    double *lateral_at, *lateral; /* [lateral_count] -, axial strain, ascending, and lateral strain, positive
                                     outwards; owned */
} sf_hyperfoam_request;

/* True if the file asks for the hyperfoam. */
sf_status sf_hyperfoam_request_asked(const sf_config *file, sf_config_item *root, bool *asked, sf_error *err);
/* Reads terms, nu and the only test. SF_ERR_INPUT also where nu is both given and measured, or neither. */
sf_status sf_hyperfoam_request_read(const sf_config *file, sf_config_item *root,
                                    sf_hyperfoam_request *request, sf_compression_test *test, sf_error *err);
void sf_hyperfoam_request_free(sf_hyperfoam_request *request);
