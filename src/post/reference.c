/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/reference.h"

#include "core/units.h"
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct unit_column {
    const char *name;
    double factor; /* to s or g */
} unit_column;

typedef struct reader {
    const char *path;
    int line;
    int time_column; /* -1 until the heading is read */
    int value_column;
    double time_factor;
    double value_factor;
    sf_series curve;
    int64_t capacity;
} reader;

static const unit_column time_columns[] = {{"time_s", 1}, {"time_ms", 1e-3}, {"time_us", 1e-6}, {NULL, 0}};
static const unit_column value_columns[] = {{"acceleration_g", 1},
                                            {"acceleration_m_s2", 1 / SF_STANDARD_GRAVITY},
                                            {"acceleration_km_s2", 1e3 / SF_STANDARD_GRAVITY},
                                            {NULL, 0}};

/* The next field of a line, without surrounding blanks and quotes; NULL at its end. */
static char *next_field(char **rest) {
    char *field = strsep(rest, ",");
    if (!field)
        return NULL;
    while (isspace((unsigned char)*field) || *field == '"')
        field++;
    size_t length = strlen(field);
    while (length > 0 && (isspace((unsigned char)field[length - 1]) || field[length - 1] == '"'))
        field[--length] = '\0';
    return field;
}

static int match(const unit_column *known, const char *name, double *factor) {
    for (; known->name; known++) {
        if (strcmp(known->name, name) == 0) {
            *factor = known->factor;
            return 1;
        }
    }
    return 0;
}

static sf_status read_heading(reader *r, char *line, sf_error *err) {
    char *field;
    if (strncmp(line, "\xef\xbb\xbf", 3) == 0) /* byte order mark of spreadsheets */
        line += 3;
    for (int column = 0; (field = next_field(&line)) != NULL; column++) {
        if (r->time_column < 0 && match(time_columns, field, &r->time_factor))
            r->time_column = column;
        else if (r->value_column < 0 && match(value_columns, field, &r->value_factor))
            r->value_column = column;
    }
    if (r->time_column < 0 || r->value_column < 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: the heading needs a column %s", r->path, r->line,
                       r->time_column < 0 ? "time_s, time_ms or time_us"
                                          : "acceleration_g, acceleration_m_s2 or acceleration_km_s2");
    return SF_OK;
}

static sf_status append(reader *r, double time, double value, sf_error *err) {
    if (r->curve.count == r->capacity) {
        int64_t capacity = r->capacity ? 2 * r->capacity : 1024;
        double *times = realloc(r->curve.time, (size_t)capacity * sizeof(double));
        if (times)
            r->curve.time = times;
        double *values = realloc(r->curve.value, (size_t)capacity * sizeof(double));
        if (values)
            r->curve.value = values;
        if (!times || !values)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory reading %s", r->path);
        r->capacity = capacity;
    }
    r->curve.time[r->curve.count] = time;
    r->curve.value[r->curve.count++] = value;
    return SF_OK;
}

static sf_status read_row(reader *r, char *line, sf_error *err) {
    double time = NAN, value = NAN;
    char *field;
    for (int column = 0; (field = next_field(&line)) != NULL; column++) {
        if (column != r->time_column && column != r->value_column)
            continue;
        char *end;
        double number = strtod(field, &end);
        if (end == field || *end != '\0' || !isfinite(number))
            return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: \"%.40s\" is not a number", r->path, r->line, field);
        if (column == r->time_column)
            time = number * r->time_factor;
        else
            value = number * r->value_factor;
    }
    if (isnan(time) || isnan(value))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: the row has too few columns", r->path, r->line);
    int64_t n = r->curve.count;
    if (n > 0 && !(time > r->curve.time[n - 1]))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: time %g ms does not follow %g ms of the row before",
                       r->path, r->line, time * 1e3, r->curve.time[n - 1] * 1e3);
    return append(r, time, value, err);
}

sf_status sf_reference_read(const char *path, sf_series *curve, sf_error *err) {
    *curve = (sf_series){0};
    reader r = {.path = path, .time_column = -1, .value_column = -1};
    char *line = NULL;
    size_t size = 0;
    errno = 0;
    FILE *file = fopen(path, "r");
    if (!file)
        return SF_FAIL(err, SF_ERR_INPUT, "cannot read the reference %s: %s", path, strerror(errno));
    while (err->status == SF_OK && getline(&line, &size, file) > 0) {
        r.line++;
        if (line[0] == '#' || line[strspn(line, " \t\r\n")] == '\0')
            continue;
        if (r.time_column < 0)
            read_heading(&r, line, err);
        else
            read_row(&r, line, err);
    }
    if (err->status == SF_OK && ferror(file))
        SF_FAIL(err, SF_ERR_IO, "reading %s failed: %s", path, strerror(errno));
    if (err->status == SF_OK && r.curve.count < 3)
        SF_FAIL(err, SF_ERR_INPUT, "%s has %lld points, at least 3 are needed", path,
                (long long)r.curve.count);
    fclose(file);
    free(line);
    if (err->status == SF_OK)
        *curve = r.curve;
    else
        sf_series_free(&r.curve);
    return err->status;
}
