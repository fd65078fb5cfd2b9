/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The support: rigid fixed bodies of any shape that the pad may touch (theory, section "Contact of the pad
 * with itself"). */
#pragma once
#include "base/error.h"
#include "case/case.h"
#include "model/model.h"
#include "pre/mesh/mesh.h"

/* Takes the surface into the model: turned outwards (open parts against the missile's direction), with the
 * nodes of sharp edges once for each side. Needs the pad's cells. SF_ERR_INPUT: a part lies inside the pad at
 * the start, or no face of the pad has it before it within the pad's thickness. */
sf_status sf_support_take(const sf_case *c, sf_surface *surface, sf_model *model, sf_error *err);

/* Sets the missile's way to the support; the missile is in its place. SF_ERR_INPUT: it meets the support
 * before the pad. */
sf_status sf_support_find_travel(sf_model *model, sf_error *err);

/* Distance (m) from x along the unit vector `direction` to the support; infinity: it is not there. */
double sf_support_distance(const sf_model *model, const double x[3], const double direction[3]);
