/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/internal_force.h"

#include <string.h>

/* V P B of one domain on the nodes it sees. */
static inline void add_domain(const double *restrict p, const uint16_t *restrict local,
                              const double *restrict b, int64_t count, sf_vec *restrict sum) {
    const sf_vec x = {p[0], p[3], p[6]}, y = {p[1], p[4], p[7]}, z = {p[2], p[5], p[8]};
    for (int64_t k = 0; k < count; k++) {
        __builtin_prefetch(&b[3 * k + SF_AHEAD]);
        sum[local[k]] += x * b[3 * k] + y * b[3 * k + 1] + z * b[3 * k + 2];
    }
}

/* What the domains of group g exert, into its array. */
static SF_KERNEL void collect_group(const sf_model *m, const sf_halo *h, const sf_state *s, int64_t g) {
    sf_vec *sum = &h->work[h->ptr[g]];
    memset(sum, 0, (size_t)(h->ptr[g + 1] - h->ptr[g]) * sizeof *sum);
    for (int64_t l = g * SF_GROUP; l < sf_halo_end(m, g); l++) {
        int64_t first = m->domain_ptr[l];
        add_domain(&s->stress[9 * l], &h->local[first], &m->domain_b[3 * first], m->domain_ptr[l + 1] - first,
                   sum);
    }
}

/* What the groups hold for the nodes of group g, from their forces. */
static SF_KERNEL void take_from_groups(const sf_model *m, const sf_halo *h, int64_t g, double *force) {
    for (int64_t i = g * SF_GROUP; i < sf_halo_end(m, g); i++) {
        sf_vec f = {0};
        for (int64_t q = h->slot_ptr[i]; q < h->slot_ptr[i + 1]; q++)
            f += h->work[h->slot[q]];
        for (int r = 0; r < 3; r++)
            force[3 * i + r] -= f[r];
    }
}

void sf_internal_force(const sf_model *m, const sf_operators *op, sf_state *s) {
    const sf_halo *h = &op->halo;
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        collect_group(m, h, s, g);
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        take_from_groups(m, h, g, s->force);
}
