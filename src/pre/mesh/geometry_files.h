/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of what geometries read (sf_gmsh_files), compared with the files as they are. */
#ifndef SF_PRE_MESH_GEOMETRY_FILES_H
#define SF_PRE_MESH_GEOMETRY_FILES_H

#include <stdbool.h>

#define SF_GMSH_FILES_OF "geometry"
#define SF_GMSH_UNKNOWN_FILES "unknown"

/* Has every file of the list the content that it had, and has none got options beside it? `folder`: of the
 * pad's and of the missile's geometry, where paths in the list begin; "" without a geometry of the missile.
 * False, too, where the list does not know all files. */
bool sf_geometry_files_are_same(const char *const folder[2], const char *files);

#endif
