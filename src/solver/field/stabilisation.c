/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/domain_stress.h"

/* The data of a node that its pairs need. */
typedef struct pair_node {
    sf_vec x, d, f[3];
    double stiffness;
} pair_node;

static inline void load_node(const sf_model *m, const double *d, const double *f, const double *stiffness,
                             int64_t i, pair_node *node) {
    node->stiffness = stiffness[i];
    node->x = sf_vec_load(&sf_model_coefficients(m)[3 * i]);
    node->d = sf_vec_load(&d[3 * i]);
    sf_vec_columns(&f[9 * i], node->f);
}

/* Contributions of one pair to its nodes: force on a, the opposite on b; the same couple and energy on
 * both. */
typedef struct pair_effect {
    sf_vec force, couple[3], energy;
} pair_effect;

static inline void pull_pair(const pair_node *a, const pair_node *b, double weight, pair_effect *out) {
    sf_vec arm = b->x - a->x, half = 0.5 * arm;
    sf_vec explained =
        (a->f[0] + b->f[0]) * half[0] + (a->f[1] + b->f[1]) * half[1] + (a->f[2] + b->f[2]) * half[2];
    sf_vec e = arm + (b->d - a->d) - explained;
    out->energy = weight * (e * e);
    out->force = (weight * (a->stiffness + b->stiffness)) * e;
    for (int c = 0; c < 3; c++)
        out->couple[c] = out->force * half[c];
}

SF_KERNEL void sf_stabilisation_group(const sf_model *m, const sf_pairs *pairs, const double *d,
                                      const double *f, const double *stiffness, int64_t g,
                                      sf_pair_sums *sums) {
    int64_t first = sf_halo_first(g), count = sf_halo_end(m, g) - first;
    int64_t inner = pairs->inner_ptr[g], outer = pairs->outer_ptr[g];
    pair_node own[SF_GROUP], other;
    pair_effect pair;
    memset(sums, 0, sizeof *sums);
    for (int64_t p = 0; p < count; p++)
        load_node(m, d, f, stiffness, first + p, &own[p]);
    for (int64_t p = 0; p < count; p++) {
        int64_t i = first + p;
        sf_vec force = sums->force[p], energy = sums->energy[p],
               couple[3] = {sums->couple[p][0], sums->couple[p][1], sums->couple[p][2]};
        for (; inner < pairs->inner_ptr[g] + pairs->inner_end[i]; inner++) {
            int64_t q = pairs->inner_place[inner];
            pull_pair(&own[p], &own[q], pairs->inner_weight[inner], &pair);
            force += pair.force;
            energy += pair.energy;
            sums->force[q] -= pair.force;
            sums->energy[q] += pair.energy;
            for (int c = 0; c < 3; c++) {
                couple[c] -= pair.couple[c];
                sums->couple[q][c] -= pair.couple[c];
            }
        }
        for (; outer < pairs->outer_ptr[g] + pairs->outer_end[i]; outer++) {
            load_node(m, d, f, stiffness, pairs->outer_node[outer], &other);
            pull_pair(&own[p], &other, pairs->outer_weight[outer], &pair);
            force += pair.force;
            energy += pair.energy;
            for (int c = 0; c < 3; c++)
                couple[c] -= pair.couple[c];
        }
        sums->force[p] = force;
        sums->energy[p] = energy;
        memcpy(sums->couple[p], couple, sizeof couple);
    }
}

double sf_stabilisation_energy(const sf_pair_sums *sums, int64_t place) {
    sf_vec energy = sums->energy[place];
    return 0.5 * (energy[0] + energy[1] + energy[2]);
}

/* The sums of group g into the state, and the energy of its chunks. */
static void take_sums(const sf_model *m, const sf_pair_sums *sums, int64_t g, sf_state *s) {
    for (int64_t i = sf_halo_first(g); i < sf_halo_end(m, g); i++) {
        sf_partial *partial = &s->partial[i / SF_CHUNK];
        int64_t p = i - sf_halo_first(g);
        double stiffness = s->stiffness[i], energy = sf_stabilisation_energy(sums, p);
        memcpy(&s->force[3 * i], &sums->force[p], 3 * sizeof *s->force);
        for (int k = 0; k < 9; k++)
            s->stress[9 * i + k] += sums->couple[p][k % 3][k / 3];
        double work = 0.5 * (s->pair_stiffness[i] + stiffness) * (energy - s->pair_sum[i]);
        s->pair_work[i] += work;
        partial->stabilisation += work;
        partial->given_back += sf_larger(0, -s->pair_work[i]);
        s->pair_sum[i] = energy;
        s->pair_stiffness[i] = stiffness;
    }
}

void sf_stabilisation(const sf_model *m, const sf_operators *op, sf_state *s) {
#pragma omp for schedule(static)
    for (int64_t g = 0; g < op->halo.group_count; g++) {
        sf_pair_sums sums;
        sf_stabilisation_group(m, &op->pairs, s->d, s->f, s->stiffness, g, &sums);
        take_sums(m, &sums, g, s);
    }
}
