/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The energy ledger and the momentum balance. Stored and hysteretic energy are state functions of W and its
 * maximum, not integrals of the forces: their agreement with the kinetic energy is a check, not an identity.
 *
 * Errors are relative to the initial energy and momentum of a free missile; with a prescribed motion, to
 * the largest work and the impulse of the motion so far. */
#ifndef SF_SOLVER_LEDGER_H
#define SF_SOLVER_LEDGER_H

#include "solver/operators.h"
#include "solver/state.h"

/* Completes the ledger of the present time from the partial sums of the domains, the stabilisation and the
 * integration; contact and friction have been added already. `constraint_force` (N): of all constraints on
 * the pad. `dt_v` (s): the distance of the half steps. */
void sf_ledger_close(const sf_model *model, sf_state *state, const double constraint_force[3], double dt_v);

/* Internal energy: stored + hysteresis + viscous + stabilisation, J. */
double sf_ledger_internal(const sf_ledger *ledger);

#endif
