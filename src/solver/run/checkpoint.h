/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checkpoints (docs/formats.md): a sealed HDF5 file. With the model it resumes a run bit for bit as if
 * uninterrupted. It holds the state after sf_step_evaluate. A drop on a pad that has been hit before begins
 * from the checkpoint of that earlier run. */
#pragma once
#include "solver/run/output.h"
#include "solver/run/recorder.h"

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

/* A drop on a pad that has been hit before: its foam's history goes on from the end of an earlier run,
 * unloaded to rest, and its permanent set (solver/set.h) is the reference. Nothing else of it remains. */

/* The pad from which a run begins. */
typedef struct sf_earlier {
    const char
        *results; /* of the earlier run, with its checkpoint beside it; NULL: the pad is new; borrowed */
    double pause; /* s, of the pad between them */
} sf_earlier;

/* Before the operators are built: gives the model of the file the reference of the drop; if the checkpoint
 * `from` is open, that of the run that is resumed. SF_ERR_INPUT if the earlier run has not ended with the
 * missile away from the pad, or if its pad is another one: nodes, volumes, layers or a set. */
sf_status sf_series_shape(const sf_earlier *earlier, const sf_checkpoint *from, sf_model *model,
                          sf_error *err);

/* A new state (sf_state_create) on that pad. SF_ERR_INPUT if its foam remembers other things. */
sf_status sf_series_begin(const sf_earlier *earlier, const sf_model *model, const sf_operators *operators,
                          sf_state *state, sf_error *err);

/* The same, but by the last state of the earlier drop, on the same pad; NULL: the pad is new. */
sf_status sf_series_continue(const sf_state *before, double pause, const sf_model *model,
                             const sf_operators *operators, sf_state *state, sf_error *err);
