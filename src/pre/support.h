/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the pad stands on: pad.base, the groups of pad.fixed and pad.sliding, and the anvil's plane. */
#ifndef SF_PRE_BASE_H
#define SF_PRE_BASE_H

#include "case/case.h"
#include "pre/hold.h"
#include "pre/mesh/mesh.h"

/* By node [node_count]: held components (SF_FIX_*), 1 if they count for the base reaction, 1 if it rests. */
typedef struct sf_base_marks {
    uint8_t *mask, *base, *rest; /* borrowed */
} sf_base_marks;

/* Marks the groups of pad.fixed by pad.base, and those of pad.sliding. Symmetry planes are marked already. */
sf_status sf_base_mark(const sf_case *c, const sf_mesh *mesh, const sf_model *model,
                       const sf_base_marks *marks, sf_error *err);

/* The resting nodes of the model with the loads that carry its weight. Needs the masses. */
sf_status sf_base_rest(const sf_case *c, const sf_base_marks *marks, sf_model *model, sf_error *err);

/* The anvil below the pad: the plane of its underside if most of that is held or rests; else there is none.
 */
void sf_base_place_anvil(const sf_case *c, const sf_hold *hold, sf_model *model);

#endif
