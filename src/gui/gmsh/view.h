/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bodies of triangles and quadrangles that move from frame to frame, and curves, shown beside the
 * geometry. */
#ifndef SF_GUI_GMSH_VIEW_H
#define SF_GUI_GMSH_VIEW_H

#include "base/error.h"
#include <stdint.h>

/* A body: its nodes and faces. */
typedef struct sf_body {
    int64_t node_count;
    double *position; /* [node_count][3], in the geometry's length unit */
    int64_t face_count;
    int32_t *face; /* [face_count][4], -1 in the fourth place of a triangle */
} sf_body;

/* The pictures. Each has its fixed place: one that is made again replaces the one before. */
typedef enum sf_picture {
    SF_PICTURE_MISSILE, /* grey */
    SF_PICTURE_PAD,     /* coloured by a value */
    SF_PICTURE_CURVE,   /* a graph */
    SF_PICTURES
} sf_picture;

/* Makes a body the picture `which` (not the graph), without frames. */
sf_status sf_view_begin(sf_picture which, const char *title, const sf_body *body, sf_error *err);
/* The next frame: displacement [node_count][3] in the geometry's unit, value [node_count] (NULL: none). */
void sf_view_add(sf_picture which, int frame, double time, const sf_body *body, const double *displacement,
                 const double *value);
/* Shows a frame of all bodies. */
void sf_view_show_frame(int frame);
/* A graph of y over x. */
void sf_view_plot(const char *title, const char *x_label, int64_t count, const double *x, const double *y);
void sf_view_remove(sf_picture which);
#endif
