/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Is the pad one body? Parts that do not share cell faces, and cells that lie in each other, cannot be meant.
 */
#ifndef SF_PRE_CLOUD_CONNECTIVITY_H
#define SF_PRE_CLOUD_CONNECTIVITY_H

#include "base/error.h"
#include "pre/cloud/dual.h"
#include "pre/mesh/mesh.h"

/* SF_ERR_INPUT, with the place, if a node or a face of the pad's surface lies inside a cell, if the cells are
 * not all connected through faces, or if those around a node are not. The cost is linear in the number of
 * cells. */
sf_status sf_connectivity_check(const sf_mesh *mesh, const sf_dual *dual, sf_error *err);

#endif
