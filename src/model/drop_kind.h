/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers that may be measured of a drop, as the accelerometer in the missile reads it (F/m), filtered
 * with CFC 1000: keys of a file of `softfall fit` (python/softfall/fit/input.py) and of response_error. */
#pragma once
#include <stdbool.h>

/* X(name, key of a fit, key in response_error, members of sf_drop_kind_info). The key of a standard deviation
 * is SF_DROP_SD(key in response_error), in both files. */
/* clang-format off */
#define SF_DROP_KINDS(X) \
    X(A_MAX, "a_max_g", "a_max", .sd = 0.02, .meaning = "largest deceleration") \
    X(HIC, "HIC", "HIC", .sd = 0.04, .meaning = "head injury criterion, no limit of the window") \
    X(WINDOW, "HIC_window_ms", "HIC_window", .sd = 0.03, .meaning = "length t_2 − t_1 of the window of HIC") \
    X(REBOUND, "v_rebound_m_s", "v_rebound", .sd = 0.03, .meaning = "speed upwards when contact ends") \
    X(CONTACT, "contact_time_ms", "contact_time", .sd = 0.03, .meaning = "from first contact to the end of contact")
/* clang-format on */
#define SF_DROP_SD(key) key "_sd"

#define SF_DROP_KIND_NAME(name, ...) SF_FIT_##name,
typedef enum sf_drop_kind { SF_DROP_KINDS(SF_DROP_KIND_NAME) SF_FIT_SAMPLES } sf_drop_kind;

typedef struct sf_drop_kind_info {
    const char *key, *error_key, *sd_key; /* of a fit and in response_error */
    double sd;                            /* default of the standard deviation in a fit, relative */
    const char *meaning;                  /* one phrase */
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
