/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/rules.h"

#include <math.h>
#include <stdlib.h>

#include "io/table_csv.h"
#include "model/model.h"

static sf_status check_guided(const sf_case_reader *reader, sf_error *err) {
    static const char *const of_free[] = {"inertia", "centre", "angular_velocity"};
    char where[SF_CASE_WHERE_SIZE], path[64];
    for (int k = 0; k < 3; k++) {
        snprintf(path, sizeof path, "missile.%s", of_free[k]);
        if (sf_case_is_given(reader, "missile", of_free[k]))
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s: %s has no meaning for a guided missile, which does not turn: leave it out, or set "
                "missile.freedom = \"free\"",
                sf_case_where_is(reader, path, where), path);
    }
    return SF_OK;
}

static sf_status check_inertia(const sf_case_reader *reader, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const sf_case *c = reader->out;
    double p[3];
    if (c->inertia_count == 0 || sf_missile_inertia_is_possible(c->inertia, p))
        return SF_OK;
    return SF_FAIL(
        err, SF_ERR_INPUT,
        "%s: missile.inertia: no body has the principal moments %.4g, %.4g and %.4g kg m2: they must be "
        "positive, and none larger than the sum of the others",
        sf_case_where_is(reader, "missile.inertia", where), p[0], p[1], p[2]);
}

sf_status sf_case_check_freedom(const sf_case_reader *reader, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const sf_case *c = reader->out;
    if (c->freedom == SF_MISSILE_GUIDED)
        return check_guided(reader, err);
    if (c->motion_count > 0)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: missile.freedom: a missile whose displacement missile.motion prescribes cannot be free",
            sf_case_where_is(reader, "missile.freedom", where));
    if (c->centre_count > 0 && c->inertia_count == 0)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: missile.centre needs missile.inertia: a solid of uniform density has its centre already",
            sf_case_where_is(reader, "missile.centre", where));
    return check_inertia(reader, err);
}

/* The key missile.motion: the displacement over time of a missile that a machine drives, and the rules that
 * join it with other keys. */

static sf_status check_point(const sf_table_point *p, sf_error *err) {
    if (p->index == 0) {
        for (int c = 0; c < 2; c++)
            if (p->value[c] != 0.0)
                return SF_FAIL(err, SF_ERR_INPUT,
                               "%s:%d: %s %s in the first point; a motion starts at (0, 0)", p->path, p->line,
                               c ? "displacement" : "time", p->text[c]);
        return SF_OK;
    }
    double span = p->value[0] - p->before[0];
    if (!(span > 0.0))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: time %s is not above the one before it (%g)", p->path,
                       p->line, p->text[0], p->last[0]);
    double speed = fabs(p->value[1] - p->before[1]) / span;
    if (!(speed <= SF_MOTION_MAX_SPEED))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: displacement %s after %g means a speed of %g m/s; at most %g m/s are possible",
                       p->path, p->line, p->text[1], p->last[1], speed, SF_MOTION_MAX_SPEED);
    return SF_OK;
}

static const sf_table_name names[] = {{"time_s", 0, 1.0, "s"},
                                      {"time_ms", 0, 1e-3, "ms"},
                                      {"displacement_m", 1, 1.0, "m"},
                                      {"displacement_mm", 1, 1e-3, "mm"}};

static const sf_table_layout layout = {
    .what = "motion",
    .column = {"time", "displacement"},
    .wanted = {"\"time_s\" or \"time_ms\"", "\"displacement_m\" or \"displacement_mm\""},
    .names = names,
    .name_count = sizeof names / sizeof *names,
    .words =
        {"time|t|*zeit|temps|tiempo|tempo",
         "displacement|extension|crosshead|position|travel|stroke|*weg|desplazamiento|déplacement|spostamento"},
    .kind = {SF_TIME, SF_LENGTH},
    .check = check_point,
};

static sf_status check_table(const char *path, const sf_table *table, sf_error *err) {
    double largest = 0.0;
    for (int64_t k = 0; k < table->count; k++)
        largest = fmax(largest, fabs(table->value[1][k]));
    if (table->count < 2)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %lld points; a motion needs at least 2", path,
                       (long long)table->count);
    if (!(largest > 0.0))
        return SF_FAIL(err, SF_ERR_INPUT, "%s: the displacement is zero everywhere", path);
    return SF_OK;
}

sf_status sf_case_read_motion(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    sf_case *c = reader->out;
    const char *text = config_setting_get_string(setting);
    if (!text || !*text)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: missile.motion: the name of a CSV file is expected",
                       sf_case_where(reader, setting, where));
    char *path = sf_case_resolve(reader, setting, text, err);
    if (!path)
        return err->status;
    sf_table table = {0};
    sf_error inner = SF_ERROR_INIT;
    if (sf_table_read(path, &layout, &table, &inner) == SF_OK)
        check_table(path, &table, &inner);
    if (inner.status == SF_OK && !table.plain)
        sf_sink_tell(reader->sink, SF_NOTE, "motion %s: %s", path, table.interpretation);
    free(path);
    c->motion_count = table.count;
    c->motion_time = table.value[0];
    c->motion_displacement = table.value[1];
    free(table.line);
    if (inner.status != SF_OK)
        return SF_FAIL(err, inner.status, "%s (named at %s)", inner.text,
                       sf_case_where(reader, setting, where));
    snprintf(detail, size, "%lld points, to %g s", (long long)table.count, table.value[0][table.count - 1]);
    return SF_OK;
}

size_t sf_case_motion_bytes(const sf_case *c) {
    return (size_t)c->motion_count * sizeof *c->motion_time;
}

sf_status sf_case_check_motion(const sf_case_reader *reader, sf_error *err) {
    static const char *const replaced[] = {"mass", "velocity", "gravity"};
    char where[SF_CASE_WHERE_SIZE], path[64];
    const sf_case *c = reader->out;
    if (c->motion_count == 0) {
        for (int k = 0; k < 2; k++)
            if (!sf_case_is_given(reader, "missile", replaced[k]))
                return sf_case_missing_key(reader, sf_case_find_key(&reader->keys, "missile", replaced[k]),
                                           err);
        return SF_OK;
    }
    for (int k = 0; k < 3; k++) {
        snprintf(path, sizeof path, "missile.%s", replaced[k]);
        if (sf_case_is_given(reader, "missile", replaced[k]))
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s: %s has no meaning when missile.motion prescribes the displacement: leave it out",
                sf_case_where_is(reader, path, where), path);
    }
    double end = c->motion_time[c->motion_count - 1];
    if (!(c->run.end_time <= end * (1 + SF_MOTION_SLACK)))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s: solver.end_time: %g s lies beyond the end of missile.motion (%g s)",
                       sf_case_where_is(reader, "solver.end_time", where), c->run.end_time, end);
    return SF_OK;
}
