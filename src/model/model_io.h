/* SPDX-License-Identifier: GPL-3.0-or-later */
/* model.h5: the model's field table and its provenance (docs/formats.md). */
#pragma once
#include "model/model.h"

/* Writes a model under a temporary name beside `path` and renames it: on failure an earlier file stays. */
sf_status sf_model_write(const char *path, const sf_model *model, const sf_provenance *provenance,
                         sf_error *err);

/* Reads and checks (sf_model_check) a model. On success the caller owns `*model` (sf_model_free) and, if
 * `file` is not NULL, the open file (sf_h5_close), for its provenance. On failure both are empty. */
sf_status sf_model_read(const char *path, sf_model *model, sf_h5 **file, sf_error *err);
