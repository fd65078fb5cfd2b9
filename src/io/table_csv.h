/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of two columns in CSV files (curves, motions, measurements), as laboratories write them:
 *
 * - separators comma, semicolon, tab or runs of blanks, found by the heading; UTF-8, with or without a byte
 *   order mark, or Latin-1 in the heading; any line ends; cells may be quoted;
 * - lines that begin with '#' are comments; other lines before the heading are passed over;
 * - the heading names the two columns exactly ("time_ms"), or by a word with a unit: "Time (ms)", "Zeit
 * [ms]", "t / ms", "acc_m_s2", or the unit in the line below. Other columns are ignored;
 * - decimal point or, unless the comma separates, decimal comma; the same throughout.
 *
 * What could be read in two ways is refused. Each sentence names file, line and cell. */
#ifndef SF_IO_TABLE_CSV_H
#define SF_IO_TABLE_CSV_H

#include "core/error.h"
#include "core/units.h"
#include <stdbool.h>
#include <stdint.h>

enum { SF_TABLE_RATIO = SF_QUANTITY_COUNT }; /* kind of a column without dimension: "%" or "1" */
enum { SF_TABLE_UNDERSTOOD = 384 };

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

/* Refuses a point. */
typedef sf_status sf_table_check(const sf_table_point *point, sf_error *err);

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
    const char *chosen[2]; /* heading of the column to take; NULL: the only one that fits */
    const char *choice;    /* how the user chooses a column, for messages; NULL: not possible */
    bool ragged;           /* a row may be shorter than the heading as long as it holds both columns */
    sf_table_check *check; /* NULL: none */
} sf_table_layout;

typedef struct sf_table {
    int64_t count;
    int64_t capacity;
    double *value[2];                     /* [count] SI, or the layout's units; owned */
    int *line;                            /* [count] in the file; owned */
    double scale[2];                      /* from the file's units to those of the values */
    char understood[SF_TABLE_UNDERSTOOD]; /* 'separator ";", decimal comma, time in ms, force in kN' */
} sf_table;

/* Reads a table; SF_ERR_INPUT names file, line and value. On failure `*table` is zeroed. */
sf_status sf_table_read(const char *path, const sf_table_layout *layout, sf_table *table, sf_error *err);

/* The same with the first of `count` layouts whose columns the heading holds; `*which` is its index. */
sf_status sf_table_read_any(const char *path, const sf_table_layout *layouts, int count, int *which,
                            sf_table *table, sf_error *err);
void sf_table_free(sf_table *table);

#endif
