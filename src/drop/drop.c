/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drop/drop.h"

#include "io/process.h"
#include "model/flight.h"
#include "solver/run/frame.h"
#include "solver/set.h"
#include "solver/step.h"

#include <omp.h>

/* The permanent set of the drop before; the reference becomes the drop's own. */
static sf_status take_set(sf_drop *d, const sf_state *before, double pause, sf_error *err) {
    sf_model *m = &d->model;
    double **own[] = {&m->position, &m->volume, &m->domain_b};
    const int64_t count[] = {3 * m->node_count, m->node_count, 3 * m->domain_nnz};
    if (!before || !(sf_model_set(m) > 0))
        return SF_OK;
    for (int k = 0; k < 3; k++) {
        const double *from = *own[k];
        if ((*own[k] = sf_alloc(err, count[k], sizeof *from, "the reference of a drop")))
            memcpy(*own[k], from, (size_t)count[k] * sizeof *from);
    }
    SF_TRY(err->status);
    return sf_set_move(m, before->set, before->set_peak, pause, err);
}

sf_status sf_drop_begin(const sf_model *model, const sf_drop *before, double pause, sf_drop *d,
                        sf_error *err) {
    const sf_state *state = before ? &before->state : NULL;
    *d = (sf_drop){.model = *model, .undeformed = *model};
    sf_recorder_begin(&d->recorder);
    if (before) /* what the model says of a drop on a new pad is nothing for a later one */
        d->undeformed.section = (sf_section_drop){0};
    if (take_set(d, state, pause, err) == SF_OK && sf_operators_build(&d->model, &d->operators, err) == SF_OK)
        sf_series_continue(state, pause, &d->model, &d->operators, &d->state, err);
    return err->status;
}

void sf_drop_free(sf_drop *d) {
    sf_recorder_free(&d->recorder);
    sf_state_free(&d->state);
    sf_operators_free(&d->operators);
    if (d->model.position != d->undeformed.position)
        SF_FREE(d->model.position, d->model.volume, d->model.domain_b);
    sf_free_all(SF_FRAME_FIELDS, d->first.field);
    sf_free_all(SF_FRAME_FIELDS, d->peak.field);
    sf_free_all(SF_FRAME_FIELDS, d->last.field);
    free(d->model.set);
}

sf_status sf_drop_keep(sf_drop *d, sf_error *err) {
    static const sf_frame_field wanted[] = {SF_FRAME_LARGEST_COMPRESSION, SF_FRAME_ENERGY_DENSITY,
                                            SF_FRAME_DISPLACEMENT, SF_FRAME_CONTACT_PRESSURE};
    const int64_t nodes = d->model.node_count;
    d->keeps = true;
    for (size_t k = 0; k < sizeof wanted / sizeof wanted[0]; k++)
        d->peak.field[wanted[k]] = sf_alloc(
            err, nodes, (size_t)sf_frame_field_get(wanted[k])->components * sizeof(double), "fields");
    if (!(d->model.anvil.depth > 0))
        return err->status;
    d->first.field[SF_FRAME_DISPLACEMENT] = sf_alloc(err, nodes, 3 * sizeof(double), "fields");
    d->last.field[SF_FRAME_DISPLACEMENT] = sf_alloc(err, nodes, 3 * sizeof(double), "fields");
    return err->status;
}

/* Takes time, missile and those fields that have room of the state. */
static void take_kept(const sf_drop *d, sf_kept *kept) {
    sf_frame_head *head = &kept->head;
    head->time = d->state.time;
    head->acceleration = sf_missile_reading(&d->model, &d->state.missile);
    sf_missile_translation(&d->model, &d->state.missile, head->missile_displacement);
    memcpy(head->missile_quaternion, d->state.missile.quaternion, sizeof head->missile_quaternion);
    for (int k = 0; k < SF_FRAME_FIELDS; k++)
        if (kept->field[k])
            sf_frame_take(&d->model, &d->operators, &d->state, (sf_frame_field)k, kept->field[k]);
}

/* The fields at a peak are taken in the first step after it, as by softfall-solve. */
static void keep_frames(sf_drop *d) {
    if (d->recorder.history.rows == 1)
        take_kept(d, &d->first);
    if (sf_recorder_peak_due(&d->recorder, &d->state))
        take_kept(d, &d->peak);
}

static void take_step(sf_drop *d) {
    if (d->recorder.history.rows > 0)
        sf_step_advance(&d->model, &d->state);
    if (sf_step_evaluate(&d->model, &d->operators, &d->state, &d->failure) != SF_OK ||
        sf_recorder_add(&d->recorder, &d->model, &d->state, &d->failure) != SF_OK)
        return;
    if (d->keeps)
        keep_frames(d);
    if (sf_ending_on_anvil(&d->model, &d->state))
        sf_ending_fail_on_anvil(&d->model, &d->state, &d->failure);
    else if (sf_ending_rebounded(&d->model, &d->state))
        d->ending = SF_DROP_REBOUND;
    else
        d->ending = sf_ending_finished(&d->model, &d->state) ? SF_DROP_FINISHED : SF_DROP_RUNS;
    const bool ended = d->failure.status != SF_OK || d->ending != SF_DROP_RUNS;
    if (ended && d->keeps && sf_recorder_peak_ahead(&d->recorder))
        take_kept(d, &d->peak);
}

void sf_drop_step(sf_drop *d) {
    const double start = sf_process_now();
    take_step(d);
    d->wall_time += sf_process_now() - start;
}

/* ---- a drop as its results file would show it ---- */

/* A copy of an array that the results own; NULL of an empty one. */
static void *copy_of(const void *from, int64_t count, size_t size, sf_error *err) {
    void *copy = from && count > 0 ? sf_alloc(err, count, size, "results of a drop") : NULL;
    if (copy)
        memcpy(copy, from, (size_t)count * size);
    return copy;
}

/* Numbers of the model. */
static void take_numbers(const sf_model *m, sf_results *r) {
    double lock_begin, lock_up = sf_model_lock_up(m, &lock_begin), place;
    *r = (sf_results){.node_count = m->node_count,
                      .cell_count = m->cell_count,
                      .cell_nnz = m->cell_nnz,
                      .surface_node_count = m->surface_node_count,
                      .surface_triangle_count = m->surface_triangle_count,
                      .support_node_count = m->support_triangle_count > 0 ? m->support_node_count : 0,
                      .support_triangle_count = m->support_triangle_count,
                      .axisymmetric = m->axisymmetric != 0,
                      .symmetry_factor = m->symmetry_factor,
                      .modelled_parts = m->symmetry_factor,
                      .modelled_nodes = m->node_count,
                      .modelled_cells = m->cell_count,
                      .thickness = m->thickness,
                      .density = sf_model_density(m),
                      .expected_mesh_error = m->expected_mesh_error > 0 ? m->expected_mesh_error : NAN,
                      .section = m->section,
                      .air = m->air,
                      .speed_scatter = m->run.speed_scatter,
                      .thickness_tolerance = m->run.thickness_tolerance,
                      .lock_up = lock_up,
                      .lock_begin = lock_begin,
                      .slit_fraction = m->slit_fraction,
                      .informed_strain = sf_model_informed_strain(m),
                      .sphere_radius = m->missile.shape == SF_SHAPE_SPHERE ? m->missile.sphere_radius : NAN,
                      .anvil_depth = m->anvil.depth,
                      .impact_x = m->missile.impact_known ? m->missile.impact[0] : NAN,
                      .impact_y = m->missile.impact_known ? m->missile.impact[1] : NAN,
                      .missile_mass = m->missile.mass,
                      .missile_speed = m->missile.speed,
                      .gravity_along = sf_flight_pull(&m->missile),
                      .kinematic = m->run.kinematic != 0,
                      .driven = sf_missile_is_driven(m),
                      .turns = sf_missile_turns(m)};
    memcpy(r->sphere_centre, m->missile.sphere_centre, sizeof r->sphere_centre);
    memcpy(r->missile_centre, m->missile.centre, sizeof r->missile_centre);
    memcpy(r->missile_direction, sf_missile_direction(m), sizeof r->missile_direction);
    sf_flight_gravity(&m->missile, r->gravity);
    for (int axis = 0; axis < 2; axis++)
        r->symmetry_place[axis] = !m->axisymmetric && sf_symmetry_plane(m, axis, &place) ? place : NAN;
}

static sf_status take_arrays(const sf_model *m, sf_results *r, sf_error *err) {
    r->position = copy_of(m->position, 3 * r->node_count, sizeof *r->position, err);
    r->volume = copy_of(m->volume, r->node_count, sizeof *r->volume, err);
    r->cell_type = copy_of(m->cell_type, r->cell_count, 1, err);
    r->cell_ptr = copy_of(m->cell_ptr, r->cell_count + 1, sizeof *r->cell_ptr, err);
    r->cell_node = copy_of(m->cell_node, r->cell_nnz, sizeof *r->cell_node, err);
    r->surface_position =
        copy_of(m->surface_position, 3 * r->surface_node_count, sizeof *r->surface_position, err);
    r->surface_triangle =
        copy_of(m->surface_triangle, 3 * r->surface_triangle_count, sizeof *r->surface_triangle, err);
    r->support_position =
        copy_of(m->support_position, 3 * r->support_node_count, sizeof *r->support_position, err);
    r->support_triangle =
        copy_of(m->support_triangle, 3 * r->support_triangle_count, sizeof *r->support_triangle, err);
    return err->status;
}

/* The layers of a pad of several materials. */
static sf_status take_layers(const sf_drop *d, sf_results *r, sf_error *err) {
    const sf_model *m = &d->undeformed;
    const int count = (int)m->material_count;
    if (count < 2)
        return SF_OK;
    SF_OWNED double *sums = sf_alloc(err, SF_LAYER_SUMS * count, sizeof *sums, "sums of the layers");
    r->layer_count = count;
    r->node_layer = copy_of(m->node_material, m->node_count, 1, err);
    r->layer_name = sf_alloc(err, count, sizeof *r->layer_name, "layers");
    r->layer_names = sf_alloc(err, count, SF_MATERIAL_NAME_SIZE, "layers");
    r->layer_density = sf_alloc(err, count, sizeof *r->layer_density, "layers");
    r->layer_informed = sf_alloc(err, count, sizeof *r->layer_informed, "layers");
    SF_TRY(err->status);
    sf_frame_layers(&d->model, &d->operators, &d->state, sums);
    for (int k = 0; k < count; k++) {
        r->layer_name[k] = r->layer_names + k * SF_MATERIAL_NAME_SIZE;
        snprintf(r->layer_name[k], SF_MATERIAL_NAME_SIZE, "%s", m->material[k].name);
        r->layer_density[k] = sf_material_density(&m->material[k]);
        r->layer_informed[k] = sf_material_informed(&m->material[k]);
    }
    for (int k = 0; k < SF_LAYER_SUMS; k++)
        r->layer_sum[k] = copy_of(&sums[k * count], count, sizeof *sums, err);
    return err->status;
}

static void add_note(void *results, sf_severity severity, const char *sentence) {
    (void)severity;
    sf_results_note_run(results, sentence);
}

/* The failure, or one word for the way a drop ended. */
static const char *ending_of(const sf_drop *d) {
    if (d->failure.status != SF_OK)
        return d->failure.text;
    return d->ending == SF_DROP_REBOUND ? "rebound" : "finished";
}

/* Tells how the drop ended; of one that goes on the results have no summary, as those of a run that was
 * killed. */
static void take_summary(const sf_drop *d, sf_results *r) {
    const sf_extremes extremes = sf_recorder_extremes(&d->recorder);
    const sf_sink sink = {add_note, r};
    double set[2] = {NAN, NAN};
    if (d->model.set)
        sf_set_measure(&d->model, set);
    r->has_summary = d->keeps && (d->ending != SF_DROP_RUNS || d->failure.status != SF_OK);
    r->contact_time = d->state.missile.contact_time;
    r->wall_time = d->wall_time;
    r->given_back = sf_model_whole(&d->undeformed) * d->state.given_back;
    r->vibration = sf_model_whole(&d->undeformed) * d->state.vibration;
    r->set = set[0];
    r->set_largest = set[1];
    r->steps = d->state.step;
    r->threads = omp_get_max_threads();
    r->interactions = d->model.domain_nnz;
    if (!r->has_summary)
        return;
    snprintf(r->status, sizeof r->status, "%.511s", ending_of(d));
    sf_run_tell_all(&d->model, &d->state, &extremes, &sink);
    if (d->failure.status != SF_OK)
        sf_results_note(r, "the run stopped with: %s", r->status);
}

/* The frames of a drop whose frames nobody wants: the first and the last. */
static sf_status take_frames(const sf_drop *d, sf_results *r, sf_error *err) {
    sf_kept last = d->last; /* the same arrays */
    r->frame_count = 2;
    r->frames = sf_alloc(err, 2, sizeof *r->frames, "frames");
    SF_TRY(err->status);
    take_kept(d, &last);
    r->frames[0] = d->first.head;
    r->frames[1] = last.head;
    r->peak = d->peak.head;
    r->frames[0].field = d->first.field;
    r->frames[1].field = d->last.field;
    r->peak.field = d->peak.field;
    r->has_peak = true;
    return SF_OK;
}

sf_status sf_drop_results(const sf_drop *d, sf_results *r, sf_error *err) {
    const int64_t rows = d->recorder.history.rows;
    take_numbers(&d->undeformed, r);
    if (rows < 3 && d->failure.status != SF_OK)
        return SF_FAIL(err, d->failure.status, "%s", d->failure.text);
    if (rows < 3)
        return SF_REFUSE(err, "the drop has %lld steps" SF_AT_LEAST("3"), (long long)rows);
    r->history = d->recorder.history;
    take_summary(d, r);
    if (!d->keeps) {
        r->position = copy_of(d->undeformed.position, 3 * r->node_count, sizeof *r->position, err);
        r->volume = copy_of(d->undeformed.volume, r->node_count, sizeof *r->volume, err);
        return err->status;
    }
    SF_TRY(take_arrays(&d->undeformed, r, err));
    SF_TRY(take_layers(d, r, err));
    SF_TRY(take_frames(d, r, err));
    return r->axisymmetric ? sf_results_revolve(r, err) : SF_OK;
}

void sf_drop_results_free(sf_results *r) {
    r->history = (sf_history){0};
    sf_results_close(r);
}
