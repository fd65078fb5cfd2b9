/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pairs of nodes that the stabilisation sees: the edges of the background mesh, by groups of nodes. A
 * pair within a group is listed once, at its node of the lower number. A pair between two groups is listed in
 * both, so that each group writes to its own nodes only. */
#pragma once
#include "solver/field/halo.h"

/* Pairs of node i are those behind the pairs of node i - 1 in its group. */
typedef struct sf_pairs {
    int64_t groups;
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

/* Number of inner and outer pairs of a model. */
int64_t sf_pairs_count(const sf_model *model);
