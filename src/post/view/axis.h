/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The places of the symmetry planes of a model and of the missile's axis, by which pictures and sections
 * of the pad are laid out. */
#pragma once
#include "post/results/results.h"

/* Places (m) of the symmetry planes normal to x and y; NaN: none. False: the model is a half or a quarter,
 * and its planes cannot be told (results of earlier versions). */
bool sf_axis_planes(const sf_results *results, double place[2]);

/* Reference x and y (m) of the missile's axis: in the symmetry planes, else in the middle of its surface. */
void sf_axis_find(const sf_results *results, double axis[2]);
