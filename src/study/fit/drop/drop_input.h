/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_STUDY_FIT_DROP_DROP_INPUT_H
#define SF_STUDY_FIT_DROP_DROP_INPUT_H
#include "model/good_run.h"
#include "post/figures/compare.h"
#include "study/column.h"
#include "study/config.h"

/* The numbers of model/good_run.h as the columns give them: the same of the simulation and of the columns.
 */

/* Logarithms of the values in the units of the keys; NaN where a value is not defined. */
void sf_drop_values_scale(const sf_columns_figures *values, double y[SF_FIT_SAMPLES]);

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

/* Reads it into drop[count], after `count` others: refused is one that is there already. Release with
 * sf_drop_input_free, also on failure. */
sf_status sf_drop_input_read(const sf_config *config, const config_setting_t *group, bool predicted,
                             int count, sf_fit_drop *drop, sf_error *err);
void sf_drop_input_free(sf_fit_drop *drop);
#endif
