/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/recorder.h"

#include "base/mat3.h"
#include "io/h5_members.h"
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
    if (sf_missile_is_driven(m))
        return sf_model_whole(m) * sf_missile_contact_force(m, &s->missile);
    if (!sf_missile_turns(m))
        return sf_missile_reading(m, &s->missile);
    const double *force = s->missile.force;
    return sqrt(sf_dot3(force, force)) / m->missile.mass;
}

/* The least of the last three rows, as sf_history_lasting. */
static double lasting_resultant(const sf_history *h) {
    double least = INFINITY;
    for (int64_t i = h->rows - 3; i < h->rows; i++)
        least = fmin(least, i < 0 ? 0 : sf_history_resultant(h, i));
    return least;
}

static double lasting_value(const sf_model *m, const sf_history *h) {
    if (sf_missile_turns(m))
        return lasting_resultant(h);
    return sf_history_lasting(sf_missile_is_driven(m) ? h->contact_force : h->acceleration, h->rows - 1);
}

sf_extremes sf_recorder_extremes(const sf_recorder *r) {
    const sf_history *h = &r->history;
    sf_internal_energy internal = {0};
    if (h->rows > 0)
        internal = sf_history_internal_energy(h);
    bool any = internal.peak > 0;
    return (sf_extremes){
        .peak_value = r->peak_value,
        .peak_time = r->peak_time,
        .largest_compression = sf_history_largest(h, h->largest_compression),
        .largest_indentation = sf_history_largest(h, h->indentation),
        .bare_at_deepest = h->rows > 0 && h->contact_nodes[sf_history_row_of_largest(h, h->indentation)] == 0,
        .largest_penetration = sf_history_largest(h, h->penetration),
        .largest_residual = sf_history_largest(h, h->constraint_residual),
        .largest_momentum = sf_history_largest(h, h->momentum_error),
        .peak_internal = internal.peak,
        .stabilisation_share = any ? internal.stabilisation : 0,
        .contact_share = any ? internal.contact : 0};
}

sf_status sf_recorder_add(sf_recorder *r, const sf_model *m, const sf_state *s, sf_error *err) {
    sf_history *h = &r->history;
    if (sf_history_add(h, m, s, err) != SF_OK)
        return err->status;
    double value = lasting_value(m, h);
    if (value > r->peak_value) {
        r->peak_value = value;
        r->peak_time = s->time;
    }
    return SF_OK;
}

static bool has_grown(const sf_recorder *r) {
    return r->peak_value > PEAK_GROWTH * r->peak_kept;
}

bool sf_recorder_peak_due(sf_recorder *r, const sf_state *s) {
    bool due = has_grown(r) && s->time > r->peak_time;
    if (due)
        r->peak_kept = r->peak_value;
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
#define NUMBER(type, name, size, units, meaning) SF_MEMBER(sf_recorder, name, type, units, meaning),
    SF_RECORDER_NUMBERS(NUMBER)
#undef NUMBER
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
