/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plane section with half the spacing. */
#pragma once
#include "pre/mesh/mesh.h"

/* Splits every triangle and quadrangle of a section into four, at the middles of its sides; the sides of the
 * sets likewise. `fine` is empty before, and owns everything; on failure it is empty again. */
sf_status sf_section_refine(const sf_mesh *section, sf_mesh *fine, sf_error *err);

/* Copies a surface; `copy` is empty before and, on failure, again. */
sf_status sf_surface_copy(const sf_surface *surface, sf_surface *copy, sf_error *err);
