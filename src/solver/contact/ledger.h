/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The part of contact in the ledger: work of pairs, and the forces of what is outside the balance. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* Books the work lost by `force` (N) over the relative motion (m) of a pair, that along the normal as
 * contact, the rest as friction; returns the rest (J). `normal` NULL: all of it is contact. */
double sf_ledger_book(sf_state *state, bool at_anvil, const double force[3], const double motion[3],
                      const double *normal);

/* Adds the forces of anvil and supports on the skin, and with `all` those of the symmetry planes, of the
 * anvil on the base of a resting pad, and of its weight. */
void sf_ledger_outside(const sf_model *model, const sf_operators *operators, const sf_state *state, bool all,
                       sf_wrench *outside);

/* Sets support_force. */
void sf_ledger_supports(const sf_model *model, const sf_skin *skin, sf_state *state);
