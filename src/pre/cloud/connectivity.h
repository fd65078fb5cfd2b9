/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of the mesh of a pad: it is one body, or several with `separate`, whose parts share cell faces, and
 * no cells lie in each other; the surface groups that a case names lie on its surface. Where cells are
 * missing they do not. */
#pragma once
#include "case/case.h"
#include "pre/cloud/dual.h"

/* SF_ERR_INPUT, with the place, if a node or a face of the pad's surface lies inside a cell, if the cells are
 * not all connected through faces (unless `separate`), or if those around a node are not. The cost is linear
 * in the number of cells. */
sf_status sf_connectivity_check(const sf_mesh *mesh, const sf_dual *dual, bool separate, sf_error *err);

/* SF_ERR_INPUT, with the place, if a face of the groups for contact, base or symmetry has no cell of the pad
 * behind it, if one of contact or symmetry lies inside the pad, or if a face in the plane of a symmetry group
 * is not in that group. Groups that do not exist, and sets without faces, are left to others. */
sf_status sf_group_check(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, sf_error *err);
