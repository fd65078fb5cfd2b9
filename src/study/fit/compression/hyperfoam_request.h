/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The keys of the file of `softfall-fit compression` with law = "hyperfoam", and the lateral strain of its
 * test. */
#ifndef SF_FIT_COMPRESSION_HYPERFOAM_REQUEST_H
#define SF_FIT_COMPRESSION_HYPERFOAM_REQUEST_H

#include "study/config.h"
#include "study/fit/compression/compression_test.h"

#define SF_HYPERFOAM_REQUEST_KEYS "law|name|density|tests|DAMP|terms|nu"

typedef struct sf_hyperfoam_request {
    int terms;                    /* 0: the hyperfoam was not asked for */
    double nu;                    /* of every term, if no lateral strain was measured */
    int lateral_count;            /* 0: no lateral strain was measured */
    double *lateral_at, *lateral; /* [lateral_count] -, axial strain, ascending, and lateral strain, positive
                                     outwards; owned */
} sf_hyperfoam_request;

/* True if the file asks for the hyperfoam. */
sf_status sf_hyperfoam_request_asked(const sf_config *file, const config_setting_t *root, bool *asked,
                                     sf_error *err);
/* Reads terms, nu and the only test. SF_ERR_INPUT also where nu is both given and measured, or neither. */
sf_status sf_hyperfoam_request_read(const sf_config *file, const config_setting_t *root,
                                    sf_hyperfoam_request *request, sf_compression_test *test, sf_error *err);
void sf_hyperfoam_request_free(sf_hyperfoam_request *request);

#endif
