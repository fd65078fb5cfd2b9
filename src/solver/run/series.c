/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/run.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "solver/field/domain_stress.h"

/* The earlier run must have come to its end, and the missile off the pad. */
static sf_status check_ending(const sf_h5 *results, const sf_h5 *checkpoint, const char *path,
                              sf_error *err) {
    char *status = NULL;
    int64_t *touching = NULL, one = 1;
    if (!sf_h5_exists(results, "/summary/status"))
        return SF_FAIL(err, SF_ERR_INPUT, "%s has not ended: --restart %s ends it", path, path);
    if (sf_h5_read_text(results, "/summary/status", &status, err) == SF_OK &&
        sf_h5_read(checkpoint, "/state/contact_count", SF_H5_I64, 1, &one, (void **)&touching, err) ==
            SF_OK &&
        ((strcmp(status, "rebound") != 0 && strcmp(status, "finished") != 0) || *touching > 0))
        SF_FAIL(
            err, SF_ERR_INPUT,
            "%s ended \"%.80s\" with %lld points in contact: a pad goes on only after the missile has left it",
            path, status, (long long)*touching);
    SF_FREE(status, touching);
    return err->status;
}

/* Compares an array of the earlier pad with this one's. */
static sf_status check_array(const sf_h5 *file, const char *name, sf_h5_type type, int64_t columns,
                             const void *mine, const sf_model *m, const char *path, sf_error *err) {
    int64_t dims[2] = {m->node_count, columns};
    size_t bytes = (size_t)(m->node_count * columns) * (type == SF_H5_U8 ? 1 : 8);
    SF_OWNED void *data = NULL;
    sf_error inner = SF_ERROR_INIT;
    sf_status status = sf_h5_read(file, name, type, columns > 1 ? 2 : 1, dims, &data, &inner);
    if (status != SF_OK || memcmp(data, mine, bytes) != 0)
        SF_FAIL(
            err, SF_ERR_INPUT,
            "the pad of %s is another one (%s differs): the geometry of the pad, its mesh and its layers must "
            "be the same, also whole or quarter",
            path, name);
    return err->status;
}

static sf_status check_pad(const sf_h5 *file, const sf_model *m, const char *path, sf_error *err) {
    SF_TRY(check_array(file, "/model/position", SF_H5_F64, 3, m->position, m, path, err));
    SF_TRY(check_array(file, "/model/volume", SF_H5_F64, 1, m->volume, m, path, err));
    return m->material_count > 1
               ? check_array(file, "/model/node_layer", SF_H5_U8, 1, m->node_material, m, path, err)
               : SF_OK;
}

static sf_status take_history(const sf_h5 *checkpoint, const sf_model *m, const char *path, sf_state *s,
                              sf_error *err) {
    int64_t dims[2] = {sf_state_rows(m, 'h'), SF_LANES}, *number = NULL, one = 1;
    void *history = NULL;
    sf_error inner = SF_ERROR_INIT;
    if (sf_h5_read(checkpoint, "/state/history", SF_H5_F64, 2, dims, &history, &inner) != SF_OK)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "the foam of %s remembers other things than this one (%.200s): law, memory, ED, rate_factor "
            "and curves of several rates must be there in both or in none",
            path, inner.text);
    free(s->history);
    s->history = history;
    if (sf_h5_read(checkpoint, "/state/drop", SF_H5_I64, 1, &one, (void **)&number, err) == SF_OK)
        s->drop = *number + 1;
    free(number);
    return err->status;
}

static sf_status take(const sf_earlier *e, const sf_model *m, const sf_operators *op, sf_state *s,
                      sf_error *err) {
    char path[SF_PATH_SIZE];
    SF_OWNED_BY(sf_checkpoint_close) sf_checkpoint c = {0};
    sf_h5 *results = NULL;
    snprintf(path, sizeof path, "%.4000s.restart", e->results);
    if (access(path, F_OK) != 0)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s is not there: it holds the state of the pad of %s, which must run without "
                       "--no-checkpoint",
                       path, e->results);
    if (sf_checkpoint_open(path, &c, err) == SF_OK && sf_h5_open(e->results, &results, err) == SF_OK &&
        sf_provenance_check(results, e->results, "softfall-results", err) == SF_OK &&
        check_ending(results, c.file, e->results, err) == SF_OK &&
        check_pad(results, m, e->results, err) == SF_OK &&
        take_history(c.file, m, e->results, s, err) == SF_OK) {
        s->ledger.before = sf_domain_rest(m, op, s, e->pause);
        s->pause = e->pause;
    }
    sf_h5_close(&results, err);
    return err->status;
}

sf_status sf_series_begin(const sf_earlier *e, const sf_model *m, const sf_operators *op, sf_state *s,
                          sf_error *err) {
    SF_TRY(sf_state_create(m, s, err));
    if (e->results && take(e, m, op, s, err) != SF_OK)
        sf_state_free(s);
    return err->status;
}
