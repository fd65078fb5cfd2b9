/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "solver/run/checkpoint.h"

/* When a run is over. */

/* The missile has left the pad for good, and the run shall end then. A driven missile may come back. */
bool sf_ending_rebounded(const sf_model *model, const sf_state *state);

/* The missile is on the anvil or the support: what follows is the impact of two rigid bodies, of which the
 * model says nothing. */
bool sf_ending_on_anvil(const sf_model *model, const sf_state *state);
/* Records SF_ERR_NUMERIC with a sentence for that. */
sf_status sf_ending_fail_on_anvil(const sf_model *model, const sf_state *state, sf_error *err);

/* The end time is reached. */
bool sf_ending_finished(const sf_model *model, const sf_state *state);

/* The notes of a run: facts for the user of its figures that no check of model/good_run.h covers, for the
 * terminal and for /summary/notes in results.h5. */

/* Tells the sink; `state` is that of the last step. */
void sf_run_tell(const sf_model *model, const sf_state *state, const sf_extremes *extremes,
                 const sf_sink *sink);

/* The same with the sentence about a later drop on a pad before them: all that /summary/notes has of a run.
 */
void sf_run_tell_all(const sf_model *model, const sf_state *state, const sf_extremes *extremes,
                     const sf_sink *sink);

/* A whole run: steps until the end, with history, frames, the peak and the summary in results.h5, and
 * checkpoints from which it can be resumed. */

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
    sf_earlier earlier;              /* the pad from which it begins */
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
