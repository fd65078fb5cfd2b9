/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading and writing of what an HDF5 file holds: datasets, texts, attributes, copies and links. The file
 * itself is opened and closed with io/h5.h, whose rules on links and failures hold here too. */
#pragma once
#include "io/h5.h"

/* Returns the bytes of an item. */
size_t sf_h5_size(sf_h5_type type);

/* Writes a whole dataset, row-major `dims[rank]`. Rank 0 is a scalar. */
sf_status sf_h5_write(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, int rank, const int64_t *dims,
                      const void *data, sf_error *err);
sf_status sf_h5_write_scalar(sf_h5 *file, const sf_h5_info *info, double value, sf_error *err);
sf_status sf_h5_write_text(sf_h5 *file, const sf_h5_info *info, const char *text, sf_error *err);

/* The same for other programs, compressed (shuffle and deflate): softfall does not read it. */
sf_status sf_h5_write_packed(sf_h5 *file, const sf_h5_info *info, sf_h5_type type, int rank,
                             const int64_t *dims, const void *data, sf_error *err);
/* Doubles, stored as the nearest floats. */
sf_status sf_h5_write_singles(sf_h5 *file, const sf_h5_info *info, int rank, const int64_t *dims,
                              const double *data, sf_error *err);

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

/* Refuses to replace a file that is neither of this format (the attribute `format`) nor damaged so that
 * nothing tells what it was; it may be missing. Not registered as an input. */
sf_status sf_h5_check_replaced(const char *path, const char *format, sf_error *err);
