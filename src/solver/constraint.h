/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Essential boundary conditions on u_h by the transformation method, as an exact projection (Chen, Pan, Wu,
 * Liu 1996; theory, section "Constraints"): with G the rows phi(X_c) of the held nodes, (G M^-1 G^T) lambda =
 * G a* + (G v) / dt,    a = a* - M^-1 G^T lambda. Components held at the same nodes share one factor
 * (solver/ldl.h), made once. */
#ifndef SF_SOLVER_CONSTRAINT_H
#define SF_SOLVER_CONSTRAINT_H

#include "core/error.h"
#include "core/model.h"

typedef struct sf_constraint_block sf_constraint_block;

typedef struct sf_constraint {
    int block_count;
    sf_constraint_block *block[3]; /* owned */
} sf_constraint;

sf_status sf_constraint_build(const sf_model *model, sf_constraint *constraint, sf_error *err);
void sf_constraint_free(sf_constraint *constraint);

/* What the constraints see of a step. */
typedef struct sf_constraint_step {
    const double *force; /* [n][3] N, all forces but the reactions */
    const double *v;     /* [n][3] m s-1, at the last half step */
    double dt;           /* s, between the half steps */
    double *reaction;    /* [n][3] N, out: G^T lambda; the acceleration is (force - reaction) / mass */
    double base[3];      /* N, out: force of the base on the pad */
    double all[3];       /* N, out: force of all constraints on the pad */
} sf_constraint_step;

void sf_constraint_project(const sf_constraint *constraint, sf_constraint_step *step);

/* Largest |G v| at the next half step, m s-1, after a projection: only rounding errors are left. */
double sf_constraint_residual(const sf_model *model, const sf_constraint *constraint,
                              const sf_constraint_step *step);

#endif
