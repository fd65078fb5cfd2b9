/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When a run is over. */
#ifndef SF_SOLVER_RUN_ENDING_H
#define SF_SOLVER_RUN_ENDING_H

#include "base/error.h"
#include "model/model.h"
#include "solver/state.h"

/* The missile has left the pad for good, and the run shall end then. A driven missile may come back. */
bool sf_ending_rebounded(const sf_model *model, const sf_state *state);

/* The missile's lowest point is on the anvil: what follows is the impact of two rigid bodies, of which the
 * model says nothing. */
bool sf_ending_on_anvil(const sf_model *model, const sf_state *state);
/* Records SF_ERR_NUMERIC with a sentence for that. */
sf_status sf_ending_fail_on_anvil(const sf_state *state, sf_error *err);

/* The end time is reached. */
bool sf_ending_finished(const sf_model *model, const sf_state *state);

#endif
