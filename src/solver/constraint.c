/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/constraint.h"

#include "core/lanes.h"
#include "solver/ldl.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 64 }; /* rows or nodes of one call of a kernel */

struct sf_constraint_block {
    uint8_t held[3]; /* are x, y, z held at these nodes? */
    sf_vec mask;     /* the same as factors */
    int64_t rows;
    int32_t *node; /* [rows] held node, in the order of the elimination */
    uint8_t *base; /* [rows] counts for the base reaction */

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
    sf_vec *field;      /* [touched_count] what G is applied to */
    sf_vec *lambda;     /* [rows] N */
    sf_ldl factor;      /* of G M^-1 G^T */
};

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

/* Lower triangle of G M^-1 G^T: all pairs of rows that share a node. */
static sf_status gram_entries(const sf_model *m, const sf_constraint_block *b, sf_ldl_entries *a,
                              sf_error *err) {
    int64_t pairs = 0;
    for (int64_t t = 0; t < b->touched_count; t++) {
        int64_t rows = b->node_ptr[t + 1] - b->node_ptr[t];
        pairs += rows * (rows + 1) / 2;
    }
    a->rows = b->rows;
    a->row = sf_alloc(err, (unsigned long)pairs, sizeof *a->row, "constraint matrix");
    a->column = sf_alloc(err, (unsigned long)pairs, sizeof *a->column, "constraint matrix");
    a->value = sf_alloc(err, (unsigned long)pairs, sizeof *a->value, "constraint matrix");
    for (int64_t t = 0; t < b->touched_count && err->status == SF_OK; t++)
        for (int64_t p = b->node_ptr[t]; p < b->node_ptr[t + 1]; p++)
            for (int64_t q = b->node_ptr[t]; q <= p; q++) {
                a->row[a->count] = b->node_row[p];
                a->column[a->count] = b->node_row[q];
                a->value[a->count++] = b->node_phi[p] * b->node_phi[q] / m->mass[b->touched[t]];
            }
    return err->status;
}

static sf_status factorize(const sf_model *m, sf_constraint_block *b, sf_error *err) {
    sf_ldl_entries a = {0};
    if (gram_entries(m, b, &a, err) == SF_OK)
        sf_ldl_build(&a, &b->factor, err);
    free(a.row);
    free(a.column);
    free(a.value);
    return err->status;
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

static void free_lists(sf_constraint_block *b) {
    free(b->touched);
    free(b->row_ptr);
    free(b->row_place);
    free(b->row_phi);
    free(b->node_ptr);
    free(b->node_row);
    free(b->node_phi);
    b->touched = b->row_place = b->node_row = NULL;
    b->row_ptr = b->node_ptr = NULL;
    b->row_phi = b->node_phi = NULL;
    b->touched_count = 0;
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
    entries = 0;
    for (int64_t r = 0; r < b->rows && err->status == SF_OK; r++) {
        for (int64_t k = m->phi_ptr[b->node[r]]; k < m->phi_ptr[b->node[r] + 1]; k++, entries++) {
            b->row_place[entries] = m->phi_node[k];
            b->row_phi[entries] = m->phi_value[k];
        }
        b->row_ptr[r + 1] = entries;
    }
    if (err->status == SF_OK && list_touched(m, b, place, err) == SF_OK) {
        b->node_ptr =
            sf_alloc(err, (unsigned long)b->touched_count + 1, sizeof *b->node_ptr, "constraint lists");
        for (int64_t k = 0; k < entries; k++)
            b->row_place[k] = place[b->row_place[k]];
        if (err->status == SF_OK)
            list_by_node(b);
    }
    free(place);
    return err->status;
}

/* The rows in the order of the elimination, and their lists again. */
static sf_status order_rows(const sf_model *m, sf_constraint_block *b, sf_error *err) {
    unsigned long rows = (unsigned long)b->rows;
    int32_t *node = sf_alloc(err, rows, sizeof *node, "constraint nodes");
    uint8_t *base = sf_alloc(err, rows, 1, "constraint nodes");
    for (int64_t r = 0; r < b->rows && err->status == SF_OK; r++) {
        node[r] = b->node[b->factor.order[r]];
        base[r] = b->base[b->factor.order[r]];
    }
    free(b->node);
    free(b->base);
    b->node = node;
    b->base = base;
    free_lists(b);
    return err->status == SF_OK ? build_lists(m, b, err) : err->status;
}

static sf_status build_block(const sf_model *m, int first, sf_constraint *c, sf_error *err) {
    sf_constraint_block *b = sf_alloc(err, 1, sizeof *b, "constraint block");
    if (!b)
        return err->status;
    c->block[c->block_count++] = b;
    for (int k = first; k < 3; k++)
        if (k == first || same_rows(m, first, k))
            b->mask[k] = b->held[k] = 1;
    b->rows = count_rows(m, (uint8_t)(1 << first));
    unsigned long rows = (unsigned long)b->rows;
    b->node = sf_alloc(err, rows, sizeof *b->node, "constraint nodes");
    b->base = sf_alloc(err, rows, 1, "constraint nodes");
    b->lambda = sf_alloc(err, rows, sizeof *b->lambda, "constraint forces");
    if (err->status != SF_OK)
        return err->status;
    int64_t r = 0;
    for (int64_t k = 0; k < m->fixed_count; k++)
        if ((m->fixed_mask[k] >> first) & 1) {
            b->node[r] = m->fixed_node[k];
            b->base[r++] = m->fixed_base[k];
        }
    if (build_lists(m, b, err) == SF_OK && factorize(m, b, err) == SF_OK)
        order_rows(m, b, err);
    if (err->status == SF_OK)
        b->field = sf_alloc(err, (unsigned long)b->touched_count, sizeof *b->field, "constraint forces");
    if (err->status == SF_OK)
        b->mobility =
            sf_alloc(err, (unsigned long)b->touched_count, sizeof *b->mobility, "constraint forces");
    for (int64_t t = 0; t < b->touched_count && err->status == SF_OK; t++)
        b->mobility[t] = 1 / m->mass[b->touched[t]];
    return err->status;
}

sf_status sf_constraint_build(const sf_model *m, sf_constraint *c, sf_error *err) {
    memset(c, 0, sizeof *c);
    for (int k = 0; k < 3 && err->status == SF_OK; k++) {
        bool done = count_rows(m, (uint8_t)(1 << k)) == 0;
        for (int b = 0; b < c->block_count; b++)
            done = done || c->block[b]->held[k];
        if (!done)
            build_block(m, k, c, err);
    }
    if (err->status != SF_OK)
        sf_constraint_free(c);
    return err->status;
}

void sf_constraint_free(sf_constraint *c) {
    for (int k = 0; k < c->block_count; k++) {
        sf_constraint_block *b = c->block[k];
        free_lists(b);
        sf_ldl_free(&b->factor);
        free(b->node);
        free(b->base);
        free(b->field);
        free(b->mobility);
        free(b->lambda);
        free(b);
    }
    memset(c, 0, sizeof *c);
}

/* lambda = G field in a batch of rows from `first`. */
static SF_KERNEL void apply_rows(const sf_constraint_block *b, int64_t first) {
    for (int64_t r = first; r < first + BATCH && r < b->rows; r++) {
        sf_vec sum = {0};
        for (int64_t k = b->row_ptr[r]; k < b->row_ptr[r + 1]; k++)
            sum += b->row_phi[k] * b->field[b->row_place[k]];
        b->lambda[r] = sum * b->mask;
    }
}

/* reaction = G^T lambda at a batch of touched nodes from `first`; no other block holds the same component. */
static SF_KERNEL void set_reactions(const sf_constraint_block *b, int64_t first, double *reaction) {
    for (int64_t t = first; t < first + BATCH && t < b->touched_count; t++) {
        sf_vec sum = {0};
        for (int64_t k = b->node_ptr[t]; k < b->node_ptr[t + 1]; k++)
            sum += b->node_phi[k] * b->lambda[b->node_row[k]];
        for (int r = 0; r < 3; r++)
            if (b->held[r])
                reaction[3 * (int64_t)b->touched[t] + r] = sum[r];
    }
}

/* lambda = G (force / mass) + G v / dt. The loops of different blocks do not wait for each other; all are for
 * the threads of one parallel region. */
static void right_sides(const sf_constraint *c, const sf_constraint_step *step) {
    double inverse = 1 / step->dt;
    for (int k = 0; k < c->block_count; k++) {
        const sf_constraint_block *b = c->block[k];
#pragma omp for schedule(static) nowait
        for (int64_t t = 0; t < b->touched_count; t++) {
            int64_t i = b->touched[t];
            b->field[t] =
                sf_vec_load(&step->force[3 * i]) * b->mobility[t] + sf_vec_load(&step->v[3 * i]) * inverse;
        }
    }
#pragma omp barrier
    for (int k = 0; k < c->block_count; k++) {
        const sf_constraint_block *b = c->block[k];
#pragma omp for schedule(static) nowait
        for (int64_t r = 0; r < b->rows; r += BATCH)
            apply_rows(b, r);
    }
#pragma omp barrier
}

static void solve(const sf_constraint *c) {
    int branches = c->block_count * SF_LDL_BRANCHES;
#pragma omp for schedule(dynamic)
    for (int q = 0; q < branches; q++) {
        const sf_constraint_block *b = c->block[q / SF_LDL_BRANCHES];
        sf_ldl_forward(&b->factor, q % SF_LDL_BRANCHES, b->lambda);
    }
#pragma omp for schedule(dynamic)
    for (int k = 0; k < c->block_count; k++)
        sf_ldl_trunk(&c->block[k]->factor, c->block[k]->lambda);
#pragma omp for schedule(dynamic)
    for (int q = 0; q < branches; q++) {
        const sf_constraint_block *b = c->block[q / SF_LDL_BRANCHES];
        sf_ldl_backward(&b->factor, q % SF_LDL_BRANCHES, b->lambda);
    }
}

/* Resultants of the reactions. */
static void add_resultants(const sf_constraint *c, sf_constraint_step *step) {
    sf_vec all = {0}, base = {0};
    for (int k = 0; k < c->block_count; k++) {
        const sf_constraint_block *b = c->block[k];
        for (int64_t r = 0; r < b->rows; r++) {
            all -= b->lambda[r];
            base -= b->lambda[r] * b->base[r];
        }
    }
    for (int r = 0; r < 3; r++) {
        step->all[r] = all[r];
        step->base[r] = base[r];
    }
}

void sf_constraint_project(const sf_constraint *c, sf_constraint_step *step) {
#pragma omp parallel default(none) shared(c, step)
    {
        right_sides(c, step);
        solve(c);
        for (int k = 0; k < c->block_count; k++) {
            const sf_constraint_block *b = c->block[k];
#pragma omp for schedule(static) nowait
            for (int64_t t = 0; t < b->touched_count; t += BATCH)
                set_reactions(b, t, step->reaction);
        }
    }
    add_resultants(c, step);
}

double sf_constraint_residual(const sf_model *m, const sf_constraint *c, const sf_constraint_step *step) {
    double residual = 0;
    for (int k = 0; k < c->block_count; k++) {
        const sf_constraint_block *b = c->block[k];
#pragma omp parallel default(none) shared(m, b, step) reduction(max : residual)
        {
#pragma omp for schedule(static)
            for (int64_t t = 0; t < b->touched_count; t++) {
                int64_t i = b->touched[t];
                sf_vec net = sf_vec_load(&step->force[3 * i]) - sf_vec_load(&step->reaction[3 * i]);
                b->field[t] = sf_vec_load(&step->v[3 * i]) + net * (step->dt / m->mass[i]);
            }
#pragma omp for schedule(static)
            for (int64_t r = 0; r < b->rows; r += BATCH)
                apply_rows(b, r);
#pragma omp for schedule(static)
            for (int64_t r = 0; r < b->rows; r++)
                for (int q = 0; q < 3; q++)
                    residual = fmax(residual, fabs(b->lambda[r][q]));
        }
    }
    return residual;
}
