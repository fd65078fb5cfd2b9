/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/workspace.h"

void *sf_workspace_take(sf_workspace *workspace, int64_t count, size_t size, const char *purpose,
                        sf_error *err) {
    size_t bytes = (size_t)count * size;
    if (workspace->bytes < bytes || !workspace->data) {
        sf_workspace_free(workspace);
        workspace->data = sf_alloc(err, count, size, purpose);
        workspace->bytes = workspace->data ? bytes : 0;
    }
    return workspace->data;
}

void sf_workspace_free(sf_workspace *workspace) {
    SF_CLEAR(workspace, workspace->data);
}
