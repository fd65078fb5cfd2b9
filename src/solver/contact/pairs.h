/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pairs of a step: points with their partners, and edges of the pad that cross. */
#pragma once
#include "solver/contact/pair.h"

/* Returns the partner of a point in the last step. */
int64_t sf_pair_last(const sf_scene *scene, int64_t point);

/* Finds the partner that a point touches at the end of the step: of those that it may touch, the nearest;
 * with `gap` the part that the step takes back. Without one, `passed`: the pair that the point was in, if it
 * has become deeper than it may; its node is -1 otherwise. */
bool sf_pair_find(const sf_scene *scene, int64_t point, sf_contact_pair *out, sf_contact_pair *passed);

/* Writes the pairs of sharp edges of the skin that close in the next step to `pair`, without force;
 * returns their number, skin.sharp_count at most. Nodes against faces do not see them before an edge
 * has sunk in by up to half a spacing (docs/adr/0024). */
int64_t sf_pair_edges(const sf_scene *scene, sf_contact_pair *pair);
