/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The symmetry planes of a model. */
#ifndef SF_CORE_SYMMETRY_H
#define SF_CORE_SYMMETRY_H

#include "model/model.h"

/* Is a plane normal to the axis (0 x, 1 y) a symmetry plane of the model, which has its sets? Then *place (m)
 * is where on that axis; else 0. */
bool sf_symmetry_plane(const sf_model *model, int axis, double *place);

#endif
