/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that implement include/softfall/softfall.h. */
#pragma once
#include "softfall/softfall.h"

#include "model/model.h"
#include "pre/vary.h"

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

/* The outcome for the user. */
static inline softfall_status softfall_return(const sf_error *err, softfall_error *error) {
    if (error) {
        error->status = (softfall_status)err->status;
        snprintf(error->text, sizeof error->text, "%s", err->status == SF_OK ? "" : err->text);
    }
    return (softfall_status)err->status;
}
