/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the user of a run's figures should know of it, beside the checks of model/good_run.h: for the terminal,
 * and for /summary/notes in results.h5. */
#ifndef SF_SOLVER_RUN_NOTES_H
#define SF_SOLVER_RUN_NOTES_H

#include "base/sink.h"
#include "solver/run/recorder.h"

/* Tells the sink; `state` is that of the last step. */
void sf_run_tell(const sf_model *model, const sf_state *state, const sf_extremes *extremes,
                 const sf_sink *sink);

/* Lines, each ended by '\n'. */
typedef struct sf_run_notes {
    char text[4096]; /* cut */
} sf_run_notes;

/* A sink that adds a line to `notes`; borrowed. */
sf_sink sf_run_notes_sink(sf_run_notes *notes);

#endif
