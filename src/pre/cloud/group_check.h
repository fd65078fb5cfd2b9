/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Do the surface groups that a case names lie on the surface of the pad? Where cells are missing they do not.
 */
#ifndef SF_PRE_CLOUD_GROUP_CHECK_H
#define SF_PRE_CLOUD_GROUP_CHECK_H

#include "case/case.h"
#include "base/error.h"
#include "pre/cloud/dual.h"
#include "pre/mesh/mesh.h"

/* SF_ERR_INPUT, with the place, if a face of the groups for contact, base or symmetry has no cell of the pad
 * behind it, if one of contact or symmetry lies inside the pad, or if a face in the plane of a symmetry group
 * is not in that group. Groups that do not exist, and sets without faces, are left to others. */
sf_status sf_group_check(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, sf_error *err);

#endif
