/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shapes of the cells of the background mesh, as places in a cell's vertex list; the skin of a mesh. */
#pragma once
#include "base/error.h"
#include <stdint.h>

/* A shape of linear cells, in VTK vertex order. Corners are (corner, three neighbours) whose edges form a
 * right-handed triad in a good cell. The apex of a pyramid has four edges and is left out: its base corners
 * see the same volume. */
typedef struct sf_cell_shape {
    const char *name;
    int vertices, edges, faces, tetrahedra, corners;
    int edge[12][2];
    int face[6][4];        /* counter-clockwise seen from outside, -1 in the fourth place of a triangle; of a
                              plane cell its sides, counter-clockwise in (R, Z), -1 in the last two */
    int edge_face[12][2];  /* the face that runs along edge (a, b) from a to b, and the one from b to a */
    int tetrahedron[6][4]; /* they fill the cell */
    int corner[8][4];      /* of a plane cell: corner, next one, the one before, -1 */
    int mirror[8];         /* the order of the vertices of its mirror image */
} sf_cell_shape;

/* The shape of a cell type (SF_CELL_*); NULL for any other code. Static storage. */
const sf_cell_shape *sf_cell_shape_of(int type);

/* Vertices of a face: 3 or 4; 2 of a plane cell. */
static inline int sf_cell_face_size(const sf_cell_shape *shape, int face) {
    int triangle = shape->face[face][2] < 0 ? 2 : 3;
    return shape->face[face][3] < 0 ? triangle : 4;
}

/* True of a cell of a plane section: in the half plane y = 0, x being the radius R and z the height Z. */
static inline bool sf_cell_is_plane(const sf_cell_shape *shape) {
    return shape->tetrahedra == 0;
}

/* A mesh, borrowed. */
typedef struct sf_cells {
    int64_t node_count, cell_count;
    const double *position; /* [node_count][3] m */
    const uint8_t *type;
    const int64_t *ptr;
    const int32_t *node;
} sf_cells;

/* A face of a cell. */
typedef struct sf_cell_face {
    int32_t key[4]; /* its nodes, ascending; the first is -1 for a triangle, the first two for a side */
    int32_t cell;
    int8_t local; /* its place among the faces of the cell */
} sf_cell_face;

/* The `*count` faces of all cells, in the order of `compare` (qsort). `place` (base/sets.h): nodes of one set
 * count as one; NULL: each is alone. Owned by the caller; NULL: out of memory. */
sf_cell_face *sf_cell_faces(const sf_cells *cells, int64_t *place,
                            int (*compare)(const void *one, const void *other), int64_t *count,
                            sf_error *err);

/* The faces that belong to one cell only and the nodes on them; of a section its cells. */
typedef struct sf_skin_faces {
    int64_t face_count, node_count;
    int32_t (*face)[4]; /* [face_count] places in `node`, -1 in the fourth place of a triangle; owned */
    int32_t *node;      /* [node_count] node of the mesh, ascending; owned */
} sf_skin_faces;

/* Release with sf_skin_faces_free, also after a failure. */
sf_status sf_skin_faces_find(const sf_cells *cells, sf_skin_faces *skin, sf_error *err);
void sf_skin_faces_free(sf_skin_faces *skin);

/* The sides of a section that belong to one cell only, counter-clockwise about it: *side [*count][2] nodes,
 * owned by the caller. */
sf_status sf_section_sides(const sf_cells *cells, int64_t *count, int32_t **side, sf_error *err);

/* The cells of a model or of results, at this address. */
#define SF_CELLS_OF(of)                                                                                      \
    ((sf_cells){(of)->node_count, (of)->cell_count, (of)->position, (of)->cell_type, (of)->cell_ptr,         \
                (of)->cell_node})

/* The free faces of the cells as triangles, turned outwards: *node [*count][3], and, unless `half` is NULL,
 * *half [*count] as of sf_model.skin_half; owned by the caller. Faces between layers are among them, once for
 * each layer. */
sf_status sf_skin_triangles(const sf_cells *cells, int64_t *count, int32_t **node, uint8_t **half,
                            sf_error *err);
