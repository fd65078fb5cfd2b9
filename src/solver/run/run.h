/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A whole run: steps until the end, with history, frames, the peak and the summary in results.h5, and
 * checkpoints from which it can be resumed. */
#ifndef SF_SOLVER_RUN_RUN_H
#define SF_SOLVER_RUN_RUN_H

#include "base/error.h"
#include "model/model.h"
#include "base/sink.h"
#include "solver/run/checkpoint.h"
#include "solver/operators.h"
#include "solver/run/output.h"
#include "solver/run/recorder.h"
#include "solver/state.h"

#include <signal.h>
#include <stdio.h>

typedef struct sf_run {
    const volatile sig_atomic_t *stop; /* non-zero asks the run to end after the present step; borrowed */
    FILE *log;                         /* progress; borrowed */
    const sf_sink *sink;               /* warnings; borrowed; NULL: none */
    bool terminal;                     /* progress as one line rewritten in place */
    int threads;
    bool checkpoints;                /* write them? */
    double checkpoint_wall;          /* s of wall time between two, at most */
    double checkpoint_time;          /* s of simulated time between two */
    const sf_provenance *provenance; /* of the checkpoints; borrowed */
    bool to_end_time;                /* resumed after its rebound, a run goes on to the end time */
    char note[1024];                 /* a sentence of the program for /summary/notes, or "" */
    /* out */
    double wall_time; /* s, with the time before a restart */
    sf_extremes extremes;
    bool shown;         /* the last frame is of the last step, and not of one before it that was finite */
    const char *ending; /* "finished", "rebound", "interrupted", "anvil", "failed" */
} sf_run;

/* Runs `state` to the end, from the beginning or from `checkpoint` (NULL: none) with a `state` freshly
 * created. `output` is open and has its base. If a frame of the run so far is lost, the run starts from the
 * beginning with a warning. On a numerical failure or an interruption everything up to the
 * last step is written, with a last frame, and the status says so. After a failure `state` and the checkpoint
 * are those of the last valid step. A missile that has reached the anvil ends the run likewise, with
 * SF_ERR_NUMERIC, and its last step is valid. When a file cannot be written the folder of `output` stays, and
 * the last checkpoint with it. */
sf_status sf_run_drop(const sf_model *model, const sf_operators *operators, sf_state *state, sf_run *run,
                      sf_output *output, const sf_checkpoint *checkpoint, sf_error *err);

#endif
