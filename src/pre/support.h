/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The holding of the pad: the surface groups that a case names, the base (pad.base, the groups of pad.fixed
 * and pad.sliding, the anvil's plane), and the supports, rigid fixed bodies of any shape that the pad may
 * touch (theory, section "Contact of the pad with itself"). */
#pragma once
#include "case/case.h"
#include "pre/hold.h"
#include "pre/mesh/mesh.h"

/* The group that the case names under `key`; NULL: SF_ERR_INPUT with the groups that exist. */
const sf_node_set *sf_group_need(const sf_mesh *mesh, const char *key, const char *name, sf_error *err);

/* True if the group is a plane normal to the axis, at `place` (m). */
bool sf_group_is_plane(const sf_model *model, const sf_node_set *set, int axis, double *place);
/* The axis (0 x, 1 y, 2 z) that a plane group is normal to, or -1. Needs positions and thickness. */
int sf_group_plane_axis(const sf_model *model, const sf_node_set *set);

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
