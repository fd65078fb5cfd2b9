/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups of consecutive nodes, and the nodes that their domains see: their own, and some of other groups. A
 * group gathers the coefficients it needs into an array of its own, and collects what its domains exert on
 * nodes there, so that the gradient B is stored once, by domain, and read in its order both ways. What it has
 * collected for nodes of other groups waits for them; a node sums it in the order of the groups: the same
 * bits for any number of threads. */
#ifndef SF_SOLVER_FIELD_HALO_H
#define SF_SOLVER_FIELD_HALO_H

#include "core/error.h"
#include "core/lanes.h"
#include "core/model.h"

enum {
    SF_HALO_WORK = 8,     /* doubles per node that passes may count on */
    SF_GROUP = 128,       /* nodes, a multiple of SF_CHUNK (state.h) */
    SF_GROUP_SEES = 4096, /* nodes at most */
    SF_AHEAD = 512,       /* numbers of B between what a kernel works on and what it asks the memory for, as B
                             does not fit into the caches and processors stop reading ahead at the end of a page */
};

typedef struct sf_halo {
    int64_t group_count;
    int64_t *ptr;      /* [group_count + 1] */
    int32_t *node;     /* [ptr[group_count]] nodes of other groups that the group sees, ascending */
    uint16_t *local;   /* [domain_nnz] place of each entry of B (domain_b) in what its group sees: its own
                          nodes, then those others */
    int32_t *slot_ptr; /* [n + 1] */
    int32_t *slot;     /* [ptr[group_count]] where the other groups' lists hold node i, ascending */
    double *work;      /* [SF_HALO_WORK n or 3 ptr[group_count], the larger] of use within one pass */
} sf_halo;

/* SF_ERR_MODEL if one group sees more than SF_GROUP_SEES nodes. */
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

#endif
