/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solution of A x = b with a sparse symmetric positive definite A and three right sides at once, many times.
 * CHOLMOD orders and factors A = L D L^T once. The elimination tree is then cut into branches, which have
 * nothing to do with each other and may run side by side, and a trunk on top of them; the cut depends on A
 * alone, so that the bits of x do not depend on the number of threads. */
#ifndef SF_SOLVER_LDL_H
#define SF_SOLVER_LDL_H

#include "core/error.h"
#include "core/lanes.h"
#include <stdint.h>

enum { SF_LDL_BRANCHES = 4 };

/* Entries of the lower triangle, in any order; those of one place add up. Owned by who fills it. */
typedef struct sf_ldl_entries {
    int64_t rows, count;
    int64_t *row, *column; /* [count] */
    double *value;         /* [count] */
} sf_ldl_entries;

typedef struct sf_ldl {
    int64_t rows;
    int32_t *order;                      /* [rows] row of A by place in the elimination, branch by branch */
    int64_t branch[SF_LDL_BRANCHES + 1]; /* first place of every branch; the last is the trunk's */
    int64_t *column;                     /* [rows + 1] L by column, without its unit diagonal */
    int64_t *trunk_from;                 /* [rows] where a column's entries in the trunk begin */
    int32_t *place;                      /* [column[rows]] ascending within a column */
    double *value;                       /* [column[rows]] */
    double *inverse;                     /* [rows] 1 / D */
    sf_vec *carried;                     /* [SF_LDL_BRANCHES][trunk rows] what branches leave to the trunk */
} sf_ldl;

/* SF_ERR_MODEL if A is singular or nearly so (reciprocal condition below 1e-13). */
sf_status sf_ldl_build(const sf_ldl_entries *a, sf_ldl *factor, sf_error *err);
void sf_ldl_free(sf_ldl *factor);

/* The three parts of a solution in place, x [rows] in the order of the elimination: every branch, then the
 * trunk, then every branch again. */
void sf_ldl_forward(const sf_ldl *factor, int branch, sf_vec *x);
void sf_ldl_trunk(const sf_ldl *factor, sf_vec *x);
void sf_ldl_backward(const sf_ldl *factor, int branch, sf_vec *x);

#endif
