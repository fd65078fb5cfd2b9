/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a report. A declaration states once how a value is called, its unit, its format and its meaning;
 * one writer each makes JSON, CSV and text of it. A record is any struct of the program; a declaration
 * points to a member of it, or has a function that computes the value. A value that a run does not define (a
 * number that is not finite, a negative count, an empty text) becomes null in JSON and a dash for
 * readers. */
#pragma once
#include "io/staging.h"
#include <stdint.h>

/* Writes strictly valid JSON (RFC 8259): a number that is not finite becomes null, texts are escaped and
 * bytes that are not UTF-8 become U+FFFD. A key of NULL stands for an element of an array. No text holds a
 * '<', so that the whole may stand in a script element of a page. */
typedef struct sf_json {
    FILE *file;
    int depth;
    uint64_t arrays; /* a bit for each of what is open, the innermost last: it is an array */
    bool empty;      /* nothing yet in the innermost object or array */
} sf_json;

/* Opens an object ('{') or an array ('['), and closes the innermost one. */
sf_json *sf_json_open(sf_json *json, const char *key, char bracket);
void sf_json_close(sf_json *json);
/* The same, closed at the end of the block: SF_JSON_OBJECT(json, "fit"); */
#define SF_JSON_OBJECT(json, key) SF_JSON_SCOPE(json, key, '{', __LINE__)
#define SF_JSON_ARRAY(json, key) SF_JSON_SCOPE(json, key, '[', __LINE__)
#define SF_JSON_SCOPE(json, key, bracket, line) SF_JSON_SCOPE_OF(json, key, bracket, line)
#define SF_JSON_SCOPE_OF(json, key, bracket, line)                                                           \
    __attribute__((unused)) SF_OWNED_BY(sf_json_end) sf_json *sf_scope_##line =                              \
        sf_json_open(json, key, bracket)
void sf_json_end(sf_json **json);
/* Declares a file of the staging directory and opens its object, or leaves the function. */
#define SF_JSON_FILE(json, output, name, err)                                                                \
    sf_json json = {.file = sf_staging_open(output, name, err)};                                             \
    SF_TRY((err)->status);                                                                                   \
    sf_json_open(&(json), NULL, '{')
void sf_json_number(sf_json *json, const char *key, double value);
/* Several numbers of the open object: SF_JSON_NUMBERS(json, {"low", low}, {"high", high}). Counts below 10^9,
 * too. */
typedef struct sf_named {
    const char *key;
    double value;
} sf_named;
void sf_json_numbers(sf_json *json, const sf_named *list); /* until a key is NULL */
#define SF_JSON_NUMBERS(json, ...) sf_json_numbers(json, (const sf_named[]){__VA_ARGS__, {0}})
/* A negative integer becomes null: all of ours are counts. */
void sf_json_integer(sf_json *json, const char *key, int64_t value);
void sf_json_bool(sf_json *json, const char *key, bool value);
void sf_json_text(sf_json *json, const char *key, const char *text); /* NULL: null */
/* Several texts of the open object, as SF_JSON_NUMBERS: each is a key and its text. */
typedef const char *sf_named_text[2];
void sf_json_texts(sf_json *json, const sf_named_text *list); /* until a key is NULL */
#define SF_JSON_TEXTS(json, ...) sf_json_texts(json, (const sf_named_text[]){__VA_ARGS__, {0}})
/* The bytes in base64, as a script takes them. */
void sf_json_base64(sf_json *json, const char *key, const unsigned char *data, size_t size);

/* Writes a CSV file, cell after cell. A number has nine digits; the cell of a number that is not finite stays
 * empty. */
typedef struct sf_csv {
    FILE *file;
    const char *name; /* borrowed */
    bool begun;       /* the line has a cell already */
} sf_csv;

/* Opens a file of the staging directory. sf_csv_close reports writes that failed. */
sf_status sf_csv_open(sf_csv *csv, const sf_staging *output, const char *name, sf_error *err);
sf_status sf_csv_close(sf_csv *csv, sf_error *err);
/* Declares a CSV file and opens it, or leaves the function: SF_CSV_FILE(csv, output, "fit.csv", err); */
#define SF_CSV_FILE(csv, output, name, err)                                                                  \
    sf_csv csv;                                                                                              \
    SF_TRY(sf_csv_open(&(csv), output, name, err))
/* One cell, or several with commas between them, as they are; SF_CSV_PRINT_LINE also ends the line. */
void sf_csv_print(sf_csv *csv, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A text in quotes. What a spreadsheet would compute, as "=1+2", gets an apostrophe in front. Line ends
 * become blanks. */
void sf_csv_quoted(sf_csv *csv, const char *text);
/* Several cells: SF_CSV_NUMBERS(&csv, low, high); the same and the end of the line. */
void sf_csv_numbers(sf_csv *csv, int count, const double *value);
#define SF_CSV_NUMBERS(csv, ...)                                                                             \
    sf_csv_numbers(csv, sizeof((const double[]){__VA_ARGS__}) / sizeof(double), (const double[]){__VA_ARGS__})
#define SF_CSV_LINE(csv, ...) (SF_CSV_NUMBERS(csv, __VA_ARGS__), sf_csv_end(csv))
#define SF_CSV_PRINT_LINE(csv, ...) (sf_csv_print(csv, __VA_ARGS__), sf_csv_end(csv))
void sf_csv_end(sf_csv *csv); /* of the line */

typedef enum sf_row_type {
    SF_ROW_NUMBER,  /* double */
    SF_ROW_COUNT,   /* int64_t */
    SF_ROW_INTEGER, /* int */
    SF_ROW_FLAG,    /* bool */
    SF_ROW_TEXT,    /* char[] in the record */
    SF_ROW_STRING,  /* const char *, borrowed */
} sf_row_type;

/* One value. */
typedef struct sf_value {
    enum { SF_VALUE_REAL, SF_VALUE_INTEGER, SF_VALUE_FLAG, SF_VALUE_TEXT } kind;
    double real; /* in the unit of the record */
    int64_t integer;
    bool flag;
    const char *text; /* NULL or empty: not defined */
} sf_value;

/* A declaration; static storage. */
typedef struct sf_row {
    const char *key;     /* in JSON, with the unit as its ending; NULL: not written there */
    const char *name;    /* for readers; NULL: not shown to them */
    const char *unit;    /* behind the shown value; NULL: none */
    const char *format;  /* of a shown number, with one conversion of a double; NULL: "%.4g" */
    double factor;       /* from the record to the unit of the key; 0: 1 */
    double shown;        /* from the record to the shown unit; 0: as `factor` */
    const char *meaning; /* of the value, for hints and tables of docs; NULL: none */
    sf_row_type type;
    size_t offset;                         /* of the member in the record */
    sf_value (*value)(const void *record); /* replaces the member; NULL: the member */
} sf_row;

/* Type and offset, for an initialiser: {.key = "mass_kg", SF_ROW_OF(NUMBER, sf_results, mass)}. */
#define SF_ROW_OF(kind, record, member) .type = SF_ROW_##kind, .offset = offsetof(record, member)

/* A list of declarations, from an array of them. */
typedef struct sf_rows {
    const sf_row *row;
    size_t count;
} sf_rows;
#define SF_ROWS(array) ((sf_rows){(array), sizeof(array) / sizeof((array)[0])})

/* Records that follow each other. */
typedef struct sf_records {
    const void *first;
    size_t stride; /* bytes */
    int64_t count;
} sf_records;

#define sf_value_real(x) ((sf_value){.kind = SF_VALUE_REAL, .real = (x)})
#define sf_value_integer(x) ((sf_value){.kind = SF_VALUE_INTEGER, .integer = (x)})
#define sf_value_flag(x) ((sf_value){.kind = SF_VALUE_FLAG, .flag = (x)})
#define sf_value_text(x) ((sf_value){.kind = SF_VALUE_TEXT, .text = (x)})

sf_value sf_row_value(const sf_row *row, const void *record);
/* The number in the unit of the key, a flag as 0 or 1; NaN: not defined, or a text. */
double sf_row_number(const sf_row *row, const void *record);
bool sf_row_is_defined(const sf_row *row, const void *record);
/* The value as a reader sees it, without the unit, with `dash` where it is not defined. Returns `text`. */
const char *sf_row_shown(const sf_row *row, const void *record, const char *dash, char *text, size_t size);

/* JSON: members of the open object; an array of objects. */
void sf_row_json(sf_json *json, const sf_row *row, const void *record);
void sf_rows_json(sf_json *json, sf_rows rows, const void *record);
void sf_rows_json_array(sf_json *json, const char *key, sf_rows rows, sf_records records);

/* Text: a line "  name   value unit"; none without a name. */
void sf_row_text(FILE *out, const sf_row *row, const void *record);
/* Text: a heading and a line for each record, columns as wide as their widest cell. */
void sf_rows_text_table(FILE *out, sf_rows rows, sf_records records);
