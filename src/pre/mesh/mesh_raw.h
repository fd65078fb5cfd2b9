/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The raw mesh of a mesh generator: nodes by tag, cells and faces by node tags; and its conversion to
 * sf_mesh. */
#pragma once
#include "pre/mesh/mesh.h"

enum { SF_RAW_CELL = 8, SF_RAW_FACE = 4 };

typedef struct sf_raw_mesh {
    size_t node_count;
    size_t *tag; /* [node_count] positive, in any order */
    double *xyz; /* [node_count][3] in the geometry's unit */
    size_t cell_count;
    uint8_t *cell_type;   /* [cell_count] SF_CELL_* */
    uint8_t *cell_chosen; /* [cell_count] 0: of no group asked for; else 1 + place of its group among them */
    size_t *cell_node;    /* [cell_count][SF_RAW_CELL] tags, VTK order; unused ones 0 */
    size_t face_count;
    int32_t *face_group; /* [face_count] index of the surface group */
    int32_t *face_part;  /* [face_count] geometrical entity: faces of one part are turned alike */
    size_t *face_node;   /* [face_count][SF_RAW_FACE] tags; the fourth is 0 for a triangle */
    int group_count;
    char **group_name; /* [group_count] */
} sf_raw_mesh;

void sf_raw_mesh_free(sf_raw_mesh *raw);
/* Adds a cell or face with the `count` tags of `node`. */
sf_status sf_raw_mesh_add_cell(sf_raw_mesh *raw, int type, int chosen, const size_t *node, int count,
                               sf_error *err);
sf_status sf_raw_mesh_add_face(sf_raw_mesh *raw, int32_t group, int32_t part, const size_t *node, int count,
                               sf_error *err);

/* Node tags in ascending order with the place of each in `tag`; tags may have gaps of any size. */
typedef struct sf_tag_index {
    size_t tag;
    size_t place;
} sf_tag_index;

/* [node_count], owned by the caller (free). */
sf_tag_index *sf_raw_mesh_index(const sf_raw_mesh *raw, sf_error *err);
/* Place of a tag in `raw->tag`; SIZE_MAX if there is no such node. */
size_t sf_raw_mesh_find(const sf_raw_mesh *raw, const sf_tag_index *index, size_t tag);
/* The place itself, in the geometry's unit; NULL. */
const double *sf_raw_mesh_place(const sf_raw_mesh *raw, const sf_tag_index *index, size_t tag);
/* The ascending tags of a face of a cell, 0 in front of those of a triangle. */
void sf_raw_cell_face(const sf_raw_mesh *raw, size_t cell, int face, size_t tag[SF_RAW_FACE]);
/* The order of two faces by such tags, with which they begin; for qsort. */
int sf_raw_face_compare(const void *one, const void *other);

/* The chosen cells with the nodes they use, in the order of `tag`, and for each group the nodes of its faces
 * that belong wholly to those cells (groups without such faces give no set). `layers`: groups asked for. On
 * failure `*mesh` is empty. */
sf_status sf_mesh_assemble(const sf_raw_mesh *raw, int layers, double unit, sf_mesh *mesh, sf_error *err);

/* All faces as triangles, turned away from the cells behind them; where there are no cells, away from the
 * centroid of all faces, part by part. A face between cells is refused. On failure `*surface` is empty. */
sf_status sf_surface_assemble(const sf_raw_mesh *raw, double unit, sf_surface *surface, sf_error *err);
