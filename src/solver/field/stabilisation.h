/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Control of the zero-energy modes of nodal integration (theory, section "Stabilisation"; after Ganzenmueller
 * 2015, doi:10.1016/j.cma.2014.12.005). For every mesh edge IJ the part of x_J - x_I that the gradients do
 * not reproduce, e = x_J - x_I - 1/2 (F_I + F_J)(X_J - X_I + P), is penalised by the energy 1/2 k |e|^2, k =
 * weight (g_I + g_J), g the current stiffness of the foam. The offset P of the arm keeps the energy where the
 * stiffness rises, so that no change of it feeds the pad. Forces are the exact gradient of the energy: on x,
 * and on F as an extra couple in the stress, so that linear and angular momentum hold. */
#pragma once
#include "base/lanes.h"
#include "solver/field/pairs.h"

typedef struct sf_operators sf_operators; /* solver/operators.h */
typedef struct sf_state sf_state;         /* solver/state.h */

/* In a parallel region all threads must call it and share the work; it ends with a barrier. Sets force to the
 * pairs' forces, adds the couples to stress, moves the offsets, and fills the partial sums of the
 * stabilisation. */
void sf_stabilisation(const sf_model *model, const sf_operators *operators, sf_state *state);

/* Input of the pairs, and their offsets. */
typedef struct sf_pair_field {
    const double *d, *f;              /* [n][3] m; [n][9] */
    const double *stiffness, *before; /* [n] Pa, now and when the pairs were last evaluated */
    double *offset; /* [pairs][3] m, of the arms: of the inner pairs, then of the outer ones; updated */
    const int32_t *has_offsets; /* [groups] 0: all offsets of the group's pairs are 0 */
} sf_pair_field;

/* Forces, couples and energies of the pairs at the nodes of a group, by place in it. */
typedef struct sf_pair_sums {
    sf_vec force[SF_GROUP];     /* N */
    sf_vec couple[SF_GROUP][3]; /* J, by column */
    sf_vec before[SF_GROUP];    /* J, half the energy of the node's pairs, by component, before stiffness and
                                   offsets change */
    sf_vec after[SF_GROUP];     /* J, the same after */
} sf_pair_sums;

/* The sums of group g; returns whether its pairs may have offsets now. */
bool sf_stabilisation_group(const sf_model *model, const sf_pairs *pairs, const sf_pair_field *field,
                            int64_t g, sf_pair_sums *sums);
