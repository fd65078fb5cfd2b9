/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cfh/rig.h"

#include "core/units.h"
#include <ctype.h>
#include <errno.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double MAX_SPEED_RATIO = 1.03; /* to free fall: beyond it a pair is wrong, not merely measured */

static const char *const height_names[] = {"height_m", "h_m", "h_m_m", NULL};
static const char *const speed_names[] = {"speed_m_s", "v_test_m_s", NULL};

typedef struct reader {
    const char *path;
    int line;
    int height_column, speed_column; /* -1 until the heading is read */
    int pairs;
    double height[SF_CFH_MAX_PAIRS], speed[SF_CFH_MAX_PAIRS];
} reader;

double sf_cfh_speed(double free_fall_height) {
    return sqrt(2 * SF_STANDARD_GRAVITY * free_fall_height);
}

double sf_cfh_free_fall_height(double speed) {
    return speed * speed / (2 * SF_STANDARD_GRAVITY);
}

sf_cfh_rig sf_cfh_free_fall(void) {
    return (sf_cfh_rig){.gravity = SF_STANDARD_GRAVITY};
}

sf_status sf_cfh_rig_fit(const char *name, int pairs, const double *height, const double *speed,
                         sf_cfh_rig *rig, sf_error *err) {
    double x[SF_CFH_MAX_PAIRS], y[SF_CFH_MAX_PAIRS], variance = 0, residual = 0;
    *rig = sf_cfh_free_fall();
    if (pairs < 2 || pairs > SF_CFH_MAX_PAIRS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s has %d pairs of height and speed, 2 to %d are needed", name,
                       pairs, SF_CFH_MAX_PAIRS);
    for (int k = 0; k < pairs; k++) {
        if (!(height[k] > 0) || !(speed[k] > 0))
            return SF_FAIL(err, SF_ERR_INPUT, "%s: pair %d, %g m and %g m/s, is not positive", name, k + 1,
                           height[k], speed[k]);
        if (speed[k] > MAX_SPEED_RATIO * sf_cfh_speed(height[k]))
            return SF_FAIL(err, SF_ERR_INPUT,
                           "%s: pair %d, %g m/s from %g m, is faster than free fall (%.4g m/s)", name, k + 1,
                           speed[k], height[k], sf_cfh_speed(height[k]));
        x[k] = 2 * height[k];
        y[k] = speed[k] * speed[k];
    }
    gsl_fit_mul(x, 1, y, 1, (size_t)pairs, &rig->gravity, &variance, &residual);
    rig->pairs = pairs;
    rig->standard_error = sqrt(variance);
    rig->margin = gsl_cdf_tdist_Pinv(0.975, pairs - 1) * rig->standard_error / rig->gravity;
    return SF_OK;
}

/* The next field of a line, without surrounding blanks; NULL at its end. */
static char *next_field(char **rest) {
    char *field = strsep(rest, ",");
    if (!field)
        return NULL;
    while (isspace((unsigned char)*field))
        field++;
    for (char *end = field + strlen(field); end > field && isspace((unsigned char)end[-1]);)
        *--end = '\0';
    return field;
}

static bool is_one_of(const char *field, const char *const *names) {
    while (*names && strcmp(field, *names) != 0)
        names++;
    return *names != NULL;
}

static sf_status read_heading(reader *r, char *line, sf_error *err) {
    char *field;
    for (int column = 0; (field = next_field(&line)) != NULL; column++) {
        bool height = is_one_of(field, height_names);
        bool speed = is_one_of(field, speed_names);
        int *place = height ? &r->height_column : &r->speed_column;
        if (!height && !speed)
            continue;
        if (*place >= 0)
            return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: two columns of %s (\"%s\" is the second)", r->path,
                           r->line, height ? "heights" : "speeds", field);
        *place = column;
    }
    if (r->height_column < 0 || r->speed_column < 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: the heading needs a column %s", r->path, r->line,
                       r->height_column < 0 ? "height_m, h_m or h_m_m" : "speed_m_s or v_test_m_s");
    return SF_OK;
}

static sf_status read_row(reader *r, char *line, sf_error *err) {
    double height = NAN, speed = NAN;
    char *field;
    for (int column = 0; (field = next_field(&line)) != NULL; column++) {
        if (column != r->height_column && column != r->speed_column)
            continue;
        char *end;
        double number = strtod(field, &end);
        if (end == field || *end != '\0' || !isfinite(number))
            return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: \"%.40s\" is not a number", r->path, r->line, field);
        *(column == r->height_column ? &height : &speed) = number;
    }
    if (isnan(height) || isnan(speed))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: the row has too few columns", r->path, r->line);
    if (r->pairs == SF_CFH_MAX_PAIRS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: more than %d pairs", r->path, r->line, SF_CFH_MAX_PAIRS);
    r->height[r->pairs] = height;
    r->speed[r->pairs++] = speed;
    return SF_OK;
}

sf_status sf_cfh_rig_read(const char *path, sf_cfh_rig *rig, sf_error *err) {
    reader r = {.path = path, .height_column = -1, .speed_column = -1};
    char *line = NULL;
    size_t size = 0;
    *rig = sf_cfh_free_fall();
    FILE *file = fopen(path, "r");
    if (!file)
        return SF_FAIL(err, SF_ERR_INPUT, "cannot read the pairs of the rig in %s: %s", path,
                       strerror(errno));
    while (err->status == SF_OK && getline(&line, &size, file) > 0) {
        r.line++;
        if (line[0] == '#' || line[strspn(line, " \t\r\n")] == '\0')
            continue;
        if (r.height_column < 0)
            read_heading(&r, line, err);
        else
            read_row(&r, line, err);
    }
    if (err->status == SF_OK && ferror(file))
        SF_FAIL(err, SF_ERR_IO, "reading %s failed", path);
    fclose(file);
    free(line);
    return err->status == SF_OK ? sf_cfh_rig_fit(path, r.pairs, r.height, r.speed, rig, err) : err->status;
}
