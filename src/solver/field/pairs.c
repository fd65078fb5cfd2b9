/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/pairs.h"

static double weigh(const sf_model *m, int64_t i, int64_t j) {
    double square = 0, share = m->volume[i] / (double)(m->edge_ptr[i + 1] - m->edge_ptr[i]) +
                               m->volume[j] / (double)(m->edge_ptr[j + 1] - m->edge_ptr[j]);
    const double *at = sf_model_coefficients(m);
    for (int c = 0; c < 3; c++) {
        double x = at[3 * j + c] - at[3 * i + c];
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

int64_t sf_pairs_count(const sf_model *m) {
    int64_t count = m->edge_pairs;
    for (int64_t i = 0; i < m->node_count && m->edge_ptr; i++)
        for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++)
            count += m->edge_node[k] > i || m->edge_node[k] / SF_GROUP != i / SF_GROUP;
    return count;
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
    p->groups = groups;
    SF_ALLOC_ALL(err, "stabilisation pairs", SF_ROOM(p->inner_ptr, ends), SF_ROOM(p->outer_ptr, ends),
                 SF_ROOM(p->inner_end, n), SF_ROOM(p->outer_end, n));
    if (err->status == SF_OK && list_pairs(m, groups, p, err) == SF_OK) {
        unsigned long inner = (unsigned long)p->inner_ptr[groups],
                      outer = (unsigned long)p->outer_ptr[groups];
        SF_ALLOC_ALL(err, "stabilisation pairs", SF_ROOM(p->inner_place, inner),
                     SF_ROOM(p->inner_weight, inner), SF_ROOM(p->outer_weight, outer),
                     SF_ROOM(p->outer_node, outer));
        if (err->status == SF_OK)
            list_pairs(m, groups, p, err);
    }
    if (err->status != SF_OK)
        sf_pairs_free(p);
    return err->status;
}

void sf_pairs_free(sf_pairs *p) {
    SF_CLEAR(p, p->inner_ptr, p->inner_end, p->inner_place, p->outer_ptr, p->outer_end, p->outer_node,
             p->inner_weight, p->outer_weight);
}
