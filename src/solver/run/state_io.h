/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state in a checkpoint: everything that the next step needs, bit by bit. */
#ifndef SF_SOLVER_RUN_STATE_IO_H
#define SF_SOLVER_RUN_STATE_IO_H

#include "io/h5.h"
#include "solver/state.h"

/* To and from the group /state; `state` is from sf_state_create for the same model. SF_ERR_IO if a dataset is
 * missing, of another size or not possible. */
sf_status sf_state_write(const sf_model *model, const sf_state *state, sf_h5 *file, sf_error *err);
sf_status sf_state_read(const sf_model *model, sf_state *state, const sf_h5 *file, sf_error *err);

#endif
