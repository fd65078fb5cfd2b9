/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "io/h5.h"
#include "io/provenance.h"
#include "solver/run/output.h"
#include "solver/run/recorder.h"
#include "solver/state.h"

/* The state in a checkpoint: everything that the next step needs, bit by bit. */

/* To and from the group /state; `state` is from sf_state_create for the same model. SF_ERR_IO if a dataset is
 * missing, of another size or not possible. */
sf_status sf_state_write(const sf_model *model, const sf_state *state, sf_h5 *file, sf_error *err);
sf_status sf_state_read(const sf_model *model, sf_state *state, const sf_h5 *file, sf_error *err);

/* Checkpoints (docs/formats.md): a sealed HDF5 file. With the model it resumes a run bit for bit as if
 * uninterrupted. It holds the state after sf_step_evaluate. */

/* An open checkpoint and the identity of its run. */
typedef struct sf_checkpoint {
    sf_h5 *file; /* open for sf_checkpoint_read */
    char *path;
    char *model_path, *model_hash, *git_revision, *compiler_flags;
    double end_time;    /* s */
    double time_before; /* s, of the step before the one that it holds */
} sf_checkpoint;

/* Replaces the checkpoint of `output`, whole or not at all; /peak comes from the folder. The provenance names
 * the model. */
sf_status sf_checkpoint_write(const sf_output *output, const sf_provenance *provenance, const sf_model *model,
                              const sf_state *state, const sf_recorder *recorder, sf_error *err);

/* Opens and checks a checkpoint. On success release with sf_checkpoint_close. */
sf_status sf_checkpoint_open(const char *path, sf_checkpoint *checkpoint, sf_error *err);
void sf_checkpoint_close(sf_checkpoint *checkpoint);

/* State and recorder, both new, of the same model; /peak goes back into the folder of `output`. */
sf_status sf_checkpoint_read(const sf_checkpoint *checkpoint, const sf_model *model, const sf_output *output,
                             sf_state *state, sf_recorder *recorder, sf_error *err);
