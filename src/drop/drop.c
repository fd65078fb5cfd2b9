/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drop/drop.h"

#include "model/flight.h"
#include "solver/set.h"
#include "solver/step.h"

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
    free(d->model.set);
}

void sf_drop_step(sf_drop *d) {
    if (d->recorder.history.rows > 0)
        sf_step_advance(&d->model, &d->state);
    if (sf_step_evaluate(&d->model, &d->operators, &d->state, &d->failure) != SF_OK ||
        sf_recorder_add(&d->recorder, &d->model, &d->state, &d->failure) != SF_OK)
        return;
    if (sf_ending_on_anvil(&d->model, &d->state))
        sf_ending_fail_on_anvil(&d->model, &d->state, &d->failure);
    else if (sf_ending_rebounded(&d->model, &d->state))
        d->ending = SF_DROP_REBOUND;
    else
        d->ending = sf_ending_finished(&d->model, &d->state) ? SF_DROP_FINISHED : SF_DROP_RUNS;
}

sf_status sf_drop_results(const sf_drop *d, sf_results *r, sf_error *err) {
    const sf_model *m = &d->undeformed;
    double lock_begin, lock_up = sf_model_lock_up(m, &lock_begin), set[2] = {NAN, NAN};
    if (d->model.set)
        sf_set_measure(&d->model, set);
    *r = (sf_results){.node_count = m->node_count,
                      .position = m->position,
                      .set = set[0],
                      .set_largest = set[1],
                      .volume = m->volume,
                      .symmetry_factor = m->symmetry_factor,
                      .thickness = m->thickness,
                      .informed_strain = sf_model_informed_strain(m),
                      .expected_mesh_error = m->expected_mesh_error > 0 ? m->expected_mesh_error : NAN,
                      .slit_fraction = m->slit_fraction,
                      .section = m->section,
                      .anvil_depth = m->anvil.depth,
                      .density = sf_model_density(m),
                      .given_back = sf_model_whole(m) * d->state.given_back,
                      .vibration = sf_model_whole(m) * d->state.vibration,
                      .air = m->air,
                      .speed_scatter = m->run.speed_scatter,
                      .thickness_tolerance = m->run.thickness_tolerance,
                      .lock_up = lock_up,
                      .lock_begin = lock_begin,
                      .impact_x = m->missile.impact_known ? m->missile.impact[0] : NAN,
                      .impact_y = m->missile.impact_known ? m->missile.impact[1] : NAN,
                      .missile_mass = m->missile.mass,
                      .missile_speed = m->missile.speed,
                      .gravity_along = sf_flight_pull(&m->missile),
                      .kinematic = m->run.kinematic != 0,
                      .driven = sf_missile_is_driven(m),
                      .history = d->recorder.history};
    sf_flight_gravity(&m->missile, r->gravity);
    if (r->history.rows < 3)
        return SF_REFUSE(err, "the drop has %lld steps" SF_AT_LEAST("3"), (long long)r->history.rows);
    return SF_OK;
}
