/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drops: created, and advanced in time. */
#include "api/api_drop.h"

#include "solver/run/ending.h"
#include "solver/step.h"
#include <math.h>
#include <omp.h>
#include <stdlib.h>

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
    if (sf_model_check(&d->model, &err) == SF_OK &&
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
