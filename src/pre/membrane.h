/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Covers without cells: the membrane on faces of the pad (theory, section "Membranes"). */
#pragma once
#include "base/error.h"
#include "case/case.h"
#include "model/model.h"
#include "pre/cloud/dual.h"
#include "pre/cloud/layers.h"

/* Sets the model's membrane to the faces of the case's groups on the surface of the whole mesh. SF_ERR_INPUT:
 * a group has no face there, or two of them share one. */
sf_status sf_membrane_take(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual,
                           const sf_layers *layers, sf_model *model, sf_error *err);
/* Adds its mass to those of the nodes. */
void sf_membrane_weigh(sf_model *model);
