/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step: a bound that holds in every step (core/stability.h), tightened by the ratio of the true highest
 * frequency to the bound, which a warm-started power iteration measures every few tens of steps (theory, section
 * "Time step"). Contact and constraints are kinematic and do not limit the step. */
#ifndef SF_SOLVER_TIME_STEP_H
#define SF_SOLVER_TIME_STEP_H

#include "solver/operators.h"
#include "solver/state.h"

/* Chooses state->dt from the partial sums of the domains: shrinks at once, grows by at most 2 % a step, never beyond
 * run.step_limit. Updates bound_step, bound_load, tightness. */
void sf_time_step_choose(const sf_model *model, const sf_operators *operators, sf_state *state);

/* Highest eigenvalue (s-2) of M^-1 K for the scalar operator K = sum V a B B^T plus the stabilisation, with a =
 * state->tangent, by `iterations` power iterations on state->mode; a lower estimate that converges from below. */
double sf_time_step_power(const sf_model *model, const sf_operators *operators, sf_state *state, int iterations);

#endif
