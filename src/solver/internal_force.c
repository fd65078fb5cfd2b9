/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/internal_force.h"

void sf_internal_force(const sf_model *m, const sf_operators *op, sf_state *s) {
#pragma omp parallel for default(none) shared(m, op, s) schedule(static)
    for (int64_t i = 0; i < m->node_count; i++) {
        double f[3] = {0};
        for (int64_t k = op->force_ptr[i]; k < op->force_ptr[i + 1]; k++) {
            const double *restrict p = &s->stress[9 * (int64_t)op->force_domain[k]], *restrict b =
                                                                                         &op->force_b[3 * k];
            for (int r = 0; r < 3; r++)
                f[r] += p[3 * r] * b[0] + p[3 * r + 1] * b[1] + p[3 * r + 2] * b[2];
        }
        for (int r = 0; r < 3; r++)
            s->force[3 * i + r] -= f[r];
    }
}
