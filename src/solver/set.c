/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/set.h"

#include "base/mat3.h"
#include "solver/constraint/constraint.h"

void sf_set_watch(const sf_model *m, sf_state *s) {
    double depth = sf_missile_depth(m, &s->missile);
    if (sf_model_set(m) > 0 && depth > s->deepest)
        memcpy(s->set_peak, s->d, 3 * (size_t)m->node_count * sizeof *s->d);
    s->deepest = fmax(s->deepest, depth);
}

/* Takes the set of a node, and its recovered part, from those in a drop to those after it and a rest. */
static void leave(const sf_memory *m, const double peak[3], double pause, double set[3], double *recovered) {
    double left = 1 - *recovered, old[3], fresh[3];
    for (int r = 0; r < 3; r++) {
        old[r] = left > 0 ? set[r] / left : 0;
        fresh[r] = m->set * (set[r] + peak[r]);
    }
    double most = sqrt(sf_dot3(old, old)), now = sqrt(sf_dot3(fresh, fresh));
    sf_memory_point point = {.recovered = now >= most ? 0 : fmin(*recovered, 1 - now / most)};
    const sf_memory rest = {.recovery = m->set_recovery, .start = m->start, .permanent = m->permanent};
    sf_memory_rest(&rest, pause, &point);
    *recovered = point.recovered;
    for (int r = 0; r < 3; r++)
        set[r] = (1 - point.recovered) * (now >= most ? fresh : old)[r];
}

/* The set of the model after a rest. */
static sf_status leave_all(const sf_model *m, const double *peak, double pause, sf_error *err) {
    SF_OWNED_BY(sf_constraint_free) sf_constraint c = {0};
    SF_OWNED double *reaction = sf_alloc(err, 3 * m->node_count, sizeof *reaction, "permanent set");
    if (!reaction || sf_constraint_build(m, &c, err) != SF_OK)
        return err->status;
    for (int64_t i = 0; i < m->node_count; i++)
        leave(sf_foam_memory(m->material), &peak[3 * i], pause, &m->set[3 * i],
              &m->set[3 * m->node_count + i]);
    sf_constraint_step held = {.force = reaction, .v = m->set, .dt = 1, .reaction = reaction};
    sf_constraint_project(&c, &held);
    for (int64_t k = 0; k < 3 * m->node_count; k++)
        m->set[k] -= reaction[k] / m->mass[k / 3];
    return SF_OK;
}

/* Moves B and V of domain i; returns det(F_s). */
static double move_domain(const sf_model *m, int64_t i) {
    double f[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, cofactor[3][3];
    for (int64_t k = m->domain_ptr[i]; k < m->domain_ptr[i + 1]; k++)
        for (int e = 0; e < 9; e++)
            f[e / 3][e % 3] += m->set[3 * (int64_t)m->domain_node[k] + e / 3] * m->domain_b[3 * k + e % 3];
    if (m->axisymmetric) { /* as in domain_stress.c: the hoop row is u_R's alone, and of a diagonal block */
        f[1][1] = 1 + f[0][1];
        f[0][1] = f[2][1] = 0;
    }
    for (int r = 0; r < 3; r++)
        sf_cross3(f[(r + 1) % 3], f[(r + 2) % 3], cofactor[r]);
    double jacobian = sf_dot3(f[0], cofactor[0]);
    for (double *b = &m->domain_b[3 * m->domain_ptr[i]]; b < &m->domain_b[3 * m->domain_ptr[i + 1]]; b += 3) {
        const double old[3] = {b[0], b[1], b[2]};
        for (int r = 0; r < 3; r++)
            b[r] = sf_dot3(cofactor[r], old) / jacobian;
    }
    m->volume[i] *= jacobian;
    return jacobian;
}

/* The displacement of node i by the set; exactly 0 in the components of `mask`, which are held. */
static void displace(const sf_model *m, int64_t i, uint8_t mask, double out[3]) {
    out[0] = out[1] = out[2] = 0;
    for (int64_t k = m->phi_ptr[i]; k < m->phi_ptr[i + 1]; k++)
        for (int c = 0; c < 3; c++)
            out[c] += mask & 1 << c ? 0 : m->phi_value[k] * m->set[3 * (int64_t)m->phi_node[k] + c];
}

sf_status sf_set_move(sf_model *m, const double *set, const double *peak, double pause, sf_error *err) {
    size_t n = (size_t)m->node_count;
    double low[3], high[3];
    m->set = sf_alloc(err, 7 * n + 1, sizeof *set, "permanent set");
    SF_TRY(err->status);
    memcpy(m->set, set, 4 * n * sizeof *set);
    sf_box3(m->node_count, m->position, low, high);
    m->set[7 * n] = high[2] - m->anvil.depth;
    if (peak)
        SF_TRY(leave_all(m, peak, pause, err));
    for (int64_t i = 0, held = 0; i < m->node_count; i++) {
        double *x = &m->position[3 * i], way[3], jacobian = move_domain(m, i);
        if (!(jacobian >= 0.3))
            return SF_REFUSE(err,
                             "the permanent set would leave %.3g of the foam's volume at (%.4g, %.4g, %.4g) "
                             "mm, less than 0.3: make material.memory.set, %g, smaller",
                             jacobian, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2], sf_model_set(m));
        while (held < m->fixed_count && m->fixed_node[held] < i)
            held++;
        displace(m, i, held < m->fixed_count && m->fixed_node[held] == i ? m->fixed_mask[held] : 0, way);
        for (int c = 0; c < 3; c++) {
            m->set[4 * m->node_count + 3 * i + c] = x[c] + m->set[3 * i + c];
            x[c] += way[c];
        }
    }
    return SF_OK;
}

sf_status sf_set_check_missile(const sf_model *m, const sf_body *body, sf_error *err) {
    double gap, normal[3];
    sf_missile missile;
    sf_missile_begin(m, &missile);
    for (const int32_t *i = m->contact_node; i < m->contact_node + m->contact_count; i++)
        if (sf_missile_gap(m, &missile, body, &m->position[3 * (int64_t)*i], &gap, normal) &&
            -gap > SF_CONTACT_ENTRY * m->spacing[*i])
            return SF_REFUSE(err,
                             "the permanent set has moved foam %.3g mm into the missile at its start: give a "
                             "larger missile.gap than %.4g mm",
                             -1e3 * gap, 1e3 * m->missile.gap);
    return SF_OK;
}

void sf_set_measure(const sf_model *m, double set[2]) {
    double best = -INFINITY, way[3];
    set[0] = set[1] = 0;
    for (int64_t c = 0; c < m->contact_count; c++) {
        const double *x = &m->position[3 * (int64_t)m->contact_node[c]];
        displace(m, m->contact_node[c], 0, way);
        double score =
            x[2] - way[2] - hypot(x[0] - way[0] - m->missile.impact[0], x[1] - way[1] - m->missile.impact[1]);
        if (score > best) { /* near, and not down a hole */
            best = score;
            set[0] = -way[2];
        }
        set[1] = fmax(set[1], -way[2]);
    }
}
