/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/constraint.h"

#include "core/lanes.h"
#include <cholmod.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct sf_constraint_block {
    int components; /* how many of x, y, z are held at these nodes */
    int component[3];
    int64_t rows;
    int32_t *node; /* [rows] held node */
    uint8_t *base; /* [rows] counts for the base reaction */

    /* G by row, over the nodes that it touches, and by touched node. */
    int64_t touched_count;
    int32_t *touched;   /* [touched_count] nodes, ascending */
    int64_t *row_ptr;   /* [rows + 1] */
    int32_t *row_place; /* [row_ptr[rows]] in `touched` */
    double *row_phi;    /* [row_ptr[rows]] */
    int64_t *node_ptr;  /* [touched_count + 1] */
    int32_t *node_row;  /* [row_ptr[rows]] */
    double *node_phi;   /* [row_ptr[rows]] */
    sf_vec *field;      /* [touched_count] what G is applied to */
    sf_vec *lambda;     /* [rows] N */

    cholmod_factor *factor;
    cholmod_dense *rhs, *solution, *work_y, *work_e;
};

static cholmod_common *common_of(const sf_constraint *constraint) {
    return constraint->common;
}

static int64_t count_rows(const sf_model *m, uint8_t mask) {
    int64_t rows = 0;
    for (int64_t k = 0; k < m->fixed_count; k++)
        rows += (m->fixed_mask[k] & mask) != 0;
    return rows;
}

/* Is component b held at exactly the nodes where component a is? */
static bool same_rows(const sf_model *m, int a, int b) {
    for (int64_t k = 0; k < m->fixed_count; k++)
        if (((m->fixed_mask[k] >> a) & 1) != ((m->fixed_mask[k] >> b) & 1))
            return false;
    return true;
}

/* Lower triangle of G M^-1 G^T in triplet form: all pairs of rows that share a node. `owner` lists, for each
 * node of the cloud, the rows it supports. */
static cholmod_triplet *gram_triplets(const sf_model *m, const sf_constraint_block *b, cholmod_common *common,
                                      sf_error *err) {
    int64_t entries = 0, pairs = 0,
            *ptr = sf_alloc(err, (unsigned long)m->node_count + 2, sizeof *ptr, "constraints");
    int32_t *row = NULL;
    double *phi = NULL;
    cholmod_triplet *t = NULL;
    for (int64_t r = 0; r < b->rows; r++)
        entries += m->phi_ptr[b->node[r] + 1] - m->phi_ptr[b->node[r]];
    row = sf_alloc(err, (unsigned long)entries, sizeof *row, "constraints");
    phi = sf_alloc(err, (unsigned long)entries, sizeof *phi, "constraints");
    if (err->status != SF_OK)
        goto done;
    for (int64_t r = 0; r < b->rows; r++)
        for (int64_t k = m->phi_ptr[b->node[r]]; k < m->phi_ptr[b->node[r] + 1]; k++)
            ptr[m->phi_node[k] + 2]++;
    for (int64_t i = 0; i < m->node_count; i++) {
        pairs += ptr[i + 2] * (ptr[i + 2] + 1) / 2;
        ptr[i + 2] += ptr[i + 1];
    }
    for (int64_t r = 0; r < b->rows; r++)
        for (int64_t k = m->phi_ptr[b->node[r]]; k < m->phi_ptr[b->node[r] + 1]; k++) {
            int64_t slot = ptr[m->phi_node[k] + 1]++;
            row[slot] = (int32_t)r;
            phi[slot] = m->phi_value[k];
        }
    t = cholmod_l_allocate_triplet((size_t)b->rows, (size_t)b->rows, (size_t)pairs, -1, CHOLMOD_REAL, common);
    if (!t) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the constraint matrix of %lld rows",
                (long long)b->rows);
        goto done;
    }
    SuiteSparse_long *ti = t->i, *tj = t->j;
    double *tx = t->x;
    for (int64_t i = 0; i < m->node_count; i++)
        for (int64_t p = ptr[i]; p < ptr[i + 1]; p++)
            for (int64_t q = ptr[i]; q <= p; q++) {
                ti[t->nnz] = row[p];
                tj[t->nnz] = row[q];
                tx[t->nnz++] = phi[p] * phi[q] / m->mass[i];
            }
done:
    free(ptr);
    free(row);
    free(phi);
    return t;
}

static sf_status factorize(const sf_model *m, sf_constraint_block *b, cholmod_common *common, sf_error *err) {
    cholmod_triplet *t = gram_triplets(m, b, common, err);
    if (!t)
        return err->status;
    cholmod_sparse *a = cholmod_l_triplet_to_sparse(t, t->nnz, common);
    cholmod_l_free_triplet(&t, common);
    b->factor = a ? cholmod_l_analyze(a, common) : NULL;
    if (b->factor)
        cholmod_l_factorize(a, b->factor, common);
    if (a)
        cholmod_l_free_sparse(&a, common);
    if (!b->factor || common->status < CHOLMOD_OK)
        return SF_FAIL(err, SF_ERR_MEMORY,
                       "CHOLMOD cannot factor the constraint matrix of %lld rows (status %d)",
                       (long long)b->rows, common->status);
    double condition = cholmod_l_rcond(b->factor, common);
    if (common->status == CHOLMOD_NOT_POSDEF || !(condition > 1e-13))
        return SF_FAIL(
            err, SF_ERR_MODEL,
            "the constraints of %lld nodes depend on each other (reciprocal condition %.3g): choose a "
            "smaller kernel.support_ratio",
            (long long)b->rows, condition);
    b->rhs = cholmod_l_allocate_dense((size_t)b->rows, (size_t)b->components, (size_t)b->rows, CHOLMOD_REAL,
                                      common);
    if (!b->rhs)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for %lld constraints", (long long)b->rows);
    return SF_OK;
}

/* Lists the touched nodes; `place` [n] gets their places. */
static sf_status list_touched(const sf_model *m, sf_constraint_block *b, int32_t *place, sf_error *err) {
    for (int64_t k = 0; k < b->row_ptr[b->rows]; k++)
        place[b->row_place[k]] = 1;
    for (int64_t i = 0; i < m->node_count; i++)
        b->touched_count += place[i];
    b->touched = sf_alloc(err, (unsigned long)b->touched_count, sizeof *b->touched, "constraint lists");
    int64_t count = 0;
    for (int64_t i = 0; i < m->node_count && err->status == SF_OK; i++)
        if (place[i]) {
            b->touched[count] = (int32_t)i;
            place[i] = (int32_t)count++;
        }
    return err->status;
}

static void list_by_node(sf_constraint_block *b) {
    for (int64_t k = 0; k < b->row_ptr[b->rows]; k++)
        b->node_ptr[b->row_place[k] + 1]++;
    for (int64_t t = 0; t < b->touched_count; t++)
        b->node_ptr[t + 1] += b->node_ptr[t];
    for (int64_t r = 0; r < b->rows; r++)
        for (int64_t k = b->row_ptr[r]; k < b->row_ptr[r + 1]; k++) {
            int64_t slot = b->node_ptr[b->row_place[k]]++;
            b->node_row[slot] = (int32_t)r;
            b->node_phi[slot] = b->row_phi[k];
        }
    memmove(&b->node_ptr[1], &b->node_ptr[0], (size_t)b->touched_count * sizeof *b->node_ptr);
    b->node_ptr[0] = 0;
}

/* The lists of G, from the rows' nodes. */
static sf_status build_lists(const sf_model *m, sf_constraint_block *b, sf_error *err) {
    int64_t entries = 0;
    for (int64_t r = 0; r < b->rows; r++)
        entries += m->phi_ptr[b->node[r] + 1] - m->phi_ptr[b->node[r]];
    unsigned long all = (unsigned long)entries, rows = (unsigned long)b->rows;
    int32_t *place = sf_alloc(err, (unsigned long)m->node_count, sizeof *place, "constraint lists");
    b->row_ptr = sf_alloc(err, rows + 1, sizeof *b->row_ptr, "constraint lists");
    b->row_place = sf_alloc(err, all, sizeof *b->row_place, "constraint lists");
    b->row_phi = sf_alloc(err, all, sizeof *b->row_phi, "constraint lists");
    b->node_row = sf_alloc(err, all, sizeof *b->node_row, "constraint lists");
    b->node_phi = sf_alloc(err, all, sizeof *b->node_phi, "constraint lists");
    b->lambda = sf_alloc(err, rows, sizeof *b->lambda, "constraint lists");
    entries = 0;
    for (int64_t r = 0; r < b->rows && err->status == SF_OK; r++) {
        for (int64_t k = m->phi_ptr[b->node[r]]; k < m->phi_ptr[b->node[r] + 1]; k++, entries++) {
            b->row_place[entries] = m->phi_node[k];
            b->row_phi[entries] = m->phi_value[k];
        }
        b->row_ptr[r + 1] = entries;
    }
    if (err->status == SF_OK && list_touched(m, b, place, err) == SF_OK) {
        unsigned long count = (unsigned long)b->touched_count;
        b->node_ptr = sf_alloc(err, count + 1, sizeof *b->node_ptr, "constraint lists");
        b->field = sf_alloc(err, count, sizeof *b->field, "constraint lists");
        for (int64_t k = 0; k < entries; k++)
            b->row_place[k] = place[b->row_place[k]];
        if (err->status == SF_OK)
            list_by_node(b);
    }
    free(place);
    return err->status;
}

static sf_status build_block(const sf_model *m, int first, sf_constraint *c, sf_error *err) {
    sf_constraint_block *b = sf_alloc(err, 1, sizeof *b, "constraint block");
    if (!b)
        return err->status;
    c->block[c->block_count++] = b;
    for (int k = first; k < 3; k++)
        if (k == first || same_rows(m, first, k))
            b->component[b->components++] = k;
    b->rows = count_rows(m, (uint8_t)(1 << first));
    b->node = sf_alloc(err, (unsigned long)b->rows, sizeof *b->node, "constraint nodes");
    b->base = sf_alloc(err, (unsigned long)b->rows, 1, "constraint nodes");
    if (err->status != SF_OK)
        return err->status;
    int64_t r = 0;
    for (int64_t k = 0; k < m->fixed_count; k++)
        if ((m->fixed_mask[k] >> first) & 1) {
            b->node[r] = m->fixed_node[k];
            b->base[r++] = m->fixed_base[k];
        }
    if (build_lists(m, b, err) != SF_OK)
        return err->status;
    return factorize(m, b, common_of(c), err);
}

sf_status sf_constraint_build(const sf_model *m, sf_constraint *c, sf_error *err) {
    memset(c, 0, sizeof *c);
    cholmod_common *common = sf_alloc(err, 1, sizeof *common, "CHOLMOD");
    if (!common)
        return err->status;
    c->common = common;
    cholmod_l_start(common);
    common->print = 0;
    common->supernodal = CHOLMOD_SIMPLICIAL; /* no BLAS: the same bits whatever its threads */
    for (int k = 0; k < 3 && err->status == SF_OK; k++) {
        bool done = count_rows(m, (uint8_t)(1 << k)) == 0;
        for (int b = 0; b < c->block_count; b++)
            for (int q = 0; q < c->block[b]->components; q++)
                done = done || c->block[b]->component[q] == k;
        if (!done)
            build_block(m, k, c, err);
    }
    if (err->status != SF_OK)
        sf_constraint_free(c);
    return err->status;
}

void sf_constraint_free(sf_constraint *c) {
    cholmod_common *common = common_of(c);
    for (int k = 0; k < c->block_count; k++) {
        sf_constraint_block *b = c->block[k];
        cholmod_l_free_factor(&b->factor, common);
        cholmod_l_free_dense(&b->rhs, common);
        cholmod_l_free_dense(&b->solution, common);
        cholmod_l_free_dense(&b->work_y, common);
        cholmod_l_free_dense(&b->work_e, common);
        free(b->node);
        free(b->base);
        free(b->touched);
        free(b->row_ptr);
        free(b->row_place);
        free(b->row_phi);
        free(b->node_ptr);
        free(b->node_row);
        free(b->node_phi);
        free(b->field);
        free(b->lambda);
        free(b);
    }
    if (common)
        cholmod_l_finish(common);
    free(common);
    memset(c, 0, sizeof *c);
}

/* G field of row r. */
static inline sf_vec apply_row(const sf_constraint_block *b, int64_t r) {
    sf_vec sum = {0};
    for (int64_t k = b->row_ptr[r]; k < b->row_ptr[r + 1]; k++)
        sum += b->row_phi[k] * b->field[b->row_place[k]];
    return sum;
}

/* G (force / mass) + G v / dt. */
static void right_side(const sf_model *m, const sf_constraint_block *b, const sf_constraint_step *step) {
    double *rhs = b->rhs->x, inverse = 1 / step->dt;
#pragma omp parallel default(none) shared(m, b, step, rhs, inverse)
    {
#pragma omp for schedule(static)
        for (int64_t t = 0; t < b->touched_count; t++) {
            int64_t i = b->touched[t];
            b->field[t] =
                sf_vec_load(&step->force[3 * i]) * (1 / m->mass[i]) + sf_vec_load(&step->v[3 * i]) * inverse;
        }
#pragma omp for schedule(static)
        for (int64_t r = 0; r < b->rows; r++) {
            sf_vec sum = apply_row(b, r);
            for (int q = 0; q < b->components; q++)
                rhs[q * b->rows + r] = sum[b->component[q]];
        }
    }
}

/* reaction = G^T lambda, and its resultants. */
static void add_reaction(const sf_constraint_block *b, sf_constraint_step *step) {
    const double *solution = b->solution->x;
    for (int64_t r = 0; r < b->rows; r++) {
        b->lambda[r] = (sf_vec){0};
        for (int q = 0; q < b->components; q++) {
            double lambda = solution[q * b->rows + r];
            int component = b->component[q];
            b->lambda[r][component] = lambda;
            step->all[component] -= lambda;
            if (b->base[r])
                step->base[component] -= lambda;
        }
    }
#pragma omp parallel for default(none) shared(b, step) schedule(static)
    for (int64_t t = 0; t < b->touched_count; t++) {
        sf_vec sum = {0};
        for (int64_t k = b->node_ptr[t]; k < b->node_ptr[t + 1]; k++)
            sum += b->node_phi[k] * b->lambda[b->node_row[k]];
        for (int q = 0; q < b->components; q++)
            step->reaction[3 * (int64_t)b->touched[t] + b->component[q]] = sum[b->component[q]];
    }
}

/* Largest |G v| after the step. */
static double measure_residual(const sf_model *m, const sf_constraint_block *b,
                               const sf_constraint_step *step) {
    double residual = 0;
#pragma omp parallel default(none) shared(m, b, step) reduction(max : residual)
    {
#pragma omp for schedule(static)
        for (int64_t t = 0; t < b->touched_count; t++) {
            int64_t i = b->touched[t];
            sf_vec net = sf_vec_load(&step->force[3 * i]) - sf_vec_load(&step->reaction[3 * i]);
            b->field[t] = sf_vec_load(&step->v[3 * i]) + net * (step->dt / m->mass[i]);
        }
#pragma omp for schedule(static)
        for (int64_t r = 0; r < b->rows; r++) {
            sf_vec sum = apply_row(b, r);
            for (int q = 0; q < b->components; q++)
                residual = fmax(residual, fabs(sum[b->component[q]]));
        }
    }
    return residual;
}

sf_status sf_constraint_project(const sf_model *m, const sf_constraint *c, sf_constraint_step *step,
                                sf_error *err) {
    cholmod_common *common = common_of(c);
    memset(step->base, 0, sizeof step->base);
    memset(step->all, 0, sizeof step->all);
    step->residual = 0;
    for (int k = 0; k < c->block_count; k++) {
        sf_constraint_block *b = c->block[k];
        right_side(m, b, step);
        if (!cholmod_l_solve2(CHOLMOD_A, b->factor, b->rhs, NULL, &b->solution, NULL, &b->work_y, &b->work_e,
                              common))
            return SF_FAIL(err, SF_ERR_LIBRARY, "CHOLMOD cannot solve for the constraint forces (status %d)",
                           common->status);
        add_reaction(b, step); /* no other block holds the same component */
    }
    for (int k = 0; k < c->block_count; k++)
        step->residual = fmax(step->residual, measure_residual(m, c->block[k], step));
    return SF_OK;
}
