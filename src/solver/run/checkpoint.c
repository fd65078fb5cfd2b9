/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/checkpoint.h"

#include "io/h5_data.h"
#include "model/model_check.h"
#include "solver/contact/skin.h"
#include "solver/field/domain_stress.h"
#include "solver/set.h"
#include <errno.h>
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
    dims[1] = (int64_t)a->bytes / (int64_t)sf_h5_size(a->type);
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
        sf_h5_write(file, &info, array[k].type, 2, dims, *(void *const *)((const char *)s + array[k].offset),
                    err);
    }
    return err->status;
}

/* True if the model has what a point of the skin touches: nothing, a facet, the anvil or a symmetry plane. */
static bool is_partner(const sf_model *m, int64_t partner) {
    double place;
    switch (SF_FIRST_BODY - partner) {
    case SF_FIRST_BODY - SF_NO_PARTNER:
        return true;
    case SF_BODY_ANVIL:
        return m->anvil.depth > 0;
    case SF_BODY_SYMMETRY_X:
        return sf_symmetry_plane(m, 0, &place);
    case SF_BODY_SYMMETRY_Y:
        return sf_symmetry_plane(m, 1, &place);
    default:
        return partner >= 0 && partner < m->skin_count + m->support_triangle_count;
    }
}

/* Numbers that loops and indices depend on. */
static sf_status check(const sf_model *m, const sf_state *s, sf_error *err) {
    if (s->step < 0 || s->measured_at < 0 || s->measured_at > s->step || s->jacobian_node < 0 ||
        s->jacobian_node >= m->node_count || !(s->time >= 0) || !(s->dt > 0) || !isfinite(s->time + s->dt))
        return SF_FAIL(err, SF_ERR_IO,
                       "the checkpoint's state is not possible: step %lld, t = %g s, dt = %g s, node %lld",
                       (long long)s->step, s->time, s->dt, (long long)s->jacobian_node);
    for (int64_t p = 0; p < sf_state_rows(m, 's'); p++)
        if (!is_partner(m, s->skin.partner[p]))
            return SF_FAIL(
                err, SF_ERR_IO,
                "the checkpoint's state is not possible: point %lld touches facet or body %d, which is not there",
                (long long)p, s->skin.partner[p]);
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
        if (sf_h5_read(file, path, array[k].type, 2, dims, &data, err) != SF_OK)
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
    SF_CLEAR(c, c->path, c->model_path, c->model_hash, c->git_revision, c->compiler_flags);
}

sf_status sf_checkpoint_read(const sf_checkpoint *c, const sf_model *m, const sf_output *o, sf_state *s,
                             sf_recorder *r, sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    if (read_state(m, s, c->file, &inner) == SF_OK && sf_recorder_read(r, m, s, c->file, &inner) == SF_OK)
        return sf_output_recover_peak(o, c->file, err);
    s->step = 0; /* nothing of it has run */
    return SF_FAIL(err, inner.status,
                   "%.800s; a checkpoint of another version cannot be resumed: start a new run with --force",
                   inner.text);
}

/* ---- the pad of an earlier drop ---- */

/* The earlier run must have come to its end, and the missile off the pad. */
static sf_status check_ending(const sf_h5 *results, const sf_h5 *checkpoint, const char *path,
                              sf_error *err) {
    SF_OWNED char *status = NULL;
    SF_OWNED int64_t *touching = NULL;
    int64_t one = 1;
    if (!sf_h5_exists(results, "/summary/status"))
        return SF_REFUSE(err, "%s has not ended: --restart %s ends it", path, path);
    if (sf_h5_read_text(results, "/summary/status", &status, err) == SF_OK &&
        sf_h5_read(checkpoint, "/state/contact_count", SF_H5_I64, 1, &one, (void **)&touching, err) ==
            SF_OK &&
        ((strcmp(status, "rebound") != 0 && strcmp(status, "finished") != 0) || *touching > 0))
        SF_REFUSE(err,
                  "%s ended \"%.80s\" with %lld points in contact: a pad goes on only after the missile has "
                  "left it",
                  path, status, (long long)*touching);
    return err->status;
}

/* Compares an array of the earlier pad with this one's. */
static sf_status check_array(const sf_h5 *file, const char *name, sf_h5_type type, int64_t dims[2],
                             const void *mine, const char *path, sf_error *err) {
    size_t bytes = (size_t)(dims[0] * dims[1]) * sf_h5_size(type);
    SF_OWNED void *data = NULL;
    sf_status status = sf_h5_read(file, name, type, dims[1] > 1 ? 2 : 1, dims, &data, SF_IGNORED);
    if (status != SF_OK || memcmp(data, mine, bytes) != 0)
        SF_REFUSE(
            err,
            "the pad of %s is another one (%s differs): the geometry of the pad, its mesh and its layers "
            "must be the same, also whole or quarter",
            path, name);
    return err->status;
}

/* The foam must be the same, too: its card, its curves and its temperature. */
static sf_status check_foam(const sf_h5 *file, const sf_model *m, const char *path, sf_error *err) {
    SF_OWNED char *foam = NULL;
    char mine[SF_MODEL_HASH_SIZE];
    sf_model_foam_hash(m, mine);
    if (!sf_h5_exists(file, "/model/foam"))
        return SF_REFUSE(err, "%s is of an older version, which does not say its foam: solve its model again",
                         path);
    if (sf_h5_read_text(file, "/model/foam", &foam, err) == SF_OK && strcmp(foam, mine) != 0)
        SF_REFUSE(
            err,
            "the pad of %s has another foam: material, curves and pad.temperature of a later drop must be "
            "those of the first",
            path);
    return err->status;
}

static sf_status check_pad(const sf_h5 *file, const sf_model *m, const char *path, sf_error *err) {
    int64_t vectors[2] = {m->node_count, 3}, numbers[2] = {m->node_count, 1};
    SF_TRY(check_array(file, "/model/position", SF_H5_F64, vectors, m->position, path, err));
    SF_TRY(check_array(file, "/model/volume", SF_H5_F64, numbers, m->volume, path, err));
    if (m->material_count > 1)
        SF_TRY(check_array(file, "/model/node_layer", SF_H5_U8, numbers, m->node_material, path, err));
    return SF_OK;
}

static sf_status take_history(const sf_h5 *checkpoint, const sf_model *m, const char *path, sf_state *s,
                              sf_error *err) {
    SF_OWNED int64_t *number = NULL;
    SF_OWNED double *time = NULL;
    int64_t dims[2] = {sf_state_rows(m, 'h'), SF_LANES}, one = 1;
    void *history = NULL;
    sf_error inner = SF_ERROR_INIT;
    if (sf_h5_read(checkpoint, "/state/history", SF_H5_F64, 2, dims, &history, &inner) != SF_OK)
        return SF_REFUSE(err,
                         "the foam of %s remembers other things than this one (%.200s): law, memory, ED, "
                         "rate_factor and curves of several rates must be there in both or in none",
                         path, inner.text);
    free(s->history);
    s->history = history;
    SF_TRY(sf_h5_read(checkpoint, "/state/drop", SF_H5_I64, 1, &one, (void **)&number, err));
    SF_TRY(sf_h5_read(checkpoint, "/state/time", SF_H5_F64, 1, &one, (void **)&time, err));
    s->drop = *number + 1;
    s->pad_before = sf_state_pad(m, *time, s->history);
    return SF_OK;
}

static sf_status open_earlier(const sf_earlier *e, sf_checkpoint *c, sf_error *err) {
    SF_PRINTED(path, SF_PATH_SIZE, "%.4000s.restart", e->results);
    if (access(path, F_OK) != 0)
        return SF_REFUSE(err,
                         "%s is not there: it holds the state of the pad of %s, which must run without "
                         "--no-checkpoint",
                         path, e->results);
    return sf_checkpoint_open(path, c, err);
}

/* Moves the reference to where it is in the run that the checkpoint holds, or in the drop after a `pause`. */
static sf_status take_set(const sf_checkpoint *c, double pause, sf_model *m, sf_error *err) {
    bool moved = pause > 0, there = sf_h5_exists(c->file, "/state/set"), wanted = sf_model_set(m) > 0;
    int64_t of_set[2] = {m->node_count, 4}, of_peak[2] = {m->node_count, 3};
    SF_OWNED double *set = NULL, *peak = NULL;
    if (there != wanted)
        return SF_REFUSE(err,
                         "the foam of %s has %s permanent set: material.memory.set is in both or in none",
                         c->path, there ? "a" : "no");
    if (there && sf_h5_read(c->file, "/state/set", SF_H5_F64, 2, of_set, (void **)&set, err) == SF_OK &&
        sf_h5_read(c->file, "/state/set_peak", SF_H5_F64, 2, of_peak, (void **)&peak, err) == SF_OK) {
        for (int64_t k = 0; k < 4 * m->node_count; k++)
            moved |= set[k] != 0;
        if (moved) /* else it is a first drop that goes on */
            sf_set_move(m, set, pause > 0 ? peak : NULL, pause, err);
    }
    return err->status;
}

sf_status sf_series_shape(const sf_earlier *e, const sf_checkpoint *from, sf_model *m, sf_error *err) {
    SF_OWNED_BY(sf_checkpoint_close) sf_checkpoint c = {0};
    SF_OWNED_BY(sf_h5_drop) sf_h5 *results = NULL;
    if (from->file || !e->results)
        return from->file ? take_set(from, 0, m, err) : SF_OK;
    SF_TRY(open_earlier(e, &c, err));
    if (sf_h5_open(e->results, &results, err) == SF_OK &&
        sf_provenance_check(results, e->results, "softfall-results", err) == SF_OK &&
        sf_seal_check(e->results, err) == SF_OK && check_ending(results, c.file, e->results, err) == SF_OK &&
        check_pad(results, m, e->results, err) == SF_OK && check_foam(results, m, e->results, err) == SF_OK)
        take_set(&c, e->pause, m, err);
    return err->status;
}

sf_status sf_series_begin(const sf_earlier *e, const sf_model *m, const sf_operators *op, sf_state *s,
                          sf_error *err) {
    SF_OWNED_BY(sf_checkpoint_close) sf_checkpoint c = {0};
    if (sf_state_create(m, s, err) != SF_OK || !e->results)
        return err->status;
    if (open_earlier(e, &c, err) == SF_OK && take_history(c.file, m, e->results, s, err) == SF_OK)
        sf_domain_rest(m, op, s, e->pause);
    else
        sf_state_free(s);
    return err->status;
}

sf_status sf_series_continue(const sf_state *before, double pause, const sf_model *m, const sf_operators *op,
                             sf_state *s, sf_error *err) {
    SF_TRY(sf_state_create(m, s, err));
    if (!before)
        return SF_OK;
    memcpy(s->history, before->history, (size_t)sf_state_rows(m, 'h') * SF_LANES * sizeof *s->history);
    s->drop = before->drop + 1;
    sf_domain_rest(m, op, s, pause);
    return SF_OK;
}
