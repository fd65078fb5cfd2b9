/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The part of contact in the ledger: the work of pairs by the trapezoidal rule, half with the force before a
 * step and half with that after it, and the forces of what is outside the balance. */
#pragma once
#include "solver/contact/solve.h"
#include "solver/weight.h"

/* Books half of the work that the force of a pair has lost over the last step, that along the normal as
 * contact, the rest as friction; `first`: it is the force at t = 0. */
void sf_ledger_book(const sf_scene *scene, const sf_contact_pair *pair, bool first);

/* Keeps half of the work over the next step for its ledger, which sf_ledger_take_ahead books: no later step
 * knows a pair of edges. */
void sf_ledger_book_ahead(const sf_scene *scene, const sf_contact_system *system,
                          const sf_contact_pair *pair);
void sf_ledger_take_ahead(sf_state *state);

/* Adds the forces of all bodies but the missile on the pad, and its weight. */
void sf_ledger_outside(const sf_model *model, const sf_weight *weight, const sf_state *state,
                       sf_wrench *outside);

/* Sets support_force and base_reaction; `base` (N): of the constraints that hold the base. */
void sf_ledger_supports(const sf_model *model, sf_state *state, const double base[3]);
