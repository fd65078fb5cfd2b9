/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/stabilisation.h"

SF_KERNEL double sf_stabilisation_node(const sf_model *m, const double *pair, const double *d,
                                       const double *f, const double *stiffness, int64_t i, double force[3],
                                       double couple[9]) {
    const sf_vec xi = sf_vec_load(&m->position[3 * i]), di = sf_vec_load(&d[3 * i]);
    sf_vec fi[3], fj[3], sum = {0}, out = {0}, moment[3] = {{0}, {0}, {0}};
    sf_vec_columns(&f[9 * i], fi);
    for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++) {
        int64_t j = m->edge_node[k];
        double weight = pair[k] * (stiffness[i] + stiffness[j]);
        sf_vec arm = sf_vec_load(&m->position[3 * j]) - xi, dj = sf_vec_load(&d[3 * j]);
        sf_vec_columns(&f[9 * j], fj);
        sf_vec half = 0.5 * arm;
        sf_vec explained = (fi[0] + fj[0]) * half[0] + (fi[1] + fj[1]) * half[1] + (fi[2] + fj[2]) * half[2];
        sf_vec e = arm + (dj - di) - explained, pull = weight * e;
        sum += pair[k] * (e * e);
        out += pull;
        for (int c = 0; c < 3; c++)
            moment[c] -= pull * half[c];
    }
    for (int r = 0; r < 3; r++) {
        force[r] = out[r];
        for (int c = 0; c < 3; c++)
            couple[3 * r + c] = moment[c][r];
    }
    return 0.5 * (sum[0] + sum[1] + sum[2]);
}

void sf_stabilisation(const sf_model *m, const sf_operators *op, sf_state *s) {
#pragma omp for schedule(static)
    for (int64_t chunk = 0; chunk < s->chunk_count; chunk++) {
        sf_partial *partial = &s->partial[chunk];
        for (int64_t i = chunk * SF_CHUNK; i < (chunk + 1) * SF_CHUNK && i < m->node_count; i++) {
            double couple[9], g = s->stiffness[i];
            double sum =
                sf_stabilisation_node(m, op->pair, s->d, s->f, s->stiffness, i, &s->force[3 * i], couple);
            for (int k = 0; k < 9; k++)
                s->stress[9 * i + k] += couple[k];
            partial->stabilisation += g * sum;
            partial->stabilisation_drift += 0.5 * (s->pair_sum[i] + sum) * (g - s->pair_stiffness[i]);
            s->pair_sum[i] = sum;
            s->pair_stiffness[i] = g;
        }
    }
}
