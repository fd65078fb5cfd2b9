/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Permanent set (theory, M7): a displacement field that drops leave, and that changes only while the pad is
 * at rest. A drop runs on the reference that the set has moved, which is free of stress, with the same
 * masses: X' = X + u_s, F_s = I + sum_J u_s(J) B_J^T, B' = F_s^-T B, V' = det(F_s) V. */
#pragma once
#include "solver/state.h"

/* Takes the coefficients at the largest indentation so far. */
void sf_set_watch(const sf_model *model, sf_state *state);

/* Moves the reference of a model by a set as in sf_model. With `peak` (sf_state.set_peak) by what is left of
 * it `pause` (s) after that drop: node by node the larger counts of the set so far and the part of the drop's
 * displacement; held and tied components are projected. SF_ERR_INPUT where det(F_s) is below 0.3. */
sf_status sf_set_move(sf_model *model, const double *set, const double *peak, double pause, sf_error *err);

/* SF_ERR_INPUT if the set has moved foam into the missile at t = 0 by more than SF_CONTACT_ENTRY. */
sf_status sf_set_check_missile(const sf_model *model, const sf_body *body, sf_error *err);

/* Depth (m) of the set at the contact node next to the impact point, not down a hole, and the largest.
 */
void sf_set_measure(const sf_model *model, double set[2]);
