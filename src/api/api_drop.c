/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "api/api_drop.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "api/api.h"
#include "build_info.h"
#include "model/model_io.h"
#include "solver/run/frame.h"
#include "solver/run/run.h"
#include "solver/step.h"

/* Drops: created, and advanced in time. */

static const softfall_drop_options by_default;

static sf_status check_options(const softfall_drop_options *o, sf_error *err) {
    if (o->threads < 0 || o->threads > 1024)
        return SF_FAIL(err, SF_ERR_INPUT, "threads: %d is not between 0 and 1024", o->threads);
    if (!(o->end_time >= 0) || !isfinite(o->end_time))
        return SF_FAIL(err, SF_ERR_INPUT, "end_time: %g s is not 0 or above", o->end_time);
    return SF_OK;
}

softfall_status softfall_drop_create(const softfall_model *model, const softfall_drop_options *options,
                                     softfall_drop **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const softfall_drop_options *o = options ? options : &by_default;
    softfall_drop *d = NULL;
    *out = NULL;
    if (check_options(o, &err) == SF_OK)
        d = softfall_new(&err, sizeof *d, "a drop");
    if (!d)
        return softfall_return(&err, error);
    d->model = model->model;
    d->threads = o->threads;
    if (o->end_time > 0)
        d->model.run.end_time = o->end_time;
    sf_recorder_begin(&d->recorder);
    softfall_drop_list(d);
    int before = softfall_drop_enter(d);
    if (d->model.run.drops > 1)
        SF_FAIL(
            &err, SF_ERR_INPUT,
            "the model is a series of %g drops; the library solves single ones: softfall-solve has series",
            d->model.run.drops);
    if (err.status == SF_OK && sf_model_check(&d->model, &err) == SF_OK &&
        sf_operators_build(&d->model, &d->operators, &err) == SF_OK)
        sf_state_create(&d->model, &d->state, &err);
    omp_set_num_threads(before);
    if (err.status == SF_OK)
        *out = d;
    else
        softfall_drop_free(d);
    return softfall_return(&err, error);
}

void softfall_drop_free(softfall_drop *d) {
    if (!d)
        return;
    sf_recorder_free(&d->recorder);
    sf_state_free(&d->state);
    sf_operators_free(&d->operators);
    free(d);
}

static void step(softfall_drop *d) {
    if (d->recorder.history.rows > 0)
        sf_step_advance(&d->model, &d->state);
    if (sf_step_evaluate(&d->model, &d->operators, &d->state, &d->failure) != SF_OK ||
        sf_recorder_add(&d->recorder, &d->model, &d->state, &d->failure) != SF_OK)
        return;
    if (sf_ending_on_anvil(&d->model, &d->state))
        sf_ending_fail_on_anvil(&d->state, &d->failure);
    else
        d->ending = sf_ending_rebounded(&d->model, &d->state)  ? SOFTFALL_REBOUND
                    : sf_ending_finished(&d->model, &d->state) ? SOFTFALL_FINISHED
                                                               : SOFTFALL_RUNNING;
}

softfall_status softfall_drop_step(softfall_drop *d, softfall_ending *ending, softfall_error *error) {
    if (d->ending == SOFTFALL_RUNNING && d->failure.status == SF_OK) {
        int before = softfall_drop_enter(d);
        step(d);
        omp_set_num_threads(before);
    }
    if (ending)
        *ending = d->ending;
    return softfall_return(&d->failure, error);
}

softfall_status softfall_drop_run(softfall_drop *d, int (*observe)(void *user, const softfall_drop *drop),
                                  void *user, softfall_ending *ending, softfall_error *error) {
    softfall_status status = softfall_return(&d->failure, error);
    bool stopped = false;
    while (status == SOFTFALL_OK && d->ending == SOFTFALL_RUNNING && !stopped) {
        status = softfall_drop_step(d, NULL, error);
        stopped = status == SOFTFALL_OK && observe && observe(user, d) != 0;
    }
    if (ending)
        *ending = d->ending;
    return status;
}

/* Results of a drop: its last step, its history, the fields over its nodes. */

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

/* Models: reading, writing and their properties. */

const char *softfall_version(void) {
    return SF_VERSION;
}

const char *softfall_revision(void) {
    return SF_GIT_REVISION;
}

/* A text of the provenance that a file may lack. */
static sf_status read_text(const sf_h5 *file, const char *path, char **text, sf_error *err) {
    return sf_h5_exists(file, path) ? sf_h5_read_text(file, path, text, err) : SF_OK;
}

static sf_status read_model(const char *path, softfall_model *m, sf_error *err) {
    sf_h5 *file = NULL;
    sf_error ignored = SF_ERROR_INIT; /* nothing was written */
    char *libraries = NULL;
    if (sf_model_read(path, &m->model, &file, err) == SF_OK &&
        read_text(file, "/provenance/case_text", &m->case_text, err) == SF_OK &&
        read_text(file, "/provenance/parameters", &m->parameters, err) == SF_OK &&
        read_text(file, "/provenance/mesh_hash", &m->mesh_hash, err) == SF_OK &&
        read_text(file, "/provenance/geometry_files", &m->geometry_files, err) == SF_OK)
        read_text(file, "/provenance/libraries", &libraries, err);
    snprintf(m->libraries, sizeof m->libraries, "%s", libraries ? libraries : "");
    free(libraries);
    sf_h5_close(&file, &ignored);
    return err->status;
}

softfall_status softfall_model_read(const char *path, softfall_model **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    *out = softfall_new(&err, sizeof **out, "a model");
    if (*out && read_model(path, *out, &err) != SF_OK) {
        softfall_model_free(*out);
        *out = NULL;
    }
    return softfall_return(&err, error);
}

softfall_status softfall_model_write(const softfall_model *m, const char *path, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_provenance provenance = {.program = "libsoftfall",
                                      .libraries = m->libraries,
                                      .case_text = m->case_text,
                                      .parameters = m->parameters,
                                      .mesh_hash = m->mesh_hash,
                                      .geometry_files = m->geometry_files};
    sf_model_write(path, &m->model, &provenance, &err);
    return softfall_return(&err, error);
}

void softfall_model_free(softfall_model *m) {
    if (!m)
        return;
    sf_model_free(&m->model);
    free(m->case_text);
    free(m->parameters);
    free(m->mesh_hash);
    free(m->geometry_files);
    free(m);
}

softfall_model_info softfall_model_describe(const softfall_model *model) {
    const sf_model *m = &model->model;
    return (softfall_model_info){.node_count = m->node_count,
                                 .symmetry_factor = m->symmetry_factor,
                                 .thickness = m->thickness,
                                 .missile_mass = m->missile.mass,
                                 .missile_speed = m->missile.speed,
                                 .end_time = m->run.end_time,
                                 .has_prescribed_motion = sf_missile_is_driven(m)};
}

const double *softfall_model_positions(const softfall_model *m) {
    return m->model.position;
}
