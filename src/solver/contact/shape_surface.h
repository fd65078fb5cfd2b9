/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A rigid surface of triangles, with the signed distance by angle-weighted normals (Baerentzen, Aanaes 2005).
 */
#pragma once
#include "solver/contact/shape.h"

extern const sf_shape sf_shape_surface;
