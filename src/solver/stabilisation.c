/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/stabilisation.h"

#include <string.h>

double sf_stabilisation_node(const sf_model *m, const double *pair, const double *restrict d,
                             const double *restrict f, const double *stiffness, int64_t i, double force[3],
                             double couple[9]) {
    const double *restrict xi = &m->position[3 * i], *restrict di = &d[3 * i], *restrict fi = &f[9 * i];
    double sum = 0, out[3] = {0}, moment[9] = {0};
    for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++) {
        int64_t j = m->edge_node[k];
        const double *restrict xj = &m->position[3 * j], *restrict dj = &d[3 * j], *restrict fj = &f[9 * j];
        double arm[3], e[3], weight = pair[k] * (stiffness[i] + stiffness[j]);
        for (int c = 0; c < 3; c++)
            arm[c] = xj[c] - xi[c];
        for (int r = 0; r < 3; r++) {
            double explained = 0;
            for (int c = 0; c < 3; c++)
                explained += (fi[3 * r + c] + fj[3 * r + c]) * arm[c];
            e[r] = arm[r] + dj[r] - di[r] - 0.5 * explained;
        }
        sum += pair[k] * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
        for (int r = 0; r < 3; r++) {
            out[r] += weight * e[r];
            for (int c = 0; c < 3; c++)
                moment[3 * r + c] -= 0.5 * weight * e[r] * arm[c];
        }
    }
    memcpy(force, out, sizeof out);
    memcpy(couple, moment, sizeof moment);
    return 0.5 * sum;
}

void sf_stabilisation(const sf_model *m, const sf_operators *op, sf_state *s) {
#pragma omp parallel for default(none) shared(m, op, s) schedule(static)
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
