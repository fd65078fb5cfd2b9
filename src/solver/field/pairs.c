/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/pairs.h"

#include "solver/field/halo.h"
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static double weigh(const sf_model *m, int64_t i, int64_t j) {
    double square = 0, share = m->volume[i] / (double)(m->edge_ptr[i + 1] - m->edge_ptr[i]) +
                               m->volume[j] / (double)(m->edge_ptr[j + 1] - m->edge_ptr[j]);
    for (int c = 0; c < 3; c++) {
        double x = m->position[3 * j + c] - m->position[3 * i + c];
        square += x * x;
    }
    return m->run.stabilisation * 0.5 * share / square;
}

/* Pairs of group g in the lists, from `inner` and `outer` on, which move behind them. Only counts without
 * lists. */
static void list_group(const sf_model *m, int64_t g, sf_pairs *p, int64_t *inner, int64_t *outer) {
    int64_t first = sf_halo_first(g), end = sf_halo_end(m, g), inner_first = *inner, outer_first = *outer;
    for (int64_t i = first; i < end; i++) {
        for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++) {
            int64_t j = m->edge_node[k];
            if (j >= first && j < i)
                continue;
            bool within = j >= first && j < end;
            if (within && p->inner_place) {
                p->inner_place[*inner] = (uint16_t)(j - first);
                p->inner_weight[*inner] = weigh(m, i, j);
            } else if (!within && p->outer_node) {
                p->outer_node[*outer] = (int32_t)j;
                p->outer_weight[*outer] = weigh(m, i, j);
            }
            ++*(within ? inner : outer);
        }
        p->inner_end[i] = (uint16_t)(*inner - inner_first);
        p->outer_end[i] = (uint16_t)(*outer - outer_first);
    }
}

static sf_status list_pairs(const sf_model *m, int64_t groups, sf_pairs *p, sf_error *err) {
    for (int64_t g = 0; g < groups && err->status == SF_OK; g++) {
        p->inner_ptr[g + 1] = p->inner_ptr[g];
        p->outer_ptr[g + 1] = p->outer_ptr[g];
        list_group(m, g, p, &p->inner_ptr[g + 1], &p->outer_ptr[g + 1]);
        if (p->inner_ptr[g + 1] - p->inner_ptr[g] > UINT16_MAX ||
            p->outer_ptr[g + 1] - p->outer_ptr[g] > UINT16_MAX)
            SF_FAIL(err, SF_ERR_MODEL, "the %d nodes from node %lld have more than %d edges", SF_GROUP,
                    (long long)sf_halo_first(g), UINT16_MAX);
    }
    return err->status;
}

sf_status sf_pairs_build(const sf_model *m, sf_pairs *p, sf_error *err) {
    int64_t groups = (m->node_count + SF_GROUP - 1) / SF_GROUP;
    unsigned long n = (unsigned long)m->node_count, ends = (unsigned long)groups + 1;
    memset(p, 0, sizeof *p);
    p->inner_ptr = sf_alloc(err, ends, sizeof *p->inner_ptr, "stabilisation pairs");
    p->outer_ptr = sf_alloc(err, ends, sizeof *p->outer_ptr, "stabilisation pairs");
    p->inner_end = sf_alloc(err, n, sizeof *p->inner_end, "stabilisation pairs");
    p->outer_end = sf_alloc(err, n, sizeof *p->outer_end, "stabilisation pairs");
    if (err->status == SF_OK && list_pairs(m, groups, p, err) == SF_OK) {
        unsigned long inner = (unsigned long)p->inner_ptr[groups],
                      outer = (unsigned long)p->outer_ptr[groups];
        p->inner_place = sf_alloc(err, inner, sizeof *p->inner_place, "stabilisation pairs");
        p->inner_weight = sf_alloc(err, inner, sizeof *p->inner_weight, "stabilisation pairs");
        p->outer_weight = sf_alloc(err, outer, sizeof *p->outer_weight, "stabilisation pairs");
        p->outer_node = sf_alloc(err, outer, sizeof *p->outer_node, "stabilisation pairs");
        if (err->status == SF_OK)
            list_pairs(m, groups, p, err);
    }
    if (err->status != SF_OK)
        sf_pairs_free(p);
    return err->status;
}

void sf_pairs_free(sf_pairs *p) {
    free(p->inner_ptr);
    free(p->inner_end);
    free(p->inner_place);
    free(p->outer_ptr);
    free(p->outer_end);
    free(p->outer_node);
    free(p->inner_weight);
    free(p->outer_weight);
    memset(p, 0, sizeof *p);
}
