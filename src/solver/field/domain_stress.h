/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stress and forces of the smoothing domains: kinematics and material law, internal force, and the control of
 * the zero-energy modes. */
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

/* Control of the zero-energy modes of nodal integration (theory, section "Stabilisation"; after Ganzenmueller
 * 2015, doi:10.1016/j.cma.2014.12.005). For every mesh edge IJ the part of x_J - x_I that the gradients do
 * not reproduce, e = x_J - x_I - 1/2 (F_I + F_J)(X_J - X_I), is penalised by the energy 1/2 k |e|^2, k =
 * weight (g_I + g_J), g the current stiffness of the foam. Forces are the exact gradient of that energy: on
 * x, and on F as an extra couple in the stress, so that linear and angular momentum hold. */

/* In a parallel region all threads must call it and share the work; it ends with a barrier.
 * Sets force to the pairs' forces, adds the couples to stress, and fills the partial sums of the
 * stabilisation. */
void sf_stabilisation(const sf_model *model, const sf_operators *operators, sf_state *state);

/* Forces, couples and energies of the pairs at the nodes of a group, by place in it. */
typedef struct sf_pair_sums {
    sf_vec force[SF_GROUP];     /* N */
    sf_vec couple[SF_GROUP][3]; /* J, by column */
    sf_vec energy[SF_GROUP];    /* m3, sum of weight e e by component */
} sf_pair_sums;

/* The sums of group g from coefficients d [n][3], gradients f [n][9] and stiffness [n]. */
void sf_stabilisation_group(const sf_model *model, const sf_pairs *pairs, const double *d, const double *f,
                            const double *stiffness, int64_t g, sf_pair_sums *sums);

/* Returns the sum of 1/2 weight |e|^2 (m3) of a node of the group. */
double sf_stabilisation_energy(const sf_pair_sums *sums, int64_t place);
