/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Part of the gmsh session (pre/mesh/gmsh_session.h): an estimate of the memory for the mesh of the open
 * geometry. */
#ifndef SF_PRE_MESH_GMSH_SIZE_H
#define SF_PRE_MESH_GMSH_SIZE_H

#include "core/error.h"

/* SF_ERR_INPUT if the memory for the mesh is more than sf_memory_available. A process of its own meshes the
 * curves only, within that memory and a minute; the estimate comes from their mean spacing and the volumes'
 * boxes and is good to a factor of about 2. This process's model is not touched, so that its mesh keeps its
 * bits. `file` for the sentence.
 */
sf_status sf_gmsh_check_size(const char *file, sf_error *err);

#endif
