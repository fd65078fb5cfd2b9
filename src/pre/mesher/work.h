/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdint.h>

/* Differences between the versions of gmsh's C API, from 4.8 on, for the mesher (gui/gmsh/window.c has its
 * own). */

/* Starts gmsh without its configuration files and without its window. Returns gmsh's code: 0 on success. */
int sf_gmsh_adapter_initialize(void);

/* The only code that calls gmsh (C API): opens the geometry of a request, meshes it if
 * it holds no mesh, and writes the mesh stream. */

/* Starts gmsh. Returns gmsh's code: 0 on success. */
int sf_work_begin(void);

/* Merges the .geo text `parameters` and the geometry. False: the stream holds gmsh's error. */
_Bool sf_work_parse(const char *parameters, const char *path);
/* Meshes what sf_work_parse read and writes the stream. */
void sf_work_mesh(const char *path);
