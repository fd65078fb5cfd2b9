/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An axisymmetric drop that is like one on a tile, on posts, or of an oblique missile: a glued plate of the
 * same foam, thickness and spacing, hit straight by a sphere of the same mass and with the same contact zone.
 * Its error by the mesh is known from a finer one. */
#pragma once
#include "case/case.h"
#include "pre/drop_check.h"

/* Nodes of a section at most that is simulated beside the drop. */
enum { SF_SECTIONS_MOST = 800 };

/* Fills the mesh of the plate's section, and the sphere's profile; both are empty before and, on failure,
 * again. SF_ERR_INPUT: the plate has more than SF_SECTIONS_MOST nodes, the pad has layers of several foams, a
 * cover without cells, or a missile whose motion is prescribed. */
sf_status sf_alike_make(const sf_case *c, const sf_model *model, const sf_contact_zone *zone, sf_mesh *mesh,
                        sf_surface *missile, sf_error *err);

/* Makes the case of a drop that of the plate; its groups are those of the plate's mesh. */
void sf_alike_case(sf_case *c);
