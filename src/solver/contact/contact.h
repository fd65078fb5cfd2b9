/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact of the pad with all that it may touch (theory, section "Contact"): prepare (positions, lists), warm
 * start (pairs with the forces of the last step), solve (contact/solve.h), store (forces, ledger). First the
 * skin with itself, its mirror image, planes and supports, then the contact points with missile and anvil.
 *
 * A force q acts on the point, and -q is shared among the points of its partner. Momentum and angular
 * momentum hold: forces along the normal are on one line, and sf_pair_lean takes up the moment of friction.
 * The energy lost is the impact energy of the surface points that are caught up with. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* Finds the contact forces of this step, adds them and a resting pad's weight to state->force (with Phi^T),
 * to missile and bodies, and adds the work lost since the last step to the ledger. Needs force without
 * contact, reaction of the last step, dt and dt_old. */
sf_status sf_contact_solve(const sf_model *model, const sf_operators *operators, sf_state *state,
                           sf_error *err);
