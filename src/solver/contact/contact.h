/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact of the pad's surface points with the rigid missile, and of a resting pad's underside with the
 * anvil, by Lagrange multipliers on the positions of the next time (forward increment method, Carpenter,
 * Taylor, Katona 1991; theory, section "Contact"; docs/adr/0003).
 *
 * Without contact forces point c would move to y*, the missile to s*. Forces q_c on the pad (and -q_c on
 * the missile) shift them by dt dt_v (A q)_c and - dt dt_v (sum q . e) / m. The forces are those for which no
 * point is inside the missile, none pulls, and Coulomb's law holds: p_c = q_c . n_c >= 0, gap_c >= 0, p_c
 * gap_c = 0, |q_c - p_c n_c| <= mu p_c (sticking below the bound), found by projected Gauss-Seidel sweeps
 * from the last step's forces. There is no penalty: no stored contact energy, no stiffness that limits the
 * time step. The energy lost is the impact energy of the surface points that the missile catches up with. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* Finds the contact forces of this step, adds them and a resting pad's weight to state->force (with Phi^T)
 * and to missile and anvil, and adds the work lost since the last step to the ledger. Needs force without
 * contact, reaction of the last step, dt and dt_old. */
void sf_contact_solve(const sf_model *model, const sf_operators *operators, sf_state *state);
