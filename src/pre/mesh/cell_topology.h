/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices, edges and outward faces of the linear cells, in VTK vertex order. */
#ifndef SF_PRE_MESH_CELL_TOPOLOGY_H
#define SF_PRE_MESH_CELL_TOPOLOGY_H

typedef struct sf_cell_topology {
    int vertices;
    int edges;
    int faces;
    int edge[12][2];
    int face_size[6];
    int face[6][4];       /* vertices, counter-clockwise seen from outside */
    int edge_face[12][2]; /* the face that runs along edge (a, b) from a to b, and the one from b to a */
} sf_cell_topology;

/* Table of a cell type (SF_CELL_*); NULL for any other code. Static storage. */
const sf_cell_topology *sf_cell_topology_of(int type);

#endif
