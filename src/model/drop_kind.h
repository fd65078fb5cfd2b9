/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers that may be measured of a drop, as the accelerometer in the missile reads it (F/m), filtered
 * with CFC 1000. This list is the only one of them.
 *
 * To add one: a line in the list and its value in sf_columns_scale (study/column.c). Keys of
 * the fit file, responses, report.html, fit.json, fit-drops.csv, posterior.csv, the material file's comments
 * and its response_error, and leave-one-out follow. */
#pragma once
#include <stdbool.h>

/* X(name, key in the fit file, key in response_error, members of sf_drop_kind_info). The key of a standard
 * deviation is SF_DROP_SD(key in response_error), in both files. */
/* clang-format off */
#define SF_DROP_KINDS(X) \
    X(A_MAX, "a_max_g", "a_max", .sd = 0.02, .model_sd = 0.01, .stem = "a_max", .suffix = "_g", .name = "a_max", \
      .unit = "g", .digits = 1, .always = true, .needs = "contact", .above_all = true, \
      .meaning = "largest deceleration") \
    X(HIC, "HIC", "HIC", .sd = 0.04, .model_sd = 0.02, .stem = "hic", .suffix = "", .name = "HIC", \
      .unit = "", .digits = 0, .always = true, .needs = "contact", .above_all = true, \
      .meaning = "head injury criterion, no limit of the window") \
    X(WINDOW, "HIC_window_ms", "HIC_window", .sd = 0.03, .model_sd = 0.02, .stem = "hic_window", .suffix = "_ms", .name = "HIC window", \
      .unit = "ms", .digits = 2, .always = true, .needs = "contact", .above_all = false, \
      .meaning = "length t_2 − t_1 of the window of HIC") \
    X(REBOUND, "v_rebound_m_s", "v_rebound", .sd = 0.03, .model_sd = 0.02, .stem = "v_rebound", .suffix = "_m_s", .name = "rebound speed", \
      .unit = "m/s", .digits = 3, .always = false, .needs = "rebound", .above_all = false, \
      .meaning = "speed upwards when contact ends") \
    X(CONTACT, "contact_time_ms", "contact_time", .sd = 0.03, .model_sd = 0.02, .stem = "contact_time", .suffix = "_ms", .name = "contact time", \
      .unit = "ms", .digits = 2, .always = false, .needs = "rebound", .above_all = false, \
      .meaning = "from first contact to the end of contact")
/* clang-format on */
#define SF_DROP_SD(key) key "_sd"

/* Rows of a drop's responses; the samples of a measured curve from SF_FIT_SAMPLES on. */
#define SF_DROP_KIND_NAME(name, ...) SF_FIT_##name,
typedef enum sf_drop_kind { SF_DROP_KINDS(SF_DROP_KIND_NAME) SF_FIT_SAMPLES } sf_drop_kind;

typedef struct sf_drop_kind_info {
    const char *key, *error_key, *sd_key; /* in the fit file and in response_error */
    double sd;                            /* default of the standard deviation, relative */
    double model_sd; /* of the logarithm, of the model's error at kappa = 1 */
    const char *stem, *suffix; /* of its key in fit.json: the suffix has the unit */
    const char *name, *unit;   /* in reports */
    int digits;                /* there */
    bool always;               /* in reports, measured or not */
    const char *needs;         /* of a drop */
    /* True if a collapsed foam counts as above every value, as of peaks. False: the number has no order,
     * as a pulse that has no end has no window. */
    bool above_all;
    const char *meaning; /* one phrase */
} sf_drop_kind_info;

/* Static storage. */
const sf_drop_kind_info *sf_drop_kind_get(int kind);

/* By how much the numbers of drops differ from those of a foam's law, in natural logarithms: an error of each
 * number that all drops share, and the standard deviation of another one of each drop. Zeros: not stated.
 * The group `response_error` of a material file (docs/case.md). */
typedef struct sf_response_error {
    bool given[SF_FIT_SAMPLES];
    double shared[SF_FIT_SAMPLES];
    double own_sd[SF_FIT_SAMPLES];
} sf_response_error;
