/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups of consecutive nodes, and the stabilisation pairs by group. A group owns its nodes; its ghosts are
 * the nodes of other groups in the supports of its domains. Gather: a group copies the coefficients of its
 * nodes and ghosts into a local array. Scatter: it sums the forces of its domains into a local array. So the
 * gradient B is stored once, by domain, and read in storage order both ways. Contributions to nodes owned by
 * other groups are stored and summed later in group order: the same bits for any number of threads. */
#pragma once
#include "model/model.h"

enum {
    SF_HALO_WORK = 8,     /* doubles per node that every pass may use */
    SF_GROUP = 128,       /* nodes, a multiple of SF_CHUNK (state.h) */
    SF_GROUP_SEES = 4096, /* nodes and ghosts of a group at most */
    SF_AHEAD = 512,       /* prefetch distance in numbers of B: B does not fit into the caches, and
                             hardware prefetch stops at the end of a page */
};

typedef struct sf_halo {
    int64_t group_count;
    int64_t *ptr;    /* [group_count + 1] */
    int32_t *node;   /* [ptr[group_count]] ghosts of the group, ascending */
    uint16_t *local; /* [domain_nnz] place of each entry of B (domain_b) in the local array of its group: own
                        nodes, then ghosts */
    int32_t *slot_ptr; /* [n + 1] */
    int32_t *slot;     /* [ptr[group_count]] places of node i in the ghost lists of other groups, ascending */
    double *work;      /* [SF_HALO_WORK n or 3 ptr[group_count], the larger] valid within one pass */
} sf_halo;

/* SF_ERR_MODEL if one group has more than SF_GROUP_SEES nodes and ghosts. */
sf_status sf_halo_build(const sf_model *model, sf_halo *halo, sf_error *err);
void sf_halo_free(sf_halo *halo);

/* Group g's first node, and the end of its nodes. */
static inline int64_t sf_halo_first(int64_t g) {
    return g * SF_GROUP;
}
static inline int64_t sf_halo_end(const sf_model *model, int64_t g) {
    int64_t end = (g + 1) * SF_GROUP;
    return end < model->node_count ? end : model->node_count;
}

/* Stabilisation pairs along the edges of the background mesh, by groups of nodes. A pair within a
 * group is listed once, at its node of the lower number. A pair between two groups is listed in both, so that
 * each group writes to its own nodes only. */

/* Pairs of node i are those behind the pairs of node i - 1 in its group. */
typedef struct sf_pairs {
    int64_t *inner_ptr;    /* [groups + 1] first pair of each group */
    uint16_t *inner_end;   /* [n] end of the node's pairs, counted from the group's first */
    uint16_t *inner_place; /* [inner_ptr[groups]] place of the other node in the group */
    double *inner_weight;  /* [inner_ptr[groups]] m, coefficient x (V_I/n_I + V_J/n_J) / (2 |X_J - X_I|^2) of
                              nodes with n_I and n_J edges: weighs the sum of their stiffnesses */
    int64_t *outer_ptr;    /* the same of pairs with nodes of other groups */
    uint16_t *outer_end;
    int32_t *outer_node; /* number of the other node */
    double *outer_weight;
} sf_pairs;

/* SF_ERR_MODEL if nodes of one group have more than 65,535 edges. */
sf_status sf_pairs_build(const sf_model *model, sf_pairs *pairs, sf_error *err);
void sf_pairs_free(sf_pairs *pairs);
