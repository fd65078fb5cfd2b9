/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/columns.h"

#include "base/error.h"
#include <math.h>
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
