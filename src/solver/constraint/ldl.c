/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/constraint/ldl.h"

#include <cholmod.h>

/* Smallest reciprocal condition, as CHOLMOD estimates it from D. */
static const double SINGULAR = 1e-13;
/* Share of L that may stand in the trunk before branches are cut smaller no more. */
static const double TRUNK_SHARE = 0.25;

/* The elimination tree of the shared rows: a parent comes after its children. */
typedef struct tree {
    int64_t rows;
    int64_t *parent; /* [rows] -1: a root */
    int64_t *below;  /* [rows] entries of L in the subtree */
    int *branch;     /* [rows] SF_LDL_BRANCHES: the trunk */
} tree;

static sf_status build_tree(const cholmod_factor *l, int64_t shared, tree *t, sf_error *err) {
    const SuiteSparse_long *p = l->p, *i = l->i, *nz = l->nz;
    unsigned long rows = (unsigned long)shared;
    t->rows = shared;
    SF_TRY(SF_ALLOC_ALL(err, "elimination tree", SF_ROOM(t->parent, rows), SF_ROOM(t->below, rows),
                        SF_ROOM(t->branch, rows)));
    for (int64_t j = 0; j < t->rows; j++) {
        t->parent[j] = nz[j] > 1 && i[p[j] + 1] < shared ? i[p[j] + 1] : -1;
        t->below[j] += nz[j];
        if (t->parent[j] >= 0)
            t->below[t->parent[j]] += t->below[j];
    }
    return SF_OK;
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

/* Work arrays of a build. A system is a list of row ranges, whose rows it has in the order of `position`. */
typedef struct builder {
    const sf_ldl_entries *a;
    int64_t rows;
    int64_t *position;    /* [rows] of a row within its range: shared, or of one component */
    cholmod_factor *l[3]; /* of the components that have rows of their own, or l[0] of the shared rows */
    cholmod_common common;
} builder;

static int64_t range_first(const sf_ldl_entries *a, int range) {
    return range == 0 ? 0 : a->part[range - 1];
}

/* Range of a row: 0 shared, 1 to 3 of a component. */
static int range_of(const sf_ldl_entries *a, int64_t row) {
    int range = 0;
    while (row >= a->part[range])
        range++;
    return range;
}

static uint8_t components_of(const sf_ldl_entries *a, int range) {
    return (uint8_t)(range == 0 ? a->shared : 1 << (range - 1));
}

bool sf_ldl_apart(const sf_ldl_entries *a, int64_t row, int64_t other) {
    return (components_of(a, range_of(a, row)) & components_of(a, range_of(a, other))) == 0;
}

/* The entries among the shared rows (if `with_shared`) and those of one component's range (0: none), at their
 * positions. */
static cholmod_sparse *gather_system(builder *w, bool with_shared, int range) {
    const sf_ldl_entries *a = w->a;
    int64_t shared = with_shared ? a->part[0] : 0, own = range ? a->part[range] - a->part[range - 1] : 0;
    size_t rows = (size_t)(shared + own);
    cholmod_triplet *t =
        cholmod_l_allocate_triplet(rows, rows, (size_t)a->count, -1, CHOLMOD_REAL, &w->common);
    if (!t)
        return NULL;
    SuiteSparse_long *ti = t->i, *tj = t->j;
    double *tx = t->x;
    for (int64_t k = 0; k < a->count; k++) {
        int64_t end[2] = {a->row[k], a->column[k]}, at[2];
        bool member = true;
        for (int e = 0; e < 2; e++) {
            int r = range_of(a, end[e]);
            member = member && (r == 0 ? with_shared : r == range);
            at[e] = w->position[end[e]] + (r == 0 ? 0 : shared);
        }
        if (!member)
            continue;
        ti[t->nnz] = at[0] > at[1] ? at[0] : at[1];
        tj[t->nnz] = at[0] > at[1] ? at[1] : at[0];
        tx[t->nnz++] = a->value[k];
    }
    cholmod_sparse *s = cholmod_l_triplet_to_sparse(t, t->nnz, &w->common);
    cholmod_l_free_triplet(&t, &w->common);
    return s;
}

static sf_status fail_library(const builder *w, sf_error *err) {
    return SF_FAIL(err, SF_ERR_MEMORY, "CHOLMOD cannot factor the constraint matrix of %lld rows (status %d)",
                   (long long)w->rows, w->common.status);
}

/* Positions within a range for little fill: the sparser of two orderings. */
static sf_status order_range(builder *w, int range, sf_error *err) {
    int64_t first = range_first(w->a, range), count = w->a->part[range] - first;
    for (int64_t k = 0; k < count; k++)
        w->position[first + k] = k;
    if (count == 0)
        return SF_OK;
    w->common.nmethods = 2;
    w->common.method[0].ordering = CHOLMOD_AMD;
    w->common.method[1].ordering = CHOLMOD_NESDIS;
    w->common.postorder = 1;
    cholmod_sparse *s = gather_system(w, range == 0, range);
    cholmod_factor *l = s ? cholmod_l_analyze(s, &w->common) : NULL;
    if (l) {
        const SuiteSparse_long *permutation = l->Perm;
        for (int64_t k = 0; k < count; k++)
            w->position[first + permutation[k]] = k;
    } else
        fail_library(w, err);
    cholmod_l_free_factor(&l, &w->common);
    cholmod_l_free_sparse(&s, &w->common);
    return err->status;
}

/* CHOLMOD stops at a zero in D, not at a negative number. */
static bool is_positive(const cholmod_factor *l) {
    const SuiteSparse_long *p = l->p;
    const double *x = l->x;
    bool positive = l->minor == l->n;
    for (size_t j = 0; j < l->n && positive; j++)
        positive = x[p[j]] > 0;
    return positive;
}

/* L D L^T of the shared rows and those of one range, in the order of their positions. */
static sf_status factorize(builder *w, int range, cholmod_factor **out, sf_error *err) {
    w->common.nmethods = 1;
    w->common.method[0].ordering = CHOLMOD_NATURAL;
    w->common.postorder = 0;
    cholmod_sparse *s = gather_system(w, true, range);
    cholmod_factor *l = s ? cholmod_l_analyze(s, &w->common) : NULL;
    if (l)
        cholmod_l_factorize(s, l, &w->common);
    cholmod_l_free_sparse(&s, &w->common);
    *out = l;
    if (!l || w->common.status < CHOLMOD_OK)
        return fail_library(w, err);
    double condition = is_positive(l) ? cholmod_l_rcond(l, &w->common) : 0;
    if (!(condition > SINGULAR))
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the constraints of %lld nodes depend on each other (reciprocal condition %.3g): "
                       "choose a smaller kernel.support_ratio",
                       (long long)w->rows, condition);
    return SF_OK;
}

/* The places of all rows: shared ones branch by branch and in the trunk, then those of the components.
 * `place` [rows]: by range and position. */
static void order_places(const builder *w, const tree *t, sf_ldl *f, int64_t *place) {
    const sf_ldl_entries *a = w->a;
    int64_t next = 0;
    for (int b = 0; b <= SF_LDL_BRANCHES; b++) {
        f->branch[b] = next;
        for (int64_t j = 0; j < t->rows; j++)
            if (t->branch[j] == b)
                place[j] = next++;
    }
    for (int64_t j = t->rows; j < f->rows; j++)
        place[j] = next++;
    for (int64_t row = 0; row < f->rows; row++) {
        int range = range_of(a, row);
        int64_t at = place[range_first(a, range) + w->position[row]];
        f->order[at] = (int32_t)row;
        for (int c = 0; c < 3; c++)
            f->mask[at][c] = (components_of(a, range) >> c) & 1;
    }
}

/* Appends those entries of column j of the factor of component c whose rows are from `first` on; rows behind
 * the shared ones are those of the component's range in A. */
static void append_entries(const builder *w, int c, int64_t j, int64_t first, const int64_t *place, sf_ldl *f,
                           int64_t *next) {
    const cholmod_factor *l = w->l[c];
    int64_t shared = w->a->part[0], own = w->a->part[c];
    const SuiteSparse_long *p = l->p, *i = l->i, *nz = l->nz;
    const double *x = l->x;
    for (int64_t k = p[j] + 1; k < p[j] + nz[j]; k++)
        if (i[k] >= first) {
            f->place[*next] = (int32_t)place[i[k] < shared ? i[k] : i[k] - shared + own];
            f->value[(*next)++] = x[k];
        }
}

/* L column by column, at their places: entries among shared rows from the first factor, those in rows of a
 * component from the component's. Entries in the trunk come last. */
static void copy_columns(const builder *w, const int64_t *source, const int64_t *place, sf_ldl *f) {
    const sf_ldl_entries *a = w->a;
    int64_t shared = a->part[0], next = 0, trunk = f->branch[SF_LDL_BRANCHES];
    int main_part = -1;
    for (int c = 2; c >= 0; c--)
        main_part = w->l[c] ? c : main_part;
    for (int64_t at = 0; at < f->rows; at++) {
        int64_t j = source[at], first = next;
        int range = j < shared ? 0 : range_of(a, j);
        int component = range == 0 ? main_part : range - 1;
        const cholmod_factor *l = w->l[component];
        int64_t local = range == 0 ? j : j - a->part[range - 1] + shared;
        f->column[at] = next;
        f->inverse[at] = 1 / ((const double *)l->x)[((const SuiteSparse_long *)l->p)[local]];
        append_entries(w, component, local, 0, place, f, &next);
        for (int c = main_part + 1; c < 3 && range == 0; c++)
            if (w->l[c])
                append_entries(w, c, local, shared, place, f, &next);
        f->trunk_from[at] = next;
        for (int64_t k = next - 1; k >= first && f->place[k] >= trunk; k--)
            f->trunk_from[at] = k;
    }
    f->column[f->rows] = next;
}

/* True if the list of column j is its next column and then that one's list. `list`: all of `place`, by
 * column. */
static bool ends_with_next(const sf_ldl *f, const int32_t *list, int64_t j) {
    int64_t first = f->column[j], next = f->column[j + 1], count = next - first - 1;
    return j + 1 < f->rows && count >= 0 && f->column[j + 2] - next == count && list[first] == j + 1 &&
           memcmp(&list[first + 1], &list[next], (size_t)count * sizeof *list) == 0;
}

/* The lists of places, each once. */
static sf_status share_lists(sf_ldl *f, sf_error *err) {
    SF_OWNED int32_t *all = f->place;
    int64_t room = 0;
    f->place = NULL;
    for (int64_t j = 0; j < f->rows; j++) {
        bool shared = j > 0 && ends_with_next(f, all, j - 1);
        f->list[j] = shared ? f->list[j - 1] + 1 : room;
        room += shared ? 0 : f->column[j + 1] - f->column[j];
    }
    f->place = sf_alloc(err, room, sizeof *f->place, "factor of the constraints");
    for (int64_t j = 0; j < f->rows && f->place; j++)
        memcpy(&f->place[f->list[j]], &all[f->column[j]],
               (size_t)(f->column[j + 1] - f->column[j]) * sizeof *all);
    return err->status;
}

/* Entries of l, with its diagonal, in rows from `first` on. */
static unsigned long count_entries(const cholmod_factor *l, int64_t first) {
    const SuiteSparse_long *p = l->p, *i = l->i, *nz = l->nz;
    unsigned long count = 0;
    for (size_t j = 0; j < l->n; j++)
        for (int64_t k = p[j]; k < p[j] + nz[j]; k++)
            count += i[k] >= first;
    return count;
}

static sf_status take_factors(builder *w, sf_ldl *f, sf_error *err) {
    tree t = {0};
    const cholmod_factor *l = NULL;
    unsigned long rows = (unsigned long)w->rows, room = 0;
    for (int c = 0; c < 3; c++)
        if (w->l[c]) {
            room += count_entries(w->l[c], l ? w->a->part[0] : 0);
            l = l ? l : w->l[c];
        }
    f->rows = w->rows;
    SF_OWNED int64_t *place = sf_alloc(err, rows, sizeof *place, "factor of the constraints");
    SF_OWNED int64_t *source = sf_alloc(err, rows, sizeof *source, "factor of the constraints");
    SF_ALLOC_ALL(err, "factor of the constraints", SF_ROOM(f->order, rows), SF_ROOM(f->column, rows + 1),
                 SF_ROOM(f->trunk_from, rows), SF_ROOM(f->list, rows), SF_ROOM(f->place, room),
                 SF_ROOM(f->value, room), SF_ROOM(f->inverse, rows), SF_ROOM(f->mask, rows));
    if (err->status == SF_OK && build_tree(l, w->a->part[0], &t, err) == SF_OK) {
        cut_tree(&t);
        order_places(w, &t, f, place);
        for (int64_t j = 0; j < f->rows; j++)
            source[place[j]] = j;
        copy_columns(w, source, place, f);
        share_lists(f, err);
        f->carried = sf_alloc(err, SF_LDL_BRANCHES * (rows - (unsigned long)f->branch[SF_LDL_BRANCHES]),
                              sizeof *f->carried, "factor of the constraints");
    }
    SF_FREE(t.parent, t.below, t.branch);
    return err->status;
}

sf_status sf_ldl_build(const sf_ldl_entries *a, sf_ldl *f, sf_error *err) {
    builder w = {.a = a, .rows = a->part[3]};
    bool parts = a->part[3] > a->part[0];
    memset(f, 0, sizeof *f);
    cholmod_l_start(&w.common);
    w.common.print = 0;
    w.common.supernodal = CHOLMOD_SIMPLICIAL; /* no BLAS: the same bits whatever its threads */
    w.common.final_monotonic = 1;
    w.position = sf_alloc(err, w.rows, sizeof *w.position, "factor of the constraints");
    for (int range = 0; range <= 3 && err->status == SF_OK; range++)
        order_range(&w, range, err);
    for (int c = 0; c < 3 && err->status == SF_OK; c++)
        if (parts ? a->part[c + 1] > a->part[c] : c == 0)
            factorize(&w, c + 1, &w.l[c], err);
    if (err->status == SF_OK)
        take_factors(&w, f, err);
    for (int c = 0; c < 3; c++)
        cholmod_l_free_factor(&w.l[c], &w.common);
    cholmod_l_finish(&w.common);
    free(w.position);
    if (err->status != SF_OK)
        sf_ldl_free(f);
    return err->status;
}

void sf_ldl_free(sf_ldl *f) {
    SF_CLEAR(f, f->order, f->column, f->trunk_from, f->list, f->place, f->value, f->inverse, f->mask,
             f->carried);
}

SF_KERNEL void sf_ldl_forward(const sf_ldl *f, int branch, sf_vec *x) {
    int64_t trunk = f->branch[SF_LDL_BRANCHES], size = f->rows - trunk;
    sf_vec *carried = &f->carried[branch * size];
    memset(carried, 0, (size_t)size * sizeof *carried);
    for (int64_t j = f->branch[branch]; j < f->branch[branch + 1]; j++) {
        const sf_vec known = x[j] *= f->mask[j];
        const int32_t *place = &f->place[f->list[j]];
        const double *value = &f->value[f->column[j]];
        int64_t k = 0, inside = f->trunk_from[j] - f->column[j], count = f->column[j + 1] - f->column[j];
        for (; k < inside; k++)
            x[place[k]] -= value[k] * known;
        for (; k < count; k++)
            carried[place[k] - trunk] += value[k] * known;
    }
}

/* Row j of D L^T x = b from those behind it. Four sums run side by side, because each addition waits for the
 * one before. */
static inline void solve_row(const sf_ldl *f, int64_t j, sf_vec *x) {
    sf_vec sum[4] = {{0}, {0}, {0}, {0}};
    const int32_t *place = &f->place[f->list[j]];
    const double *value = &f->value[f->column[j]];
    int64_t k = 0, count = f->column[j + 1] - f->column[j];
    for (; k + 3 < count; k += 4)
        for (int q = 0; q < 4; q++)
            sum[q] += value[k + q] * x[place[k + q]];
    for (; k < count; k++)
        sum[0] += value[k] * x[place[k]];
    x[j] = f->inverse[j] * x[j] - ((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

SF_KERNEL void sf_ldl_trunk(const sf_ldl *f, sf_vec *x) {
    int64_t trunk = f->branch[SF_LDL_BRANCHES], size = f->rows - trunk;
    for (int64_t j = trunk; j < f->rows; j++) {
        for (int b = 0; b < SF_LDL_BRANCHES; b++)
            x[j] -= f->carried[b * size + j - trunk];
        const sf_vec known = x[j] *= f->mask[j];
        const int32_t *place = &f->place[f->list[j]];
        const double *value = &f->value[f->column[j]];
        for (int64_t k = 0; k < f->column[j + 1] - f->column[j]; k++)
            x[place[k]] -= value[k] * known;
    }
    for (int64_t j = f->rows - 1; j >= trunk; j--)
        solve_row(f, j, x);
}

SF_KERNEL void sf_ldl_backward(const sf_ldl *f, int branch, sf_vec *x) {
    for (int64_t j = f->branch[branch + 1] - 1; j >= f->branch[branch]; j--)
        solve_row(f, j, x);
}
