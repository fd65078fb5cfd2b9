/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/point_rows.h"
#include "base/sets.h"

enum { COMPONENTS = 3 };

/* Sets of nodes with the same component of u_h, as trees; NULL if nothing is tied. */
typedef struct joined {
    int64_t *parent[COMPONENTS]; /* [node_count] each */
    uint8_t *held;               /* [node_count] SF_FIX_* bits */
    int32_t *next; /* [node_count] ring of the nodes at one place, over all ties whatever they join */
} joined;

static bool in_ring(const int32_t *next, int32_t from, int32_t node) {
    int32_t i = from;
    do {
        if (i == node)
            return true;
        i = next[i];
    } while (i != from);
    return false;
}

static void join(const sf_model *m, joined *j) {
    for (int32_t i = 0; i < (int32_t)m->node_count; i++)
        j->next[i] = i;
    for (int64_t k = 0; k < m->fixed_count; k++)
        j->held[m->fixed_node[k]] = m->fixed_mask[k];
    for (int64_t t = 0; t < m->tie_count; t++) {
        int32_t a = m->tie_node[t], b = m->tie_other[t], swap = j->next[a];
        for (int r = 0; r < COMPONENTS; r++)
            if ((m->tie_mask[t] >> r) & 1)
                sf_sets_join(j->parent[r], a, b);
        if (in_ring(j->next, a, b))
            continue;
        j->next[a] = j->next[b]; /* two rings become one */
        j->next[b] = swap;
    }
}

static sf_status join_alloc(const sf_model *m, joined *j, sf_error *err) {
    unsigned long n = (unsigned long)m->node_count;
    if (m->tie_count == 0)
        return SF_OK;
    for (int r = 0; r < COMPONENTS; r++)
        j->parent[r] = sf_sets_alone(m->node_count, "contact rows", err);
    SF_ALLOC_ALL(err, "contact rows", SF_ROOM(j->held, n), SF_ROOM(j->next, n));
    if (err->status == SF_OK)
        join(m, j);
    return err->status;
}

/* True if nodes of one place move as one: each component is tied, or held in both. */
static bool move_as_one(const joined *j, int32_t a, int32_t b) {
    for (int r = 0; r < COMPONENTS; r++)
        if (!((j->held[a] & j->held[b]) >> r & 1) &&
            sf_sets_find(j->parent[r], a) != sf_sets_find(j->parent[r], b))
            return false;
    return true;
}

/* The next node of the ring that moves as `first` does; `first` itself at the end. */
static int32_t next_copy(const joined *j, int32_t first, int32_t node) {
    if (!j->next)
        return first;
    do
        node = j->next[node];
    while (node != first && !move_as_one(j, first, node));
    return node;
}

static double inertia(const sf_model *m, int32_t node) {
    double mobility = 0;
    for (int64_t k = m->phi_ptr[node]; k < m->phi_ptr[node + 1]; k++)
        mobility += m->phi_value[k] * m->phi_value[k] / m->mass[m->phi_node[k]];
    return 1 / mobility;
}

/* Entries of the point at `first`, written from `at` on if there is room for them; returns their end. */
static int64_t put_row(const sf_model *m, const joined *j, int32_t first, sf_point_rows *rows, int64_t at) {
    double all = 0;
    int32_t node = first;
    do
        all += inertia(m, node);
    while ((node = next_copy(j, first, node)) != first);
    do {
        double share = next_copy(j, first, first) == first ? 1 : inertia(m, node) / all;
        for (int64_t k = m->phi_ptr[node]; k < m->phi_ptr[node + 1]; k++, at++)
            if (rows->value) {
                rows->node[at] = m->phi_node[k];
                rows->value[at] = share * m->phi_value[k];
            }
    } while ((node = next_copy(j, first, node)) != first);
    return at;
}

static void measure_rows(const sf_model *m, int64_t points, sf_point_rows *rows) {
    for (int64_t c = 0; c < points; c++) {
        double sum = 0;
        for (int64_t k = rows->ptr[c]; k < rows->ptr[c + 1]; k++) {
            rows->by_mass[k] = rows->value[k] / m->mass[rows->node[k]];
            sum += fabs(rows->value[k]);
        }
        rows->spread = fmax(rows->spread, sum);
    }
}

sf_status sf_point_rows_build(const sf_model *m, int64_t points, const int32_t *point, sf_point_rows *rows,
                              sf_error *err) {
    joined j = {0};
    memset(rows, 0, sizeof *rows);
    rows->ptr = sf_alloc(err, points + 1, sizeof *rows->ptr, "contact rows");
    if (err->status == SF_OK)
        join_alloc(m, &j, err);
    for (int pass = 0; pass < 2 && err->status == SF_OK; pass++) {
        for (int64_t c = 0; c < points; c++)
            rows->ptr[c + 1] = put_row(m, &j, point[c], rows, rows->ptr[c]);
        if (pass == 0)
            SF_ALLOC_ALL(err, "contact rows", SF_ROOM(rows->node, rows->ptr[points]),
                         SF_ROOM(rows->value, rows->ptr[points]), SF_ROOM(rows->by_mass, rows->ptr[points]));
        else
            measure_rows(m, points, rows);
    }
    SF_FREE(j.parent[0], j.parent[1], j.parent[2], j.held, j.next);
    if (err->status != SF_OK)
        sf_point_rows_free(rows);
    return err->status;
}

void sf_point_rows_free(sf_point_rows *rows) {
    SF_CLEAR(rows, rows->ptr, rows->node, rows->value, rows->by_mass);
}
