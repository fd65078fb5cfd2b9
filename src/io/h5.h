/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HDF5 files and the objects in them; io/h5_data.h reads and writes what they hold. Only src/io calls HDF5.
 * Every dataset carries the attributes `units` (UDUNITS-2 spelling, "1" if dimensionless) and `description`.
 * Numbers are stored in the native types named by sf_h5_type. All functions record failures in `err` and
 * return its status; a failing read returns no buffer. */
#pragma once
#include "base/error.h"
#include <stdint.h>

typedef struct sf_h5 sf_h5;

typedef enum sf_h5_type { SF_H5_F64, SF_H5_I32, SF_H5_I64, SF_H5_U8 } sf_h5_type;

/* A dataset: its path in the file and the two attributes. All strings are borrowed. */
typedef struct sf_h5_info {
    const char *path;        /* absolute, e.g. "/cloud/position"; missing groups are created */
    const char *units;       /* UDUNITS-2, e.g. "m s-1" */
    const char *description; /* one phrase, with the shape's meaning */
} sf_h5_info;

/* Creates a new file, where none of the name may be, or opens read-only. `*file` is owned by the caller:
 * release with sf_h5_close. Opening a file that is missing, unreadable or not HDF5 is SF_ERR_IO with a
 * sentence that says which. */
sf_status sf_h5_create(const char *path, sf_h5 **file, sf_error *err);
sf_status sf_h5_open(const char *path, sf_h5 **file, sf_error *err);
/* The same of a file that has no folder of its own (a checkpoint, a file of such a folder): no link of it is
 * followed. */
sf_status sf_h5_open_alone(const char *path, sf_h5 **file, sf_error *err);
/* Closes; `*file` may be NULL and is NULL afterwards. Reports a failed final write. */
sf_status sf_h5_close(sf_h5 **file, sf_error *err);
/* The same of a file into which nothing was written, so that nothing can be lost. */
void sf_h5_drop(sf_h5 **file);

/* True if a group or dataset of this path exists in the file itself, or by a link of sf_h5_link in a plain
 * file of the folder of its run (FILE.run), and there without any further link; other soft and external links
 * do not count and are never followed. The same holds for all that is read below. */
bool sf_h5_exists(const sf_h5 *file, const char *path);
/* Number of members of a group (-1 if there is no such group, or more than its file can hold), and the name
 * of member `index` in name order.
 */
int64_t sf_h5_group_size(const sf_h5 *file, const char *path);
sf_status sf_h5_group_member(const sf_h5 *file, const char *path, int64_t index, char *name, size_t size,
                             sf_error *err);

/* "1.10.8", static storage. */
const char *sf_h5_version(void);
