/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/state_io.h"

#include "io/h5_members.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const sf_member members[] = {
#define NUMBER(type, name, size, units, meaning) SF_MEMBER(sf_state, name, type, units, meaning),
#define OF_MISSILE(type, name, size, units, meaning) SF_MEMBER(sf_state, missile.name, type, units, meaning),
#define OF_LEDGER(type, name, size, units, meaning) SF_MEMBER(sf_state, ledger.name, type, units, meaning),
    SF_STATE_NUMBERS(NUMBER) SF_MISSILE_NUMBERS(OF_MISSILE) SF_LEDGER_NUMBERS(OF_LEDGER)
#undef NUMBER
#undef OF_MISSILE
#undef OF_LEDGER
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
