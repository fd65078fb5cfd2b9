/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_API_API_DROP_H
#define SF_API_API_DROP_H
#include <omp.h>

#include "api/api.h"
#include "model/columns.h"
#include "solver/operators.h"
#include "solver/run/recorder.h"
#include "solver/state.h"

/* A drop behind its handle. */

struct softfall_drop {
    sf_model model; /* arrays borrowed from the caller's model */
    sf_operators operators;
    sf_state state;
    sf_recorder recorder;
    int threads; /* 0: as OpenMP would */
    softfall_ending ending;
    sf_error failure; /* of a step */
    softfall_quantity column[SF_HISTORY_COUNT], field[SF_FRAME_FIELDS];
};

/* Sets the number of threads of the drop and returns the number before. */
static inline int softfall_drop_enter(const softfall_drop *drop) {
    int before = omp_get_max_threads();
    if (drop->threads > 0)
        omp_set_num_threads(drop->threads);
    return before;
}

/* Fills the lists of columns and fields. */
void softfall_drop_list(softfall_drop *drop);
#endif
