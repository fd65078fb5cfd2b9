/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "model/cells.h"
#include "post/results/results.h"

/* The places of the symmetry planes of a model and of the missile's axis, by which pictures and sections
 * of the pad are laid out. */

/* Places (m) of the symmetry planes normal to x and y; NaN: none. False: the model is a half or a quarter,
 * and its planes cannot be told (results of earlier versions). */
bool sf_axis_planes(const sf_results *results, double place[2]);

/* Reference x and y (m) of the missile's axis: in the symmetry planes, else in the middle of its surface. */
void sf_axis_find(const sf_results *results, double axis[2]);

/* The undeformed pad and the missile cut by the vertical plane y = constant through the missile's axis: what
 * the pictures of a report show, deformed. Where a symmetry plane is the picture's plane the cut lies a
 * millionth of the pad's size inside. */

/* A point on an edge of the mesh: (1 - weight) of the first node and weight of the second. */
typedef struct sf_cut_point {
    int32_t node[2];
    double weight;
} sf_cut_point;

typedef struct sf_cut_polygon {
    int count; /* 3 or 4 */
    sf_cut_point point[4];
} sf_cut_polygon;

/* Grows as it is filled; arrays from malloc, owned by the cut. */
typedef struct sf_cut {
    const sf_results *results; /* borrowed */
    double plane;              /* m, y */
    double axis;               /* m, x of the missile's axis */
    bool mirrored;             /* the other half, mirrored at the axis, belongs to the pad too */
    double x[2], z[2];         /* m, extent of the undeformed pad in the plane, without the other half */
    double missile[2];         /* m, extent of the missile along x in the plane */
    int64_t polygon_count;
    sf_cut_polygon *polygon; /* of the tetrahedra that fill the cells */
    int64_t line_count;
    sf_cut_point (*line)[2]; /* of the faces of the cells */
    int64_t outline_count;
    double (*outline)[2][2]; /* m, x and z of both ends: of the missile's triangles at t = 0, and of */
    int64_t support_first;   /* the supports' triangles from this one on */
} sf_cut;

/* Release with sf_cut_free, also after a failure. */
sf_status sf_cut_make(const sf_results *results, sf_cut *cut, sf_error *err);
void sf_cut_free(sf_cut *cut);

/* Value of a field ([node_count][components]) at a point. */
double sf_cut_value(const sf_cut_point *point, const double *field, int components, int component);

/* Pictures of the deformed pad and the missile in the cut of post/view/cut.h, side by side, as one SVG
 * element with one scale of colours: bands of a field that is linear in each tetrahedron. */

/* The colours of the scale, red, green and blue, from its low to its high end; those between are linear. */
enum { SF_PICTURE_COLOURS = 8 };
extern const unsigned char sf_picture_colours[SF_PICTURE_COLOURS][3];
extern const double sf_picture_decades; /* of the logarithmic scale */

/* One instant. */
typedef struct sf_picture {
    const char *title;
    const sf_frame_head *head;
    const sf_frame *frame; /* holds the displacement, and the field */
} sf_picture;

typedef struct sf_picture_style {
    sf_frame_field field; /* of one component */
    double factor;        /* from its unit to that of the scale */
    const char *label;    /* of the scale, with its unit */
    bool logarithmic;     /* from the largest value over 300; else from 0 */
    bool lines;           /* the cells' outlines */
    double half_width;    /* m, of what is shown, to both sides of the axis; INFINITY: the whole pad */
} sf_picture_style;

/* Returns the picture from malloc, owned by the caller; NULL on failure. */
char *sf_picture_draw(const sf_cut *cut, const sf_picture *pictures, int count, const sf_picture_style *style,
                      sf_error *err);

/* A polygon of a linear field. */
enum { SF_CORNERS = 8 };
typedef struct sf_corner {
    double x, y, value;
} sf_corner;
/* The part of a convex polygon of at most 6 corners where low <= value <= high, into `part`; returns its
 * corners, 0 if there is none. */
int sf_picture_band(int count, const sf_corner *corner, double low, double high, sf_corner part[SF_CORNERS]);
