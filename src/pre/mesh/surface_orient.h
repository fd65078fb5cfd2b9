/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turns the missile's surface towards the pad: contact sees only what its normals face. */
#ifndef SF_PRE_MESH_SURFACE_ORIENT_H
#define SF_PRE_MESH_SURFACE_ORIENT_H

#include "base/error.h"
#include "pre/mesh/mesh.h"

/* Parts (triangles joined by edges) without cells behind them are turned as one: a closed part outwards, an
 * open one so that its area faces along `direction`, the missile's motion. Parts with cells behind them stay
 * as they are. SF_ERR_INPUT: a part is one-sided (a Moebius strip), or no triangle faces along `direction`.
 */
sf_status sf_surface_orient(sf_surface *surface, const double direction[3], sf_error *err);

#endif
