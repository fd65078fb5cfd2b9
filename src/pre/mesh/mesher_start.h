/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts softfall-mesh. */
#ifndef SF_PRE_MESH_MESHER_START_H
#define SF_PRE_MESH_MESHER_START_H

#include "base/error.h"
#include <stddef.h>
#include <sys/types.h>

typedef struct sf_mesher_child {
    pid_t process;
    int control, data, print; /* this side of the child's files (mesher_protocol.h); the caller closes them */
} sf_mesher_child;

/* The path of softfall-mesh: in SF_BIN_DIR if that is set, else beside this program or library, in
 * libexec/softfall or bin of a folder above it, or where it was to be installed. SF_ERR_IO if it is nowhere.
 */
sf_status sf_mesher_find(char *path, size_t size, sf_error *err);

/* The child gets `parameters` as a file, a small environment and no other open files. */
sf_status sf_mesher_start(const char *parameters, sf_mesher_child *child, sf_error *err);

#endif
