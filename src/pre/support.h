/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "case/case.h"
#include "model/model.h"
#include "pre/hold.h"
#include "pre/mesh/mesh.h"

/* The surface groups that a case names. */

/* The group that the case names under `key`; NULL: SF_ERR_INPUT with the groups that exist. */
const sf_node_set *sf_group_need(const sf_mesh *mesh, const char *key, const char *name, sf_error *err);

/* The axis (0 x, 1 y, 2 z) that a plane group is normal to, or -1. Needs positions and thickness. */
int sf_group_plane_axis(const sf_model *model, const sf_node_set *set);

/* The support of the pad: pad.base, the groups of pad.fixed and pad.sliding, and the anvil's plane. */

/* By node [node_count]: held components (SF_FIX_*), 1 if they count for the base reaction, 1 if it rests. */
typedef struct sf_base_marks {
    uint8_t *mask, *base, *rest; /* borrowed */
} sf_base_marks;

/* Marks the groups of pad.fixed by pad.base, and those of pad.sliding. Symmetry planes are marked already. */
sf_status sf_base_mark(const sf_case *c, const sf_mesh *mesh, const sf_model *model,
                       const sf_base_marks *marks, sf_error *err);

/* The resting nodes of the model with the loads that carry its weight. Needs the masses. */
sf_status sf_base_rest(const sf_case *c, const sf_base_marks *marks, sf_model *model, sf_error *err);

/* The anvil below the pad: the plane of its underside if most of that is held or rests; or none. */
void sf_base_place_anvil(const sf_case *c, const sf_hold *hold, sf_model *model);
