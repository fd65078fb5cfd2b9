/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Control of the zero-energy modes of nodal integration (theory, section "Stabilisation"; after Ganzenmueller
 * 2015, doi:10.1016/j.cma.2014.12.005). For every mesh edge IJ the part of x_J - x_I that the gradients do
 * not explain, e = x_J - x_I - 1/2 (F_I + F_J)(X_J - X_I), is penalised by the energy 1/2 k |e|^2, k = pair
 * (g_I + g_J), g the current stiffness of the foam. Forces are the exact gradient of that energy: on x, and
 * on F as an extra couple in the stress, so that linear and angular momentum hold. */
#ifndef SF_SOLVER_STABILISATION_H
#define SF_SOLVER_STABILISATION_H

#include "solver/operators.h"
#include "solver/state.h"

/* In a parallel region all threads must call it and share the work; it ends with a barrier.
 * Sets force to the pairs' forces, adds the couples to stress, and fills the partial sums of the
 * stabilisation. */
void sf_stabilisation(const sf_model *model, const sf_operators *operators, sf_state *state);

/* Force (N) and couple (J) of one node, and the sum of 1/2 c |e|^2 (m3), from coefficients d and gradients f.
 */
double sf_stabilisation_node(const sf_model *model, const double *pair, const double *d, const double *f,
                             const double *stiffness, int64_t node, double force[3], double couple[9]);

#endif
