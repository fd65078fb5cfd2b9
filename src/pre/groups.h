/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surface groups that a case names. */
#ifndef SF_PRE_GROUPS_H
#define SF_PRE_GROUPS_H

#include "model/model.h"
#include "pre/mesh/mesh.h"

/* The group that the case names under `key`; NULL: SF_ERR_INPUT with the groups that exist. */
const sf_node_set *sf_group_need(const sf_mesh *mesh, const char *key, const char *name, sf_error *err);

/* The axis (0 x, 1 y, 2 z) that a plane group is normal to, or -1. Needs positions and thickness. */
int sf_group_plane_axis(const sf_model *model, const sf_node_set *set);

#endif
