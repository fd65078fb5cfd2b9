/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/recorder.h"

#include "io/members.h"
#include "solver/ledger.h"
#include <math.h>
#include <stddef.h>
#include <string.h>

static const double PEAK_GROWTH = 1.001; /* of the acceleration from one kept maximum to the next */

void sf_recorder_begin(sf_recorder *r) {
    memset(r, 0, sizeof *r);
    r->frame_step = -1;
}

void sf_recorder_free(sf_recorder *r) {
    sf_history_free(&r->history);
    memset(r, 0, sizeof *r);
}

double sf_recorder_measure(const sf_model *m, const sf_state *s) {
    return sf_missile_is_driven(m) ? sf_model_whole(m) * sf_missile_contact_force(m, &s->missile)
                                   : sf_missile_deceleration(m, &s->missile);
}

static void watch(sf_extremes *x, const sf_model *m, const sf_state *s) {
    double whole = sf_model_whole(m), internal = whole * sf_ledger_internal(&s->ledger);
    x->largest_compression = fmax(x->largest_compression, s->largest_compression);
    x->largest_indentation = fmax(x->largest_indentation, sf_missile_depth(m, &s->missile));
    x->largest_penetration = fmax(x->largest_penetration, s->penetration);
    x->largest_residual = fmax(x->largest_residual, s->constraint_residual);
    x->largest_momentum = fmax(x->largest_momentum, fabs(s->ledger.momentum_error));
    if (internal > x->peak_internal) {
        x->peak_internal = internal;
        x->stabilisation_share = whole * s->ledger.stabilisation / internal;
        x->contact_share = whole * s->ledger.contact / internal;
    }
}

sf_status sf_recorder_add(sf_recorder *r, const sf_model *m, const sf_state *s, sf_error *err) {
    double value = sf_recorder_measure(m, s);
    watch(&r->extremes, m, s);
    if (value > r->extremes.peak_value) {
        r->extremes.peak_value = value;
        r->extremes.peak_time = s->time;
    }
    return sf_history_add(&r->history, m, s, err);
}

static bool has_grown(const sf_recorder *r) {
    return r->extremes.peak_value > PEAK_GROWTH * r->peak_kept;
}

bool sf_recorder_peak_due(sf_recorder *r, const sf_state *s) {
    bool due = has_grown(r) && s->time > r->extremes.peak_time;
    if (due)
        r->peak_kept = r->extremes.peak_value;
    return due || s->step == 0;
}

bool sf_recorder_peak_ahead(const sf_recorder *r) {
    return has_grown(r) || r->history.rows == 0;
}

bool sf_recorder_frame_due(sf_recorder *r, const sf_model *m, const sf_state *s) {
    bool due = false;
    for (; s->time >= r->next_frame; r->next_frame += m->run.frame_interval)
        due = true;
    for (; r->next_extra < m->frame_time_count && s->time >= m->frame_time[r->next_extra]; r->next_extra++)
        due = true;
    if (due) {
        r->frames++;
        r->frame_step = s->step;
    }
    return due;
}

static const sf_member members[] = {
#define NUMBER(member, units)                                                                                \
    { #member, units, SF_H5_F64, 1, offsetof(sf_recorder, member) }
#define COUNT(member)                                                                                        \
    { #member, "1", SF_H5_I64, 1, offsetof(sf_recorder, member) }
    NUMBER(extremes.peak_value, "1"),
    NUMBER(extremes.peak_time, "s"),
    NUMBER(extremes.largest_compression, "1"),
    NUMBER(extremes.largest_indentation, "m"),
    NUMBER(extremes.largest_penetration, "m"),
    NUMBER(extremes.largest_residual, "m s-1"),
    NUMBER(extremes.largest_momentum, "1"),
    NUMBER(extremes.peak_internal, "J"),
    NUMBER(extremes.stabilisation_share, "1"),
    NUMBER(extremes.contact_share, "1"),
    NUMBER(peak_kept, "1"),
    COUNT(frames),
    COUNT(frame_step),
    NUMBER(next_frame, "s"),
    COUNT(next_extra),
    NUMBER(wall_time, "s"),
    COUNT(restarts),
#undef NUMBER
#undef COUNT
};
enum { MEMBERS = sizeof members / sizeof members[0] };

sf_status sf_recorder_write(const sf_recorder *r, sf_h5 *file, sf_error *err) {
    sf_members_write(file, "/recorder", members, MEMBERS, r, err);
    return err->status == SF_OK ? sf_history_write(&r->history, file, err) : err->status;
}

sf_status sf_recorder_read(sf_recorder *r, const sf_model *m, const sf_state *s, const sf_h5 *file,
                           sf_error *err) {
    if (sf_members_read(file, "/recorder", members, MEMBERS, r, err) != SF_OK ||
        sf_history_read(&r->history, file, err) != SF_OK)
        return err->status;
    bool whole = r->history.rows == s->step + 1 && r->frames >= 0 && r->frames <= r->history.rows &&
                 r->next_frame > s->time && r->next_extra >= 0 && r->next_extra <= m->frame_time_count;
    if (!whole)
        return SF_FAIL(err, SF_ERR_IO,
                       "the checkpoint's record is not possible: %lld rows at step %lld, %lld frames, the "
                       "next at %g s after %g s",
                       (long long)r->history.rows, (long long)s->step, (long long)r->frames, r->next_frame,
                       s->time);
    return SF_OK;
}
