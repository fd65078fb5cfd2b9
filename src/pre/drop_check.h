/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Does a model make sense as a drop? The checks that need the case and the group names of the geometry, which
 * sf_model_check does not have. */
#ifndef SF_PRE_DROP_CHECK_H
#define SF_PRE_DROP_CHECK_H

#include "base/error.h"
#include "model/model.h"
#include "base/sink.h"
#include "case/case.h"
#include "pre/mesh/mesh.h"
#include "pre/mesh_error.h"

/* SF_ERR_INPUT, naming the key, the value and the bound: the pad's thickness is not one of a pad; the
 * missile's share in the model is lighter than a node; the missile starts inside the pad; it is not symmetric
 * to a symmetry plane, or cut open where there is none; the mesh is too coarse for pad.mesh_error_limit. The
 * model has its nodes, its sets and its missile; the mesh still has its sets. */
sf_status sf_drop_check(const sf_case *c, const sf_mesh *mesh, const sf_model *m, const sf_contact_zone *zone,
                        sf_error *err);

/* Warns of a symmetry group of the geometry that the case does not hold, of a material where the solver is
 * known to be weak (sf_law.caution), and of a coarse mesh. */
void sf_drop_warn(const sf_case *c, const sf_mesh *mesh, const sf_model *m, const sf_contact_zone *zone,
                  const sf_sink *sink);

#endif
