/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/laws.h"
#include "solver/contact/contact_rows.h"

typedef struct sf_operators sf_operators; /* solver/operators.h */
typedef struct sf_state sf_state;         /* solver/state.h */

/* Groups of consecutive nodes. A group owns its nodes; its ghosts are the nodes of other groups in the
 * supports of its domains. Gather: a group copies the coefficients of its nodes and ghosts into a local
 * array. Scatter: it sums the forces of its domains into a local array. So the gradient B is stored once, by
 * domain, and read in storage order both ways. Contributions to nodes owned by other groups are stored and
 * summed later in group order: the same bits for any number of threads. */

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

/* The membrane on faces of the pad: triangles of constant strain between the physical positions of its nodes,
 * x = X + Phi d, whose forces act on the coefficients by the same rows (theory, section "Membranes"). */

enum { SF_MEMBRANE_ROW = 11 }; /* numbers of a triangle: forces on its nodes, N, energy, J, largest strain */

typedef struct sf_membrane {
    int64_t count, triangle_count;
    int32_t *node;     /* [count] of the model, ascending */
    int32_t *triangle; /* [triangle_count][3] nodes of the membrane */
    double
        *gradient; /* [triangle_count][3][2] m-1, of the shape functions in axes of the undeformed triangle */
    double *volume; /* [triangle_count] m3 */
    double load;    /* s-2, bound on the square of its highest frequency, at rest */
    sf_contact_rows rows;
} sf_membrane;

sf_status sf_membrane_build(const sf_model *model, sf_membrane *membrane, sf_error *err);
void sf_membrane_free(sf_membrane *membrane);

/* The membrane's part of the state, all of it made anew in each step. */
typedef struct sf_membrane_state {
    double *position; /* [count][3] m, present */
    double *force;    /* [count][3] N, on its nodes */
    double *row;      /* [triangle_count][SF_MEMBRANE_ROW] */
    double energy;    /* J, stored */
    double load;      /* s-2, bound on the square of its highest frequency now */
} sf_membrane_state;

/* Adds its forces at the coefficients d [node_count][3] (m) to force [node_count][3] (N). */
void sf_membrane_force(const sf_model *model, const sf_membrane *membrane, const double *d,
                       sf_membrane_state *state, double *force);

/* Kinematics and stress of every smoothing domain: F = I + sum d_J B_J^T, material law, V P (theory eq. 7,
 * section "Foam"). Writes f, stress, history, energy, stiffness, tangent, and the domains' partial sums. */

/* dt_old is the step that led to the present coefficients; 0 at the start. In a parallel region all threads
 * must call it and share the work; it ends with a barrier. */
void sf_domain_stress(const sf_model *model, const sf_operators *operators, sf_state *state);

/* The law once more, at rest, at the F and the largest W of a block of SF_LANES domains: stretches, W
 * and hysteresis factor. */
void sf_domain_law(const sf_model *model, const sf_operators *operators, const sf_state *state, int64_t block,
                   sf_law_batch *batch);

/* The history of the pad unloaded to rest, and after a `pause` (s) there, with the ledger's `before`. */
void sf_domain_rest(const sf_model *model, const sf_operators *operators, sf_state *state, double pause);

/* Internal forces f_I = - sum_L (V P)_L B_I^L, scattered by groups of domains, then summed by node
 * (theory eq. 8). */

/* Adds them to force. In a parallel region all threads must call it and share the work; it ends with a
 * barrier. */
void sf_internal_force(const sf_model *model, const sf_operators *operators, sf_state *state);

/* Control of the zero-energy modes of nodal integration (theory, section "Stabilisation"; after Ganzenmueller
 * 2015, doi:10.1016/j.cma.2014.12.005). For every mesh edge IJ the part of x_J - x_I that the gradients do
 * not reproduce, e = x_J - x_I - 1/2 (F_I + F_J)(X_J - X_I), is penalised by the energy 1/2 k |e|^2, k =
 * weight (g_I + g_J), g the current stiffness of the foam. Forces are the exact gradient of that energy: on
 * x, and on F as an extra couple in the stress, so that linear and angular momentum hold. */

/* In a parallel region all threads must call it and share the work; it ends with a barrier.
 * Sets force to the pairs' forces, adds the couples to stress, and fills the partial sums of the
 * stabilisation. */
void sf_stabilisation(const sf_model *model, const sf_operators *operators, sf_state *state);

/* Forces, couples and energies of the pairs at the nodes of a group, by place in it. */
typedef struct sf_pair_sums {
    sf_vec force[SF_GROUP];     /* N */
    sf_vec couple[SF_GROUP][3]; /* J, by column */
    sf_vec energy[SF_GROUP];    /* m3, sum of weight e e by component */
} sf_pair_sums;

/* The sums of group g from coefficients d [n][3], gradients f [n][9] and stiffness [n]. */
void sf_stabilisation_group(const sf_model *model, const sf_pairs *pairs, const double *d, const double *f,
                            const double *stiffness, int64_t g, sf_pair_sums *sums);

/* Returns the sum of 1/2 weight |e|^2 (m3) of a node of the group. */
double sf_stabilisation_energy(const sf_pair_sums *sums, int64_t place);
