/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/contact_gram.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The contact points that each node supports: rows by node, entries in ascending contact point. */
typedef struct transposed {
    int64_t *ptr;   /* [n + 2] */
    int32_t *point; /* [..] */
    double *phi;    /* [..] */
} transposed;

static sf_status transpose(const sf_model *m, const sf_contact_rows *rows, transposed *t, sf_error *err) {
    int64_t count = rows->ptr[sf_model_points(m)];
    t->ptr = sf_alloc(err, (unsigned long)m->node_count + 2, sizeof *t->ptr, "contact lists");
    t->point = sf_alloc(err, (unsigned long)count, sizeof *t->point, "contact lists");
    t->phi = sf_alloc(err, (unsigned long)count, sizeof *t->phi, "contact lists");
    if (err->status != SF_OK)
        return err->status;
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

static int by_value(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
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
    qsort(list, (size_t)used, sizeof *list, by_value);
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
    double *dense = sf_alloc(err, count, sizeof *dense, "contact matrix");
    int32_t *list = sf_alloc(err, count, sizeof *list, "contact matrix");
    uint8_t *seen = sf_alloc(err, count, 1, "contact matrix");
    gram->ptr = sf_alloc(err, count + 1, sizeof *gram->ptr, "contact matrix");
    gram->diagonal = sf_alloc(err, count, sizeof *gram->diagonal, "contact matrix");
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
            gram->index =
                sf_alloc(err, (unsigned long)gram->ptr[count], sizeof *gram->index, "contact matrix");
            gram->value =
                sf_alloc(err, (unsigned long)gram->ptr[count], sizeof *gram->value, "contact matrix");
        }
    }
done:
    free(t.ptr);
    free(t.point);
    free(t.phi);
    free(dense);
    free(list);
    free(seen);
    if (err->status != SF_OK)
        sf_contact_gram_free(gram);
    return err->status;
}

void sf_contact_gram_free(sf_contact_gram *gram) {
    free(gram->ptr);
    free(gram->index);
    free(gram->value);
    free(gram->diagonal);
    memset(gram, 0, sizeof *gram);
}
