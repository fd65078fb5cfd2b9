/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The energy ledger and the momentum balance. Stored and hysteretic energy are state functions of W and its
 * maximum, not integrals of the forces: their agreement with the kinetic energy is a check, not an identity.
 *
 * Errors are relative to the energy and momentum at first contact of a free missile; with a prescribed
 * motion, to the largest work and the impulse of the motion so far. The balance in space counts the pad, and
 * a missile that turns (sf_missile_momenta); angular momentum is about the origin, its error refers to the
 * same momentum times the pad's thickness. Both hold to rounding, whatever the step: theory, section
 * "Ledger". */
#pragma once
#include "solver/state.h"

/* Force (N) and moment (N m, about the origin) on the pad of all that is outside the balance: constraints,
 * anvil, weight; but for the missile. Whoever applies such a force adds it. */
typedef struct sf_wrench {
    double force[3], moment[3];
} sf_wrench;

/* A force (N) at the place x (m, present). */
void sf_wrench_add(sf_wrench *wrench, const double x[3], const double force[3]);

/* Completes the ledger of the present time from the partial sums of the domains, the stabilisation and the
 * integration; contact and friction have been added already. `outside`: for the balance of momentum, along
 * the missile's direction and, with that of angular momentum, in space. `dt_v` (s): the distance of the half
 * steps. */
void sf_ledger_close(const sf_model *model, sf_state *state, const sf_wrench *outside, double dt_v);

/* Internal energy: stored + hysteresis + viscous + stabilisation, J. */
double sf_ledger_internal(const sf_ledger *ledger);
