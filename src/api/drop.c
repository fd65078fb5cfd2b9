/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: drops, their histories and fields. */
#include "api/api.h"
#include "model/model_check.h"
#include "solver/run/frame.h"
#include "solver/set.h"

_Static_assert((int)SOFTFALL_RUNNING == SF_DROP_RUNS && (int)SOFTFALL_REBOUND == SF_DROP_REBOUND &&
                   (int)SOFTFALL_FINISHED == SF_DROP_FINISHED,
               "the two lists of endings are one");

static softfall_ending ending_of(const softfall_drop *d) {
    return (softfall_ending)d->drop.ending;
}

/* Fills the lists of columns and fields. */
static void list_quantities(softfall_drop *d) {
    for (int k = 0; k < SF_HISTORY_COUNT; k++) {
        const sf_history_column *column = sf_history_column_get(k);
        d->column[k] = (softfall_quantity){column->name, column->units, column->description, 1};
    }
    for (int k = 0; k < SF_FRAME_FIELDS; k++) {
        const sf_frame_field_info *f = sf_frame_field_get((sf_frame_field)k);
        d->field[k] = (softfall_quantity){f->name, f->units, f->description, f->components};
    }
}

/* ---- drops: created, and advanced in time ---- */

static const softfall_drop_options by_default;

static sf_status check_options(const softfall_drop_options *o, sf_error *err) {
    SF_TRY(softfall_check_threads(o->threads, err));
    if (!(o->end_time >= 0) || !isfinite(o->end_time))
        return SF_REFUSE(err, "end_time: %g s is not 0 or above", o->end_time);
    return SF_OK;
}

/* The drop of a model; `before` and `pause`: as of sf_drop_begin. */
static sf_status create(const sf_model *model, int threads, const softfall_drop *before, double pause,
                        softfall_drop **out, sf_error *err) {
    softfall_drop *d = sf_alloc(err, 1, sizeof *d, "a drop");
    SF_TRY(err->status);
    d->threads = threads;
    list_quantities(d);
    int usual = softfall_enter(d);
    if (model->series_count > 1)
        SF_REFUSE(err,
                  "the model is a series of %lld drops; the library solves one after another: make the model "
                  "of the case with series.drops = 1, and its later drops with softfall_drop_next",
                  (long long)model->series_count);
    if (err->status == SF_OK && sf_model_check(model, err) == SF_OK)
        sf_drop_begin(model, before ? &before->drop : NULL, pause, &d->drop, err);
    if (err->status == SF_OK)
        sf_drop_keep(&d->drop, err);
    omp_set_num_threads(usual);
    if (err->status == SF_OK)
        *out = d;
    else
        softfall_drop_free(d);
    return err->status;
}

softfall_status softfall_drop_create(const softfall_model *model, const softfall_drop_options *options,
                                     softfall_drop **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const softfall_drop_options *o = options ? options : &by_default;
    sf_model single = model->model;
    *out = NULL;
    if (o->end_time > 0)
        single.run.end_time = o->end_time;
    if (check_options(o, &err) == SF_OK)
        create(&single, o->threads, NULL, 0, out, &err);
    return softfall_return(&err, error);
}

/* The pad of a later drop must be that which the drop before has left. */
static sf_status check_pad(const softfall_drop *before, const sf_model *m, sf_error *err) {
    const sf_model *b = &before->drop.undeformed;
    const size_t n = (size_t)b->node_count;
    char foam[2][SF_MODEL_HASH_SIZE];
    sf_model_foam_hash(b, foam[0]);
    sf_model_foam_hash(m, foam[1]);
    bool same = strcmp(foam[0], foam[1]) == 0 && b->node_count == m->node_count &&
                b->material_count == m->material_count &&
                memcmp(b->position, m->position, 3 * n * sizeof *b->position) == 0 &&
                memcmp(b->volume, m->volume, n * sizeof *b->volume) == 0 &&
                memcmp(b->node_material, m->node_material, n) == 0 &&
                sf_state_rows(b, 'h') == sf_state_rows(m, 'h') &&
                (sf_model_set(b) > 0) == (sf_model_set(m) > 0);
    return same
               ? SF_OK
               : SF_REFUSE(err, "the pad of the model is not that of the drop before: geometry, mesh, layers "
                                "and foam must be the same");
}

softfall_status softfall_drop_next(const softfall_drop *before, double pause, softfall_drop **out,
                                   softfall_error *error) {
    return softfall_drop_next_of(before, NULL, pause, out, error);
}

softfall_status softfall_drop_next_of(const softfall_drop *before, const softfall_model *model, double pause,
                                      softfall_drop **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_model *own = model ? &model->model : &before->drop.undeformed;
    *out = NULL;
    if (!(pause > 0) || !isfinite(pause))
        SF_REFUSE(&err, "pause: %g s" SF_NOT_ABOVE_0, pause);
    else if (before->drop.ending == SF_DROP_RUNS || before->drop.failure.status != SF_OK ||
             before->drop.state.contact_count > 0)
        SF_REFUSE(&err, "the drop before has not ended, or its missile still touches the pad");
    else if (!model || check_pad(before, own, &err) == SF_OK)
        create(own, before->threads, before, pause, out, &err);
    return softfall_return(&err, error);
}

void softfall_drop_free(softfall_drop *d) {
    if (d)
        sf_drop_free(&d->drop);
    free(d);
}

softfall_status softfall_drop_step(softfall_drop *d, softfall_ending *ending, softfall_error *error) {
    if (d->drop.ending == SF_DROP_RUNS && d->drop.failure.status == SF_OK) {
        int before = softfall_enter(d);
        sf_drop_step(&d->drop);
        omp_set_num_threads(before);
    }
    if (ending)
        *ending = ending_of(d);
    return softfall_return(&d->drop.failure, error);
}

softfall_status softfall_drop_run(softfall_drop *d, int (*observe)(void *user, const softfall_drop *drop),
                                  void *user, softfall_ending *ending, softfall_error *error) {
    softfall_status status = softfall_return(&d->drop.failure, error);
    bool stopped = false;
    while (status == SOFTFALL_OK && d->drop.ending == SF_DROP_RUNS && !stopped) {
        status = softfall_drop_step(d, NULL, error);
        stopped = status == SOFTFALL_OK && observe && observe(user, d) != 0;
    }
    if (ending)
        *ending = ending_of(d);
    return status;
}

/* ---- results of a drop: its last step, its history, the fields over its nodes ---- */

int64_t softfall_drop_steps(const softfall_drop *d) {
    return d->drop.recorder.history.rows;
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
            *values = d->drop.recorder.history.column[k];
            return d->drop.recorder.history.rows;
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
        return SF_REFUSE(err, "unknown field \"%.80s\" of the nodes", name);
    int64_t needed = d->drop.model.node_count * d->field[field].components;
    if (size != needed)
        return SF_REFUSE(err, "the field \"%s\" has %lld values, room was given for %lld", name,
                         (long long)needed, (long long)size);
    if (d->drop.recorder.history.rows == 0 || d->drop.failure.status != SF_OK)
        return SF_REFUSE(err, "the drop has no good step whose fields could be read");
    sf_frame_take(&d->drop.model, &d->drop.operators, &d->drop.state, (sf_frame_field)field, values);
    return SF_OK;
}

softfall_status softfall_drop_field(const softfall_drop *d, const char *name, double *values, int64_t size,
                                    softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    int before = softfall_enter(d);
    take_field(d, name, values, size, &err);
    omp_set_num_threads(before);
    return softfall_return(&err, error);
}
