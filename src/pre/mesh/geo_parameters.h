/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters that a .geo file offers: gmsh itself accepts a value for any name without a message, so that
 * a misspelt parameter would keep its default unnoticed. */
#ifndef SF_PRE_MESH_GEO_PARAMETERS_H
#define SF_PRE_MESH_GEO_PARAMETERS_H

#include "core/error.h"
#include "case/case.h"

/* Refuses a parameter of the source that no DefineConstant of its .geo file (or of the files that it includes
 * or merges) defines; the sentence lists those that exist. Any other kind of file offers none. */
sf_status sf_geo_parameters_check(const sf_geo_source *source, sf_error *err);

#endif
