/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The only code that calls gmsh (C API), with gmsh_adapter.h and gmsh_size.h. A session reads geometries that
 * gmsh can open (.geo, .msh, .step with groups), sets their parameters, meshes them if they hold no mesh, and
 * hands out the pad's cells and the missile's surface. gmsh is not re-entrant: one session at a time. */
#ifndef SF_PRE_MESH_GMSH_SESSION_H
#define SF_PRE_MESH_GMSH_SESSION_H

#include "core/error.h"
#include "case/case.h"
#include "pre/mesh/mesh.h"

typedef struct sf_gmsh sf_gmsh;

sf_status sf_gmsh_begin(sf_gmsh **session, sf_error *err);
void sf_gmsh_end(sf_gmsh **session);

/* Opens a geometry with its parameters and meshes it. Errors: file missing, gmsh's own errors with file and
 * line, a parameter that the file does not define, no mesh. Replaces the model that was open. */
sf_status sf_gmsh_load(sf_gmsh *session, const sf_geo_source *source, sf_error *err);

/* The pad: cells of the volume group `pad_group`, and all surface groups on its boundary, scaled by `unit` (m
 * per unit). Errors name the groups that exist; an entity in two groups of the same dimension, an empty
 * group, a cell type other than linear tetrahedron, pyramid, prism, hexahedron are refused. */
sf_status sf_gmsh_read_mesh(sf_gmsh *session, const char *pad_group, double unit, sf_mesh *mesh,
                            sf_error *err);

/* The triangles (quadrangles are split) of the surface group, turned outwards. */
sf_status sf_gmsh_read_surface(sf_gmsh *session, const char *surface_group, double unit, sf_surface *surface,
                               sf_error *err);

/* The version of gmsh that runs, for example "4.8.4"; valid as long as the session. */
const char *sf_gmsh_version(const sf_gmsh *session);

#endif
