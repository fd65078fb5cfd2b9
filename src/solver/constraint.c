/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/constraint.h"

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
        free(b);
    }
    if (common)
        cholmod_l_finish(common);
    free(common);
    memset(c, 0, sizeof *c);
}

/* G (force / mass) + G v / dt for one component. */
static void right_side(const sf_model *m, const sf_constraint_block *b, const sf_constraint_step *step,
                       int component, double *out) {
    double inverse = 1 / step->dt;
    for (int64_t r = 0; r < b->rows; r++) {
        double sum = 0;
        for (int64_t k = m->phi_ptr[b->node[r]]; k < m->phi_ptr[b->node[r] + 1]; k++) {
            int64_t i = m->phi_node[k];
            sum += m->phi_value[k] *
                   (step->force[3 * i + component] / m->mass[i] + step->v[3 * i + component] * inverse);
        }
        out[r] = sum;
    }
}

static void add_reaction(const sf_model *m, const sf_constraint_block *b, sf_constraint_step *step,
                         int component, const double *lambda) {
    for (int64_t r = 0; r < b->rows; r++) {
        for (int64_t k = m->phi_ptr[b->node[r]]; k < m->phi_ptr[b->node[r] + 1]; k++)
            step->reaction[3 * (int64_t)m->phi_node[k] + component] += m->phi_value[k] * lambda[r];
        step->all[component] -= lambda[r];
        if (b->base[r])
            step->base[component] -= lambda[r];
    }
}

/* Largest |G v| after the step. */
static void measure_residual(const sf_model *m, const sf_constraint_block *b, sf_constraint_step *step,
                             int component) {
    for (int64_t r = 0; r < b->rows; r++) {
        double sum = 0;
        for (int64_t k = m->phi_ptr[b->node[r]]; k < m->phi_ptr[b->node[r] + 1]; k++) {
            int64_t i = 3 * (int64_t)m->phi_node[k] + component;
            sum += m->phi_value[k] *
                   (step->v[i] + step->dt * (step->force[i] - step->reaction[i]) / m->mass[m->phi_node[k]]);
        }
        step->residual = fmax(step->residual, fabs(sum));
    }
}

sf_status sf_constraint_project(const sf_model *m, const sf_constraint *c, sf_constraint_step *step,
                                sf_error *err) {
    cholmod_common *common = common_of(c);
    memset(step->base, 0, sizeof step->base);
    memset(step->all, 0, sizeof step->all);
    step->residual = 0;
    for (int k = 0; k < c->block_count; k++) { /* only these entries can be non-zero */
        const sf_constraint_block *b = c->block[k];
        for (int64_t r = 0; r < b->rows; r++)
            for (int64_t q = m->phi_ptr[b->node[r]]; q < m->phi_ptr[b->node[r] + 1]; q++)
                memset(&step->reaction[3 * (int64_t)m->phi_node[q]], 0, 3 * sizeof *step->reaction);
    }
    for (int k = 0; k < c->block_count; k++) {
        sf_constraint_block *b = c->block[k];
        for (int q = 0; q < b->components; q++)
            right_side(m, b, step, b->component[q], (double *)b->rhs->x + q * b->rows);
        if (!cholmod_l_solve2(CHOLMOD_A, b->factor, b->rhs, NULL, &b->solution, NULL, &b->work_y, &b->work_e,
                              common))
            return SF_FAIL(err, SF_ERR_LIBRARY, "CHOLMOD cannot solve for the constraint forces (status %d)",
                           common->status);
        for (int q = 0; q < b->components; q++)
            add_reaction(m, b, step, b->component[q], (double *)b->solution->x + q * b->rows);
    }
    for (int k = 0; k < c->block_count; k++)
        for (int q = 0; q < c->block[k]->components; q++)
            measure_residual(m, c->block[k], step, c->block[k]->component[q]);
    return SF_OK;
}
