/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The requirements of a program on a table of two columns (io/table_csv.h): which names and units its heading
 * may have, which part of several is taken, and what makes a point unfit. */
#pragma once
#include "base/units.h"
#include <stdint.h>

enum { SF_TABLE_RATIO = SF_QUANTITY_COUNT }; /* kind of a column without dimension: "%" or "1" */

/* A name that the heading may use exactly, which of the two columns it is, and its factor to the table's
 * unit.
 */
typedef struct sf_table_name {
    const char *name;
    int column;
    double scale;
    const char *unit; /* of the name, for sentences; NULL: not told */
} sf_table_name;

/* A line that was read: values, and the cells as written, so that the user finds them in the file. */
typedef struct sf_table_point {
    const char *path;
    int line;
    int64_t index; /* of the point, from 0 */
    double value[2];
    const char *text[2];
    double before[2]; /* the point before; zero at the first */
    double last[2];   /* the same in the file's own units */
} sf_table_point;

/* A file may hold several specimens or cycles: with their numbers in a column, with columns side by side, or
 * as tables one below the other. The part is chosen by what its column holds, or by its number, from 1. */
typedef enum sf_table_part { SF_TABLE_SPECIMEN, SF_TABLE_CYCLE, SF_TABLE_PARTS } sf_table_part;

/* Refuses a point. */
typedef sf_status sf_table_check(const sf_table_point *point, sf_error *err);

/* The names of a layout, from an array of them. */
#define SF_TABLE_NAMES(array) .names = (array), .name_count = sizeof(array) / sizeof *(array)

typedef struct sf_table_layout {
    const char *what;      /* "curve" */
    const char *column[2]; /* "strain", "stress" */
    const char *wanted[2]; /* the names allowed in the heading, for messages */
    const sf_table_name *names;
    int name_count;
    const char *words[2]; /* "time|t|*zeit": words that stand in a heading with a unit ('*': they end a word);
                             NULL: exact names only */
    int kind[2];          /* sf_quantity or SF_TABLE_RATIO, with words */
    double unit[2];       /* SI value of the unit of the table's values; 0: SI */
    const char *unfit[2]; /* words of headings that mean another quantity; NULL: none */
    const char *unfit_why;            /* what such a column is, and how to convert it */
    const char *chosen[2];            /* heading of the column to take; NULL: the only one that fits */
    const char *choice;               /* how the user chooses a column, for messages; NULL: not possible */
    const char *part[SF_TABLE_PARTS]; /* the specimen and the cycle to take; NULL: the only one */
    const char *part_option[SF_TABLE_PARTS]; /* how the user chooses them, for messages; NULL: not possible */
    const char *heading;        /* the user's, of a file without one; NULL: it stands in the file */
    const char *heading_option; /* how the user gives it, for messages; NULL: not possible */
    bool counted; /* values of the first column are the numbers of the samples, in their own column or those
                     of the rows */
    bool ragged;  /* a row may be shorter than the heading as long as it holds both columns */
    sf_table_check *check; /* NULL: none */
} sf_table_layout;
