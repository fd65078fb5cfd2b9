/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile's history: one row per time step, buffered and appended to results.h5:/history, scaled to the
 * whole pad (docs/formats.md). */
#ifndef SF_SOLVER_HISTORY_H
#define SF_SOLVER_HISTORY_H

#include "core/error.h"
#include "core/model.h"
#include "io/h5.h"
#include "solver/state.h"

enum { SF_HISTORY_COLUMNS = 25, SF_HISTORY_BUFFER = 2048 };

typedef struct sf_history {
    int64_t rows; /* in the buffer */
    double buffer[SF_HISTORY_COLUMNS][SF_HISTORY_BUFFER];
} sf_history;

/* Creates the empty datasets. */
sf_status sf_history_create(sf_h5 *file, sf_error *err);

/* Adds the present state; writes when the buffer is full. */
sf_status sf_history_add(sf_history *history, const sf_model *model, const sf_state *state, sf_h5 *file,
                         sf_error *err);

/* Appends what is buffered. */
sf_status sf_history_write(sf_history *history, sf_h5 *file, sf_error *err);

#endif
