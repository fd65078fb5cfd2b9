/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/ledger.h"

#include "core/mat3.h"

double sf_ledger_internal(const sf_ledger *l) {
    return l->stored + l->hysteresis + l->viscous + l->stabilisation;
}

void sf_ledger_close(const sf_model *m, sf_state *s, const double constraint_force[3], double dt_v) {
    sf_ledger *l = &s->ledger;
    const double *e = m->missile.direction;
    double potential = 0, drift = 0, momentum[3] = {0};
    s->smallest_jacobian = INFINITY;
    double shortest = INFINITY;
    l->stored = l->hysteresis = l->kinetic_pad = 0;
    for (int64_t k = 0; k < s->chunk_count; k++) {
        const sf_partial *p = &s->partial[k];
        l->stored += p->stored;
        l->hysteresis += p->hysteresis;
        l->viscous += p->viscous;
        l->kinetic_pad += p->kinetic;
        potential += p->stabilisation;
        drift += p->stabilisation_drift;
        shortest = fmin(shortest, p->shortest);
        if (p->jacobian < s->smallest_jacobian) {
            s->smallest_jacobian = p->jacobian;
            s->jacobian_node = p->jacobian_node;
        }
        for (int c = 0; c < 3; c++)
            momentum[c] += p->momentum[c];
    }
    s->largest_compression = 1 - shortest;
    l->stabilisation_drift += drift;
    l->stabilisation = potential - l->stabilisation_drift;

    double mass = m->missile.mass / (double)m->symmetry_factor, pull = -m->missile.gravity * e[2];
    double before = s->missile.velocity - dt_v * s->missile.acceleration;
    l->kinetic_missile = 0.5 * mass * before * s->missile.velocity;
    l->external = mass * pull * s->missile.displacement;
    double total = l->kinetic_missile + l->kinetic_pad + sf_ledger_internal(l) + l->contact + l->friction;
    l->error = (total - l->external) / l->initial - 1;
    l->largest_error = fmax(l->largest_error, fabs(l->error));

    l->impulse += dt_v * (mass * pull + sf_dot3(constraint_force, e));
    double change = mass * s->missile.velocity + sf_dot3(momentum, e) - l->momentum_initial;
    l->momentum_error = (change - l->impulse) / l->momentum_initial;
}
