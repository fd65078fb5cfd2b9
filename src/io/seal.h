/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A checksum at the end of a file, behind the part that its own format (HDF5) reads: 8 bytes "SFSEAL01", the
 * length of the file before it (u64) and its hash (u64, base/hash.h), in the machine's byte order. */
#ifndef SF_IO_SEAL_H
#define SF_IO_SEAL_H

#include "base/error.h"

sf_status sf_seal_add(const char *path, sf_error *err);

typedef enum sf_seal_state {
    SF_SEAL_SOUND,
    SF_SEAL_BROKEN,  /* the file has changed */
    SF_SEAL_NONE,    /* the file was cut, or another tool wrote it */
    SF_SEAL_NO_FILE, /* there is no such file */
} sf_seal_state;

/* The state of a file; fails if it is not known, as the system refused to open or read the file. */
sf_status sf_seal_examine(const char *path, sf_seal_state *state, sf_error *err);

/* SF_ERR_INPUT if the file is not plain; SF_ERR_IO if it is missing, cannot be read, was cut or has changed.
 */
sf_status sf_seal_check(const char *path, sf_error *err);
/* The same for a file that may have come from another tool (h5repack), without a seal: then SF_OK. */
sf_status sf_seal_check_any(const char *path, sf_error *err);

#endif
