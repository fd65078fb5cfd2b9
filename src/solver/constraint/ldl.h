/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solution of three sparse symmetric positive definite systems at once, many times: one for each component of
 * a vector. They share the rows and entries that hold for all components; each may have rows of its own,
 * which come last. CHOLMOD orders and factors A = L D L^T once, and L too is shared. The elimination tree of
 * the shared rows is cut into independent branches, which may be solved in parallel, and a trunk above them.
 * The cut depends on A alone: x is the same, bit for bit, for any number of threads. */
#pragma once
#include "base/error.h"
#include "base/lanes.h"

enum { SF_LDL_BRANCHES = 4 };

/* Entries of the lower triangle, in any order; those of one place add up. Rows 0 to part[0] - 1 are those of
 * the components in `shared` (bits 1, 2, 4) together, part[c] to part[c + 1] - 1 those of component c alone.
 * Owned by the caller that fills it. */
typedef struct sf_ldl_entries {
    uint8_t shared;
    int64_t part[4], count;
    int64_t *row, *column; /* [count] */
    double *value;         /* [count] */
} sf_ldl_entries;

typedef struct sf_ldl {
    int64_t rows;
    int32_t *order; /* [rows] row of A by place in the elimination: branch by branch, trunk */
    int64_t branch[SF_LDL_BRANCHES + 1]; /* first place of every branch; the last is the trunk's, which ends
                                            with the rows of single components */
    int64_t *column;                     /* [rows + 1] L by column, without its unit diagonal */
    int64_t *trunk_from;                 /* [rows] where a column's entries in the trunk begin */
    int64_t *list;                       /* [rows] where a column's list of places begins */
    int32_t *place;  /* lists; a column whose entries are those of the next, and the next's
                        diagonal, ends with that one's list */
    double *value;   /* [column[rows]] */
    double *inverse; /* [rows] 1 / D */
    sf_vec *mask;    /* [rows] 1 in the components that have the row, else 0 */
    sf_vec *carried; /* [SF_LDL_BRANCHES][rows - branch[SF_LDL_BRANCHES]] contributions of the branches to the
                        trunk; work of one solution at a time */
} sf_ldl;

/* True if two rows have no component in common; A has no entry there. */
bool sf_ldl_apart(const sf_ldl_entries *a, int64_t row, int64_t other);

/* SF_ERR_MODEL if A is not positive definite, or nearly singular (reciprocal condition below 1e-13). */
sf_status sf_ldl_build(const sf_ldl_entries *a, sf_ldl *factor, sf_error *err);
void sf_ldl_free(sf_ldl *factor);

/* The three parts of a solution in place, x [rows] in the order of the elimination: every branch, then the
 * trunk, then every branch again. Components that do not have a row get zero there. */
void sf_ldl_forward(const sf_ldl *factor, int branch, sf_vec *x);
void sf_ldl_trunk(const sf_ldl *factor, sf_vec *x);
void sf_ldl_backward(const sf_ldl *factor, int branch, sf_vec *x);
