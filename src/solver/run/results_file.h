/* SPDX-License-Identifier: GPL-3.0-or-later */
/* results.h5 before the first step: provenance and the part of the model that post-processing needs. */
#ifndef SF_SOLVER_RUN_RESULTS_FILE_H
#define SF_SOLVER_RUN_RESULTS_FILE_H

#include "base/error.h"
#include "model/model.h"
#include "io/h5.h"
#include "io/provenance.h"

/* Creates `path` (truncating) with /provenance, the model's provenance from `model_file`, and /model. On
 * success the caller owns `*file`. */
sf_status sf_results_create(const char *path, const sf_model *model, const sf_h5 *model_file,
                            const sf_provenance *provenance, sf_h5 **file, sf_error *err);

#endif
