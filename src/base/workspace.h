/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/error.h"

/* Memory that stays from call to call, so that a step of the solver allocates nothing: a block that is large
 * enough is given again. */
typedef struct sf_workspace {
    void *data;   /* owned; sf_workspace_free */
    size_t bytes; /* of it */
} sf_workspace;

/* Returns a block of `count` items of `size` bytes, whose content is undefined. It belongs to `workspace`,
 * and the one before it is no longer valid. Returns NULL without memory, with an error that names `purpose`.
 */
void *sf_workspace_take(sf_workspace *workspace, int64_t count, size_t size, const char *purpose,
                        sf_error *err);
void sf_workspace_free(sf_workspace *workspace);
