/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/constraint/constraint.h"

#include "base/sets.h"

enum { ALL = 7, BATCH = 64 }; /* mask of x, y and z; rows or nodes of one call of a kernel */

/* True if a node whose components in `mask` are held has a row in the range: 0 for all components in
 * `shared` together, 1 to 3 for one of the others. */
static bool has_row(uint8_t mask, uint8_t shared, int range) {
    bool together = (mask & shared) == shared;
    if (range == 0)
        return together;
    int bit = 1 << (range - 1);
    return (mask & bit) != 0 && !(together && (shared & bit) != 0);
}

/* Returns constraint number k of the model, the held ones first, then the tied ones, with the components
 * in `mask`. */
static sf_constraint_row row_of(const sf_model *m, int64_t k, uint8_t *mask) {
    int64_t t = k - m->fixed_count;
    *mask = t < 0 ? m->fixed_mask[k] : m->tie_mask[t];
    return t < 0 ? (sf_constraint_row){m->fixed_node[k], -1, m->fixed_base[k]}
                 : (sf_constraint_row){m->tie_node[t], m->tie_other[t], 0};
}

/* The components that most rows are to hold together: all, or the one that is held most often if no node is
 * held in all. */
static uint8_t choose_shared(const sf_model *m) {
    int64_t held[3] = {0};
    int most = 0;
    for (int64_t k = 0; k < m->fixed_count + m->tie_count; k++) {
        uint8_t mask;
        row_of(m, k, &mask);
        if (mask == ALL)
            return ALL;
        for (int r = 0; r < 3; r++)
            held[r] += (mask >> r) & 1;
    }
    for (int r = 1; r < 3; r++)
        most = held[r] > held[most] ? r : most;
    return (uint8_t)(1 << most);
}

/* The rows range by range, in the order of the model, and the ends of the ranges. */
static sf_status list_rows(const sf_model *m, sf_constraint *c, sf_ldl_entries *a, sf_error *err) {
    int64_t all = m->fixed_count + m->tie_count, row = 0;
    uint8_t mask;
    a->shared = choose_shared(m);
    for (int range = 0; range < 4; range++) {
        for (int64_t k = 0; k < all; k++) {
            row_of(m, k, &mask);
            c->rows += has_row(mask, a->shared, range);
        }
        a->part[range] = c->rows;
    }
    c->row = sf_alloc(err, c->rows, sizeof *c->row, "constraint nodes");
    for (int range = 0; range < 4 && err->status == SF_OK; range++)
        for (int64_t k = 0; k < all; k++) {
            const sf_constraint_row held = row_of(m, k, &mask);
            if (has_row(mask, a->shared, range))
                c->row[row++] = held;
        }
    return err->status;
}

static void list_by_node(sf_constraint *c) {
    for (int64_t k = 0; k < c->row_ptr[c->rows]; k++)
        c->node_ptr[c->row_place[k] + 1]++;
    for (int64_t t = 0; t < c->touched_count; t++)
        c->node_ptr[t + 1] += c->node_ptr[t];
    for (int64_t r = 0; r < c->rows; r++)
        for (int64_t k = c->row_ptr[r]; k < c->row_ptr[r + 1]; k++) {
            int64_t slot = c->node_ptr[c->row_place[k]]++;
            c->node_row[slot] = (int32_t)r;
            c->node_phi[slot] = c->row_phi[k];
        }
    memmove(&c->node_ptr[1], &c->node_ptr[0], (size_t)c->touched_count * sizeof *c->node_ptr);
    c->node_ptr[0] = 0;
}

static void free_lists(sf_constraint *c) {
    SF_FREE(c->touched, c->row_ptr, c->row_place, c->row_phi, c->node_ptr, c->node_row, c->node_phi);
    c->touched = c->row_place = c->node_row = NULL;
    c->row_ptr = c->node_ptr = NULL;
    c->row_phi = c->node_phi = NULL;
    c->touched_count = 0;
}

/* Entries of phi at a node; none at node -1. */
static int64_t phi_count(const sf_model *m, int32_t node) {
    return node < 0 ? 0 : m->phi_ptr[node + 1] - m->phi_ptr[node];
}

/* Puts them behind the entries of G so far, with a sign; returns how many there are then. */
static int64_t put_phi(const sf_model *m, sf_constraint *c, int32_t node, int sign, int64_t entries) {
    int64_t count = phi_count(m, node);
    for (int64_t k = 0; k < count; k++) {
        c->row_place[entries + k] = m->phi_node[m->phi_ptr[node] + k];
        c->row_phi[entries + k] = sign * m->phi_value[m->phi_ptr[node] + k];
    }
    return entries + count;
}

/* The lists of G, from the rows' nodes. */
static sf_status build_lists(const sf_model *m, sf_constraint *c, sf_error *err) {
    int64_t entries = 0;
    for (int64_t r = 0; r < c->rows; r++)
        entries += phi_count(m, c->row[r].node) + phi_count(m, c->row[r].other);
    unsigned long all = (unsigned long)entries, rows = (unsigned long)c->rows;
    SF_ALLOC_ALL(err, "constraint lists", SF_ROOM(c->row_ptr, rows + 1), SF_ROOM(c->row_place, all),
                 SF_ROOM(c->row_phi, all), SF_ROOM(c->node_row, all), SF_ROOM(c->node_phi, all));
    entries = 0;
    for (int64_t r = 0; r < c->rows && err->status == SF_OK; r++) {
        entries = put_phi(m, c, c->row[r].node, 1, entries);
        entries = put_phi(m, c, c->row[r].other, -1, entries);
        c->row_ptr[r + 1] = entries;
    }
    SF_TRY(err->status);
    c->touched =
        sf_list_number(m->node_count, entries, c->row_place, &c->touched_count, "constraint lists", err);
    c->node_ptr = sf_alloc(err, c->touched_count + 1, sizeof *c->node_ptr, "constraint lists");
    if (err->status == SF_OK)
        list_by_node(c);
    return err->status;
}

/* Lower triangle of G M^-1 G^T: all pairs of rows that share a node and a component. */
static sf_status gram_entries(const sf_model *m, const sf_constraint *c, sf_ldl_entries *a, sf_error *err) {
    int64_t pairs = 0;
    for (int64_t t = 0; t < c->touched_count; t++) {
        int64_t rows = c->node_ptr[t + 1] - c->node_ptr[t];
        pairs += rows * (rows + 1) / 2;
    }
    SF_ALLOC_ALL(err, "constraint matrix", SF_ROOM(a->row, pairs), SF_ROOM(a->column, pairs),
                 SF_ROOM(a->value, pairs));
    for (int64_t t = 0; t < c->touched_count && err->status == SF_OK; t++)
        for (int64_t p = c->node_ptr[t]; p < c->node_ptr[t + 1]; p++)
            for (int64_t q = c->node_ptr[t]; q <= p; q++) {
                int64_t high = c->node_row[p], low = c->node_row[q]; /* rows ascend within a node */
                if (sf_ldl_apart(a, low, high))
                    continue;
                a->row[a->count] = high;
                a->column[a->count] = low;
                a->value[a->count++] = c->node_phi[p] * c->node_phi[q] / m->mass[c->touched[t]];
            }
    return err->status;
}

/* The rows in the order of the elimination. */
static sf_status order_rows(sf_constraint *c, sf_error *err) {
    sf_constraint_row *row = sf_alloc(err, c->rows, sizeof *row, "constraint nodes");
    for (int64_t r = 0; r < c->rows && err->status == SF_OK; r++)
        row[r] = c->row[c->factor.order[r]];
    free(c->row);
    c->row = row;
    return err->status;
}

static sf_status build_work(const sf_model *m, sf_constraint *c, sf_error *err) {
    unsigned long touched = (unsigned long)c->touched_count;
    SF_ALLOC_ALL(err, "constraint forces", SF_ROOM(c->lambda, c->rows), SF_ROOM(c->field, touched),
                 SF_ROOM(c->mobility, touched));
    for (int64_t t = 0; t < c->touched_count && err->status == SF_OK; t++)
        c->mobility[t] = 1 / m->mass[c->touched[t]];
    return err->status;
}

sf_status sf_constraint_build(const sf_model *m, sf_constraint *c, sf_error *err) {
    sf_ldl_entries a = {.count = 0};
    memset(c, 0, sizeof *c);
    if (list_rows(m, c, &a, err) == SF_OK && c->rows > 0 && build_lists(m, c, err) == SF_OK &&
        gram_entries(m, c, &a, err) == SF_OK && sf_ldl_build(&a, &c->factor, err) == SF_OK &&
        order_rows(c, err) == SF_OK) {
        free_lists(c);
        if (build_lists(m, c, err) == SF_OK)
            build_work(m, c, err);
    }
    SF_FREE(a.row, a.column, a.value);
    if (err->status != SF_OK)
        sf_constraint_free(c);
    return err->status;
}

void sf_constraint_free(sf_constraint *c) {
    free_lists(c);
    sf_ldl_free(&c->factor);
    SF_CLEAR(c, c->row, c->mobility, c->field, c->lambda);
}

/* lambda = G field in a batch of rows from `first`. */
static SF_KERNEL void apply_rows(const sf_constraint *c, int64_t first) {
    for (int64_t r = first; r < first + BATCH && r < c->rows; r++) {
        sf_vec sum = {0};
        for (int64_t k = c->row_ptr[r]; k < c->row_ptr[r + 1]; k++)
            sum += c->row_phi[k] * c->field[c->row_place[k]];
        c->lambda[r] = sum * c->factor.mask[r];
    }
}

/* reaction = G^T lambda at a batch of touched nodes from `first`. */
static SF_KERNEL void set_reactions(const sf_constraint *c, int64_t first, double *reaction) {
    for (int64_t t = first; t < first + BATCH && t < c->touched_count; t++) {
        sf_vec sum = {0};
        for (int64_t k = c->node_ptr[t]; k < c->node_ptr[t + 1]; k++)
            sum += c->node_phi[k] * c->lambda[c->node_row[k]];
        for (int r = 0; r < 3; r++)
            reaction[3 * (int64_t)c->touched[t] + r] = sum[r];
    }
}

/* lambda = G (force / mass) + G v / dt. Like the solution, for the threads of a parallel region. */
static void right_side(const sf_constraint *c, const sf_constraint_step *step) {
    double inverse = 1 / step->dt;
#pragma omp for schedule(static)
    for (int64_t t = 0; t < c->touched_count; t++) {
        int64_t i = c->touched[t];
        c->field[t] =
            sf_vec_load(&step->force[3 * i]) * c->mobility[t] + sf_vec_load(&step->v[3 * i]) * inverse;
    }
#pragma omp for schedule(static)
    for (int64_t r = 0; r < c->rows; r += BATCH)
        apply_rows(c, r);
}

static void solve(const sf_constraint *c) {
#pragma omp for schedule(dynamic)
    for (int b = 0; b < SF_LDL_BRANCHES; b++)
        sf_ldl_forward(&c->factor, b, c->lambda);
#pragma omp single
    sf_ldl_trunk(&c->factor, c->lambda);
#pragma omp for schedule(dynamic)
    for (int b = 0; b < SF_LDL_BRANCHES; b++)
        sf_ldl_backward(&c->factor, b, c->lambda);
}

/* Resultants of the reactions; ties have none. */
static void add_resultants(const sf_constraint *c, sf_constraint_step *step) {
    sf_vec all = {0}, base = {0};
    for (int64_t r = 0; r < c->rows; r++) {
        all -= c->row[r].other < 0 ? c->lambda[r] : (sf_vec){0};
        base -= c->lambda[r] * c->row[r].base;
    }
    for (int r = 0; r < 3; r++) {
        step->all[r] = all[r];
        step->base[r] = base[r];
    }
}

static void find_reactions(const sf_constraint *c, sf_constraint_step *step) {
    right_side(c, step);
    if (c->rows > 0)
        solve(c);
#pragma omp for schedule(static)
    for (int64_t t = 0; t < c->touched_count; t += BATCH)
        set_reactions(c, t, step->reaction);
}

void sf_constraint_project(const sf_constraint *c, sf_constraint_step *step) {
    SF_BY_ALL_THREADS(c->rows > SF_FEW_POINTS, find_reactions(c, step));
    add_resultants(c, step);
}

double sf_constraint_residual(const sf_model *m, const sf_constraint *c, const sf_constraint_step *step) {
    double residual = 0;
#pragma omp parallel if (c->rows > SF_FEW_POINTS) default(none) shared(m, c, step) reduction(max : residual)
    {
#pragma omp for schedule(static)
        for (int64_t t = 0; t < c->touched_count; t++) {
            int64_t i = c->touched[t];
            sf_vec net = sf_vec_load(&step->force[3 * i]) - sf_vec_load(&step->reaction[3 * i]);
            c->field[t] = sf_vec_load(&step->v[3 * i]) + net * (step->dt / m->mass[i]);
        }
#pragma omp for schedule(static)
        for (int64_t r = 0; r < c->rows; r += BATCH)
            apply_rows(c, r);
#pragma omp for schedule(static)
        for (int64_t r = 0; r < c->rows; r++)
            for (int k = 0; k < 3; k++)
                residual = fmax(residual, fabs(c->lambda[r][k]));
    }
    return residual;
}
