/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: drops, their results and figures, models in files. */
#include "api/api.h"
#include "build_info.h"
#include "drop/drop.h"
#include "io/h5_data.h"
#include "model/model_check.h"
#include "model/model_io.h"
#include "post/figures/compare.h"
#include "post/figures/verdict.h"
#include "solver/set.h"
#include "solver/run/frame.h"

#include <omp.h>

/* A drop behind its handle. */
struct softfall_drop {
    sf_drop drop;
    int threads; /* 0: as OpenMP would */
    softfall_quantity column[SF_HISTORY_COUNT], field[SF_FRAME_FIELDS];
};

_Static_assert((int)SOFTFALL_RUNNING == SF_DROP_RUNS && (int)SOFTFALL_REBOUND == SF_DROP_REBOUND &&
                   (int)SOFTFALL_FINISHED == SF_DROP_FINISHED,
               "the two lists of endings are one");

static softfall_ending ending_of(const softfall_drop *d) {
    return (softfall_ending)d->drop.ending;
}

/* Sets the number of threads of the drop and returns the number before. */
static int enter(const softfall_drop *drop) {
    int before = omp_get_max_threads();
    if (drop->threads > 0)
        omp_set_num_threads(drop->threads);
    return before;
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
    if (o->threads < 0 || o->threads > 1024)
        return SF_REFUSE(err, "threads" SF_OUTSIDE("%d", "0", "1024"), o->threads);
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
    int usual = enter(d);
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
        int before = enter(d);
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
    int before = enter(d);
    take_field(d, name, values, size, &err);
    omp_set_num_threads(before);
    return softfall_return(&err, error);
}

/* ---- models: reading, writing and their properties ---- */

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
    SF_OWNED_BY(sf_h5_drop) sf_h5 *file = NULL;
    SF_OWNED char *libraries = NULL;
    if (sf_model_read(path, &m->model, &file, err) == SF_OK &&
        read_text(file, "/provenance/case_text", &m->case_text, err) == SF_OK &&
        read_text(file, "/provenance/parameters", &m->parameters, err) == SF_OK &&
        read_text(file, "/provenance/mesh_hash", &m->mesh_hash, err) == SF_OK &&
        read_text(file, "/provenance/geometry_files", &m->geometry_files, err) == SF_OK)
        read_text(file, "/provenance/libraries", &libraries, err);
    snprintf(m->libraries, sizeof m->libraries, "%s", libraries ? libraries : "");
    return err->status;
}

softfall_status softfall_model_read(const char *path, softfall_model **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    *out = sf_alloc(&err, 1, sizeof **out, "a model");
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
    SF_FREE(m->case_text, m->parameters, m->mesh_hash, m->geometry_files, m);
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

const char *softfall_model_geometry_files(const softfall_model *model) {
    return model->geometry_files ? model->geometry_files : "";
}

const double *softfall_model_positions(const softfall_model *m) {
    return m->model.position;
}

/* ---- figures ---- */

#define ONE(...) +1
struct softfall_figures {
    int count;
    softfall_quantity figure[SF_FIGURES(ONE)];
    double value[SF_FIGURES(ONE)];
    int grade;
    double sure; /* -, sf_verdict.sure */
    char status[512], verdict[SF_VERDICT_LINE_SIZE];
};

static sf_status check_filter(double filter, sf_error *err) {
    if (filter == 60 || filter == 180 || filter == 600 || filter == 1000)
        return SF_OK;
    return SF_REFUSE(err, "filter: %g; the channel frequency classes are 60, 180, 600 and 1000", filter);
}

/* Fills the list of the figures that are numbers. */
static void list_figures(softfall_quantity *list, int *count) {
    *count = 0;
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        if (sf_figure_at[k].row.type != SF_ROW_TEXT)
            list[(*count)++] =
                (softfall_quantity){sf_figure_at[k].row.key, "", sf_figure_at[k].row.meaning, 1};
}

/* Takes the numbers of the list of figures, and the verdict. */
static sf_status compute(const sf_results *results, double filter, softfall_figures **out, sf_error *err) {
    SF_OWNED_BY(sf_figures_free) sf_figures f = {0};
    const sf_limits limits = SF_DEFAULT_LIMITS; /* no part of the grade */
    sf_verdict verdict;
    SF_TRY(check_filter(filter, err));
    SF_TRY(sf_figures_compute(results, filter, &f, err));
    softfall_figures *made = *out = sf_alloc(err, 1, sizeof *made, "figures");
    SF_TRY(err->status);
    list_figures(made->figure, &made->count);
    for (size_t k = 0, n = 0; k < SF_FIGURE_TOTAL; k++)
        if (sf_figure_at[k].row.type != SF_ROW_TEXT)
            made->value[n++] = sf_figure_number(&sf_figure_at[k], results, &f);
    sf_verdict_compute(results, &f, &limits, &verdict);
    made->grade = (int)verdict.grade;
    made->sure = verdict.sure;
    sf_verdict_line(&verdict, made->verdict, sizeof made->verdict);
    snprintf(made->status, sizeof made->status, "%s", results->status);
    return SF_OK;
}

softfall_status softfall_drop_figures(const softfall_drop *drop, double filter, softfall_figures **out,
                                      softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_drop_results_free) sf_results r = {0};
    const int before = enter(drop);
    *out = NULL;
    if (sf_drop_results(&drop->drop, &r, &err) == SF_OK)
        compute(&r, filter, out, &err);
    omp_set_num_threads(before);
    return softfall_return(&err, error);
}

softfall_status softfall_results_figures(const char *path, double filter, softfall_figures **out,
                                         softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_results_close) sf_results r = {0};
    *out = NULL;
    if (sf_results_open(path, &r, &err) == SF_OK)
        compute(&r, filter, out, &err);
    return softfall_return(&err, error);
}

int softfall_figures_grade(const softfall_figures *figures) {
    return figures->grade;
}

double softfall_figures_sure(const softfall_figures *figures) {
    return figures->sure;
}

const char *softfall_figures_verdict(const softfall_figures *figures) {
    return figures->verdict;
}

const char *softfall_figures_status(const softfall_figures *figures) {
    return figures->status;
}

void softfall_figures_free(softfall_figures *figures) {
    free(figures);
}

const softfall_quantity *softfall_figures_list(const softfall_figures *figures, int *count) {
    static softfall_quantity list[SF_FIGURES(ONE)];
    if (!figures) {
#pragma omp critical(softfall_figures_list)
        list_figures(list, count);
        return list;
    }
    *count = figures->count;
    return figures->figure;
}

softfall_status softfall_figure(const softfall_figures *figures, const char *key, double *value,
                                softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    int k = 0;
    while (k < figures->count && strcmp(figures->figure[k].name, key) != 0)
        k++;
    if (k < figures->count)
        *value = figures->value[k];
    else
        SF_REFUSE(&err, "unknown figure \"%.80s\"; softfall_figures_list has their keys", key);
    return softfall_return(&err, error);
}

/* One drop of a batch; its figures into `values`. */
static softfall_status run_one(const softfall_model *model, const softfall_batch *batch, double *values,
                               softfall_error *error) {
    const softfall_drop_options options = {.threads = 1};
    softfall_drop *drop = NULL;
    softfall_figures *figures = NULL;
    softfall_status status = softfall_drop_create(model, &options, &drop, error);
    for (int k = 0; k < batch->keys; k++)
        values[k] = NAN;
    if (status == SOFTFALL_OK)
        status = softfall_drop_run(drop, NULL, NULL, NULL, error);
    if (status == SOFTFALL_OK)
        status = softfall_drop_figures(drop, batch->filter, &figures, error);
    for (int k = 0; k < batch->keys && status == SOFTFALL_OK; k++)
        status = softfall_figure(figures, batch->key[k], &values[k], error);
    softfall_figures_free(figures);
    softfall_drop_free(drop);
    return status;
}

static sf_status check_batch(const softfall_batch *batch, sf_error *err) {
    SF_TRY(check_filter(batch->filter, err));
    SF_TRY(check_options(&(softfall_drop_options){.threads = batch->threads}, err));
    for (int k = 0; k < batch->keys; k++) {
        bool known = false;
        for (size_t f = 0; f < SF_FIGURE_TOTAL; f++)
            known = known || (sf_figure_at[f].row.type != SF_ROW_TEXT &&
                              strcmp(sf_figure_at[f].row.key, batch->key[k]) == 0);
        if (!known)
            return SF_REFUSE(err, "unknown figure \"%.80s\"; softfall_figures_list has their keys",
                             batch->key[k]);
    }
    return SF_OK;
}

softfall_status softfall_batch_run(const softfall_model *const *models, int64_t count,
                                   const softfall_batch *batch, double *values, softfall_error *errors,
                                   softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    int threads = batch->threads > 0 ? batch->threads : omp_get_max_threads();
    if (check_batch(batch, &err) != SF_OK)
        return softfall_return(&err, error);
#pragma omp parallel for schedule(dynamic) num_threads(threads) default(none)                                \
    shared(models, count, batch, values, errors)
    for (int64_t k = 0; k < count; k++)
        run_one(models[k], batch, &values[k * batch->keys], &errors[k]);
    return softfall_return(&err, error);
}

/* Curves of the host. The arrays are read only. */

static sf_series borrow(const double *time, const double *value, int64_t count) {
    return (sf_series){.count = count, .time = (double *)time, .value = (double *)value};
}

softfall_status softfall_hic(const double *time, const double *deceleration, int64_t count, double window,
                             double hic[3], softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_series curve = borrow(time, deceleration, count);
    sf_hic found = {0};
    if (!(window > 0))
        SF_REFUSE(&err, "window: %g s" SF_NOT_ABOVE_0, window);
    else if (sf_series_check(&curve, "the deceleration", &err) == SF_OK)
        sf_hic_evaluate(&curve, window, &found, &err);
    hic[0] = err.status == SF_OK ? found.value : NAN;
    hic[1] = found.t1;
    hic[2] = found.t2;
    return softfall_return(&err, error);
}

softfall_status softfall_cfc(const double *time, const double *value, int64_t count, double filter,
                             double *filtered, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_series curve = borrow(time, value, count);
    SF_OWNED_BY(sf_series_free) sf_series made = {0};
    if (check_filter(filter, &err) == SF_OK &&
        sf_series_check(&curve, "the curve to filter", &err) == SF_OK &&
        sf_signal_filter(&curve, filter, &made, &err) == SF_OK)
        for (int64_t i = 0; i < count; i++)
            filtered[i] = sf_series_at(&made, time[i]);
    return softfall_return(&err, error);
}

static sf_status read_curve(const sf_series *curve, const softfall_instrument *by, double *read,
                            double *contact, sf_error *err) {
    SF_OWNED_BY(sf_series_free) sf_series uniform = {0}, made = {0};
    const sf_signal_chain passed = {by->frequency, by->damping, by->coupling};
    SF_TRY(check_filter(by->filter, err));
    if (!(by->frequency >= 0 && by->coupling >= 0) ||
        (by->frequency > 0 && !(by->damping > 0 && by->damping < 1)))
        return SF_REFUSE(err,
                         "a mount of %g Hz with damping %g, or a coupling of %g s: frequency and time are "
                         "from 0 on, damping is between 0 and 1",
                         by->frequency, by->damping, by->coupling);
    SF_TRY(sf_series_check(curve, "the curve to read", err));
    SF_TRY(sf_signal_resample(curve, sf_signal_rate(curve), &uniform, err));
    sf_signal_pass(&passed, &uniform);
    SF_TRY(sf_signal_filter_cfc(&uniform, by->filter, &made, err));
    for (int64_t i = 0; i < curve->count; i++)
        read[i] = sf_series_at(&made, curve->time[i]);
    return sf_contact_instant(&made, "the curve to read", 0, contact, err);
}

softfall_status softfall_reading(const double *time, const double *value, int64_t count,
                                 const softfall_instrument *instrument, double *read, double *contact,
                                 softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_series curve = borrow(time, value, count);
    read_curve(&curve, instrument, read, contact, &err);
    return softfall_return(&err, error);
}

softfall_status softfall_refine(double fine, double coarse, double ratio, double cells, double refined[2],
                                softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_figure_refine(fine, coarse, ratio, cells, refined, &err);
    return softfall_return(&err, error);
}
