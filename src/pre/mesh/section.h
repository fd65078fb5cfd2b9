/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plane section of an axisymmetric drop: triangles and quadrangles in the half plane y = 0, x being the
 * radius R and z the height Z, of a pad that is a plate; and the missile, a body of revolution about the axis
 * x = y = 0. */
#pragma once
#include "case/case.h"
#include "pre/mesh/mesh.h"

/* Says why an axisymmetric model cannot be made of this case, whatever its geometry: an oblique, turning or
 * off-centre missile, supports, a cover without cells, bodies or layers that are loose. */
sf_status sf_section_check_case(const sf_case *c, sf_error *err);

/* Turns the mesh of a pad into its section about the axis: plane cells, drawn with the radius along x and the
 * height along y, are moved into the half plane; of a solid plate with its centre on the axis the faces of
 * its symmetry plane y = 0 become the cells, and its groups their sides there. SF_ERR_INPUT: the section
 * crosses the axis or does not reach it; it is no rectangle, or the pad no plate; there is no such plane. */
sf_status sf_section_take_pad(const sf_case *c, sf_mesh *mesh, sf_error *err);
/* The same of a solid pad, which stays; `section` is empty before and, on failure, again. */
sf_status sf_section_cut(const sf_case *c, const sf_mesh *solid, sf_mesh *section, sf_error *err);

/* Makes the missile's surface one of revolution by its profile: its points where it has no triangles, or the
 * nodes of the surface, whole or a part of it, by radius and height. Its facets touch the profile in the half
 * plane y = 0, where contact is sought. SF_ERR_INPUT: it is no body of revolution about the axis, or its
 * profile is not seen from one point of the axis. */
sf_status sf_section_take_missile(sf_surface *surface, sf_error *err);

/* Makes the cells below the edge of a missile's flat face smaller, since the error that an edge leaves is
 * decided by the spacing there (docs/theory.md, section 14): the edge and 2 spacings about it have at
 * least SF_EDGE_ROWS spacings to the thickness, or a quarter of the mesh's. A missile that has no flat face,
 * or whose edge is rounded more widely than about 2.5 spacings, leaves the mesh as it is, and so does one
 * that sf_section_take_missile refuses. */
enum { SF_EDGE_ROWS = 16 };
sf_status sf_section_refine_edge(const sf_case *c, const sf_surface *missile, sf_mesh *mesh, sf_error *err);
