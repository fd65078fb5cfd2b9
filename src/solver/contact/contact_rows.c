/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/contact_rows.h"
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
static int64_t put_row(const sf_model *m, const joined *j, int32_t first, sf_contact_rows *rows, int64_t at) {
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

sf_status sf_contact_rows_build(const sf_model *m, sf_contact_rows *rows, sf_error *err) {
    int64_t points = sf_model_points(m);
    SF_OWNED int32_t *node = sf_alloc(err, points, sizeof *node, "contact rows");
    memset(rows, 0, sizeof *rows);
    for (int64_t c = 0; node && c < points; c++)
        node[c] = (int32_t)sf_model_point_node(m, c);
    if (node)
        sf_contact_rows_of_nodes(m, points, node, rows, err);
    return err->status;
}

sf_status sf_contact_rows_of_nodes(const sf_model *m, int64_t points, const int32_t *point,
                                   sf_contact_rows *rows, sf_error *err) {
    joined j = {0};
    memset(rows, 0, sizeof *rows);
    rows->ptr = sf_alloc(err, points + 1, sizeof *rows->ptr, "contact rows");
    if (err->status == SF_OK)
        join_alloc(m, &j, err);
    for (int pass = 0; pass < 2 && err->status == SF_OK; pass++) {
        for (int64_t c = 0; c < points; c++)
            rows->ptr[c + 1] = put_row(m, &j, point[c], rows, rows->ptr[c]);
        if (pass == 1)
            break;
        SF_ALLOC_ALL(err, "contact rows", SF_ROOM(rows->node, rows->ptr[points]),
                     SF_ROOM(rows->value, rows->ptr[points]));
    }
    SF_FREE(j.parent[0], j.parent[1], j.parent[2], j.held, j.next);
    if (err->status != SF_OK)
        sf_contact_rows_free(rows);
    return err->status;
}

void sf_contact_rows_free(sf_contact_rows *rows) {
    SF_CLEAR(rows, rows->ptr, rows->node, rows->value);
}

/* The contact points that each node supports: rows by node, entries in ascending contact point. */
typedef struct transposed {
    int64_t *ptr;   /* [n + 2] */
    int32_t *point; /* [..] */
    double *phi;    /* [..] */
} transposed;

static sf_status transpose(const sf_model *m, const sf_contact_rows *rows, transposed *t, sf_error *err) {
    int64_t count = rows->ptr[sf_model_points(m)];
    SF_TRY(SF_ALLOC_ALL(err, "contact lists", SF_ROOM(t->ptr, m->node_count + 2), SF_ROOM(t->point, count),
                        SF_ROOM(t->phi, count)));
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t c = 0; c < sf_model_points(m); c++)
            for (int64_t k = rows->ptr[c]; k < rows->ptr[c + 1]; k++) {
                if (pass == 0) {
                    t->ptr[rows->node[k] + 2]++;
                    continue;
                }
                int64_t slot = t->ptr[rows->node[k] + 1]++;
                t->point[slot] = (int32_t)c;
                t->phi[slot] = rows->value[k];
            }
        for (int64_t i = 0; pass == 0 && i < m->node_count; i++)
            t->ptr[i + 2] += t->ptr[i + 1];
    }
    return SF_OK;
}

/* Row c: sums into `dense` (zero on entry and exit) and lists the points touched. */
static int64_t gram_row(const sf_model *m, const sf_contact_rows *rows, const transposed *t, int64_t c,
                        double *dense, int32_t *list, uint8_t *seen) {
    int64_t used = 0;
    for (int64_t k = rows->ptr[c]; k < rows->ptr[c + 1]; k++) {
        int32_t node = rows->node[k];
        for (int64_t q = t->ptr[node]; q < t->ptr[node + 1]; q++) {
            if (!seen[t->point[q]]) {
                seen[t->point[q]] = 1;
                list[used++] = t->point[q];
            }
            dense[t->point[q]] += rows->value[k] * t->phi[q] / m->mass[node];
        }
    }
    qsort(list, (size_t)used, sizeof *list, sf_by_number);
    return used;
}

static void measure_points(const sf_model *m, const sf_contact_rows *rows, sf_contact_gram *gram) {
    gram->spacing = INFINITY;
    for (int64_t c = 0; c < sf_model_points(m); c++) {
        double sum = 0;
        for (int64_t k = rows->ptr[c]; k < rows->ptr[c + 1]; k++)
            sum += fabs(rows->value[k]);
        gram->spread = fmax(gram->spread, sum);
        if (!sf_model_point_rests(m, c))
            gram->spacing = fmin(gram->spacing, m->spacing[sf_model_point_node(m, c)]);
    }
}

sf_status sf_contact_gram_build(const sf_model *m, const sf_contact_rows *rows, sf_contact_gram *gram,
                                sf_error *err) {
    unsigned long count = (unsigned long)sf_model_points(m);
    transposed t = {0};
    memset(gram, 0, sizeof *gram);
    measure_points(m, rows, gram);
    SF_OWNED double *dense = sf_alloc(err, count, sizeof *dense, "contact matrix");
    SF_OWNED int32_t *list = sf_alloc(err, count, sizeof *list, "contact matrix");
    SF_OWNED uint8_t *seen = sf_alloc(err, count, 1, "contact matrix");
    SF_ALLOC_ALL(err, "contact matrix", SF_ROOM(gram->ptr, count + 1), SF_ROOM(gram->diagonal, count));
    if (err->status != SF_OK || transpose(m, rows, &t, err) != SF_OK)
        goto done;
    for (int pass = 0; pass < 2 && err->status == SF_OK; pass++) {
        for (int64_t c = 0; c < sf_model_points(m); c++) {
            int64_t used = gram_row(m, rows, &t, c, dense, list, seen);
            gram->ptr[c + 1] = gram->ptr[c] + used;
            for (int64_t k = 0; k < used; k++) {
                if (pass == 1) {
                    gram->index[gram->ptr[c] + k] = list[k];
                    gram->value[gram->ptr[c] + k] = dense[list[k]];
                }
                seen[list[k]] = 0;
                if (list[k] == c)
                    gram->diagonal[c] = dense[c];
            }
            for (int64_t k = 0; k < used; k++)
                dense[list[k]] = 0;
        }
        if (pass == 0) {
            SF_ALLOC_ALL(err, "contact matrix", SF_ROOM(gram->index, gram->ptr[count]),
                         SF_ROOM(gram->value, gram->ptr[count]));
        }
    }
done:
    SF_FREE(t.ptr, t.point, t.phi);
    if (err->status != SF_OK)
        sf_contact_gram_free(gram);
    return err->status;
}

void sf_contact_gram_free(sf_contact_gram *gram) {
    SF_CLEAR(gram, gram->ptr, gram->index, gram->value, gram->diagonal);
}
