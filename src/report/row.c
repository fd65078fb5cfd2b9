/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/row.h"

#include "base/text.h"

#include <math.h>
#include <string.h>

/* ---- JSON ---- */

static void put_text(FILE *file, const char *text) {
    fputc('"', file);
    for (const unsigned char *s = (const unsigned char *)text; *s;) {
        int length = sf_utf8_length(s);
        if (length == 0) {
            fputs("\\ufffd", file);
            length = 1;
        } else if (*s == '"' || *s == '\\') {
            fprintf(file, "\\%c", *s);
        } else if (*s < 0x20 || *s == 0x7f || *s == '<') {
            fprintf(file, "\\u%04x", *s);
        } else {
            fwrite(s, 1, (size_t)length, file);
        }
        s += length;
    }
    fputc('"', file);
}

static void begin(sf_json *json, const char *key) {
    if (json->depth > 0)
        fprintf(json->file, "%s\n%*s", json->empty ? "" : ",", 2 * json->depth, "");
    json->empty = false;
    if (key) {
        put_text(json->file, key);
        fputs(": ", json->file);
    }
}

sf_json *sf_json_open(sf_json *json, const char *key, char bracket) {
    begin(json, key);
    fputc(bracket, json->file);
    json->depth++;
    json->arrays = json->arrays << 1 | (bracket == '[');
    json->empty = true;
    return json;
}

void sf_json_close(sf_json *json) {
    json->depth--;
    if (!json->empty)
        fprintf(json->file, "\n%*s", 2 * json->depth, "");
    fputc(json->arrays & 1 ? ']' : '}', json->file);
    if (json->depth == 0)
        fputc('\n', json->file);
    json->arrays >>= 1;
    json->empty = false;
}

void sf_json_end(sf_json **json) {
    sf_json_close(*json);
}

void sf_json_number(sf_json *json, const char *key, double value) {
    begin(json, key);
    if (isfinite(value))
        fprintf(json->file, "%.9g", value);
    else
        fputs("null", json->file);
}

void sf_json_numbers(sf_json *json, const sf_named *list) {
    for (; list->key; list++)
        sf_json_number(json, list->key, list->value);
}

void sf_json_integer(sf_json *json, const char *key, int64_t value) {
    begin(json, key);
    if (value >= 0)
        fprintf(json->file, "%lld", (long long)value);
    else
        fputs("null", json->file);
}

void sf_json_bool(sf_json *json, const char *key, bool value) {
    begin(json, key);
    fputs(value ? "true" : "false", json->file);
}

void sf_json_texts(sf_json *json, const sf_named_text *list) {
    for (; (*list)[0]; list++)
        sf_json_text(json, (*list)[0], (*list)[1]);
}

static void put_base64(FILE *out, const unsigned char *data, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t k = 0; k < size; k += 3) {
        size_t left = size - k;
        unsigned three = (unsigned)data[k] << 16;
        if (left > 1)
            three |= (unsigned)data[k + 1] << 8;
        if (left > 2)
            three |= data[k + 2];
        putc_unlocked(digits[three >> 18], out);
        putc_unlocked(digits[three >> 12 & 63], out);
        putc_unlocked(left > 1 ? digits[three >> 6 & 63] : '=', out);
        putc_unlocked(left > 2 ? digits[three & 63] : '=', out);
    }
}

void sf_json_base64(sf_json *json, const char *key, const unsigned char *data, size_t size) {
    begin(json, key);
    fputc('"', json->file);
    put_base64(json->file, data, size);
    fputc('"', json->file);
}

void sf_json_text(sf_json *json, const char *key, const char *text) {
    begin(json, key);
    if (text)
        put_text(json->file, text);
    else
        fputs("null", json->file);
}

/* ---- CSV ---- */

sf_status sf_csv_open(sf_csv *csv, const sf_staging *output, const char *name, sf_error *err) {
    *csv = (sf_csv){.file = sf_staging_open(output, name, err), .name = name};
    return err->status;
}

sf_status sf_csv_close(sf_csv *csv, sf_error *err) {
    return sf_staging_close(csv->file, csv->name, err);
}

/* Puts the comma in front of the next cell. */
static FILE *next_cell(sf_csv *csv) {
    if (csv->begun)
        fputc(',', csv->file);
    csv->begun = true;
    return csv->file;
}

void sf_csv_print(sf_csv *csv, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vfprintf(next_cell(csv), format, arguments);
    va_end(arguments);
}

static bool is_formula(const char *text) {
    double number;
    return *text && strchr("=+-@\t", *text) && !sf_decimal_is(text, &number);
}

void sf_csv_quoted(sf_csv *csv, const char *text) {
    FILE *file = next_cell(csv);
    fputs(is_formula(text) ? "\"'" : "\"", file);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', file);
        fputc(*text == '\n' || *text == '\r' ? ' ' : *text, file);
    }
    fputc('"', file);
}

void sf_csv_numbers(sf_csv *csv, int count, const double *value) {
    for (int k = 0; k < count; k++)
        if (isfinite(value[k]))
            sf_csv_print(csv, "%.9g", value[k]);
        else
            next_cell(csv);
}

void sf_csv_end(sf_csv *csv) {
    fputc('\n', csv->file);
    csv->begun = false;
}

/* ---- rows ---- */

sf_value sf_row_value(const sf_row *row, const void *record) {
    const char *member = (const char *)record + row->offset;
    if (row->value)
        return row->value(record);
    switch (row->type) {
    case SF_ROW_NUMBER:
        return sf_value_real(*(const double *)member);
    case SF_ROW_COUNT:
        return sf_value_integer(*(const int64_t *)member);
    case SF_ROW_INTEGER:
        return sf_value_integer(*(const int *)member);
    case SF_ROW_FLAG:
        return sf_value_flag(*(const bool *)member);
    case SF_ROW_TEXT:
        return sf_value_text(member);
    case SF_ROW_STRING:
        return sf_value_text(*(const char *const *)member);
    }
    return sf_value_text(NULL);
}

static double factor_of(const sf_row *row) {
    return row->factor != 0 ? row->factor : 1;
}

static bool is_defined(sf_value value) {
    switch (value.kind) {
    case SF_VALUE_REAL:
        return isfinite(value.real);
    case SF_VALUE_INTEGER:
        return value.integer >= 0;
    case SF_VALUE_FLAG:
        return true;
    case SF_VALUE_TEXT:
        return value.text && *value.text;
    }
    return false;
}

bool sf_row_is_defined(const sf_row *row, const void *record) {
    return is_defined(sf_row_value(row, record));
}

double sf_row_number(const sf_row *row, const void *record) {
    sf_value value = sf_row_value(row, record);
    if (!is_defined(value))
        return NAN;
    switch (value.kind) {
    case SF_VALUE_REAL:
        return value.real * factor_of(row);
    case SF_VALUE_INTEGER:
        return (double)value.integer;
    case SF_VALUE_FLAG:
        return value.flag;
    case SF_VALUE_TEXT:
        break;
    }
    return NAN;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral" /* formats are those of the declarations */
const char *sf_row_shown(const sf_row *row, const void *record, const char *dash, char *text, size_t size) {
    sf_value value = sf_row_value(row, record);
    double shown = value.real * (row->shown != 0 ? row->shown : factor_of(row));
    const char *usual = fabs(shown) >= 1e4 ? "%.6g" : "%.4g";
    if (!is_defined(value))
        snprintf(text, size, "%s", dash);
    else if (value.kind == SF_VALUE_REAL)
        snprintf(text, size, row->format ? row->format : usual, shown);
    else if (value.kind == SF_VALUE_INTEGER)
        snprintf(text, size, "%lld", (long long)value.integer);
    else if (value.kind == SF_VALUE_TEXT)
        snprintf(text, size, "%s", value.text);
    else
        snprintf(text, size, "%s", value.flag ? "yes" : "no");
    return text;
}
#pragma GCC diagnostic pop

void sf_row_json(sf_json *json, const sf_row *row, const void *record) {
    sf_value value = sf_row_value(row, record);
    if (!row->key)
        return;
    if (value.kind == SF_VALUE_REAL)
        sf_json_number(json, row->key, value.real * factor_of(row));
    else if (value.kind == SF_VALUE_INTEGER)
        sf_json_integer(json, row->key, value.integer);
    else if (value.kind == SF_VALUE_FLAG)
        sf_json_bool(json, row->key, value.flag);
    else
        sf_json_text(json, row->key, is_defined(value) ? value.text : NULL);
}

void sf_rows_json(sf_json *json, sf_rows rows, const void *record) {
    for (size_t k = 0; k < rows.count; k++)
        sf_row_json(json, &rows.row[k], record);
}

static const void *record_at(sf_records records, int64_t k) {
    return (const char *)records.first + (size_t)k * records.stride;
}

void sf_rows_json_array(sf_json *json, const char *key, sf_rows rows, sf_records records) {
    SF_JSON_ARRAY(json, key);
    for (int64_t k = 0; k < records.count; k++) {
        SF_JSON_OBJECT(json, NULL);
        sf_rows_json(json, rows, record_at(records, k));
    }
}

/* ---- text ---- */

/* "name (unit)", as tables head a column. */
static void put_heading(const sf_row *row, char *text, size_t size) {
    if (row->unit)
        snprintf(text, size, "%s (%s)", row->name, row->unit);
    else
        snprintf(text, size, "%s", row->name);
}

static bool is_number(const sf_row *row) {
    return row->type <= SF_ROW_INTEGER;
}

void sf_row_text(FILE *out, const sf_row *row, const void *record) {
    char text[160];
    if (!row->name)
        return;
    sf_row_shown(row, record, "-", text, sizeof text);
    bool unit = row->unit && sf_row_is_defined(row, record);
    fprintf(out, "  %-24s %12s%s%s\n", row->name, text, unit ? " " : "", unit ? row->unit : "");
}

/* Returns the value of a text table, or with `record` NULL the heading. */
static const char *table_text(const sf_row *row, const void *record, char *text, size_t size) {
    if (record)
        return sf_row_shown(row, record, "-", text, size);
    put_heading(row, text, size);
    return text;
}

/* Characters of a text in UTF-8. */
static int width_of(const char *text) {
    int width = 0;
    for (; *text; text++)
        width += ((unsigned char)*text & 0xc0) != 0x80;
    return width;
}

/* Numbers stand right in their column, texts left. */
static void put_padded(FILE *out, const char *text, int width, bool right) {
    int pad = width - width_of(text);
    fprintf(out, "  %*s%s%*s", right ? pad : 0, "", text, right ? 0 : pad, "");
}

void sf_rows_text_table(FILE *out, sf_rows rows, sf_records records) {
    char text[512];
    for (int64_t k = -1; k < records.count; k++) {
        for (size_t c = 0; c < rows.count; c++) {
            const sf_row *row = &rows.row[c];
            int width = 0;
            if (!row->name)
                continue;
            for (int64_t j = -1; j < records.count; j++) {
                int own = width_of(table_text(row, j < 0 ? NULL : record_at(records, j), text, sizeof text));
                width = own > width ? own : width;
            }
            table_text(row, k < 0 ? NULL : record_at(records, k), text, sizeof text);
            put_padded(out, text, width, is_number(row));
        }
        fputc('\n', out);
    }
}
