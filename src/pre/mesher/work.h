/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdint.h>

/* Takes from this process what a hostile geometry could do harm with. Irrevocable. */

/* Limits of memory (bytes beyond what is mapped now; 0: none; none in builds with a sanitizer, whose shadow
 * takes terabytes), of processor time (seconds; 0: none), no core file, no file that grows, few open files;
 * first to be ended when the machine has no memory; ends with its parent. */
void sf_confine_resources(uint64_t bytes, uint64_t seconds);

/* Makes the kernel refuse every system call that is not on a list (EPERM): no program, file name, socket,
 * signal to others, new executable memory. A file can only be opened by the parent, at the other end of
 * the socket SF_MESHER_CONTROL (mesher_protocol.h): open() sends its path there and receives the file. An
 * attempt to start a program is told to the parent. Returns 0, or an errno value if the kernel cannot do
 * this; then nothing is confined. */
int sf_confine_calls(void);

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
