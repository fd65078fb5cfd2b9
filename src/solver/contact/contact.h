/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact of the pad's surface points with the rigid missile, and of a resting pad's underside with the
 * anvil (theory, section "Contact"; contact/solve.h). The energy lost is the impact energy of the surface
 * points that the missile catches up with. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* Finds the contact forces of this step, adds them and a resting pad's weight to state->force (with Phi^T)
 * and to missile and anvil, and adds the work lost since the last step to the ledger. Needs force without
 * contact, reaction of the last step, dt and dt_old. */
sf_status sf_contact_solve(const sf_model *model, const sf_operators *operators, sf_state *state,
                           sf_error *err);
