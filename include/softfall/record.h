/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured records of one impact (libsoftfall). */
#pragma once
#include "softfall/status.h"

/* A measured record of one impact in a CSV file (docs/formats.md), read, filtered and judged as softfall-post
 * does with --reference. `options` [count]: "filter=600" or "filter=none" (default 1000), "column=HEADING",
 * "columns=x,y,z", "impact=2", "invert", "zero",
 * "speed=4.5 m/s" (known at contact), "range=200 g" (of the channel). `out`
 * is owned by the caller. */
typedef struct softfall_record softfall_record;
SOFTFALL_API softfall_status softfall_record_read(const char *path, const char *const *options, int count,
                                                  softfall_record **out, softfall_error *error);
/* The samples of a file that the caller has read. */
typedef struct softfall_samples {
    const char *name;    /* of the file, for sentences */
    const char *reading; /* how it was read, in words */
    int64_t count;
    const double *time;     /* [count] s, ascending */
    int axes;               /* 1: the deceleration; 2 or 3: axes, whose resultant it is */
    const double *value[3]; /* [axes][count] g */
} softfall_samples;
/* The record of such samples, by the same options except column and columns. */
SOFTFALL_API softfall_status softfall_record_make(const softfall_samples *samples, const char *const *options,
                                                  int count, softfall_record **out, softfall_error *error);
SOFTFALL_API void softfall_record_free(softfall_record *record);
/* The filtered curve: time in s on the clock of the file, deceleration in g; returns the number of points.
 * The arrays are the record's. */
SOFTFALL_API int64_t softfall_record_curve(const softfall_record *record, const double **time,
                                           const double **deceleration);
/* 0: valid, 1: valid with remarks, 2: not to be used; and that with the findings, in words. */
SOFTFALL_API int softfall_record_grade(const softfall_record *record);
SOFTFALL_API const char *softfall_record_verdict(const softfall_record *record);
/* Returns how the file was read, in words. */
SOFTFALL_API const char *softfall_record_interpretation(const softfall_record *record);
/* Sets `value`: a_max_g, a_max_time_ms, hic, hic_t1_ms, hic_t2_ms, hic15, hic36, gadd, clip_3ms_g,
 * clip_3ms_cumulative_g as in summary.json. SOFTFALL_INPUT: another key. */
SOFTFALL_API softfall_status softfall_record_figure(const softfall_record *record, const char *key,
                                                    double *value, softfall_error *error);
