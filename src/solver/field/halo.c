/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/halo.h"

/* Lists the nodes of other groups that group g sees, marked in `seen` (zero on entry and exit), into `list`
 * if that is not NULL, and returns how many. */
static int64_t list_others(const sf_model *m, int64_t g, uint8_t *seen, int32_t *list) {
    int64_t own = sf_halo_first(g), end = sf_halo_end(m, g), first = own, last = end - 1, count = 0;
    for (int64_t k = m->domain_ptr[own]; k < m->domain_ptr[end]; k++) {
        int32_t node = m->domain_node[k];
        seen[node] = 1;
        first = node < first ? node : first;
        last = node > last ? node : last;
    }
    memset(&seen[own], 0, (size_t)(end - own));
    for (int64_t i = first; i <= last; i++) {
        if (seen[i] && list)
            list[count] = (int32_t)i;
        count += seen[i];
        seen[i] = 0;
    }
    return count;
}

/* `place` [n]: scratch. */
static void number_entries(const sf_model *m, sf_halo *h, int32_t *place) {
    for (int64_t g = 0; g < h->group_count; g++) {
        int64_t first = sf_halo_first(g), end = sf_halo_end(m, g);
        for (int64_t i = first; i < end; i++)
            place[i] = (int32_t)(i - first);
        for (int64_t q = h->ptr[g]; q < h->ptr[g + 1]; q++)
            place[h->node[q]] = (int32_t)(end - first + q - h->ptr[g]);
        for (int64_t k = m->domain_ptr[first]; k < m->domain_ptr[end]; k++)
            h->local[k] = (uint16_t)place[m->domain_node[k]];
    }
}

static void list_slots(const sf_model *m, sf_halo *h) {
    int64_t total = h->ptr[h->group_count];
    for (int64_t q = 0; q < total; q++)
        h->slot_ptr[h->node[q] + 1]++;
    for (int64_t i = 0; i < m->node_count; i++)
        h->slot_ptr[i + 1] += h->slot_ptr[i];
    for (int64_t q = 0; q < total; q++)
        h->slot[h->slot_ptr[h->node[q]]++] = (int32_t)q;
    memmove(&h->slot_ptr[1], &h->slot_ptr[0], (size_t)m->node_count * sizeof *h->slot_ptr);
    h->slot_ptr[0] = 0;
}

sf_status sf_halo_build(const sf_model *m, sf_halo *h, sf_error *err) {
    unsigned long n = (unsigned long)m->node_count;
    memset(h, 0, sizeof *h);
    h->group_count = (m->node_count + SF_GROUP - 1) / SF_GROUP;
    SF_OWNED uint8_t *seen = sf_alloc(err, n, 1, "group lists");
    SF_OWNED int32_t *place = sf_alloc(err, n, sizeof *place, "group lists");
    SF_ALLOC_ALL(err, "group lists", SF_ROOM(h->ptr, h->group_count + 1), SF_ROOM(h->slot_ptr, n + 1),
                 SF_ROOM(h->local, m->domain_nnz));
    for (int64_t g = 0; g < h->group_count && err->status == SF_OK; g++) {
        int64_t count = list_others(m, g, seen, NULL);
        h->ptr[g + 1] = h->ptr[g] + count;
        if (count > SF_GROUP_SEES - SF_GROUP)
            SF_FAIL(err, SF_ERR_MODEL,
                    "the %d domains from node %lld see %lld nodes, more than %d: number the nodes so that "
                    "neighbours are close",
                    SF_GROUP, (long long)sf_halo_first(g), (long long)count + SF_GROUP, SF_GROUP_SEES);
    }
    if (err->status == SF_OK && h->ptr[h->group_count] > INT32_MAX)
        SF_FAIL(err, SF_ERR_MODEL,
                "groups of domains see %lld nodes of other groups, more than %d: number the nodes so that "
                "neighbours are close",
                (long long)h->ptr[h->group_count], INT32_MAX);
    if (err->status == SF_OK) {
        unsigned long total = (unsigned long)h->ptr[h->group_count];
        SF_ALLOC_ALL(err, "group lists", SF_ROOM(h->node, total), SF_ROOM(h->slot, total));
        h->work = sf_alloc(err, 3 * total > SF_HALO_WORK * n ? 3 * total : SF_HALO_WORK * n, sizeof *h->work,
                           "group sums");
    }
    if (err->status == SF_OK) {
        for (int64_t g = 0; g < h->group_count; g++)
            list_others(m, g, seen, &h->node[h->ptr[g]]);
        number_entries(m, h, place);
        list_slots(m, h);
    }
    if (err->status != SF_OK)
        sf_halo_free(h);
    return err->status;
}

void sf_halo_free(sf_halo *h) {
    SF_CLEAR(h, h->ptr, h->node, h->local, h->slot_ptr, h->slot, h->work);
}

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
