/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internal forces f_I = - sum_L (V P)_L B_I^L, scattered by groups of domains (halo.h), then summed by node
 * (theory eq. 8). */
#ifndef SF_SOLVER_FIELD_INTERNAL_FORCE_H
#define SF_SOLVER_FIELD_INTERNAL_FORCE_H

#include "solver/operators.h"
#include "solver/state.h"

/* Adds them to force. In a parallel region all threads must call it and share the work; it ends with a
 * barrier. */
void sf_internal_force(const sf_model *model, const sf_operators *operators, sf_state *state);

#endif
