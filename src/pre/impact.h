/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The impact point: where on the pad's top the missile's lowest point arrives. */
#pragma once
#include "case/case.h"
#include "base/error.h"
#include "model/model.h"
#include "pre/mesh/mesh.h"

/* The missile's lowest point (m): of its sphere, or of its surface's nodes; where several are lowest the
 * centroid of the flat faces there, or, without such faces, the middle of the box around these nodes. */
void sf_impact_lowest(const sf_surface *surface, const sf_missile_card *card, double point[3]);

/* Height (m) of the pad's highest point. */
double sf_impact_top(const sf_model *model);

/* Moves the surface, and the card's sphere, in x and y so that the lowest point, on its way along
 * the direction, comes to missile.position at the height of the pad's highest point. Normal to a symmetry
 * plane nothing moves. Does nothing without missile.position. The card's shape is set, its body not yet;
 * the model has its cloud and its sets. SF_ERR_INPUT: the position lies off a
 * symmetry plane, or outside the convex outline of the contact nodes. */
sf_status sf_impact_place(const sf_case *c, const sf_model *model, sf_surface *surface, sf_missile_card *card,
                          sf_error *err);

/* The impact point (m) of a complete model, by the same rule; on its symmetry planes. */
void sf_impact_point(const sf_model *model, double point[3]);
