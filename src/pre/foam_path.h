/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thickness of the pad where the missile hits it: the length of foam on the missile's path. */
#pragma once
#include "model/model.h"

/* Sets model->thickness, which is the extent along z until then. A ray from each face that the missile may
 * touch goes along its direction through the foam, also through holes and layers, to the first face that is
 * held or rests, or to the end of the foam. The thickness is the vertical part of the shortest of these
 * lengths over the contact zone, the faces that the missile reaches on its first half of the length under the
 * first touch. model->air is the vertical part of the air on that way, between parts of foam and below them
 * to the anvil, which the foam must cross before it is pressed altogether. `between` fails if a part of the
 * missile passes between the contact nodes. Needs cells, constraints and the placed missile. */
sf_status sf_foam_path_measure(sf_model *model, sf_error *between, sf_error *err);
