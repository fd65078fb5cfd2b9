/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The membrane on faces of the pad: triangles of constant strain between the physical positions of its nodes,
 * x = X + Phi d, whose forces act on the coefficients by the same rows (theory, section "Membranes"). */
#pragma once
#include "solver/point_rows.h"

enum { SF_MEMBRANE_ROW = 11 }; /* numbers of a triangle: forces on its nodes, N, energy, J, largest strain */

typedef struct sf_membrane {
    int64_t count, triangle_count;
    int32_t *node;     /* [count] of the model, ascending */
    int32_t *triangle; /* [triangle_count][3] nodes of the membrane */
    double
        *gradient; /* [triangle_count][3][2] m-1, of the shape functions in axes of the undeformed triangle */
    double *volume; /* [triangle_count] m3 */
    double load;    /* s-2, bound on the square of its highest frequency, at rest */
    sf_point_rows rows;
} sf_membrane;

sf_status sf_membrane_build(const sf_model *model, sf_membrane *membrane, sf_error *err);
void sf_membrane_free(sf_membrane *membrane);

/* The membrane's part of the state, all of it made anew in each step. */
typedef struct sf_membrane_state {
    double *position; /* [count][3] m, present */
    double *force;    /* [count][3] N, on its nodes */
    double *row;      /* [triangle_count][SF_MEMBRANE_ROW] */
    double energy;    /* J, stored */
    double load;      /* s-2, bound on the square of its highest frequency now */
} sf_membrane_state;

/* Adds its forces at the coefficients d [node_count][3] (m) to force [node_count][3] (N). */
void sf_membrane_force(const sf_model *model, const sf_membrane *membrane, const double *d,
                       sf_membrane_state *state, double *force);
