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
#include "io/table_layout.h"

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
