/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A user's own geometry in gmsh's window, as in gmsh itself: its language may do there what it may do in
 * gmsh. A run never uses what is made here: softfall-pre reads the file anew, confined. */
#ifndef SF_GUI_GMSH_GEOMETRY_H
#define SF_GUI_GMSH_GEOMETRY_H

#include "base/error.h"
#include <stdint.h>

/* Triangles of a surface, in the geometry's length unit. */
typedef struct sf_triangles {
    int64_t count;
    double *corner; /* [count][3][3] owned: free */
    double low[3], high[3];
} sf_triangles;

/* Opens the file as the one model that is shown, with its parameters in the tree at the values that the tree
 * has. SF_ERR_INPUT: the first error that gmsh reports, with its file and line. */
sf_status sf_geometry_show(const char *path, sf_error *err);
/* Box of the model that is shown. */
void sf_geometry_box(double low[3], double high[3]);
/* Opens the file, meshes its surfaces and forgets it; its parameters stay in the tree. */
sf_status sf_geometry_read_surface(const char *path, sf_triangles *surface, sf_error *err);
/* Forgets all models and pictures. */
void sf_geometry_clear(void);

#endif
