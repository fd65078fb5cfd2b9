/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cells of the background mesh, as tetrahedra and by their faces; positions in a cell's vertex list. */
#pragma once
#include "base/error.h"
#include <stdint.h>

/* Vertices of a cell of this type; 0: there is no such type. */
int sf_cell_vertices(int type);

/* Tetrahedra that fill a cell of this type (SF_CELL_*), static storage; returns how many. */
int sf_cell_tetrahedra(int type, const int (**tetrahedra)[4]);

/* Faces in order around them, counter-clockwise seen from outside, -1 in the fourth place of a triangle;
 * returns how many. */
int sf_cell_faces(int type, const int (**faces)[4]);

/* A mesh, borrowed. */
typedef struct sf_cells {
    int64_t node_count, cell_count;
    const double *position; /* [node_count][3] m */
    const uint8_t *type;
    const int64_t *ptr;
    const int32_t *node;
} sf_cells;

/* The faces that belong to one cell only and the nodes on them. */
typedef struct sf_skin_faces {
    int64_t face_count, node_count;
    int32_t (*face)[4]; /* [face_count] places in `node`, -1 in the fourth place of a triangle; owned */
    int64_t *node;      /* [node_count] node of the mesh, ascending; owned */
} sf_skin_faces;

/* Release with sf_skin_faces_free, also after a failure. */
sf_status sf_skin_faces_find(const sf_cells *cells, sf_skin_faces *skin, sf_error *err);
void sf_skin_faces_free(sf_skin_faces *skin);
