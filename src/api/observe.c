/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Results of a drop: its last step, its history, the fields over its nodes. */
#include "api/api_drop.h"

#include "solver/run/frame.h"
#include <math.h>
#include <omp.h>
#include <string.h>

void softfall_drop_list(softfall_drop *d) {
    for (int k = 0; k < SF_HISTORY_COUNT; k++) {
        const sf_history_column *column = sf_history_column_get(k);
        d->column[k] = (softfall_quantity){column->name, column->units, column->description, 1};
    }
    for (int k = 0; k < SF_FRAME_FIELDS; k++) {
        const sf_frame_field_info *f = sf_frame_field_get((sf_frame_field)k);
        d->field[k] = (softfall_quantity){f->name, f->units, f->description, f->components};
    }
}

int64_t softfall_drop_steps(const softfall_drop *d) {
    return d->recorder.history.rows;
}

double softfall_drop_latest(const softfall_drop *d, const char *name) {
    const double *values = NULL;
    int64_t rows = softfall_drop_history(d, name, &values);
    return rows > 0 ? values[rows - 1] : NAN;
}

const softfall_quantity *softfall_drop_columns(const softfall_drop *d, int *count) {
    *count = SF_HISTORY_COUNT;
    return d->column;
}

int64_t softfall_drop_history(const softfall_drop *d, const char *name, const double **values) {
    for (int k = 0; k < SF_HISTORY_COUNT; k++)
        if (strcmp(d->column[k].name, name) == 0) {
            *values = d->recorder.history.column[k];
            return d->recorder.history.rows;
        }
    return -1;
}

const softfall_quantity *softfall_drop_fields(const softfall_drop *d, int *count) {
    *count = SF_FRAME_FIELDS;
    return d->field;
}

static sf_status take_field(const softfall_drop *d, const char *name, double *values, int64_t size,
                            sf_error *err) {
    int field = 0;
    while (field < SF_FRAME_FIELDS && strcmp(d->field[field].name, name) != 0)
        field++;
    if (field == SF_FRAME_FIELDS)
        return SF_FAIL(err, SF_ERR_INPUT, "there is no field \"%.80s\" of the nodes", name);
    int64_t needed = d->model.node_count * d->field[field].components;
    if (size != needed)
        return SF_FAIL(err, SF_ERR_INPUT, "the field \"%s\" has %lld values, room was given for %lld", name,
                       (long long)needed, (long long)size);
    if (d->recorder.history.rows == 0 || d->failure.status != SF_OK)
        return SF_FAIL(err, SF_ERR_INPUT, "the drop has no good step whose fields could be read");
    sf_frame_take(&d->model, &d->operators, &d->state, (sf_frame_field)field, values);
    return SF_OK;
}

softfall_status softfall_drop_field(const softfall_drop *d, const char *name, double *values, int64_t size,
                                    softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    int before = softfall_drop_enter(d);
    take_field(d, name, values, size, &err);
    omp_set_num_threads(before);
    return softfall_return(&err, error);
}
