/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file of a case's text (case/parts.h). */
#ifndef SF_CASE_PART_H
#define SF_CASE_PART_H

typedef struct sf_case_part {
    char *path;        /* where it stands, from / */
    char *included_as; /* the name in its include; NULL: the case file, or one of a --set text */
    char *text;        /* its includes are @include "#INDEX of the part" until sf_case_parts_finish */
    char *name;        /* where it goes, from the new folder; NULL: no longer part of the case */
} sf_case_part;

typedef struct sf_case_parts {
    int count, capacity;
    sf_case_part *part; /* [count], the case file first */
} sf_case_parts;

#endif
