/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "model/cells.h"

/* The background mesh of the pad and the missile's surface, as read from a geometry: metres, nodes renumbered
 * from 0 in gmsh's order without orphans. Everything is owned by the struct. */

/* A named set of nodes: those of a physical surface group. */
typedef struct sf_node_set {
    char *name;
    int64_t count;
    int32_t *node; /* [count] ascending */
    int64_t face_count;
    int32_t *face; /* [face_count][4] ascending nodes of the group's faces; the first is -1 for a triangle */
    int64_t left_out; /* faces with nodes that no cell of the pad uses; not counted above */
} sf_node_set;

typedef struct sf_surface {
    int64_t node_count;
    double *position; /* [node_count][3] m */
    int64_t triangle_count;
    int32_t *triangle; /* [triangle_count][3] turned outwards (away from the missile's volume) */
    uint8_t *solid;    /* [triangle_count] 1: a cell of the missile lies behind it; NULL: none */

    /* The outer surface of the cells behind it, if it was asked for (sf_gmsh_read_hull) and there are any;
     * some nodes are inside. */
    int64_t hull_node_count, hull_triangle_count;
    double *hull_position;  /* [hull_node_count][3] m */
    int32_t *hull_triangle; /* [hull_triangle_count][3] turned outwards */

    double origin[3]; /* m, where the first node of the surface was as read: it may be moved since */
} sf_surface;

typedef struct sf_mesh {
    int64_t node_count;
    double *position; /* [node_count][3] m */
    int64_t cell_count;
    uint8_t *cell_type;  /* [cell_count] SF_CELL_* */
    int64_t *cell_ptr;   /* [cell_count + 1] */
    int32_t *cell_node;  /* [..] VTK vertex order, positive volume */
    uint8_t *cell_layer; /* [cell_count] place of its volume group among those asked for; NULL: one group */
    int set_count;
    sf_node_set *set;     /* [set_count] every physical surface group whose nodes belong to the pad */
    int64_t orphan_count; /* nodes of the geometry that no cell of any volume uses (counted, not kept) */
    sf_surface *support;  /* [support_count] of the rigid bodies that the pad may touch; borrowed */
    int support_count;
} sf_mesh;

void sf_mesh_free(sf_mesh *mesh);

/* True of a mesh of plane cells, the section of an axisymmetric pad (pre/mesh/section.h). */
bool sf_mesh_is_section(const sf_mesh *mesh);

/* For qsort: faces by their ascending nodes (int32_t[4]); of sf_cell_face, by these and then their cells. */
int sf_face_compare(const void *one, const void *other);
int sf_cell_face_compare(const void *one, const void *other);
/* The middle of nodes, m. */
void sf_mesh_middle(const sf_mesh *mesh, const int32_t *node, int64_t count, double out[3]);
void sf_surface_free(sf_surface *surface);

/* Finds a set by name; NULL if there is none. */
const sf_node_set *sf_mesh_find_set(const sf_mesh *mesh, const char *name);

/* Volume of a cell by the divergence theorem over its faces (quadrangles split at their centroid); m3. Of a
 * plane cell that of the ring that it makes about the axis. */
double sf_mesh_cell_volume(const sf_mesh *mesh, int64_t cell);

/* Mirrors the vertex order of the cells whose corners are all left-handed (readers differ in their
 * conventions), so that their volume is positive; returns how many. Cells with mixed corners are left for
 * sf_mesh_check to refuse. */
int64_t sf_mesh_orient(sf_mesh *mesh);

/* Refuses a mesh that has no cells, a cell with a non-positive volume at any corner (inverted), a cell
 * smaller than 1e-6 of the mean (tiny), coinciding nodes, or non-finite positions; names the cell and its
 * centroid. On success
 * `*volume` is the mesh volume in m3. */
sf_status sf_mesh_check(const sf_mesh *mesh, double *volume, sf_error *err);
