/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sharp edges of the pad that cross: nodes against faces do not see them before an edge has sunk in by up to
 * half a spacing (docs/adr/0024). Their candidates are those of their nodes; deeper edges than the limit lie
 * on the far sides of a thin part. */
#pragma once
#include "solver/contact/shape.h"

extern const sf_shape sf_shape_edge;
