/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The exact cap of a sphere. */
#pragma once
#include "solver/contact/shape.h"

extern const sf_shape sf_shape_sphere;
