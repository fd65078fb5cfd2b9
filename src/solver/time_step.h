/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step: a bound that holds in every step (model/stability.h), tightened by the ratio of the true
 * highest frequency to the bound. A warm-started Lanczos iteration measures that ratio when the bound has
 * moved by 10 %, and at least every 40 steps (theory, section "Time step"). Contact and constraints are
 * kinematic and do not limit the step. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* True if the frequency is measured in this step; it then needs state->directional. */
bool sf_time_step_due(const sf_state *state);

/* Chooses state->dt from the partial sums of the domains: shrinks at once; between measurements it does not
 * grow, and from step to step by at most 2 %; never beyond run.step_limit. Updates bound_step, bound_load,
 * tightness. */
void sf_time_step_choose(const sf_model *model, const sf_operators *operators, sf_state *state);

/* Highest eigenvalue (s-2) of M^-1 K for the scalar operator K = sum V B^T A B plus the stabilisation, with A
 * = state->directional, by Lanczos cycles from state->mode with at most `products` products in all; a Ritz
 * value, which converges from below. Ends early when a cycle, or a product within it, adds less than
 * `settled` of the value; 0: never. */
double sf_time_step_power(const sf_model *model, const sf_operators *operators, sf_state *state, int products,
                          double settled);
