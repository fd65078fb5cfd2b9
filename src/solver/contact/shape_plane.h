/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plane that stops the pad: that of the anvil, if the pad may reach it, and those of symmetry, beyond which
 * its mirror image is. */
#pragma once
#include "solver/contact/shape.h"

extern const sf_shape sf_shape_plane;
