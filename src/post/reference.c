/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/reference.h"

#include "core/units.h"
#include "io/table_csv.h"
#include <stdlib.h>

enum { FEWEST_POINTS = 3 };

static const sf_table_name names[] = {{"time_s", 0, 1},
                                      {"time_ms", 0, 1e-3},
                                      {"time_us", 0, 1e-6},
                                      {"acceleration_g", 1, 1},
                                      {"acceleration_m_s2", 1, 1 / SF_STANDARD_GRAVITY},
                                      {"acceleration_km_s2", 1, 1e3 / SF_STANDARD_GRAVITY}};

static sf_status check_point(const sf_table_point *p, sf_error *err) {
    if (p->index > 0 && !(p->value[0] > p->before[0]))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: time %g ms does not follow %g ms of the row before",
                       p->path, p->line, p->value[0] * 1e3, p->before[0] * 1e3);
    return SF_OK;
}

static const sf_table_layout layout = {
    .what = "reference",
    .column = {"time", "acceleration"},
    .wanted = {"time_s, time_ms or time_us", "acceleration_g, acceleration_m_s2 or acceleration_km_s2"},
    .names = names,
    .name_count = sizeof names / sizeof *names,
    .first = true,
    .ragged = true,
    .check = check_point,
};

sf_status sf_reference_read(const char *path, sf_series *curve, sf_error *err) {
    sf_table table;
    *curve = (sf_series){0};
    if (sf_table_read(path, &layout, &table, err) != SF_OK)
        return err->status;
    if (table.count < FEWEST_POINTS) {
        SF_FAIL(err, SF_ERR_INPUT, "%s has %lld points, at least %d are needed", path, (long long)table.count,
                FEWEST_POINTS);
    } else {
        *curve = (sf_series){.count = table.count, .time = table.value[0], .value = table.value[1]};
        table.value[0] = table.value[1] = NULL;
    }
    sf_table_free(&table);
    return err->status;
}
