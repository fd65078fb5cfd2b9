/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The only code that calls HDF5. Every dataset carries the attributes `units` (UDUNITS-2 spelling, "1" if
 * dimensionless) and `description`. Numbers are stored in the native types named by sf_h5_type. All functions
 * record failures in `err` and return its status; a failing read returns no buffer. */
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

/* Writes a whole dataset, row-major `dims[rank]`. Rank 0 is a scalar. */
sf_status sf_h5_write(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, int rank, const int64_t *dims,
                      const void *data, sf_error *err);
sf_status sf_h5_write_scalar(sf_h5 *file, const sf_h5_info *info, double value, sf_error *err);
sf_status sf_h5_write_text(sf_h5 *file, const sf_h5_info *info, const char *text, sf_error *err);

/* The same for other programs, compressed (shuffle and deflate): softfall does not read it. `single`: doubles
 * are stored as the nearest floats. */
sf_status sf_h5_write_packed(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, bool single, int rank,
                             const int64_t *dims, const void *data, sf_error *err);

/* A dataset on its way into a file, rows (items of the first dimension) after rows. */
typedef struct sf_h5_rows {
    sf_h5 *file;         /* borrowed, like the path */
    const char *path;    /* info->path */
    sf_h5_type type;     /* of an item */
    int64_t next, count; /* rows written, and in all */
    int64_t set;         /* the library's name of it, -1: none */
} sf_h5_rows;

/* Creates the dataset; adds the next `count` rows; closes it, SF_ERR_IO if rows are missing. After a begin,
 * failed or not, and whatever was added, sf_h5_rows_end releases. */
sf_status sf_h5_rows_begin(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, int rank,
                           const int64_t *dims, sf_h5_rows *rows, sf_error *err);
sf_status sf_h5_rows_add(sf_h5_rows *rows, int64_t count, const void *data, sf_error *err);
sf_status sf_h5_rows_end(sf_h5_rows *rows, sf_error *err);

/* Reads a whole dataset. `dims[rank]`: on entry the expected extent or -1 for any, on return the extent
 * found. The rank, every given extent and the type class must agree with the file. `*data` comes from
 * sf_alloc, owned by the caller. Nothing is allocated before the claimed size is found to be stored and
 * within the file's; data in other files and filters (compression) are refused. */
sf_status sf_h5_read(const sf_h5 *file, const char *path, sf_h5_type type, int rank, int64_t *dims,
                     void **data, sf_error *err);
/* A scalar of SF_H5_F64 or SF_H5_I64: `value` has eight bytes. */
sf_status sf_h5_read_one(const sf_h5 *file, const char *path, sf_h5_type type, void *value, sf_error *err);
sf_status sf_h5_read_scalar(const sf_h5 *file, const char *path, double *value, sf_error *err);
/* One string of fixed length. `*text` is NUL-terminated, from malloc, owned by the caller. */
sf_status sf_h5_read_text(const sf_h5 *file, const char *path, char **text, sf_error *err);

/* Attributes: written to the file itself, read of an existing group or dataset ("/" for the file). */
sf_status sf_h5_set_attribute(sf_h5 *file, const char *name, const char *text, sf_error *err);
sf_status sf_h5_set_attribute_i64(sf_h5 *file, const char *name, int64_t value, sf_error *err);
sf_status sf_h5_get_attribute(const sf_h5 *file, const char *object, const char *name, char *text,
                              size_t size, sf_error *err);
sf_status sf_h5_get_attribute_i64(const sf_h5 *file, const char *object, const char *name, int64_t *value,
                                  sf_error *err);

/* Copies an object (a dataset, or a group with all it holds) to the same path of another file, 64 kB (or one
 * row) at a time. */
sf_status sf_h5_copy(const sf_h5 *from, const char *path, sf_h5 *to, sf_error *err);
/* Makes `path` stand for the object of the same path in another file, named relative to the folder of this
 * one: a sealed file (io/replace.h) of the folder of its run, or nothing reads it. */
sf_status sf_h5_link(sf_h5 *file, const char *path, const char *target, sf_error *err);

/* "1.10.8", static storage. */
const char *sf_h5_version(void);

/* Lists of numbers, X(type, name, array size, units, meaning), that declare the members of a struct;
 * sf_members_write and sf_members_read go by the list. */

#define SF_DECLARE(type, name, size, units, meaning) type name size;

/* Numbers of a struct as datasets of one group, by a table. */

typedef struct sf_member {
    const char *name;
    const char *units;
    const char *description;
    sf_h5_type type; /* of an item: SF_H5_F64 or SF_H5_I64 */
    int count;       /* items in a row */
    size_t offset;
} sf_member;

/* A row of the table for a member of the struct `base`, of type double or int64_t or an array of them. */
#define SF_MEMBER(base, member, type, units, description)                                                    \
    { #member, units, description, SF_MEMBER_##type, sizeof(((base *)0)->member) / 8, offsetof(base, member) }
#define SF_MEMBER_double SF_H5_F64
#define SF_MEMBER_int64_t SF_H5_I64

/* Writes the members of `base` to "group/name". */
sf_status sf_members_write(sf_h5 *file, const char *group, const sf_member *member, size_t count,
                           const void *base, sf_error *err);
/* Reads them back, bit by bit. */
sf_status sf_members_read(const sf_h5 *file, const char *group, const sf_member *member, size_t count,
                          void *base, sf_error *err);
