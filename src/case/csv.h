/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of two columns that a case names, as CSV files: lines that begin with '#' are comments; a header
 * names the columns (others are ignored), then one point per line. Each sentence names file, line and cell.
 */
#ifndef SF_CASE_CSV_H
#define SF_CASE_CSV_H

#include "core/error.h"
#include <stdint.h>

/* A name that the header may use, which of the two columns it is, and what makes it SI. */
typedef struct sf_case_csv_name {
    const char *name;
    int column;
    double scale;
} sf_case_csv_name;

/* A line that was read: SI values, and the cells as written, so that the user finds them in the file. */
typedef struct sf_case_csv_point {
    const char *path;
    int line;
    int64_t index; /* of the point, from 0 */
    double value[2];
    const char *text[2];
    double before[2]; /* the point before; zero at the first */
    double last[2];   /* the same in the file's own units */
} sf_case_csv_point;

/* Refuses a point. */
typedef sf_status sf_case_csv_check(const sf_case_csv_point *point, sf_error *err);

typedef struct sf_case_csv_layout {
    const char *what;      /* "curve" */
    const char *column[2]; /* "strain", "stress" */
    const char *wanted[2]; /* what the header may call them, for the sentence */
    const sf_case_csv_name *names;
    int name_count;
    sf_case_csv_check *check;
} sf_case_csv_layout;

/* Stress over strain in compression; the strain may be in percent. */
sf_case_csv_layout sf_case_csv_stress_strain(const char *what, sf_case_csv_check *check);

typedef struct sf_case_csv {
    int64_t count;
    int64_t capacity;
    double *value[2]; /* [count] SI; owned */
    int *line;        /* [count] in the file; owned */
    double scale[2];  /* from the file's units to SI */
} sf_case_csv;

/* Reads a table; SF_ERR_INPUT names file, line and value. On failure `*table` is zeroed. */
sf_status sf_case_csv_read(const char *path, const sf_case_csv_layout *layout, sf_case_csv *table,
                           sf_error *err);
void sf_case_csv_free(sf_case_csv *table);

#endif
