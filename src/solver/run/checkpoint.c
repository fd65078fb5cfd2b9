/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/run.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

/* The state: everything that the next step needs, bit by bit. */

static bool is_kept(const sf_model *m, const sf_state_array *a) {
    return a->name && sf_state_rows(m, a->rows) > 0;
}

static void name_array(const sf_model *m, const sf_state_array *a, char path[64], int64_t dims[2]) {
    snprintf(path, 64, "/state/%s", a->name);
    dims[0] = sf_state_rows(m, a->rows);
    dims[1] = a->bytes / (int)sizeof(double);
}

static sf_status write_state(const sf_model *m, const sf_state *s, sf_h5 *file, sf_error *err) {
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

static sf_status read_state(const sf_model *m, sf_state *s, const sf_h5 *file, sf_error *err) {
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

static const char FORMAT[] = "softfall-checkpoint";

sf_status sf_checkpoint_write(const sf_output *o, const sf_provenance *provenance, const sf_model *m,
                              const sf_state *s, const sf_recorder *r, sf_error *err) {
    static const sf_h5_info end = {"/end_time", "s", "end of the simulated time"},
                            before = {"/time_before", "s", "of the step before the one held"};
    char partial[SF_PATH_SIZE];
    sf_h5 *file = NULL;
    if (sf_replace_begin(o->checkpoint, partial, err) != SF_OK || sf_h5_create(partial, &file, err) != SF_OK)
        return err->status;
    if (sf_provenance_write(file, FORMAT, provenance, err) == SF_OK &&
        sf_h5_write_scalar(file, &end, m->run.end_time, err) == SF_OK &&
        sf_h5_write_scalar(file, &before, s->time - s->dt_old, err) == SF_OK &&
        write_state(m, s, file, err) == SF_OK && sf_recorder_write(r, file, err) == SF_OK)
        sf_output_copy_peak(o, file, err);
    return sf_output_seal(&file, partial, o->checkpoint, err);
}

sf_status sf_checkpoint_open(const char *path, sf_checkpoint *c, sf_error *err) {
    memset(c, 0, sizeof *c);
    if (access(path, F_OK) != 0)
        return SF_FAIL(err, SF_ERR_IO,
                       "there is no checkpoint %s to resume from (%s): start a new run with --force", path,
                       strerror(errno));
    if (sf_seal_check(path, err) != SF_OK || sf_h5_open_alone(path, &c->file, err) != SF_OK)
        return err->status;
    c->path = strdup(path);
    if (!c->path)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory opening %s", path);
    if (err->status != SF_OK || sf_provenance_check(c->file, path, FORMAT, err) != SF_OK ||
        sf_h5_read_text(c->file, "/provenance/model_path", &c->model_path, err) != SF_OK ||
        sf_h5_read_text(c->file, "/provenance/model_hash", &c->model_hash, err) != SF_OK ||
        sf_h5_read_text(c->file, "/provenance/git_revision", &c->git_revision, err) != SF_OK ||
        sf_h5_read_text(c->file, "/provenance/compiler_flags", &c->compiler_flags, err) != SF_OK ||
        sf_h5_read_scalar(c->file, "/end_time", &c->end_time, err) != SF_OK ||
        sf_h5_read_scalar(c->file, "/time_before", &c->time_before, err) != SF_OK)
        sf_checkpoint_close(c);
    return err->status;
}

void sf_checkpoint_close(sf_checkpoint *c) {
    sf_h5_drop(&c->file);
    SF_FREE(c->path, c->model_path, c->model_hash, c->git_revision, c->compiler_flags);
    memset(c, 0, sizeof *c);
}

sf_status sf_checkpoint_read(const sf_checkpoint *c, const sf_model *m, const sf_output *o, sf_state *s,
                             sf_recorder *r, sf_error *err) {
    if (read_state(m, s, c->file, err) != SF_OK || sf_recorder_read(r, m, s, c->file, err) != SF_OK)
        return err->status;
    return sf_output_recover_peak(o, c->file, err);
}
