/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "case/case.h"
#include "pre/mesh/broker.h"

/* Reads the mesh stream of softfall-mesh (mesher_protocol.h), which may hold anything: every count is checked
 * against what is there, every number against its range, before anything is allocated. */

enum { SF_GEO_NAME_SIZE = 256, SF_GEO_MAX_GROUPS = 4096 };

/* A physical group. */
typedef struct sf_geo_group {
    int32_t dimension, tag;      /* 2 or 3 */
    char name[SF_GEO_NAME_SIZE]; /* "" if it has none */
    size_t count;
    int32_t *entity; /* [count] ascending, owned */
} sf_geo_group;

/* The elements of one type of one surface or volume. */
typedef struct sf_geo_block {
    int32_t dimension, entity, type; /* type: gmsh's number */
    char type_name[64];
    size_t length;
    const uint64_t *node; /* [length] tags, in the stream */
} sf_geo_block;

/* A mesh as gmsh made it. Arrays in the stream are borrowed from it. */
typedef struct sf_geo_data {
    char version[32]; /* of gmsh */
    char error[1024]; /* gmsh's error; then there is nothing else */
    size_t node_count;
    const uint64_t *tag; /* [node_count] not 0 */
    const double *xyz;   /* [node_count][3] finite */
    size_t group_count;
    sf_geo_group *group; /* [group_count], owned */
    size_t block_count;
    sf_geo_block *block; /* [block_count] ascending by dimension and entity; owned */
} sf_geo_data;

/* `data` must be aligned for 64 bits and outlive `*out`. SF_ERR_INPUT: the stream is cut or damaged, or a
 * position is not finite; `file` for the sentence. On failure `*out` is empty. */
sf_status sf_geo_data_read(const void *data, size_t size, const char *file, sf_geo_data *out, sf_error *err);
void sf_geo_data_free(sf_geo_data *data);

bool sf_geo_group_has(const sf_geo_group *group, int32_t entity);

/* First block of the entity, `*end` is one beyond its last; equal if it has none. */
size_t sf_geo_data_blocks(const sf_geo_data *data, int dimension, int entity, size_t *end);

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
    double seconds;      /* of processor time; 0: SF_MESHER_SECONDS */
    const sf_sink *sink; /* told every ten seconds that gmsh works; may be NULL */
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

/* ---- mesh_store.c ---- */

/* The list of what geometries read (sf_gmsh.files), compared with the files as they are. */

#define SF_GMSH_FILES_OF "geometry"
#define SF_GMSH_UNKNOWN_FILES "unknown"

/* True if every file of the list has the content that it had, and none got options beside it. `folder`:
 * those of the geometries of pad, missile and supports, where paths in the list begin; "" or NULL without
 * one. False, too, where the list does not know all files. */
bool sf_geometry_files_are_same(const char *const folder[SF_GEOMETRIES], const char *files);

/* The mesh of a geometry, kept in a store (io/folder.h) for the drops of a campaign: as gmsh made it, with
 * the list of what gmsh read. It is used again as long as these files are as they were. */

/* The mesh into the empty `*out`, and the geometry's part of sf_gmsh.files, from malloc. False: none. */
bool sf_mesh_store_find(const char *folder, const sf_geo_source *source, sf_meshed *out, char **files);
/* Keeps the mesh of a confined gmsh. */
void sf_mesh_store_keep(const char *folder, const sf_geo_source *source, const sf_meshed *meshed,
                        const char *files);
