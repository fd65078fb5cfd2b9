/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/domain_stress.h"

#include "core/stability.h"
#include "solver/time_step.h"
#include <math.h>
#include <string.h>

/* F of one domain, row-major. */
static inline void deformation_gradient(const sf_model *m, const double *restrict d, int64_t l, double f[9]) {
    double g[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int64_t k = m->domain_ptr[l]; k < m->domain_ptr[l + 1]; k++) {
        const double *restrict x = &d[3 * (int64_t)m->domain_node[k]], *restrict b = &m->domain_b[3 * k];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                g[3 * i + j] += x[i] * b[j];
    }
    memcpy(f, g, sizeof g);
}

/* Lanes first .. first + count - 1 of a batch from the state; spare lanes are an undeformed point. */
static void load_batch(const sf_model *m, const sf_operators *op, const sf_state *s, int64_t block, int count,
                       sf_foam_batch *b) {
    int64_t first = block * SF_LANES;
    for (int l = 0; l < SF_LANES; l++) {
        double f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        const double *old = l < count ? &s->f[9 * (first + l)] : f;
        for (int k = 0; k < 9; k++)
            b->f_old[k][l] = old[k];
        if (l < count)
            deformation_gradient(m, s->d, first + l, f);
        for (int k = 0; k < 9; k++)
            b->f[k][l] = f[k];
        b->length[l] = l < count ? op->damp_length[first + l] : 1;
    }
    memcpy(b->maxwell, &s->maxwell[block * 6 * SF_LANES], sizeof b->maxwell);
    memcpy(b->peak, &s->peak[block * SF_LANES], sizeof b->peak);
    memcpy(b->rate, &s->rate[block * SF_LANES], sizeof b->rate);
}

static void store_batch(const sf_model *m, const sf_operators *op, sf_state *s, int64_t block, int count,
                        const sf_foam_batch *b, sf_partial *sum) {
    int64_t first = block * SF_LANES;
    memcpy(&s->maxwell[block * 6 * SF_LANES], b->maxwell, sizeof b->maxwell);
    memcpy(&s->peak[block * SF_LANES], b->peak, sizeof b->peak);
    memcpy(&s->rate[block * SF_LANES], b->rate, sizeof b->rate);
    double inverse = s->dt_old > 0 ? 2 / s->dt_old : 0;
    for (int l = 0; l < count; l++) {
        int64_t i = first + l;
        double v = m->volume[i], c = op->stability[i] * s->tightness;
        for (int k = 0; k < 9; k++) {
            s->f[9 * i + k] = b->f[k][l];
            s->stress[9 * i + k] = v * b->p[k][l];
        }
        s->energy[i] = b->energy[l];
        s->stiffness[i] = b->stiffness[l];
        s->tangent[i] = 0;
        for (int k = 0; k < 3; k++) {
            double a = b->direction_tangent[k][l], eta = b->direction_viscosity[k][l];
            s->tangent[i] = fmax(s->tangent[i], a + eta * inverse);
            sum->step = fmin(sum->step, sf_stability_step(c, a, eta));
        }
        for (int k = 0; k < 6 && b->directions; k++)
            s->directional[6 * i + k] = b->directional[k][l];
        sum->stored += v * b->stored[l];
        sum->hysteresis += v * b->lost[l];
        sum->viscous += v * b->work[l];
        sum->load = fmax(sum->load, op->stability[i] * s->tangent[i]);
        sum->shortest = fmin(sum->shortest, fmin(b->stretch[0][l], fmin(b->stretch[1][l], b->stretch[2][l])));
        if (!(b->jacobian[l] >= sum->jacobian) && !isnan(sum->jacobian)) { /* NaN is kept */
            sum->jacobian = b->jacobian[l];
            sum->jacobian_node = i;
        }
    }
}

void sf_domain_stress(const sf_model *m, const sf_operators *op, sf_state *s) {
#pragma omp parallel for default(none) shared(m, op, s) schedule(static)
    for (int64_t chunk = 0; chunk < s->chunk_count; chunk++) {
        sf_partial *sum = &s->partial[chunk];
        *sum = (sf_partial){.step = INFINITY, .jacobian = INFINITY, .shortest = INFINITY};
        for (int64_t block = chunk * (SF_CHUNK / SF_LANES);
             block < (chunk + 1) * (SF_CHUNK / SF_LANES) && block * SF_LANES < m->node_count; block++) {
            sf_foam_batch batch = {.directions = sf_time_step_due(s)};
            int64_t left = m->node_count - block * SF_LANES;
            int count = left < SF_LANES ? (int)left : SF_LANES;
            load_batch(m, op, s, block, count, &batch);
            sf_foam_update(&op->foam, s->dt_old, &batch);
            store_batch(m, op, s, block, count, &batch, sum);
        }
    }
}
