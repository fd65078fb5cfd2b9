/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/curve.h"

#include <stdlib.h>
#include <string.h>

sf_table_layout sf_case_curve_layout(const char *what, sf_table_check *check) {
    static const sf_table_name names[] = {{"strain", 0, 1.0, "1"},
                                          {"strain_percent", 0, 0.01, "%"},
                                          {"stress_Pa", 1, 1.0, "Pa"},
                                          {"stress_kPa", 1, 1e3, "kPa"},
                                          {"stress_MPa", 1, 1e6, "MPa"}};
    return (sf_table_layout){
        .what = what,
        .column = {"strain", "stress"},
        .wanted = {"\"strain\" or \"strain_percent\"", "\"stress_Pa\", \"stress_kPa\" or \"stress_MPa\""},
        .names = names,
        .name_count = sizeof names / sizeof *names,
        .words = {"strain|*dehnung|*stauchung|deformation|déformation|deformación|deformazione",
                  "stress|*spannung|contrainte|tensión|esfuerzo|sforzo|tensione"},
        .kind = {SF_TABLE_RATIO, SF_PRESSURE},
        .check = check,
    };
}

void sf_case_curve_free(sf_case_curve *curve) {
    free(curve->strain);
    free(curve->stress);
    memset(curve, 0, sizeof *curve);
}

static sf_status check_point(const sf_table_point *p, sf_error *err) {
    if (p->value[0] < 0.0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: strain %s is negative; compression is positive", p->path,
                       p->line, p->text[0]);
    if (p->value[0] >= 1.0)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: strain %s means a compression to nothing; it must be below 1 (100 %%)",
                       p->path, p->line, p->text[0]);
    if (p->value[1] < 0.0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: stress %s is negative; compression is positive", p->path,
                       p->line, p->text[1]);
    if (p->index == 0)
        return p->value[0] == 0.0 && p->value[1] != 0.0
                   ? SF_FAIL(err, SF_ERR_INPUT,
                             "%s:%d: stress %s at zero strain; the curve must start at (0, 0)", p->path,
                             p->line, p->text[1])
                   : SF_OK;
    if (p->value[0] <= p->before[0])
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: strain %s is not above the one before it (%g)", p->path,
                       p->line, p->text[0], p->last[0]);
    if (p->value[1] < p->before[1])
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: stress %s is below the one before it (%g); it must not fall", p->path, p->line,
                       p->text[1], p->last[1]);
    return SF_OK;
}

/* The table's points, after (0, 0) if they begin above it. */
static sf_status take_points(const sf_table *table, sf_case_curve *curve, sf_error *err) {
    size_t points = (size_t)table->count, before = table->value[0][0] > 0.0;
    curve->extended = before > 0;
    curve->count = (int64_t)(points + before);
    curve->strain = sf_alloc(err, points + before, sizeof *curve->strain, "the curve");
    curve->stress = sf_alloc(err, points + before, sizeof *curve->stress, "the curve");
    if (err->status != SF_OK)
        return err->status;
    memcpy(curve->strain + before, table->value[0], points * sizeof *curve->strain);
    memcpy(curve->stress + before, table->value[1], points * sizeof *curve->stress);
    return SF_OK;
}

sf_status sf_case_curve_read(const char *path, sf_case_curve *curve, sf_error *err) {
    const sf_table_layout layout = sf_case_curve_layout("curve", check_point);
    sf_table table;
    memset(curve, 0, sizeof *curve);
    if (sf_table_read(path, &layout, &table, err) != SF_OK)
        return err->status;
    if (table.count < SF_CURVE_MIN_POINTS)
        SF_FAIL(err, SF_ERR_INPUT, "%s: %lld points; a compression curve needs at least %d", path,
                (long long)table.count, SF_CURVE_MIN_POINTS);
    else if (!(table.value[1][table.count - 1] > 0.0))
        SF_FAIL(err, SF_ERR_INPUT, "%s: the stress is zero everywhere", path);
    else if (!(table.value[0][table.count - 1] >= SF_CURVE_MIN_END))
        SF_FAIL(err, SF_ERR_INPUT, "%s: the curve stops at the strain %g; it must reach at least %g", path,
                table.value[0][table.count - 1], SF_CURVE_MIN_END);
    else
        take_points(&table, curve, err);
    if (!table.plain)
        memcpy(curve->understood, table.understood, sizeof curve->understood);
    sf_table_free(&table);
    if (err->status != SF_OK)
        sf_case_curve_free(curve);
    return err->status;
}
