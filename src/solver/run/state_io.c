/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/state_io.h"

#include "io/members.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const sf_member members[] = {
#define NUMBER(member, units)                                                                                \
    { #member, units, SF_H5_F64, 1, offsetof(sf_state, member) }
#define COUNT(member)                                                                                        \
    { #member, "1", SF_H5_I64, 1, offsetof(sf_state, member) }
    COUNT(step),
    NUMBER(time, "s"),
    NUMBER(dt, "s"),
    NUMBER(dt_old, "s"),
    NUMBER(tightness, "1"),
    {"missile_old", "m", SF_H5_F64, 1, offsetof(sf_state, missile.displacement_old)},
    COUNT(contact_count),
    NUMBER(penetration, "m"),
    COUNT(contact_unsettled),
    NUMBER(missile.displacement, "m"),
    NUMBER(missile.velocity, "m s-1"),
    NUMBER(missile.velocity_now, "m s-1"),
    NUMBER(missile.acceleration, "m s-2"),
    {"missile.force", "N", SF_H5_F64, 3, offsetof(sf_state, missile.force)},
    NUMBER(missile.friction, "N"),
    NUMBER(missile.contact_time, "s"),
    NUMBER(missile.release_time, "s"),
    NUMBER(ledger.kinetic_missile, "J"),
    NUMBER(ledger.kinetic_pad, "J"),
    NUMBER(ledger.stored, "J"),
    NUMBER(ledger.hysteresis, "J"),
    NUMBER(ledger.viscous, "J"),
    NUMBER(ledger.stabilisation, "J"),
    NUMBER(ledger.contact, "J"),
    NUMBER(ledger.friction, "J"),
    NUMBER(ledger.external, "J"),
    NUMBER(ledger.reference, "J"),
    NUMBER(ledger.stabilisation_drift, "J"),
    NUMBER(ledger.error, "1"),
    NUMBER(ledger.largest_error, "1"),
    NUMBER(ledger.momentum_reference, "kg m s-1"),
    NUMBER(ledger.impulse, "N s"),
    NUMBER(ledger.momentum_error, "1"),
    {"base_reaction", "N", SF_H5_F64, 3, offsetof(sf_state, base_reaction)},
    NUMBER(constraint_residual, "m s-1"),
    NUMBER(largest_compression, "1"),
    NUMBER(smallest_jacobian, "1"),
    COUNT(jacobian_node),
    NUMBER(bound_step, "s"),
    NUMBER(bound_load, "s-2"),
    COUNT(measured_at),
    NUMBER(measured_load, "s-2"),
    NUMBER(ceiling, "s"),
    COUNT(power_iterations),
#undef NUMBER
#undef COUNT
};
enum { MEMBERS = sizeof members / sizeof members[0] };

static bool is_kept(const sf_model *m, const sf_state_array *a) {
    return a->name && sf_state_rows(m, a->rows) > 0;
}

static void name_array(const sf_model *m, const sf_state_array *a, char path[64], int64_t dims[2]) {
    snprintf(path, 64, "/state/%s", a->name);
    dims[0] = sf_state_rows(m, a->rows);
    dims[1] = a->bytes / (int)sizeof(double);
}

sf_status sf_state_write(const sf_model *m, const sf_state *s, sf_h5 *file, sf_error *err) {
    size_t count;
    const sf_state_array *array = sf_state_arrays(&count);
    sf_members_write(file, "/state", members, MEMBERS, s, err);
    for (size_t k = 0; k < count && err->status == SF_OK; k++) {
        char path[64];
        int64_t dims[2];
        if (!is_kept(m, &array[k]))
            continue;
        name_array(m, &array[k], path, dims);
        sf_h5_info info = {path, "1", "SI units, sf_state in src/solver/state.h"};
        sf_h5_write(file, &info, SF_H5_F64, 2, dims, *(void *const *)((const char *)s + array[k].offset),
                    err);
    }
    return err->status;
}

/* Numbers that loops and indices depend on. */
static sf_status check(const sf_model *m, const sf_state *s, sf_error *err) {
    if (s->step < 0 || s->measured_at < 0 || s->measured_at > s->step || s->jacobian_node < 0 ||
        s->jacobian_node >= m->node_count || !(s->time >= 0) || !(s->dt > 0) || !isfinite(s->time + s->dt))
        return SF_FAIL(err, SF_ERR_IO,
                       "the checkpoint's state is not possible: step %lld, t = %g s, dt = %g s, node %lld",
                       (long long)s->step, s->time, s->dt, (long long)s->jacobian_node);
    return SF_OK;
}

sf_status sf_state_read(const sf_model *m, sf_state *s, const sf_h5 *file, sf_error *err) {
    size_t count;
    const sf_state_array *array = sf_state_arrays(&count);
    sf_members_read(file, "/state", members, MEMBERS, s, err);
    for (size_t k = 0; k < count && err->status == SF_OK; k++) {
        char path[64];
        int64_t dims[2];
        void *data = NULL;
        if (!is_kept(m, &array[k]))
            continue;
        name_array(m, &array[k], path, dims);
        if (sf_h5_read(file, path, SF_H5_F64, 2, dims, &data, err) != SF_OK)
            break;
        void **mine = (void **)((char *)s + array[k].offset);
        free(*mine);
        *mine = data;
    }
    return err->status == SF_OK ? check(m, s, err) : err->status;
}
