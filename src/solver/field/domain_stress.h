/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stress and forces of the smoothing domains: kinematics and material law, and internal force. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* Kinematics and stress of every smoothing domain: F = I + sum d_J B_J^T, material law, V P (theory eq. 7,
 * section "Foam"). Writes f, stress, history, energy, stiffness, tangent, and the domains' partial sums. */

/* dt_old is the step that led to the present coefficients; 0 at the start. In a parallel region all threads
 * must call it and share the work; it ends with a barrier. */
void sf_domain_stress(const sf_model *model, const sf_operators *operators, sf_state *state);

/* The law once more, at rest, at the F and the largest W of a block of SF_LANES domains: stretches, W
 * and hysteresis factor. */
void sf_domain_law(const sf_model *model, const sf_operators *operators, const sf_state *state, int64_t block,
                   sf_law_batch *batch);

/* The history of the pad unloaded to rest, and after a `pause` (s) there, with the ledger's `before`. */
void sf_domain_rest(const sf_model *model, const sf_operators *operators, sf_state *state, double pause);

/* Internal forces f_I = - sum_L (V P)_L B_I^L, scattered by groups of domains, then summed by node
 * (theory eq. 8). */

/* Adds them to force. In a parallel region all threads must call it and share the work; it ends with a
 * barrier. */
void sf_internal_force(const sf_model *model, const sf_operators *operators, sf_state *state);
