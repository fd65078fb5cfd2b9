/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/recorder.h"

#include "base/mat3.h"
#include "io/h5_data.h"

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

/* The least of the last three rows, as sf_history_sustained. */
static double lasting_resultant(const sf_history *h) {
    double least = INFINITY;
    for (int64_t i = h->rows - 3; i < h->rows; i++)
        least = fmin(least, i < 0 ? 0 : sf_history_resultant(h, i));
    return least;
}

static double lasting_value(const sf_model *m, const sf_history *h) {
    if (sf_missile_turns(m))
        return lasting_resultant(h);
    return sf_history_sustained(sf_missile_is_driven(m) ? h->contact_force : h->acceleration, h->rows - 1);
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

/* The dataset of column k; its path is in `path`. */
static sf_h5_info dataset(int k, char path[64]) {
    const sf_history_column *column = sf_history_column_get(k);
    snprintf(path, 64, "/history/%s", column->name);
    return (sf_h5_info){path, column->units, column->description};
}

/* Into an empty history. */
static sf_status read_history(sf_history *h, const sf_h5 *file, sf_error *err) {
    int64_t rows = -1;
    for (int k = 0; k < SF_HISTORY_COUNT; k++) {
        char path[64];
        void *data = NULL;
        if (sf_h5_read(file, dataset(k, path).path, SF_H5_F64, 1, &rows, &data, err) != SF_OK) {
            sf_history_free(h);
            return err->status;
        }
        h->column[k] = data;
    }
    h->rows = h->room = rows;
    return SF_OK;
}

sf_status sf_recorder_read(sf_recorder *r, const sf_model *m, const sf_state *s, const sf_h5 *file,
                           sf_error *err) {
    SF_TRY(sf_members_read(file, "/recorder", members, MEMBERS, r, err));
    SF_TRY(read_history(&r->history, file, err));
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

enum { FIRST_ROWS = 4096 };

/* Area (m2) of the undeformed surface whose points have a contact force, of the modelled part. */
static double area_in_contact(const sf_model *m, const sf_state *s) {
    double area = 0;
    const double *load = sf_state_load(m, s);
    for (int64_t n = 0; n < s->contact.close_count; n++) {
        int64_t k = s->contact.close[n];
        if (!sf_model_point_rests(m, k) && sf_dot3(&load[3 * k], &load[3 * k]) > 0)
            area += m->contact_area[k];
    }
    return area;
}

/* The value of each column of model/columns.h. m: the model; s: the state after sf_step_evaluate; whole:
 * modelled parts that make the whole. */
#define VALUE(name, value)                                                                                   \
    static double name##_now(const sf_model *m, const sf_state *s, double whole) {                           \
        (void)m, (void)s, (void)whole;                                                                       \
        return value;                                                                                        \
    }

/* The components of a member of sf_missile_motion. */
#define MOTION(name)                                                                                         \
    VALUE(name##_x, sf_missile_read(m, &s->missile).name[0])                                                 \
    VALUE(name##_y, sf_missile_read(m, &s->missile).name[1])                                                 \
    VALUE(name##_z, sf_missile_read(m, &s->missile).name[2])

/* clang-format off */
VALUE(time, s->time)
VALUE(acceleration, sf_missile_reading(m, &s->missile))
VALUE(velocity, s->missile.velocity_now)
VALUE(displacement, s->missile.displacement)
VALUE(indentation, fmax(0, sf_missile_depth(m, &s->missile)))
VALUE(contact_force, whole * sf_missile_contact_force(m, &s->missile))
VALUE(friction_force, whole * s->missile.friction)
VALUE(base_reaction, whole * s->base_reaction[2])
VALUE(support_force_1, whole * s->support_force[0])
VALUE(support_force_2, whole * s->support_force[1])
VALUE(support_force_3, whole * s->support_force[2])
VALUE(support_force_4, whole * s->support_force[3])
VALUE(energy_kinetic_missile, whole * s->ledger.kinetic_missile)
VALUE(energy_kinetic_pad, whole * s->ledger.kinetic_pad)
VALUE(energy_stored, whole * s->ledger.stored)
VALUE(energy_hysteresis, whole * s->ledger.hysteresis)
VALUE(energy_viscous, whole * s->ledger.viscous)
VALUE(energy_stabilisation, whole * s->ledger.stabilisation)
VALUE(energy_contact, whole * s->ledger.contact)
VALUE(energy_friction, whole * s->ledger.friction)
VALUE(energy_external, whole * s->ledger.external)
VALUE(energy_weight, whole * s->ledger.weight)
VALUE(energy_anvil, whole * s->ledger.anvil)
VALUE(energy_error, s->ledger.error)
VALUE(momentum_error, s->ledger.momentum_error)
MOTION(translation)
VALUE(quaternion_w, s->missile.quaternion[0])
VALUE(quaternion_x, s->missile.quaternion[1])
VALUE(quaternion_y, s->missile.quaternion[2])
VALUE(quaternion_z, s->missile.quaternion[3])
MOTION(velocity)
MOTION(specific_force)
MOTION(angular_velocity)
MOTION(angular_acceleration)
VALUE(momentum_error_space, s->ledger.vector_error)
VALUE(angular_momentum_error, s->ledger.angular_error)
VALUE(largest_compression, s->largest_compression)
VALUE(smallest_jacobian, s->smallest_jacobian)
VALUE(contact_nodes, (double)s->contact_count)
VALUE(anvil_nodes, (double)s->anvil_count)
VALUE(contact_area, whole * area_in_contact(m, s))
VALUE(penetration, s->penetration)
VALUE(constraint_residual, s->constraint_residual)
VALUE(time_step, s->dt)
/* clang-format on */

typedef double (*value_of)(const sf_model *m, const sf_state *s, double whole);
#define NOW(name, ...) name##_now,
static const value_of values[SF_HISTORY_COUNT] = {SF_HISTORY_COLUMNS(NOW)};

/* Room for one row more. */
static sf_status grow(sf_history *h, sf_error *err) {
    if (h->rows < h->room)
        return SF_OK;
    int64_t room = h->room > 0 ? 2 * h->room : FIRST_ROWS;
    for (int k = 0; k < SF_HISTORY_COUNT; k++) {
        double *grown = realloc(h->column[k], (size_t)room * sizeof *grown);
        if (!grown)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a history of %lld rows", (long long)room);
        h->column[k] = grown;
    }
    h->room = room;
    return SF_OK;
}

static sf_status add_row(sf_history *h, const sf_model *m, const sf_state *s, sf_error *err) {
    double whole = sf_model_whole(m);
    SF_TRY(grow(h, err));
    for (int k = 0; k < SF_HISTORY_COUNT; k++)
        h->column[k][h->rows] = values[k](m, s, whole);
    h->rows++;
    return SF_OK;
}

sf_status sf_recorder_add(sf_recorder *r, const sf_model *m, const sf_state *s, sf_error *err) {
    sf_history *h = &r->history;
    SF_TRY(add_row(h, m, s, err));
    double value = lasting_value(m, h);
    if (value > r->peak_value) {
        r->peak_value = value;
        r->peak_time = s->time;
    }
    return SF_OK;
}

sf_status sf_history_write(const sf_history *h, sf_h5 *file, sf_error *err) {
    for (int k = 0; k < SF_HISTORY_COUNT; k++) {
        char path[64];
        sf_h5_info info = dataset(k, path);
        SF_TRY(sf_h5_write(file, &info, SF_H5_F64, 1, &h->rows, h->column[k], err));
    }
    return SF_OK;
}
