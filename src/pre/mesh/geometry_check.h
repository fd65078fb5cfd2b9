/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a geometry file before gmsh opens it. gmsh chooses the format by name and content and runs a file
 * of unknown format as a script; a script can write files and run programs. */
#ifndef SF_PRE_MESH_GEOMETRY_CHECK_H
#define SF_PRE_MESH_GEOMETRY_CHECK_H

#include "core/error.h"

/* SF_ERR_INPUT, naming file and line, for: a file that is missing or no plain file; a name whose ending is
 * none of .geo, .msh and the CAD and mesh formats that are data only; a .msh that does not begin with
 * $MeshFormat; a .geo, or one that it includes, with a command that writes a file, runs a program or ends
 * this one, or an Include or Merge whose file is not named by a plain text. */
sf_status sf_geometry_check(const char *path, sf_error *err);

#endif
