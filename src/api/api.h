/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contents of the handles that several files share, and their checks. */
#pragma once
#include "softfall/softfall.h"

#include "drop/drop.h"
#include "pre/vary.h"

#include <omp.h>

_Static_assert((int)SOFTFALL_INPUT == SF_ERR_INPUT && (int)SOFTFALL_FILE == SF_ERR_IO &&
                   (int)SOFTFALL_MODEL == SF_ERR_MODEL && (int)SOFTFALL_NUMERIC == SF_ERR_NUMERIC &&
                   (int)SOFTFALL_MEMORY == SF_ERR_MEMORY && (int)SOFTFALL_LIBRARY == SF_ERR_LIBRARY,
               "the two lists of statuses are one");

struct softfall_model {
    sf_model model;
    char *case_text, *parameters, *mesh_hash, *geometry_files; /* of the provenance; NULL: unknown; owned */
    char libraries[96];                                        /* that made it */
    sf_kernel kernel;                                          /* zeros: read from a file */
};

struct softfall_drop {
    sf_drop drop;
    int threads; /* 0: as OpenMP would */
    softfall_quantity column[SF_HISTORY_COUNT], field[SF_FRAME_FIELDS];
};

/* Sets the number of threads of the drop and returns the number before. */
static inline int softfall_enter(const softfall_drop *drop) {
    int before = omp_get_max_threads();
    if (drop->threads > 0)
        omp_set_num_threads(drop->threads);
    return before;
}

static inline sf_status softfall_check_threads(int threads, sf_error *err) {
    if (threads >= 0 && threads <= 1024)
        return SF_OK;
    return SF_REFUSE(err, "threads" SF_OUTSIDE("%d", "0", "1024"), threads);
}

static inline sf_status softfall_check_filter(double filter, sf_error *err) {
    if (filter == 60 || filter == 180 || filter == 600 || filter == 1000)
        return SF_OK;
    return SF_REFUSE(err, "filter: %g; the channel frequency classes are 60, 180, 600 and 1000", filter);
}

/* The outcome for the user. */
static inline softfall_status softfall_return(const sf_error *err, softfall_error *error) {
    if (error) {
        error->status = (softfall_status)err->status;
        snprintf(error->text, sizeof error->text, "%s", err->status == SF_OK ? "" : err->text);
    }
    return (softfall_status)err->status;
}
