/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Headings of CSV tables: which cells are the two columns of a layout, and in which units. Internal to
 * table_csv.c and table_text.c. */
#pragma once
#include "io/table_layout.h"

enum { SF_TABLE_COLUMNS = 256, SF_TABLE_TITLE = 96, SF_TABLE_UNIT = 32 };
enum { SF_TABLE_ROW = -2 }; /* place of a first column that is the number of the row */

/* A line split into cells; points into the line. */
typedef struct sf_table_cells {
    int count; /* SF_TABLE_COLUMNS + 1: more */
    char *cell[SF_TABLE_COLUMNS];
} sf_table_cells;

typedef struct sf_table_heading {
    int columns;              /* cells of the heading, without empty ones at its end */
    int place[2];             /* of the two columns; SF_TABLE_ROW */
    int part[SF_TABLE_PARTS]; /* places of the columns that number specimens and cycles; -1: none */
    int side_by_side;         /* columns of one quantity, of which the specimen chooses one */
    double scale[2];
    char unit[2][SF_TABLE_UNIT];
    char title[2][SF_TABLE_TITLE]; /* of a column found by its unit alone; else empty */
    bool exact[2];                 /* found by an exact name */
    bool unit_line;                /* the line below the heading holds the units */
    int found;                     /* columns that the line seems to hold */
    char problem[512];             /* why the line cannot be used; empty: it can */
} sf_table_heading;

/* Splits in place at `separator` (' ': runs of blanks and tabs), without blanks and quotes around a cell. In
 * a heading split at blanks a unit in brackets belongs to the cell before it. */
void sf_table_split(char *line, char separator, bool heading, sf_table_cells *cells);

/* True if the cell is a number, with decimal point or comma; its value, which may be not finite (NULL: none).
 */
bool sf_table_number(const char *cell, double *value);

/* Reads `cells` as the heading of `layout`; `below`: the line under it, or NULL. `*units` is opened when it
 * is needed, for the caller to close. Fails only without the unit system. */
sf_status sf_table_heading_read(const sf_table_layout *layout, const sf_table_cells *cells,
                                const sf_table_cells *below, sf_units **units, sf_table_heading *heading,
                                sf_error *err);
