/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pairs of the points of a step with their partners. */
#pragma once
#include "solver/contact/pair.h"

/* Returns the partner of a point in the last step. */
int64_t sf_pair_last(const sf_scene *scene, int64_t point);

/* Finds the partner that a point touches at the end of the step: of those that it may touch, the nearest.
 * Without one, `passed`: the pair that the point was in, if it has become deeper than it may; its node is -1
 * otherwise. */
bool sf_pair_find(const sf_scene *scene, int64_t point, sf_contact_pair *out, sf_contact_pair *passed);
