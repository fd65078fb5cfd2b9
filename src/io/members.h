/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers of a struct as datasets of one group, by a table. */
#ifndef SF_IO_MEMBERS_H
#define SF_IO_MEMBERS_H

#include "io/h5.h"

typedef struct sf_member {
    const char *name;
    const char *units;
    sf_h5_type type; /* of an item: SF_H5_F64 or SF_H5_I64 */
    int count;       /* items in a row */
    size_t offset;
} sf_member;

/* Writes the members of `base` to "group/name". */
sf_status sf_members_write(sf_h5 *file, const char *group, const sf_member *member, size_t count,
                           const void *base, sf_error *err);
/* Reads them back, bit by bit. */
sf_status sf_members_read(const sf_h5 *file, const char *group, const sf_member *member, size_t count,
                          void *base, sf_error *err);

#endif
