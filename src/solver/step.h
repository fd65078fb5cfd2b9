/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step of the explicit total-Lagrangian method. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* Forces, accelerations and ledger of the present time (state->time). SF_ERR_NUMERIC on a collapsed or
 * non-finite domain, a time step below 1e-9 of the end time, or an energy error above run.energy_limit: the
 * message names node, position and time, and the state holds the last values. */
sf_status sf_step_evaluate(const sf_model *model, const sf_operators *operators, sf_state *state,
                           sf_error *err);

/* Moves coefficients and missile to the next time with the velocities that sf_step_evaluate has set. */
void sf_step_advance(const sf_model *model, sf_state *state);
