/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cells of the background mesh, as tetrahedra and by their faces; positions in a cell's vertex list. */
#ifndef SF_POST_CELLS_H
#define SF_POST_CELLS_H

/* Tetrahedra that fill a cell of this type (SF_CELL_*), static storage; returns how many. */
int sf_cell_tetrahedra(int type, const int (**tetrahedra)[4]);

/* Faces in order around them, -1 in the fourth place of a triangle; returns how many. */
int sf_cell_faces(int type, const int (**faces)[4]);

#endif
