/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Essential boundary conditions on u_h by the transformation method, as an exact projection (Chen, Pan, Wu,
 * Liu 1996; theory, section "Constraints"): with G the rows phi(X_c) of the held nodes, (G M^-1 G^T) lambda =
 * G a* + (G v) / dt, a = a* - M^-1 G^T lambda. The matrix is factored once (solver/constraint/ldl.h). A row
 * of G stands for a node held in all components, or for one component of a node that is held in some. Ties
 * between layers are rows too: phi(X_c) of one cloud less that of the other. */
#pragma once
#include "model/model.h"
#include "solver/constraint/ldl.h"

/* The kinds of row of G. */
typedef struct sf_constraint_row {
    int32_t node;  /* held node */
    int32_t other; /* the node of another layer that it is tied to; -1: it is held at zero */
    uint8_t base;  /* counts for the base reaction */
} sf_constraint_row;

typedef struct sf_constraint {
    int64_t rows;
    sf_constraint_row *row; /* [rows] in the order of the elimination */

    /* G by row, over the nodes that it touches, and by touched node. */
    int64_t touched_count;
    int32_t *touched;   /* [touched_count] nodes, ascending */
    double *mobility;   /* [touched_count] kg-1, inverse masses */
    int64_t *row_ptr;   /* [rows + 1] */
    int32_t *row_place; /* [row_ptr[rows]] in `touched` */
    double *row_phi;    /* [row_ptr[rows]] */
    int64_t *node_ptr;  /* [touched_count + 1] */
    int32_t *node_row;  /* [row_ptr[rows]] */
    double *node_phi;   /* [row_ptr[rows]] */

    sf_ldl factor; /* of G M^-1 G^T */
    /* Work of one projection at a time, although the functions take a constant. */
    sf_vec *field;  /* [touched_count] the vector that G multiplies */
    sf_vec *lambda; /* [rows] right side, then lambda (N); in sf_constraint_residual G v */
} sf_constraint;

sf_status sf_constraint_build(const sf_model *model, sf_constraint *constraint, sf_error *err);
void sf_constraint_free(sf_constraint *constraint);

/* Input and output of the projection in one step. */
typedef struct sf_constraint_step {
    const double *force; /* [n][3] N, all forces but the reactions */
    const double *v;     /* [n][3] m s-1, at the last half step */
    double dt;           /* s, between the half steps */
    double *reaction;    /* [n][3] N, out: G^T lambda; the acceleration is (force - reaction) / mass */
    double base[3];      /* N, out: force of the base on the pad */
    double all[3];       /* N, out: force of all constraints on the pad; ties are forces between its layers */
} sf_constraint_step;

void sf_constraint_project(const sf_constraint *constraint, sf_constraint_step *step);

/* Largest |G v| at the next half step, m s-1, after a projection: only rounding errors are left. */
double sf_constraint_residual(const sf_model *model, const sf_constraint *constraint,
                              const sf_constraint_step *step);
