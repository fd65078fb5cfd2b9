/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mesh of a geometry, kept in a store (io/folder.h) for the drops of a campaign: as gmsh made it, with
 * the list of what gmsh read. It is used again as long as these files are as they were. */
#pragma once
#include "pre/mesh/mesher.h"

/* The list of what geometries read (sf_gmsh.files), compared with the files as they are. */

#define SF_GMSH_FILES_OF "geometry"
#define SF_GMSH_UNKNOWN_FILES "unknown"

/* True if every file of the list has the content that it had, and none got options beside it. `folder`:
 * those of the geometries of pad, missile and supports, where paths in the list begin; "" or NULL without
 * one. False, too, where the list does not know all files. */
bool sf_geometry_files_are_same(const char *const folder[SF_GEOMETRIES], const char *files);

/* The mesh into the empty `*out`, and the geometry's part of sf_gmsh.files, from malloc. False: none. */
bool sf_mesh_store_find(const char *folder, const sf_geo_source *source, sf_meshed *out, char **files);
/* Keeps the mesh of a confined gmsh. */
void sf_mesh_store_keep(const char *folder, const sf_geo_source *source, const sf_meshed *meshed,
                        const char *files);
