/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers of a struct as datasets of one group of an HDF5 file, by a table of its members. */
#pragma once
#include "io/h5.h"

/* Lists of numbers, X(type, name, array size, units, meaning), that declare the members of a struct;
 * sf_members_write and sf_members_read go by the list. */

#define SF_DECLARE(type, name, size, units, meaning) type name size;

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
