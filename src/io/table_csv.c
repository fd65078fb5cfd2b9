/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/table_csv.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MAX_COLUMNS = 256 };

/* The file being read: data for the messages and the growing arrays. */
typedef struct csv {
    const char *path;
    const sf_table_layout *layout;
    int line;
    int columns;     /* in the header */
    int place[2];    /* of the two columns, -1: not seen yet */
    double scale[2]; /* that makes them SI */
    sf_table *table;
} csv;

void sf_table_free(sf_table *table) {
    free(table->value[0]);
    free(table->value[1]);
    free(table->line);
    memset(table, 0, sizeof *table);
}

static bool is_margin(char c) {
    return isspace((unsigned char)c) || c == '"';
}

/* Splits at commas in place, trimming blanks and quotes; returns the number of cells (MAX_COLUMNS + 1 if
 * there are more). */
static int split(char *line, char *cell[MAX_COLUMNS]) {
    int count = 0;
    for (char *rest = line; rest; count++) {
        if (count == MAX_COLUMNS)
            return MAX_COLUMNS + 1;
        char *text = rest;
        rest = strchr(rest, ',');
        if (rest)
            *rest++ = '\0';
        while (is_margin(*text))
            text++;
        for (char *end = text + strlen(text); end > text && is_margin(end[-1]);)
            *--end = '\0';
        cell[count] = text;
    }
    return count;
}

static sf_status read_header(csv *file, char *line, sf_error *err) {
    const sf_table_layout *layout = file->layout;
    char *cell[MAX_COLUMNS];
    file->columns = split(line, cell);
    file->place[0] = file->place[1] = -1;
    if (file->columns > MAX_COLUMNS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: more than %d columns", file->path, file->line, MAX_COLUMNS);
    for (int i = 0; i < file->columns; i++) {
        for (int k = 0; k < layout->name_count; k++) {
            const sf_table_name *name = &layout->names[k];
            if (strcmp(cell[i], name->name) != 0)
                continue;
            int *place = &file->place[name->column];
            if (*place >= 0 && layout->first)
                continue;
            if (*place >= 0)
                return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: two %s columns (\"%s\" and \"%s\")", file->path,
                               file->line, layout->column[name->column], cell[*place], cell[i]);
            *place = i;
            file->scale[name->column] = file->table->scale[name->column] = name->scale;
        }
    }
    for (int c = 0; c < 2; c++)
        if (file->place[c] < 0)
            return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: the header has no column %s", file->path, file->line,
                           layout->wanted[c]);
    return SF_OK;
}

static sf_status read_number(const csv *file, const char *name, const char *text, double *value,
                             sf_error *err) {
    char *end = NULL;
    *value = strtod(text, &end);
    if (end == text || *end)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s \"%s\" is not a number", file->path, file->line, name,
                       text);
    if (!isfinite(*value))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s \"%s\" is not finite", file->path, file->line, name,
                       text);
    return SF_OK;
}

static sf_status append(csv *file, const double value[2], sf_error *err) {
    sf_table *table = file->table;
    if (table->count == table->capacity) {
        int64_t capacity = table->capacity ? 2 * table->capacity : 64;
        for (int c = 0; c < 2; c++) {
            double *grown = realloc(table->value[c], (size_t)capacity * sizeof *grown);
            if (!grown)
                return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the %s %s", file->layout->what,
                               file->path);
            table->value[c] = grown;
        }
        int *lines = realloc(table->line, (size_t)capacity * sizeof *lines);
        if (!lines)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the %s %s", file->layout->what, file->path);
        table->line = lines;
        table->capacity = capacity;
    }
    for (int c = 0; c < 2; c++)
        table->value[c][table->count] = value[c];
    table->line[table->count] = file->line;
    table->count++;
    return SF_OK;
}

static sf_status read_point(csv *file, char *line, sf_error *err) {
    char *cell[MAX_COLUMNS];
    const sf_table *table = file->table;
    sf_table_point point = {.path = file->path, .line = file->line, .index = table->count};
    int count = split(line, cell);
    int needed = file->place[0] > file->place[1] ? file->place[0] : file->place[1];
    if (count != file->columns && !(file->layout->ragged && count > needed))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %d values where the header has %d columns", file->path,
                       file->line, count, file->columns);
    for (int c = 0; c < 2; c++) {
        point.text[c] = cell[file->place[c]];
        if (read_number(file, file->layout->column[c], point.text[c], &point.value[c], err) != SF_OK)
            return err->status;
        point.value[c] *= file->scale[c];
        if (table->count == 0)
            continue;
        point.before[c] = table->value[c][table->count - 1];
        point.last[c] = point.before[c] / file->scale[c];
    }
    return file->layout->check(&point, err) == SF_OK ? append(file, point.value, err) : err->status;
}

static sf_status read_lines(csv *file, FILE *stream, sf_error *err) {
    char *line = NULL;
    size_t size = 0;
    bool header = false;
    sf_status status = SF_OK;
    while (status == SF_OK && getline(&line, &size, stream) >= 0) {
        file->line++;
        char *text = line;
        if (file->line == 1 && strncmp(text, "\xEF\xBB\xBF", 3) == 0)
            text += 3; /* spreadsheets write a byte order mark */
        text += strspn(text, " \t\r\n");
        if (*text == '\0' || *text == '#')
            continue;
        status = header ? read_point(file, text, err) : read_header(file, text, err);
        header = true;
    }
    free(line);
    return status;
}

sf_status sf_table_read(const char *path, const sf_table_layout *layout, sf_table *table, sf_error *err) {
    memset(table, 0, sizeof *table);
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return SF_FAIL(err, SF_ERR_INPUT, "the %s %s is not a plain file", layout->what, path);
    FILE *stream = fopen(path, "r");
    if (!stream)
        return SF_FAIL(err, SF_ERR_INPUT, "the %s %s cannot be read: %s", layout->what, path,
                       strerror(errno));
    csv file = {.path = path, .layout = layout, .table = table};
    sf_status status = read_lines(&file, stream, err);
    if (status == SF_OK && ferror(stream))
        status = SF_FAIL(err, SF_ERR_IO, "reading the %s %s failed: %s", layout->what, path, strerror(errno));
    fclose(stream);
    if (status != SF_OK)
        sf_table_free(table);
    return status;
}
