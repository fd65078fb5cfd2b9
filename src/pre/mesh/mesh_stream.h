/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the mesh stream of softfall-mesh (mesher_protocol.h), which may hold anything: every count is checked
 * against what is there, every number against its range, before anything is allocated. */
#pragma once
#include "base/error.h"
#include <stdint.h>

enum { SF_GEO_NAME_SIZE = 256, SF_GEO_MAX_GROUPS = 4096 };

/* A physical group. */
typedef struct sf_geo_group {
    int32_t dimension, tag;      /* 1, only in a geometry without cells, 2 or 3 */
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
