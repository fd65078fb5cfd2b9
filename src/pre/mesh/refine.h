/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plane section with half the spacing. */
#pragma once
#include "pre/mesh/mesh.h"

/* Splits the marked triangles and quadrangles of a section (`marked` [cells]; NULL: all) into four, at the
 * middles of their sides, their neighbours into triangles that have these middles as corners, and the sides
 * of the sets likewise. `fine` is empty before, and owns everything; on failure it is empty again. */
sf_status sf_section_refine(const sf_mesh *section, const uint8_t *marked, sf_mesh *fine, sf_error *err);

/* Copies a surface; `copy` is empty before and, on failure, again. */
sf_status sf_surface_copy(const sf_surface *surface, sf_surface *copy, sf_error *err);
