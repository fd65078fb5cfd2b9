/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mesh of a geometry, kept in a store (io/store.h) for the drops of a campaign: as gmsh made it, with the
 * list of what gmsh read. It is used again as long as these files are as they were. */
#ifndef SF_PRE_MESH_MESH_STORE_H
#define SF_PRE_MESH_MESH_STORE_H

#include "pre/mesh/mesher.h"

/* Of the geometry's own file, its parameters and softfall-mesh. False: not known, and nothing is shared. */
bool sf_mesh_store_key(const sf_geo_source *source, uint64_t *key);

/* The mesh into the empty `*out`, and the geometry's part of sf_gmsh_files, from malloc. False: none. */
bool sf_mesh_store_find(const char *folder, const sf_geo_source *source, sf_meshed *out, char **files);
/* Keeps the mesh of a confined gmsh. */
void sf_mesh_store_keep(const char *folder, const sf_geo_source *source, const sf_meshed *meshed,
                        const char *files);

#endif
