/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile's history: one row per time step, kept in memory and written to /history as a whole, scaled to
 * the whole pad (docs/formats.md). */
#ifndef SF_SOLVER_RUN_HISTORY_H
#define SF_SOLVER_RUN_HISTORY_H

#include "core/error.h"
#include "core/model.h"
#include "io/h5.h"
#include "solver/state.h"

enum { SF_HISTORY_COLUMNS = 25 };

/* Start with an empty one ({0}). */
typedef struct sf_history {
    int64_t rows, room;
    double *column[SF_HISTORY_COLUMNS]; /* [room] owned */
} sf_history;

/* Adds the present state as a row. */
sf_status sf_history_add(sf_history *history, const sf_model *model, const sf_state *state, sf_error *err);

/* All rows to /history, and back; a history that is read must be empty. */
sf_status sf_history_write(const sf_history *history, sf_h5 *file, sf_error *err);
sf_status sf_history_read(sf_history *history, const sf_h5 *file, sf_error *err);

void sf_history_free(sf_history *history);

#endif
