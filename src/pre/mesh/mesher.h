/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "case/case.h"
#include "pre/mesh/broker.h"
#include "pre/mesh/mesh_stream.h"
#include "pre/mesh/mesher_spare.h"

/* The memory that softfall-pre may take: SOFTFALL_MEMORY_MB of the environment if it is set, else the
 * memory that Linux calls available. */

/* Bytes; INFINITY if unknown. */
double sf_memory_available(void);

/* The path of softfall-mesh: in SF_BIN_DIR if that is set, else beside this program or library, in
 * libexec/softfall or bin of a folder above it, or where it was to be installed. SF_ERR_IO: it is nowhere. */
sf_status sf_mesher_find(char *path, size_t size, sf_error *err);

/* Runs gmsh on a geometry in a process of its own, softfall-mesh, that can neither start programs nor open
 * files (docs/adr/0014-confined-gmsh.md). Whatever the geometry does there, this process gets a mesh or an
 * error. */

typedef struct sf_mesher_limits {
    double seconds;         /* of processor time; 0: SF_MESHER_SECONDS */
    const sf_sink *sink;    /* told every ten seconds that gmsh works; may be NULL */
    sf_mesher_spare *spare; /* for several geometries; borrowed, NULL: none */
} sf_mesher_limits;

enum { SF_MESHER_SECONDS = 600 };

typedef struct sf_meshed {
    sf_geo_data data;
    void *stream;     /* `data` borrows from it */
    size_t size;      /* of the stream, bytes */
    sf_broker broker; /* what was read */
    bool confined;
} sf_meshed;

/* SF_ERR_INPUT: the file is missing or not plain, gmsh reports an error (with file and line), crashes, takes
 * too long or too much memory, the geometry tries to start a program, a parameter is not defined in it.
 * SF_ERR_IO: softfall-mesh is missing or cannot be started, or the kernel cannot confine it (the environment
 * SOFTFALL_UNCONFINED=1 allows that). On failure
 * `*out` is empty. */
sf_status sf_mesher_run(const sf_geo_source *source, const sf_mesher_limits *limits, sf_meshed *out,
                        sf_error *err);
void sf_meshed_free(sf_meshed *meshed);
