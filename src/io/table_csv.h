/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of two columns in CSV files (curves, motions, measurements), in the one form that the programs read:
 * UTF-8, commas between the cells, decimal points, one heading row; lines that begin with '#' are comments
 * and empty rows do not count. `softfall read` makes such a table from any laboratory's file, and refusals
 * name that command.
 *
 * A column is found by its heading: a name of the quantity with its unit, as "time_ms", "acceleration_m_s2",
 * "strain_percent", "Time (ms)" or "Time [ms]", or of a ratio the name alone. The case of the name does not
 * matter. Other columns are ignored. */
#pragma once
#include "base/units.h"
#include <stdint.h>

enum { SF_TABLE_RATIO = SF_QUANTITY_COUNT }; /* kind of a column without dimension: "%" or "1" */

/* A quantity that a column may hold. */
typedef struct sf_table_column {
    const char *name;    /* for sentences: "stress" */
    const char *names;   /* in headings: "stress" or "time|t" */
    int kind;            /* sf_quantity or SF_TABLE_RATIO */
    double unit;         /* SI value of the unit of the table's values */
    const char *example; /* "stress_kPa" */
} sf_table_column;

extern const sf_table_column sf_column_time, sf_column_acceleration, sf_column_strain, sf_column_stress,
    sf_column_lateral_strain, sf_column_displacement, sf_column_force, sf_column_height, sf_column_speed,
    sf_column_static_stress, sf_column_peak;

/* A line that was read: values, and the cells as written, so that the user finds them in the file. */
typedef struct sf_table_point {
    const char *path;
    int line;
    int64_t index; /* of the point, from 0 */
    double value[2];
    const char *text[2];
    double before[2];   /* the point before; zero at the first */
    double last[2];     /* the same in the file's own units */
    const char *remedy; /* command that reads the file in other forms */
} sf_table_point;

/* Refuses a point. */
typedef sf_status sf_table_check(const sf_table_point *point, sf_error *err);

typedef struct sf_table_layout {
    const char *what; /* "curve" */
    const char *kind; /* of tables, as `softfall read --kind` names it */
    const sf_table_column *column[2];
    const char *means; /* what both columns are together, for the interpretation; NULL: their names say it */
    const char
        *chosen; /* heading of the second column, with or without its unit; NULL: the only one that fits */
    const char *choice;    /* how the user chooses it, for messages; NULL: not possible */
    bool ragged;           /* a row may be shorter than the heading as long as it holds both columns */
    sf_table_check *check; /* NULL: none */
} sf_table_layout;

enum { SF_TABLE_INTERPRETATION = 640 };

typedef struct sf_table {
    int64_t count;
    double *value[2];                             /* [count] in the units of the columns; owned */
    int *line;                                    /* [count] in the file; owned */
    double scale[2];                              /* from the file's units to those of the values */
    char interpretation[SF_TABLE_INTERPRETATION]; /* "time in ms, acceleration in g", and what softfall read
                                                     said */
} sf_table;

/* Reads a table; SF_ERR_INPUT names file, line and value. On failure `*table` is zeroed. */
sf_status sf_table_read(const char *path, const sf_table_layout *layout, sf_table *table, sf_error *err);

/* The same with the first of `count` layouts whose columns the heading holds; `*which` is its index. */
sf_status sf_table_read_any(const char *path, const sf_table_layout *layouts, int count, int *which,
                            sf_table *table, sf_error *err);
void sf_table_free(sf_table *table);
