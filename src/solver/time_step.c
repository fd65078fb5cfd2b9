/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/time_step.h"

#include <math.h>

enum {
    POWER_INTERVAL = 25, /* steps between power iterations */
    POWER_FIRST = 80,    /* iterations of the first estimate */
    POWER_WARM = 8,      /* of the later ones */
};
/* The power iteration converges from below; its estimate of the frequency squared is raised by this factor. */
static const double POWER_MARGIN = 1.08;
static const double GROWTH = 1.02;

/* mode_work: gradient of the mode in every domain. */
static void mode_gradients(const sf_model *m, sf_state *s) {
#pragma omp parallel for default(none) shared(m, s) schedule(static)
    for (int64_t l = 0; l < m->node_count; l++) {
        double g[3] = {0};
        for (int64_t k = m->domain_ptr[l]; k < m->domain_ptr[l + 1]; k++)
            for (int c = 0; c < 3; c++)
                g[c] += s->mode[m->domain_node[k]] * m->domain_b[3 * k + c];
        for (int c = 0; c < 3; c++)
            s->mode_work[4 * l + c] = g[c];
    }
}

/* Pair force of node i, and its couple: what the stabilisation adds for a scalar field. */
static double mode_pairs(const sf_model *m, const sf_operators *op, const sf_state *s, int64_t i, double couple[3]) {
    double force = 0;
    couple[0] = couple[1] = couple[2] = 0;
    for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++) {
        int64_t j = m->edge_node[k];
        double arm[3], explained = 0, weight = op->pair[k] * (s->stiffness[i] + s->stiffness[j]);
        for (int c = 0; c < 3; c++) {
            arm[c] = m->position[3 * j + c] - m->position[3 * i + c];
            explained += (s->mode_work[4 * i + c] + s->mode_work[4 * j + c]) * arm[c];
        }
        double e = s->mode[j] - s->mode[i] - 0.5 * explained;
        force -= weight * e;
        for (int c = 0; c < 3; c++)
            couple[c] -= 0.5 * weight * e * arm[c];
    }
    return force;
}

/* The product K mode, into power_out: the same gathers as in the step itself. */
static void apply_operator(const sf_model *m, const sf_operators *op, sf_state *s) {
    double *couples = s->power_couple, *out = s->power_out;
    mode_gradients(m, s);
#pragma omp parallel for default(none) shared(m, op, s, couples, out) schedule(static)
    for (int64_t i = 0; i < m->node_count; i++) {
        double couple[3];
        out[i] = mode_pairs(m, op, s, i, couple);
        for (int c = 0; c < 3; c++)
            couples[3 * i + c] = couple[c] + m->volume[i] * s->tangent[i] * s->mode_work[4 * i + c];
    }
#pragma omp parallel for default(none) shared(m, op, couples, out) schedule(static)
    for (int64_t i = 0; i < m->node_count; i++) {
        double sum = out[i];
        for (int64_t k = op->force_ptr[i]; k < op->force_ptr[i + 1]; k++) {
            const double *q = &couples[3 * (int64_t)op->force_domain[k]], *b = &op->force_b[3 * k];
            sum += q[0] * b[0] + q[1] * b[1] + q[2] * b[2];
        }
        out[i] = sum;
    }
}

double sf_time_step_power(const sf_model *m, const sf_operators *op, sf_state *s, int iterations) {
    int64_t n = m->node_count;
    double *out = s->power_out, estimate = 0;
    for (int k = 0; k < iterations; k++) {
        double norm = 0, rayleigh = 0;
        for (int64_t i = 0; i < n; i++)
            norm += m->mass[i] * s->mode[i] * s->mode[i];
        double scale = norm > 0 ? 1 / sqrt(norm) : 0;
        for (int64_t i = 0; i < n; i++)
            s->mode[i] *= scale;
        apply_operator(m, op, s);
        for (int64_t i = 0; i < n; i++) {
            rayleigh += s->mode[i] * out[i];
            s->mode[i] = out[i] / m->mass[i];
        }
        estimate = fmax(estimate, rayleigh);
    }
    s->power_iterations += iterations;
    return estimate;
}

/* A little of every node's sawtooth, weighted by how stiff its domain is, so that the iteration finds a new stiff spot
 * even if the old mode vanishes there. */
static void seed_mode(const sf_model *m, const sf_operators *op, sf_state *s) {
    double largest = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        largest = fmax(largest, fabs(s->mode[i]));
    double amplitude = largest > 0 ? 0.2 * largest : 1;
    for (int64_t i = 0; i < m->node_count; i++) {
        uint64_t hash = ((uint64_t)i + 1) * 0x9e3779b97f4a7c15ULL;
        double sign = (double)(hash >> 40) / (double)(1 << 23) - 1;
        double stiff = op->stability[i] * s->tangent[i] / s->bound_load;
        s->mode[i] += amplitude * sign * stiff * stiff;
    }
}

static void merge_bounds(sf_state *s) {
    s->bound_step = INFINITY;
    s->bound_load = 0;
    for (int64_t k = 0; k < s->chunk_count; k++) {
        s->bound_step = fmin(s->bound_step, s->partial[k].step);
        s->bound_load = fmax(s->bound_load, s->partial[k].load);
    }
}

void sf_time_step_choose(const sf_model *m, const sf_operators *op, sf_state *s) {
    merge_bounds(s);
    if (s->step % POWER_INTERVAL == 0) {
        seed_mode(m, op, s);
        double power = sf_time_step_power(m, op, s, s->step == 0 ? POWER_FIRST : POWER_WARM);
        double old = s->tightness;
        s->tightness = POWER_MARGIN * power / s->bound_load;
        s->bound_step *= sqrt(old / s->tightness); /* to first order in the damping; exact from the next step on */
    }
    double dt = fmin(m->run.step_safety * s->bound_step, m->run.step_limit);
    s->dt = s->step == 0 ? dt : fmin(dt, GROWTH * s->dt_old);
}
