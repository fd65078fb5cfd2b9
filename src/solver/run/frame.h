/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame: the fields at the nodes at one time, as docs/formats.md lists them. */
#pragma once
#include "solver/operators.h"
#include "solver/state.h"

/* Writes the state after sf_step_evaluate to the group `path`: time, missile and the fields whose SF_FIELD_
 * bits are set, some nodes at a time. */
sf_status sf_frame_write(const sf_model *model, const sf_operators *operators, const sf_state *state,
                         int64_t fields, const char *path, sf_h5 *file, sf_error *err);

/* One field of all nodes into values [node_count][components]. */
void sf_frame_take(const sf_model *model, const sf_operators *operators, const sf_state *state,
                   sf_frame_field field, double *values);

/* Sums by layer of a pad of several materials, of the whole pad: sums [4][material_count], the stored, lost
 * and viscous energy (J) and the largest compression to date. */
void sf_frame_layers(const sf_model *model, const sf_operators *operators, const sf_state *state,
                     double *sums);
