/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run.h"

#include "core/mat3.h"
#include "solver/frame.h"
#include "solver/history.h"
#include "solver/ledger.h"
#include "solver/step.h"
#include <math.h>
#include <stdlib.h>
#include <time.h>

static const double PEAK_GROWTH = 1.001;   /* of the acceleration from one kept maximum to the next */
static const double REBOUND_WAIT = 1e-3;   /* s, without contact before the run may end */
static const double PROGRESS_INTERVAL = 5; /* s of wall time between plain lines */

/* What a run carries from step to step beside the state. */
typedef struct recorder {
    sf_history *history;
    sf_snapshot peak;
    double peak_kept; /* the run's peak_value that `peak` follows */
    int64_t frames;
    double next_frame;       /* s */
    int64_t next_extra;      /* index in model->frame_time */
    double start, last_line; /* s, wall clock */
} recorder;

static double wall_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* What a run is watched for: deceleration, or the contact force on a missile whose motion is prescribed. */
static double peak_measure(const sf_model *m, const sf_state *s) {
    return m->motion_count > 0 ? -(double)m->symmetry_factor * sf_dot3(s->missile.force, m->missile.direction)
                               : -s->missile.acceleration;
}

static void print_progress(const sf_model *m, const sf_state *s, sf_run *run, recorder *r, bool last) {
    double now = wall_clock(), interval = run->terminal ? 0.2 : PROGRESS_INTERVAL;
    if (!last && now - r->last_line < interval)
        return;
    r->last_line = now;
    double done = s->time / m->run.end_time, spent = now - r->start;
    bool driven = m->motion_count > 0;
    fprintf(
        run->log,
        "%st %7.3f / %.3g ms  step %6lld  dt %6.2f us  %s %6.1f %s  indentation %5.1f mm  compression %.3f  "
        "energy %+.3f %%",
        run->terminal ? "\r" : "", 1e3 * s->time, 1e3 * m->run.end_time, (long long)s->step, 1e6 * s->dt,
        driven ? "force" : "a", peak_measure(m, s) / (driven ? 1 : 9.80665), driven ? "N" : "g",
        1e3 * (s->missile.displacement - m->missile.gap), s->largest_compression, 100 * s->ledger.error);
    if (done > 0 && !last)
        fprintf(run->log, "  left <= %.0f s  ", spent * (1 - done) / done);
    if (!run->terminal || last)
        fputc('\n', run->log);
    fflush(run->log);
}

static sf_status write_frame(const sf_model *m, const sf_operators *op, const sf_state *s, recorder *r,
                             sf_h5 *file, sf_error *err) {
    char path[32];
    snprintf(path, sizeof path, "/frames/%06lld", (long long)r->frames++);
    if (sf_frame_write(m, op, s, path, file, err) != SF_OK ||
        sf_history_write(r->history, file, err) != SF_OK)
        return err->status;
    return sf_h5_flush(file, err);
}

/* Extremes over the run, and the fields at its peak. */
static void watch(const sf_model *m, const sf_operators *op, const sf_state *s, sf_run *run, recorder *r) {
    double whole = (double)m->symmetry_factor, internal = whole * sf_ledger_internal(&s->ledger);
    double value = peak_measure(m, s);
    run->largest_compression = fmax(run->largest_compression, s->largest_compression);
    run->largest_indentation =
        fmax(run->largest_indentation, -m->missile.direction[2] * (s->missile.displacement - m->missile.gap));
    run->largest_penetration = fmax(run->largest_penetration, s->penetration);
    run->largest_residual = fmax(run->largest_residual, s->constraint_residual);
    run->largest_momentum = fmax(run->largest_momentum, fabs(s->ledger.momentum_error));
    if (internal > run->peak_internal) {
        run->peak_internal = internal;
        run->stabilisation_share = whole * s->ledger.stabilisation / internal;
        run->contact_share = whole * s->ledger.contact / internal;
    }
    if (value > run->peak_value) {
        run->peak_value = value;
        run->peak_time = s->time;
    } else if (run->peak_value > PEAK_GROWTH * r->peak_kept) { /* one step past a maximum */
        r->peak_kept = run->peak_value;
        sf_snapshot_take(m, op, s, &r->peak);
    }
}

/* Has the missile left the pad for good? A driven one may come back. */
static bool has_rebounded(const sf_model *m, const sf_state *s) {
    return m->motion_count == 0 && m->run.stop_after_rebound && s->missile.velocity < 0 &&
           s->contact_count == 0 && s->time - s->missile.release_time > REBOUND_WAIT;
}

/* Is a frame due? Advances both schedules past the present time. */
static bool frame_is_due(const sf_model *m, const sf_state *s, recorder *r) {
    bool due = false;
    for (; s->time >= r->next_frame; r->next_frame += m->run.frame_interval)
        due = true;
    for (; r->next_extra < m->frame_time_count && s->time >= m->frame_time[r->next_extra]; r->next_extra++)
        due = true;
    return due;
}

static sf_status run_steps(const sf_model *m, const sf_operators *op, sf_state *s, sf_run *run, recorder *r,
                           sf_h5 *file, sf_error *err) {
    for (;;) {
        if (sf_step_evaluate(m, op, s, err) != SF_OK) {
            run->ending = "failed";
            return err->status;
        }
        watch(m, op, s, run, r);
        if (sf_history_add(r->history, m, s, file, err) != SF_OK)
            return err->status;
        bool end = s->time >= m->run.end_time, rebound = has_rebounded(m, s), stop = *run->stop != 0;
        if ((frame_is_due(m, s, r) || end || rebound || stop) && write_frame(m, op, s, r, file, err) != SF_OK)
            return err->status;
        print_progress(m, s, run, r, end || rebound || stop);
        if (end || rebound || stop) {
            run->ending = stop ? "interrupted" : rebound ? "rebound" : "finished";
            return stop ? SF_FAIL(err, SF_INTERRUPTED,
                                  "interrupted at t = %.6g s; results up to there are readable", s->time)
                        : SF_OK;
        }
        sf_step_advance(m, s);
    }
}

static sf_status write_scalar(sf_h5 *file, const char *path, const char *units, const char *text,
                              double value, sf_error *err) {
    sf_h5_info info = {path, units, text};
    return sf_h5_write_scalar(file, &info, value, err);
}

static sf_status write_count(sf_h5 *file, const char *path, const char *text, int64_t value, sf_error *err) {
    sf_h5_info info = {path, "1", text};
    return sf_h5_write(file, &info, SF_H5_I64, 0, NULL, &value, err);
}

static sf_status write_summary(const sf_model *m, const sf_state *s, const sf_run *run, const char *status,
                               sf_h5 *file, sf_error *err) {
    sf_h5_info info = {"/summary/status", "1", "how the run ended"};
    if (sf_h5_write_text(file, &info, status, err) != SF_OK ||
        write_count(file, "/summary/steps", "time steps", s->step, err) != SF_OK ||
        write_count(file, "/summary/threads", "OpenMP threads", run->threads, err) != SF_OK ||
        write_count(file, "/summary/nodes", "nodes", m->node_count, err) != SF_OK ||
        write_count(file, "/summary/interactions", "(domain, node) pairs", m->domain_nnz, err) != SF_OK ||
        write_count(file, "/summary/power_iterations", "spent on the time step", s->power_iterations, err) !=
            SF_OK ||
        write_scalar(file, "/summary/wall_time", "s", "time of the run", run->wall_time, err) != SF_OK)
        return err->status;
    return write_scalar(file, "/summary/contact_time", "s", "first contact, NaN if none",
                        s->missile.contact_time, err);
}

sf_status sf_run_drop(const sf_model *m, const sf_operators *op, sf_state *s, sf_run *run, sf_h5 *file,
                      sf_error *err) {
    recorder r = {.start = wall_clock()};
    sf_error late = SF_ERROR_INIT;
    r.history = sf_alloc(err, 1, sizeof *r.history, "history");
    if (err->status != SF_OK || sf_snapshot_create(m, &r.peak, err) != SF_OK ||
        sf_history_create(file, err) != SF_OK)
        goto done;
    run_steps(m, op, s, run, &r, file, err);
    run->wall_time = wall_clock() - r.start;
    /* Whatever ended the run, what it found so far is written; the first failure stays the one reported. */
    if (err->status == SF_ERR_NUMERIC)
        write_frame(m, op, s, &r, file, &late);
    if (err->status == SF_OK || err->status == SF_ERR_NUMERIC || err->status == SF_INTERRUPTED) {
        if (run->peak_value > PEAK_GROWTH * r.peak_kept) /* it was still rising */
            sf_snapshot_take(m, op, s, &r.peak);
        sf_history_write(r.history, file, &late);
        sf_snapshot_write(m, &r.peak, "/peak", file, &late);
        write_summary(m, s, run, err->status == SF_ERR_NUMERIC ? err->text : run->ending, file, &late);
        if (late.status != SF_OK)
            SF_FAIL(err, late.status, "%s", late.text);
    }
done:
    free(r.history);
    sf_snapshot_free(&r.peak);
    return err->status;
}
