/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Many drops side by side (libsoftfall). */
#pragma once
#include "softfall/model.h"

/* Each drop is on one thread. */
typedef struct softfall_batch {
    int threads;            /* drops at a time, 0: the default of OpenMP; the figures do not depend on it */
    double filter;          /* channel frequency class */
    int keys;               /* number of figures */
    const char *const *key; /* [keys] their names, as of softfall_figure */
} softfall_batch;

/* Runs a drop of each of the `count` models (which may be the same) to its end, and fills `values`
 * [count][keys] and `errors` [count]; the values of a drop that failed are NaN. SOFTFALL_INPUT: the batch has
 * no such figure or filter. */
SOFTFALL_API softfall_status softfall_batch_run(const softfall_model *const *models, int64_t count,
                                                const softfall_batch *batch, double *values,
                                                softfall_error *errors, softfall_error *error);
