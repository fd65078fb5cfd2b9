/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/case_curve.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MAX_COLUMNS = 16 };

/* Where the two columns stand and what makes them SI. */
typedef struct columns {
    int count;
    int strain, stress;
    double strain_scale, stress_scale;
} columns;

/* The file being read: what the sentences and the growing arrays need. */
typedef struct csv {
    const char *path;
    int line;
    columns columns;
    int64_t capacity;
    int64_t read; /* points in the file */
    sf_case_curve *curve;
} csv;

void sf_case_curve_free(sf_case_curve *curve) {
    free(curve->strain);
    free(curve->stress);
    memset(curve, 0, sizeof *curve);
}

/* Splits at commas in place, trimming blanks; returns the number of cells (MAX_COLUMNS + 1 if there are
 * more). */
static int split(char *line, char *cell[MAX_COLUMNS]) {
    int count = 0;
    for (char *rest = line; rest; count++) {
        if (count == MAX_COLUMNS)
            return MAX_COLUMNS + 1;
        char *text = rest;
        rest = strchr(rest, ',');
        if (rest)
            *rest++ = '\0';
        while (isspace((unsigned char)*text))
            text++;
        for (char *end = text + strlen(text); end > text && isspace((unsigned char)end[-1]);)
            *--end = '\0';
        cell[count] = text;
    }
    return count;
}

static sf_status read_header(csv *file, char *line, sf_error *err) {
    static const struct {
        const char *name;
        bool is_stress;
        double scale;
    } known[] = {{"strain", false, 1.0},
                 {"strain_percent", false, 0.01},
                 {"stress_Pa", true, 1.0},
                 {"stress_kPa", true, 1e3},
                 {"stress_MPa", true, 1e6}};
    char *cell[MAX_COLUMNS];
    columns *c = &file->columns;
    *c = (columns){split(line, cell), -1, -1, 0.0, 0.0};
    if (c->count > MAX_COLUMNS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: more than %d columns", file->path, file->line, MAX_COLUMNS);
    for (int i = 0; i < c->count; i++) {
        for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
            if (strcmp(cell[i], known[k].name) != 0)
                continue;
            int *column = known[k].is_stress ? &c->stress : &c->strain;
            if (*column >= 0)
                return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: two %s columns (\"%s\" and \"%s\")", file->path,
                               file->line, known[k].is_stress ? "stress" : "strain", cell[*column], cell[i]);
            *column = i;
            *(known[k].is_stress ? &c->stress_scale : &c->strain_scale) = known[k].scale;
        }
    }
    if (c->strain < 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: the header has no column \"strain\" or \"strain_percent\"",
                       file->path, file->line);
    if (c->stress < 0)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: the header has no column \"stress_Pa\", \"stress_kPa\" or \"stress_MPa\"",
                       file->path, file->line);
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

static sf_status append(csv *file, double strain, double stress, sf_error *err) {
    sf_case_curve *curve = file->curve;
    if (curve->count == file->capacity) {
        int64_t capacity = file->capacity ? 2 * file->capacity : 64;
        double *e = realloc(curve->strain, (size_t)capacity * sizeof *e);
        if (e)
            curve->strain = e;
        double *s = realloc(curve->stress, (size_t)capacity * sizeof *s);
        if (s)
            curve->stress = s;
        if (!e || !s)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the curve %s", file->path);
        file->capacity = capacity;
    }
    curve->strain[curve->count] = strain;
    curve->stress[curve->count++] = stress;
    return SF_OK;
}

/* Sentences quote the cells as written, so that the user finds them in the file. */
static sf_status check_point(const csv *file, double strain, double stress, const char *strain_text,
                             const char *stress_text, sf_error *err) {
    const sf_case_curve *curve = file->curve;
    const char *path = file->path;
    int line = file->line;
    if (strain < 0.0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: strain %s is negative; compression is positive", path, line,
                       strain_text);
    if (strain >= 1.0)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: strain %s means a compression to nothing; it must be below 1 (100 %%)", path,
                       line, strain_text);
    if (stress < 0.0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: stress %s is negative; compression is positive", path, line,
                       stress_text);
    if (curve->count == 0)
        return strain == 0.0 && stress != 0.0
                   ? SF_FAIL(err, SF_ERR_INPUT,
                             "%s:%d: stress %s at zero strain; the curve must start at (0, 0)", path, line,
                             stress_text)
                   : SF_OK;
    int64_t last = curve->count - 1;
    if (strain <= curve->strain[last])
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: strain %s is not above the one before it (%g)", path, line,
                       strain_text, curve->strain[last] / file->columns.strain_scale);
    if (stress < curve->stress[last])
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: stress %s is below the one before it (%g); it must not fall", path, line,
                       stress_text, curve->stress[last] / file->columns.stress_scale);
    return SF_OK;
}

static sf_status read_point(csv *file, char *line, sf_error *err) {
    char *cell[MAX_COLUMNS];
    const columns *c = &file->columns;
    int count = split(line, cell);
    if (count != c->count)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %d values where the header has %d columns", file->path,
                       file->line, count, c->count);
    double strain, stress;
    if (read_number(file, "strain", cell[c->strain], &strain, err) != SF_OK ||
        read_number(file, "stress", cell[c->stress], &stress, err) != SF_OK)
        return err->status;
    strain *= c->strain_scale;
    stress *= c->stress_scale;
    if (check_point(file, strain, stress, cell[c->strain], cell[c->stress], err) != SF_OK)
        return err->status;
    if (file->curve->count == 0 && strain > 0.0) {
        file->curve->extended = true;
        if (append(file, 0.0, 0.0, err) != SF_OK)
            return err->status;
    }
    file->read++;
    return append(file, strain, stress, err);
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
    if (status == SF_OK && file->read < SF_CURVE_MIN_POINTS)
        status = SF_FAIL(err, SF_ERR_INPUT, "%s: %lld points; a compression curve needs at least %d",
                         file->path, (long long)file->read, SF_CURVE_MIN_POINTS);
    if (status == SF_OK && !(file->curve->stress[file->curve->count - 1] > 0.0))
        status = SF_FAIL(err, SF_ERR_INPUT, "%s: the stress is zero everywhere", file->path);
    return status;
}

sf_status sf_case_curve_read(const char *path, sf_case_curve *curve, sf_error *err) {
    memset(curve, 0, sizeof *curve);
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return SF_FAIL(err, SF_ERR_INPUT, "the curve %s is not a plain file", path);
    FILE *stream = fopen(path, "r");
    if (!stream)
        return SF_FAIL(err, SF_ERR_INPUT, "the curve %s cannot be read: %s", path, strerror(errno));
    csv file = {.path = path, .curve = curve};
    sf_status status = read_lines(&file, stream, err);
    fclose(stream);
    if (status != SF_OK)
        sf_case_curve_free(curve);
    return status;
}
