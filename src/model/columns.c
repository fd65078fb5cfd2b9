/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/columns.h"

#include "base/error.h"
#include "model/good_run.h"
#include <string.h>

const sf_frame_field_info *sf_frame_field_get(sf_frame_field field) {
    static const sf_frame_field_info fields[SF_FRAME_FIELDS] = {
#define FIELD(constant, name, components, units, array, description, remark)                                 \
    {#name, components, units, array, description, remark},
        SF_FRAME_FIELD_LIST(FIELD, )
#undef FIELD
    };
    return &fields[field];
}

const sf_history_column *sf_history_column_get(int k) {
    static const sf_history_column columns[SF_HISTORY_COUNT] = {
#define COLUMN(name, units, csv, factor, description, remark)                                                \
    {#name, units, csv, factor, description, remark},
        SF_HISTORY_COLUMNS(COLUMN)
#undef COLUMN
    };
    return &columns[k];
}

const sf_good_run *sf_good_run_limits(void) {
#define LIMIT(name, remark, ...) .name = remark,
    static const sf_good_run limits = {SF_GOOD_RUN(LIMIT)};
#undef LIMIT
    return &limits;
}

const sf_good_run_rule *sf_good_run_rule_get(int k) {
#define RULE(name, remark, refuse, sure, shown, title, figures, why)                                         \
    {#name, title, remark, refuse, sure, shown == SF_AS_PERCENT, figures, why},
    static const sf_good_run_rule rules[SF_CHECKS] = {SF_GOOD_RUN(RULE)};
#undef RULE
    return &rules[k];
}

const sf_drop_kind_info *sf_drop_kind_get(int kind) {
#define SF_DROP_KIND_INFO(name, key, error_key, ...) {key, error_key, SF_DROP_SD(error_key), __VA_ARGS__},
    static const sf_drop_kind_info info[] = {SF_DROP_KINDS(SF_DROP_KIND_INFO)};
    return &info[kind];
}

void sf_history_free(sf_history *h) {
    sf_free_all(SF_HISTORY_COUNT, h->column);
    memset(h, 0, sizeof *h);
}

double sf_history_largest(const sf_history *h, const double *column) {
    double largest = 0;
    for (int64_t i = 0; i < h->rows; i++)
        largest = fmax(largest, fabs(column[i]));
    return largest;
}

int64_t sf_history_row_of_largest(const sf_history *h, const double *column) {
    int64_t row = 0;
    for (int64_t i = 1; i < h->rows; i++)
        if (column[i] > column[row])
            row = i;
    return row;
}

double sf_history_sustained(const double *column, int64_t row) {
    return row < 2 ? 0 : fmin(column[row], fmin(column[row - 1], column[row - 2]));
}

double sf_history_resultant(const sf_history *h, int64_t row) {
    double x = h->specific_force_x[row], y = h->specific_force_y[row], z = h->specific_force_z[row];
    return sqrt(x * x + y * y + z * z);
}

int64_t sf_history_row_of_sustained(const sf_history *h, const double *column) {
    int64_t row = 0;
    for (int64_t i = 1; i < h->rows; i++)
        if (sf_history_sustained(column, i) > sf_history_sustained(column, row))
            row = i;
    return row;
}

static double internal_energy(const sf_history *h, int64_t i) {
    return h->energy_stored[i] + h->energy_hysteresis[i] + h->energy_viscous[i] + h->energy_stabilisation[i];
}

sf_internal_energy sf_history_internal_energy(const sf_history *h) {
    int64_t row = 0;
    for (int64_t i = 1; i < h->rows; i++)
        if (internal_energy(h, i) > internal_energy(h, row))
            row = i;
    double peak = internal_energy(h, row);
    bool positive = peak > 0;
    return (sf_internal_energy){.peak = peak,
                                .time = h->time[row],
                                .stabilisation = positive ? h->energy_stabilisation[row] / peak : NAN,
                                .contact = positive ? h->energy_contact[row] / peak : NAN};
}
