/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact of the pad's skin with itself, its mirror image, the plane of the anvil and the rigid support:
 * every node of the skin against the faces of the skin before it, by multipliers as the missile's contact has
 * them (contact.h; theory, section "Contact of the pad with itself"). Without these forces the gap of node
 * and face at the next time would be g; the forces q on the node, and -q shared among the face's nodes, are
 * those for which no gap is negative, none pulls, and Coulomb's law holds. Momentum and angular momentum
 * hold: those along the normal are on one line, and sf_pair_lean takes up the moment of friction. A node
 * touches a face only if it comes from outside: one that lies deeper behind a face than it may, as behind the
 * other side of a thin wall, does not see it. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* Finds the forces of this step, adds them to state->force, and the work lost since the last step to the
 * ledger. Needs force without contact, reaction of the last step, dt and dt_old. */
sf_status sf_self_contact_solve(const sf_model *model, const sf_operators *operators, sf_state *state,
                                sf_error *err);
