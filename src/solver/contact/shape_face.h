/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces of the pad and of supports. A node touches a face only if it comes from outside: one that lies deeper
 * behind a face than it may, as behind the other side of a thin wall, does not see it. */
#pragma once
#include "solver/contact/shape.h"

extern const sf_shape sf_shape_face;
