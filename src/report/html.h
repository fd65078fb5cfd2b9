/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reports: one self-contained page on A4, without a script and without anything to load. All programs use
 * this template. The page is well-formed XML; texts are escaped, bytes that are not UTF-8 become U+FFFD.
 * Failed writes are reported by sf_staging_close. */
#pragma once
#include "io/staging.h"

/* Opens report.html in the staging directory: head, style, title and the line below it (NULL: none). NULL on
 * failure. */
FILE *sf_html_begin(const sf_staging *output, const char *title, const char *subtitle, sf_error *err);
/* The command that repeats the report (NULL: it was told), the line at the foot, and sf_staging_close. */
sf_status sf_html_end(FILE *page, const char *command, const char *foot, sf_error *err);

/* Escaped text, without an element around it. */
void sf_html_text(FILE *page, const char *text);

/* <h2>, <p>, <p class="note">, <pre>, <pre class="prose">; escaped. */
void sf_html_heading(FILE *page, const char *text);
void sf_html_paragraph(FILE *page, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sf_html_note(FILE *page, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sf_html_pre(FILE *page, const char *text);

/* The line at the top that judges all that follows. `kind`: "good", "fair", "bad" or "plain". */
void sf_html_banner(FILE *page, const char *kind, const char *phrase, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* A part that is not broken between pages, with a heading; it ends with the block of the statement. */
#define SF_HTML_BLOCK(page, heading) SF_HTML_SCOPE(sf_html_block(page, heading), __LINE__)
#define SF_HTML_SCOPE(page, line) SF_HTML_SCOPE_OF(page, line)
#define SF_HTML_SCOPE_OF(page, line)                                                                         \
    __attribute__((unused)) SF_OWNED_BY(sf_html_division_end) FILE *sf_scope_##line = page
FILE *sf_html_block(FILE *page, const char *heading);
void sf_html_division_end(FILE **page);

/* A figure of an SVG element; with `svg` NULL the caption says what is missing and why. */
void sf_html_figure(FILE *page, const char *svg, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The bytes in base64, as an URL or a script takes them. */
void sf_html_base64(FILE *out, const unsigned char *data, size_t size);

/* A table; released by nothing. */
typedef struct sf_html_table {
    FILE *page;
    unsigned right; /* bits of the columns of numbers */
    int column;     /* of the next cell */
} sf_html_table;

/* `columns`: the headings between '|'; one that begins with '>' is of numbers, set right. NULL: no headings,
 * two columns of which the first is set as a heading. */
sf_html_table sf_html_table_begin(FILE *page, const char *columns);
void sf_html_row(sf_html_table *table);
void sf_html_cell(sf_html_table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A row, and its first cell. */
#define SF_HTML_ROW(table, ...) (sf_html_row(table), sf_html_cell(table, __VA_ARGS__))
/* A row: a cell of text, and cells of numbers and words of ours between '|' in the format; NULL: these alone,
 * in the row that is open. A cell that begins with a number that is not finite is a dash. */
void sf_html_line(sf_html_table *table, const char *first, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void sf_html_table_end(sf_html_table *table);
/* A table that ends with the block of its variable. */
#define SF_HTML_TABLE SF_OWNED_BY(sf_html_table_end) sf_html_table
/* Adds a row to a table without headings. */
void sf_html_fact(sf_html_table *table, const char *title, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
