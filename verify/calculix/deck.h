/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Input files for CalculiX, written from what softfall reads: the pad's mesh and the missile's surface.
 * Millimetres, newtons, megapascals in the deck. */
#ifndef SF_VERIFY_DECK_H
#define SF_VERIFY_DECK_H

#include "calculix/ogden.h"
#include "pre/mesh/mesh.h"

#include <stdbool.h>

typedef struct sf_deck {
    const char *element; /* of the pad: for example "C3D8" */
    bool nodes;          /* contact node to surface instead of face to face */
    double penalty;      /* N mm-3 */
    double radius;       /* m, of the missile */
    double depth;        /* m, indentation at time 1 */
    double interval;     /* m, of indentation between two printed states */
} sf_deck;

/* One C3D8 of 1 mm stretched to `stretch` in x, y and z over time 1, all nodes prescribed. Total forces of
 * the faces x = 1, y = 1 and z = 1 (sets NX, NY, NZ) are printed in every increment. */
void sf_deck_element(const sf_ogden *law, const double stretch[3], FILE *file);

/* One C3D8 of 1 mm, all nodes prescribed: at time k + 1 its deformation gradient is f[k], row-major. Total
 * forces as above. */
void sf_deck_path(const sf_ogden *law, int count, const double (*f)[9], FILE *file);

/* Frictionless indentation of the pad, glued at "base", with symmetry planes "symmetry_x" and "symmetry_y",
 * by the rigid missile: the triangles of `surface`, moved to touch the pad's top and thickened inwards to
 * wedges whose nodes are all prescribed. Total forces of the base (set NBASE) are printed at every `interval`
 * and at the end. Errors: a cell that is no hexahedron. */
sf_status sf_deck_indentation(const sf_ogden *law, const sf_deck *deck, const sf_mesh *mesh,
                              const sf_surface *surface, FILE *file, sf_error *err);

#endif
