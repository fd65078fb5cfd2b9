/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/ldl.h"

#include <cholmod.h>
#include <stdlib.h>
#include <string.h>

/* Smallest reciprocal condition, as CHOLMOD estimates it from D. */
static const double SINGULAR = 1e-13;
/* Share of L that may stand in the trunk before branches are cut smaller no more. */
static const double TRUNK_SHARE = 0.25;

/* The elimination tree, by CHOLMOD's columns: a parent comes after its children. */
typedef struct tree {
    int64_t rows;
    int64_t *parent; /* [rows] -1: a root */
    int64_t *below;  /* [rows] entries of L in the subtree */
    int *branch;     /* [rows] SF_LDL_BRANCHES: the trunk; for subtrees that are not cut, -1 - branch at their
                        root until it is handed down */
} tree;

static sf_status build_tree(const cholmod_factor *l, tree *t, sf_error *err) {
    const SuiteSparse_long *p = l->p, *i = l->i, *nz = l->nz;
    t->rows = (int64_t)l->n;
    t->parent = sf_alloc(err, l->n, sizeof *t->parent, "elimination tree");
    t->below = sf_alloc(err, l->n, sizeof *t->below, "elimination tree");
    t->branch = sf_alloc(err, l->n, sizeof *t->branch, "elimination tree");
    if (err->status != SF_OK)
        return err->status;
    for (int64_t j = 0; j < t->rows; j++) {
        t->parent[j] = nz[j] > 1 ? i[p[j] + 1] : -1;
        t->below[j] += nz[j];
        if (t->parent[j] >= 0)
            t->below[t->parent[j]] += t->below[j];
    }
    return SF_OK;
}

static void free_tree(tree *t) {
    free(t->parent);
    free(t->below);
    free(t->branch);
}

/* Cuts the tree: the largest subtree gives its root to the trunk until it is no larger than its share, or the
 * trunk is large; subtrees then go to the branch that has least, the largest first. */
static void cut_tree(tree *t) {
    enum { FREE = -1, UNCUT = -2, TRUNK = SF_LDL_BRANCHES };
    int64_t total = 0, trunk = 0, load[SF_LDL_BRANCHES] = {0};
    for (int64_t j = 0; j < t->rows; j++) {
        t->branch[j] = t->parent[j] < 0 ? FREE : UNCUT;
        total += t->parent[j] < 0 ? t->below[j] : 0;
    }
    for (;;) {
        int64_t largest = -1;
        for (int64_t j = 0; j < t->rows; j++)
            if (t->branch[j] == FREE && (largest < 0 || t->below[j] > t->below[largest]))
                largest = j;
        if (largest < 0)
            break;
        int64_t own = t->below[largest];
        for (int64_t j = 0; j < largest; j++)
            own -= t->parent[j] == largest ? t->below[j] : 0;
        if (t->below[largest] * SF_LDL_BRANCHES > total &&
            (double)(trunk + own) < TRUNK_SHARE * (double)total) {
            trunk += own;
            t->branch[largest] = TRUNK;
            for (int64_t j = 0; j < largest; j++)
                if (t->parent[j] == largest)
                    t->branch[j] = FREE;
            continue;
        }
        int least = 0;
        for (int b = 1; b < SF_LDL_BRANCHES; b++)
            if (load[b] < load[least])
                least = b;
        t->branch[largest] = least;
        load[least] += t->below[largest];
    }
    for (int64_t j = t->rows - 1; j >= 0; j--)
        if (t->branch[j] == UNCUT)
            t->branch[j] = t->branch[t->parent[j]];
}

/* Sorts the columns by branch; `place` [rows] gets their places. */
static void order_columns(const cholmod_factor *l, const tree *t, sf_ldl *f, int64_t *place) {
    const SuiteSparse_long *permutation = l->Perm;
    int64_t next = 0;
    for (int b = 0; b <= SF_LDL_BRANCHES; b++) {
        f->branch[b] = next;
        for (int64_t j = 0; j < t->rows; j++)
            if (t->branch[j] == b) {
                place[j] = next;
                f->order[next++] = (int32_t)permutation[j];
            }
    }
}

/* Columns of L at their places. The order of the columns within a branch is CHOLMOD's, so that entries stay
 * ascending, and those of the trunk come last. */
static void copy_columns(const cholmod_factor *l, const tree *t, const int64_t *place, sf_ldl *f) {
    const SuiteSparse_long *p = l->p, *i = l->i, *nz = l->nz;
    const double *x = l->x;
    for (int64_t j = 0; j < f->rows; j++)
        f->column[place[j] + 1] = nz[j] - 1;
    for (int64_t j = 0; j < f->rows; j++)
        f->column[j + 1] += f->column[j];
    for (int64_t j = 0; j < f->rows; j++) {
        int64_t at = f->column[place[j]], entries = nz[j] - 1;
        f->inverse[place[j]] = 1 / x[p[j]];
        f->trunk_from[place[j]] = at + entries;
        for (int64_t k = 0; k < entries; k++) {
            int64_t row = i[p[j] + 1 + k];
            f->place[at + k] = (int32_t)place[row];
            f->value[at + k] = x[p[j] + 1 + k];
            if (t->branch[row] == SF_LDL_BRANCHES && f->trunk_from[place[j]] > at + k)
                f->trunk_from[place[j]] = at + k;
        }
    }
}

static sf_status take_factor(const cholmod_factor *l, sf_ldl *f, sf_error *err) {
    const SuiteSparse_long *nz = l->nz;
    tree t = {0};
    unsigned long rows = l->n, entries = 0;
    for (unsigned long j = 0; j < rows; j++)
        entries += (unsigned long)nz[j] - 1;
    f->rows = (int64_t)rows;
    int64_t *place = sf_alloc(err, rows, sizeof *place, "factor of the constraints");
    f->order = sf_alloc(err, rows, sizeof *f->order, "factor of the constraints");
    f->column = sf_alloc(err, rows + 1, sizeof *f->column, "factor of the constraints");
    f->trunk_from = sf_alloc(err, rows, sizeof *f->trunk_from, "factor of the constraints");
    f->place = sf_alloc(err, entries, sizeof *f->place, "factor of the constraints");
    f->value = sf_alloc(err, entries, sizeof *f->value, "factor of the constraints");
    f->inverse = sf_alloc(err, rows, sizeof *f->inverse, "factor of the constraints");
    if (err->status == SF_OK && build_tree(l, &t, err) == SF_OK) {
        cut_tree(&t);
        order_columns(l, &t, f, place);
        copy_columns(l, &t, place, f);
        f->carried = sf_alloc(err, SF_LDL_BRANCHES * (rows - (unsigned long)f->branch[SF_LDL_BRANCHES]),
                              sizeof *f->carried, "factor of the constraints");
    }
    free_tree(&t);
    free(place);
    return err->status;
}

/* CHOLMOD's L D L^T with the sparser of two orderings. */
static cholmod_factor *factorize(const sf_ldl_entries *a, cholmod_common *common, sf_error *err) {
    cholmod_triplet triplet = {.nrow = (size_t)a->rows,
                               .ncol = (size_t)a->rows,
                               .nzmax = (size_t)a->count,
                               .nnz = (size_t)a->count,
                               .i = a->row,
                               .j = a->column,
                               .x = a->value,
                               .stype = -1,
                               .itype = CHOLMOD_LONG,
                               .xtype = CHOLMOD_REAL,
                               .dtype = CHOLMOD_DOUBLE};
    common->print = 0;
    common->supernodal = CHOLMOD_SIMPLICIAL; /* no BLAS: the same bits whatever its threads */
    common->final_monotonic = 1;
    common->nmethods = 2;
    common->method[0].ordering = CHOLMOD_AMD;
    common->method[1].ordering = CHOLMOD_NESDIS;
    cholmod_sparse *sparse = cholmod_l_triplet_to_sparse(&triplet, triplet.nnz, common);
    cholmod_factor *l = sparse ? cholmod_l_analyze(sparse, common) : NULL;
    if (l)
        cholmod_l_factorize(sparse, l, common);
    cholmod_l_free_sparse(&sparse, common);
    if (!l || common->status < CHOLMOD_OK) {
        SF_FAIL(err, SF_ERR_MEMORY, "CHOLMOD cannot factor the constraint matrix of %lld rows (status %d)",
                (long long)a->rows, common->status);
        return l;
    }
    double condition = cholmod_l_rcond(l, common);
    if (common->status == CHOLMOD_NOT_POSDEF || !(condition > SINGULAR))
        SF_FAIL(err, SF_ERR_MODEL,
                "the constraints of %lld nodes depend on each other (reciprocal condition %.3g): choose a "
                "smaller kernel.support_ratio",
                (long long)a->rows, condition);
    return l;
}

sf_status sf_ldl_build(const sf_ldl_entries *a, sf_ldl *f, sf_error *err) {
    cholmod_common common;
    memset(f, 0, sizeof *f);
    cholmod_l_start(&common);
    cholmod_factor *l = factorize(a, &common, err);
    if (err->status == SF_OK)
        take_factor(l, f, err);
    cholmod_l_free_factor(&l, &common);
    cholmod_l_finish(&common);
    if (err->status != SF_OK)
        sf_ldl_free(f);
    return err->status;
}

void sf_ldl_free(sf_ldl *f) {
    free(f->order);
    free(f->column);
    free(f->trunk_from);
    free(f->place);
    free(f->value);
    free(f->inverse);
    free(f->carried);
    memset(f, 0, sizeof *f);
}

SF_KERNEL void sf_ldl_forward(const sf_ldl *f, int branch, sf_vec *x) {
    int64_t trunk = f->branch[SF_LDL_BRANCHES], size = f->rows - trunk;
    sf_vec *carried = &f->carried[branch * size];
    memset(carried, 0, (size_t)size * sizeof *carried);
    for (int64_t j = f->branch[branch]; j < f->branch[branch + 1]; j++) {
        const sf_vec known = x[j];
        int64_t k = f->column[j];
        for (; k < f->trunk_from[j]; k++)
            x[f->place[k]] -= f->value[k] * known;
        for (; k < f->column[j + 1]; k++)
            carried[f->place[k] - trunk] += f->value[k] * known;
    }
}

/* Row j of D L^T x = b from those behind it. Four sums run side by side, because each addition waits for the
 * one before. */
static inline void solve_row(const sf_ldl *f, int64_t j, sf_vec *x) {
    sf_vec sum[4] = {{0}, {0}, {0}, {0}};
    const int32_t *place = f->place;
    const double *value = f->value;
    int64_t k = f->column[j], end = f->column[j + 1];
    for (; k + 3 < end; k += 4)
        for (int q = 0; q < 4; q++)
            sum[q] += value[k + q] * x[place[k + q]];
    for (; k < end; k++)
        sum[0] += value[k] * x[place[k]];
    x[j] = f->inverse[j] * x[j] - ((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

SF_KERNEL void sf_ldl_trunk(const sf_ldl *f, sf_vec *x) {
    int64_t trunk = f->branch[SF_LDL_BRANCHES], size = f->rows - trunk;
    for (int64_t j = trunk; j < f->rows; j++) {
        for (int b = 0; b < SF_LDL_BRANCHES; b++)
            x[j] -= f->carried[b * size + j - trunk];
        const sf_vec known = x[j];
        for (int64_t k = f->column[j]; k < f->column[j + 1]; k++)
            x[f->place[k]] -= f->value[k] * known;
    }
    for (int64_t j = f->rows - 1; j >= trunk; j--)
        solve_row(f, j, x);
}

SF_KERNEL void sf_ldl_backward(const sf_ldl *f, int branch, sf_vec *x) {
    for (int64_t j = f->branch[branch + 1] - 1; j >= f->branch[branch]; j--)
        solve_row(f, j, x);
}
