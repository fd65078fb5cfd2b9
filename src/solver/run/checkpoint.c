/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/checkpoint.h"

#include "io/seal.h"
#include "solver/run/state_io.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
        sf_state_write(m, s, file, err) == SF_OK && sf_recorder_write(r, file, err) == SF_OK)
        sf_output_copy_peak(o, file, err);
    sf_h5_close(&file, err);
    if (err->status == SF_OK && sf_seal_add(partial, err) == SF_OK)
        return sf_replace_commit(partial, o->checkpoint, err);
    unlink(partial);
    return err->status;
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
    sf_error ignored = SF_ERROR_INIT; /* nothing was written */
    sf_h5_close(&c->file, &ignored);
    free(c->path);
    free(c->model_path);
    free(c->model_hash);
    free(c->git_revision);
    free(c->compiler_flags);
    memset(c, 0, sizeof *c);
}

sf_status sf_checkpoint_read(const sf_checkpoint *c, const sf_model *m, const sf_output *o, sf_state *s,
                             sf_recorder *r, sf_error *err) {
    if (sf_state_read(m, s, c->file, err) != SF_OK || sf_recorder_read(r, m, s, c->file, err) != SF_OK)
        return err->status;
    return sf_output_recover_peak(o, c->file, err);
}
