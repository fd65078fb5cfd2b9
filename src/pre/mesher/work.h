/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_PRE_MESHER_WORK_H
#define SF_PRE_MESHER_WORK_H
#include <stddef.h>
#include <stdint.h>

/* Differences between the versions of gmsh's C API, from 4.8 on, for the mesher (gui/gmsh/window.c has its
 * own). */

/* Starts gmsh without its configuration files and without its window. Returns gmsh's code: 0 on success. */
int sf_gmsh_adapter_initialize(void);

/* The version of the library that runs, for example "4.8.4", which may be newer than the header; writes at
 * most `size` bytes to `out`. gmsh must be started. */
void sf_gmsh_adapter_version(char *out, size_t size);

/* Writes the mesh stream (pre/mesh/mesher_protocol.h) to SF_MESHER_DATA. A parent that does not listen ends
 * this process. */

void sf_stream_word(uint64_t word);
void sf_stream_int(int value);
void sf_stream_text(const char *text);
/* `size` bytes, a multiple of 8. */
void sf_stream_words(const void *data, size_t size);
void sf_stream_flush(void);

/* The only code that calls gmsh (C API), with gmsh_adapter.h: opens the geometry of a request, meshes it if
 * it holds no mesh, and writes the mesh stream. */

/* Starts gmsh. Returns gmsh's code: 0 on success. */
int sf_work_begin(void);

/* Merges the .geo text `parameters` and the geometry. False: the stream holds gmsh's error. */
_Bool sf_work_parse(const char *parameters, const char *path);
/* Meshes what sf_work_parse read and writes the stream. */
void sf_work_mesh(const char *path);
#endif
