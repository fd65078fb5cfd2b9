/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Differences between the versions of gmsh's C API, from 4.8 on, for the mesher (gui/gmsh/window.c has its
 * own). */
#ifndef SF_MESHER_GMSH_ADAPTER_H
#define SF_MESHER_GMSH_ADAPTER_H

#include <stddef.h>

/* Starts gmsh without its configuration files and without its window. Returns gmsh's code: 0 on success. */
int sf_gmsh_adapter_initialize(void);

/* The version of the library that runs, for example "4.8.4", which may be newer than the header; writes at
 * most `size` bytes to `out`. gmsh must be started. */
void sf_gmsh_adapter_version(char *out, size_t size);

#endif
