/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of a run's history (model/columns.h): one per time step, kept in memory and written to /history as
 * a whole, scaled to the whole pad. */
#ifndef SF_SOLVER_RUN_HISTORY_H
#define SF_SOLVER_RUN_HISTORY_H

#include "base/error.h"
#include "model/columns.h"
#include "model/model.h"
#include "io/h5.h"
#include "solver/state.h"

/* Adds the present state as a row of a history that began empty ({0}); release with sf_history_free. */
sf_status sf_history_add(sf_history *history, const sf_model *model, const sf_state *state, sf_error *err);

/* All rows to /history, and back; a history that is read must be empty. */
sf_status sf_history_write(const sf_history *history, sf_h5 *file, sf_error *err);
sf_status sf_history_read(sf_history *history, const sf_h5 *file, sf_error *err);

#endif
