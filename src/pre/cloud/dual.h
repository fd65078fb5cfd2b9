/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "pre/mesh/mesh.h"

/* Topology of the median dual of the background mesh: its edges with the cells around each, and its boundary
 * faces. The smoothing domain of a node is bounded, in each cell, by one facet per cell edge that ends at the
 * node: the quadrangle (edge midpoint, face centroid, cell centroid, face centroid), as two triangles
 * (theory, section 2). */

/* One appearance of an edge in a cell. `reversed`: the cell's edge runs from the higher node to the lower
 * one. */
typedef struct sf_edge_use {
    int32_t cell;
    int8_t local; /* edge number in the cell's topology table */
    int8_t reversed;
} sf_edge_use;

typedef struct sf_boundary_face {
    int32_t cell;
    int8_t local;    /* face number in the cell's topology table */
    int8_t size;     /* 3 or 4; 2 in a section */
    int32_t node[4]; /* counter-clockwise seen from outside; of a side counter-clockwise about its cell */
} sf_boundary_face;

/* A face that two cells share. */
typedef struct sf_inner_face {
    int32_t cell[2];
    int32_t node[4]; /* ascending; the first is -1 for a triangle, the first two for a side */
} sf_inner_face;

typedef struct sf_dual {
    int64_t edge_count;
    int32_t *edge;    /* [edge_count][2] low node, high node; ascending */
    int64_t *use_ptr; /* [edge_count + 1] */
    sf_edge_use *use; /* [..] ascending by cell within an edge */
    int64_t face_count;
    sf_boundary_face *face; /* [face_count] faces that belong to one cell only */
    int64_t inner_count;
    sf_inner_face *inner; /* [inner_count] */
    int64_t *edge_ptr;    /* [nodes + 1] symmetric adjacency of the edges */
    int32_t *edge_node;   /* [2 edge_count] node at the other end, ascending within a row */
    int64_t *edge_id;     /* [2 edge_count] which edge it is */
} sf_dual;

/* Builds the dual of a mesh; refuses a face of more than two cells or seen from the same side by both. */
sf_status sf_dual_build(const sf_mesh *mesh, sf_dual *dual, sf_error *err);
void sf_dual_free(sf_dual *dual);

/* A triangle of a facet: centroid (m) and area vector (m2). In a section a facet is a line, and stands for
 * two of Gauss's points of the surface that it makes about the axis: place and 2 pi R N dl. */
typedef struct sf_facet_triangle {
    double centroid[3];
    double area[3];
} sf_facet_triangle;

/* The two triangles of the facet of one edge use; area vectors point from the edge's low node to its high
 * node. */
void sf_dual_facet(const sf_mesh *mesh, const sf_edge_use *use, sf_facet_triangle out[2]);

/* A section's points of integration over the domains of the edge's low and high node, between node, middle of
 * the edge and centre of the cell: places (m) and 2 pi dA (m2). */
void sf_dual_fan(const sf_mesh *mesh, const sf_edge_use *use, double place[2][3], double weight[2]);

/* The two boundary triangles that belong to vertex `corner` of a boundary face (outward), and for each the
 * weights that express its centroid by the face's vertices. */
void sf_dual_boundary(const sf_mesh *mesh, const sf_boundary_face *face, int corner, sf_facet_triangle out[2],
                      double weight[2][4]);

/* A surface group as faces: the boundary faces whose nodes all belong to it. Its area by nodes, and the way
 * it looks. */

enum { SF_ANY_LAYER = -1 };

/* [mesh->node_count] 1: the node is in the set; owned by the caller, NULL on failure. */
uint8_t *sf_surface_members(const sf_mesh *mesh, const sf_node_set *set, sf_error *err);
/* True if all nodes of the face are members. */
bool sf_surface_has_face(const sf_boundary_face *face, const uint8_t *member);

/* Adds to area [mesh->node_count], m2, the share of each node by the median dual, as the volumes do; of the
 * faces of one layer only, unless it is SF_ANY_LAYER. */
sf_status sf_surface_area(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set, int layer,
                          double *area, sf_error *err);

typedef struct sf_surface_sides {
    double area;   /* m2 */
    double facing; /* m2, of its faces that look against the direction, projected on it */
} sf_surface_sides;

/* Finds the orientation of the group against a body that comes along `direction` (unit vector). */
sf_status sf_surface_find_sides(const sf_mesh *mesh, const sf_dual *dual, const sf_node_set *set,
                                const double direction[3], sf_surface_sides *sides, sf_error *err);
