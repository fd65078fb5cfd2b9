/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The supports: rigid fixed bodies of any shape that the pad may touch (theory, section "Contact of the pad
 * with itself"). */
#pragma once
#include "case/case.h"
#include "pre/mesh/mesh.h"

/* The surface of a support that is a plane: two triangles, far wider than the pad. */
sf_status sf_support_plane(const sf_case_support *plane, const sf_mesh *mesh, sf_surface *out, sf_error *err);

/* Takes the surfaces of the mesh into the model: turned outwards (open parts of files against the missile's
 * direction), with the nodes of sharp edges once for each side. Needs the pad's cells. SF_ERR_INPUT: a part
 * lies inside the pad at the start, or no face of it has a support before it within the pad's thickness. */
sf_status sf_support_take(const sf_case *c, const sf_mesh *mesh, sf_model *model, sf_error *err);

/* Sets the missile's way to the supports; the missile is in its place. SF_ERR_INPUT: it meets one
 * before the pad. */
sf_status sf_support_find_travel(sf_model *model, sf_error *err);

/* Distance (m) from x along the unit vector `direction` to the supports; infinity: none is there. */
double sf_support_distance(const sf_model *model, const double x[3], const double direction[3]);
