/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drops (libsoftfall). */
#pragma once
#include "softfall/model.h"

typedef struct softfall_drop softfall_drop;

typedef struct softfall_drop_options {
    int threads;     /* OpenMP threads, 0: the default of OpenMP; results do not depend on it, bit for bit */
    double end_time; /* s, 0: that of the model */
} softfall_drop_options;

typedef enum softfall_ending {
    SOFTFALL_RUNNING = 0,
    SOFTFALL_REBOUND = 1, /* the missile has left the pad upwards */
    SOFTFALL_FINISHED = 2 /* the end time is reached */
} softfall_ending;

/* A drop at t = 0 before its first step. The model is borrowed: it must outlive the drop, and several drops
 * may share it. `options` may be NULL: all zero. */
SOFTFALL_API softfall_status softfall_drop_create(const softfall_model *model,
                                                  const softfall_drop_options *options, softfall_drop **out,
                                                  softfall_error *error);
/* The next drop of the same missile on the pad as `before` has left it, after a rest of `pause` (s): the bits
 * are those of a series of softfall-solve. `before` must have ended with the missile away from the pad; it
 * does not change, and may be freed, but its model must outlive the new drop. Threads and end time are those
 * of `before`. Later drops of a foam without memory are too soft. */
SOFTFALL_API softfall_status softfall_drop_next(const softfall_drop *before, double pause,
                                                softfall_drop **out, softfall_error *error);
/* The same with another missile, that of `model`, on the same pad; `model` NULL: that of `before`. */
SOFTFALL_API softfall_status softfall_drop_next_of(const softfall_drop *before, const softfall_model *model,
                                                   double pause, softfall_drop **out, softfall_error *error);
SOFTFALL_API void softfall_drop_free(softfall_drop *drop);

/* Advances the drop by one step; the first computes the state at t = 0. `ending` (may be NULL) tells whether
 * the drop has ended with it; further steps of an ended drop change nothing. After a failure the history up
 * to the last good step can still be read, and further steps return the same failure. A missile that reaches
 * the anvil is a failure, too; the history has that step. */
SOFTFALL_API softfall_status softfall_drop_step(softfall_drop *drop, softfall_ending *ending,
                                                softfall_error *error);

/* Steps until the drop ends, or until `observe` (may be NULL), which is called after each step, returns
 * nonzero: then `ending` is SOFTFALL_RUNNING and the drop can be continued. */
SOFTFALL_API softfall_status softfall_drop_run(softfall_drop *drop,
                                               int (*observe)(void *user, const softfall_drop *drop),
                                               void *user, softfall_ending *ending, softfall_error *error);

/* Steps that the drop has, that of t = 0 included: 0 before the first. */
SOFTFALL_API int64_t softfall_drop_steps(const softfall_drop *drop);
/* Value of a column of the history in the last step; NaN before the first, or if there is no such column. */
SOFTFALL_API double softfall_drop_latest(const softfall_drop *drop, const char *name);

/* The history, a value for each step: `columns` [count] lists its columns. The values of a column are owned
 * by the drop and valid until its next step; the result is their number, -1 if there is no such column. */
SOFTFALL_API const softfall_quantity *softfall_drop_columns(const softfall_drop *drop, int *count);
SOFTFALL_API int64_t softfall_drop_history(const softfall_drop *drop, const char *name,
                                           const double **values);

/* Fields over the nodes after the last step. `values` [node_count][components] belongs to the caller; `size`
 * is its number of doubles. SOFTFALL_INPUT: no such field, another size, or no step yet. */
SOFTFALL_API const softfall_quantity *softfall_drop_fields(const softfall_drop *drop, int *count);
SOFTFALL_API softfall_status softfall_drop_field(const softfall_drop *drop, const char *name, double *values,
                                                 int64_t size, softfall_error *error);
