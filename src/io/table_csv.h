/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of two columns in CSV files (curves, motions, measurements): lines that begin with '#' are comments;
 * a header names the columns (others are ignored), then one point per line. Blanks and quotes around a cell
 * do not count. Each sentence names file, line and cell. */
#ifndef SF_IO_TABLE_CSV_H
#define SF_IO_TABLE_CSV_H

#include "core/error.h"
#include <stdbool.h>
#include <stdint.h>

/* A name that the header may use, which of the two columns it is, and its factor to SI. */
typedef struct sf_table_name {
    const char *name;
    int column;
    double scale;
} sf_table_name;

/* A line that was read: SI values, and the cells as written, so that the user finds them in the file. */
typedef struct sf_table_point {
    const char *path;
    int line;
    int64_t index; /* of the point, from 0 */
    double value[2];
    const char *text[2];
    double before[2]; /* the point before; zero at the first */
    double last[2];   /* the same in the file's own units */
} sf_table_point;

/* Refuses a point. */
typedef sf_status sf_table_check(const sf_table_point *point, sf_error *err);

typedef struct sf_table_layout {
    const char *what;      /* "curve" */
    const char *column[2]; /* "strain", "stress" */
    const char *wanted[2]; /* the names allowed in the header, for messages */
    const sf_table_name *names;
    int name_count;
    bool first;  /* of several columns that mean the same the first counts; else they are refused */
    bool ragged; /* a row may be longer or shorter than the header as long as it holds both columns */
    sf_table_check *check;
} sf_table_layout;

typedef struct sf_table {
    int64_t count;
    int64_t capacity;
    double *value[2]; /* [count] SI; owned */
    int *line;        /* [count] in the file; owned */
    double scale[2];  /* from the file's units to SI */
} sf_table;

/* Reads a table; SF_ERR_INPUT names file, line and value. On failure `*table` is zeroed. */
sf_status sf_table_read(const char *path, const sf_table_layout *layout, sf_table *table, sf_error *err);
void sf_table_free(sf_table *table);

#endif
