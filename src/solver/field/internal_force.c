/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/internal_force.h"

#include <string.h>

/* Adds V P B_J of domain l to the local sums of its nodes; x, y, z: columns of V P. */
static inline void add_domain(const sf_model *m, const sf_halo *h, int64_t l, sf_vec x, sf_vec y, sf_vec z,
                              sf_vec *restrict sum) {
    const int64_t first = m->domain_ptr[l], count = m->domain_ptr[l + 1] - first;
    const double *b = &m->domain_b[3 * first];
    const uint16_t *local = &h->local[first];
    for (int64_t k = 0; k < count; k++) {
        __builtin_prefetch(&b[3 * k + SF_AHEAD]);
        sum[local[k]] += x * b[3 * k] + y * b[3 * k + 1] + z * b[3 * k + 2];
    }
}

/* Forces of the domains of group g: on its own nodes at once; contributions to nodes owned by other groups
 * are stored and summed later in group order. */
static SF_KERNEL void collect_group(const sf_model *m, const sf_halo *h, const double *stress, int64_t g,
                                    double *force) {
    int64_t own = sf_halo_first(g), end = sf_halo_end(m, g), others = h->ptr[g + 1] - h->ptr[g];
    sf_vec seen[SF_GROUP_SEES];
    memset(seen, 0, (size_t)(end - own + others) * sizeof *seen);
    for (int64_t l = own; l < end; l++) {
        const double *p = &stress[9 * l];
        const sf_vec x = {p[0], p[3], p[6]}, y = {p[1], p[4], p[7]}, z = {p[2], p[5], p[8]};
        add_domain(m, h, l, x, y, z, seen);
    }
    for (int64_t i = own; i < end; i++)
        for (int r = 0; r < 3; r++)
            force[3 * i + r] -= seen[i - own][r];
    for (int64_t q = 0; q < others; q++)
        memcpy(&h->work[3 * (h->ptr[g] + q)], &seen[end - own + q], 3 * sizeof(double));
}

/* Subtracts the stored contributions of other groups from the forces on the nodes of group g. */
static SF_KERNEL void take_waiting(const sf_model *m, const sf_halo *h, int64_t g, double *force) {
    for (int64_t i = sf_halo_first(g); i < sf_halo_end(m, g); i++) {
        sf_vec f = {0};
        for (int32_t q = h->slot_ptr[i]; q < h->slot_ptr[i + 1]; q++)
            f += sf_vec_load(&h->work[3 * (int64_t)h->slot[q]]);
        for (int r = 0; r < 3; r++)
            force[3 * i + r] -= f[r];
    }
}

void sf_internal_force(const sf_model *m, const sf_operators *op, sf_state *s) {
    const sf_halo *h = &op->halo;
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        collect_group(m, h, s->stress, g, s->force);
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        take_waiting(m, h, g, s->force);
}
