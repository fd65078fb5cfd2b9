/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of two columns in CSV files (curves, motions, measurements), as laboratories write them:
 *
 * - separators comma, semicolon, tab or runs of blanks, found by the heading; UTF-8, with or without a byte
 *   order mark, UTF-16 with one, or Latin-1 in the heading; any line ends; cells may be quoted;
 * - lines that begin with '#' are comments; other lines before the heading are passed over, numbers only if
 * an empty line follows on them; remarks below the data are left out, if no data follow on them;
 * - groups of thousands where another mark is the decimal one ("1,017.76");
 * - several specimens or cycles, of which the layout chooses; a heading that the user gives instead of the
 *   file; the number of the sample in place of a first column;
 * - a channel in ISO-MME (ISO/TS 13499), with its unit, its interval and its first time;
 * - the heading names the two columns exactly ("time_ms"), or by a word with a unit: "Time (ms)", "Zeit
 * [ms]", "t / ms", "acc_m_s2", or the unit in the line below. Other columns are ignored;
 * - decimal point or, unless the comma separates, decimal comma; the same throughout.
 *
 * What could be read in two ways is refused. Each sentence names file, line and cell. */
#pragma once
#include "base/units.h"
#include <stdint.h>

/* The requirements of a program on a table of two columns. */

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

enum { SF_TABLE_INTERPRETATION = 384 };

typedef struct sf_table {
    int64_t count;
    double *value[2];                /* [count] SI, or the layout's units; owned */
    int *line;                       /* [count] in the file; owned */
    double scale[2];                 /* from the file's units to those of the values */
    bool part_taken[SF_TABLE_PARTS]; /* the file held several, of which the layout's choice was read */
    bool plain;                      /* commas, decimal points and exact names: nothing to tell */
    char
        interpretation[SF_TABLE_INTERPRETATION]; /* 'separator ";", decimal comma, time in ms, force in kN' */
} sf_table;

/* Reads a table; SF_ERR_INPUT names file, line and value. On failure `*table` is zeroed. */
sf_status sf_table_read(const char *path, const sf_table_layout *layout, sf_table *table, sf_error *err);

/* The same with the first of `count` layouts whose columns the heading holds; `*which` is its index. */
sf_status sf_table_read_any(const char *path, const sf_table_layout *layouts, int count, int *which,
                            sf_table *table, sf_error *err);
void sf_table_free(sf_table *table);

/* Headings of CSV tables: which cells are the two columns of a layout, and in which units. Only
 * table_csv.c, table_heading.c and table_text.c use this part. */

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

/* Reads a file (io/plain_file.h) as zero-terminated text for the caller to free: UTF-16 with a byte order
 * mark becomes UTF-8, a channel in ISO-MME a table of two columns whose lines are those of the file. `what`:
 * the file in messages. */
sf_status sf_table_text_read(const char *path, const char *what, char **text, sf_error *err);

/* True if the line is empty or a comment. */
bool sf_table_line_is_empty(const char *line);
/* A copy of the line at *rest, which is moved behind it, or of the next line from `rest` on that is neither
 * empty nor a comment; from malloc, NULL at the end. The text stays as it is. */
char *sf_table_line_copy(const char **rest);
char *sf_table_content_copy(const char *rest);
/* A copy in UTF-8, from malloc: what is not is taken for Latin-1. NULL of NULL, and without memory. */
char *sf_table_utf8_copy(const char *text);

/* "1,017.76" or "1.017,76": groups of three digits and another decimal mark; `quoted`: "1,017" is of
 * thousands too, as in a file with decimal points whose commas separate columns. Writes it without the
 * groups. */
bool sf_table_has_thousands(const char *text, bool quoted, char *plain, size_t size);
