/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "model/cells.h"
#include "model/model.h"

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

/* For qsort: faces by their ascending nodes (int32_t[4]); of sf_cell_face, by these and then their cells. */
int sf_face_compare(const void *one, const void *other);
int sf_cell_face_compare(const void *one, const void *other);
/* The middle of nodes, m. */
void sf_mesh_middle(const sf_mesh *mesh, const int32_t *node, int64_t count, double out[3]);
void sf_surface_free(sf_surface *surface);

/* Finds a set by name; NULL if there is none. */
const sf_node_set *sf_mesh_find_set(const sf_mesh *mesh, const char *name);

/* Volume of a cell by the divergence theorem over its faces (quadrangles split at their centroid); m3. */
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

/* The raw mesh of a mesh generator: nodes by tag, cells and faces by node tags; and its conversion to
 * sf_mesh. */

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

/* Adds the hull to a surface that was assembled from the same mesh: of all cells that are joined through
 * faces to one behind it. Without cells there is none. */
sf_status sf_hull_assemble(const sf_raw_mesh *raw, double unit, sf_surface *surface, sf_error *err);

/* Turns the missile's surface towards the pad: contact sees only what its normals face. */

/* Parts (triangles joined by edges) without cells behind them are turned as one: a closed part outwards, an
 * open one so that its area faces along `direction`, as the missile's motion. Parts with cells behind them
 * stay as they are. SF_ERR_INPUT: a part is one-sided (a Moebius strip). */
sf_status sf_surface_turn(sf_surface *surface, const double direction[3], sf_error *err);
/* The same, and refuses a surface that nowhere faces along `direction`. */
sf_status sf_surface_orient(sf_surface *surface, const double direction[3], sf_error *err);

/* The missile's surface: is it a sphere cap, and where does it first touch the pad? */

/* Least-squares sphere through the surface's nodes. `*deviation` is the largest distance of a node from it
 * divided by the radius. Fails on fewer than 4 nodes or coplanar ones. */
sf_status sf_missile_fit_sphere(const sf_surface *surface, double centre[3], double *radius,
                                double *deviation, sf_error *err);

/* Sets shape, sphere_* of the card from the surface by `rule` (0 auto, 1 sphere, 2 surface): a surface is a
 * sphere when its nodes deviate by less than 1e-6 of the radius. */
sf_status sf_missile_set_shape(const sf_surface *surface, int rule, sf_missile_card *card, sf_error *err);

/* Distance (m, any sign) that the missile must travel along its direction until its surface touches one of
 * the `count` points; SF_ERR_MODEL if its path misses them all. */
sf_status sf_missile_distance(const sf_surface *surface, const sf_missile_card *card, const double *position,
                              int64_t count, const int32_t *node, double *distance, sf_error *err);

/* Travel (m) of a triangle along the direction until it touches x, negative if it has passed x: intersection
 * with the line through x (Moeller and Trumbore 1997). Infinity if it is missed or the line is in its plane.
 */
double sf_triangle_travel(const double *a, const double *b, const double *c, const double direction[3],
                          const double x[3]);

/* The same distance to one point; infinity if the path misses it. */
double sf_missile_travel(const sf_surface *surface, const sf_missile_card *card, const double x[3]);

/* The missile's surface of a model; borrowed. */
sf_surface sf_surface_of_missile(const sf_model *model);
