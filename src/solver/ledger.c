/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/ledger.h"

#include <math.h>

double sf_ledger_internal(const sf_ledger *l) {
    return l->stored + l->hysteresis + l->viscous + l->stabilisation;
}

static double total_energy(const sf_ledger *l) {
    return l->kinetic_missile + l->kinetic_pad + sf_ledger_internal(l) + l->contact + l->friction;
}

/* Pad and missile against gravity and the constraints. `held` (N): the constraints' force along the
 * direction; `carried` (kg m s-1): the pad's momentum along it. */
static void balance_free(const sf_model *m, sf_state *s, double held, double carried, double dt_v) {
    sf_ledger *l = &s->ledger;
    l->kinetic_missile = sf_missile_kinetic(m, &s->missile, dt_v);
    l->external = sf_missile_gravity_work(m, &s->missile);
    l->error = (total_energy(l) - l->external) / l->reference - 1;

    l->impulse += dt_v * (sf_missile_weight(m) + held);
    double change = sf_missile_momentum(m, &s->missile) + carried - l->momentum_reference;
    l->momentum_error = (change - l->impulse) / l->momentum_reference;
}

/* The pad alone, which starts at rest, against the missile and the constraints. There is no initial value, so
 * that the errors refer to the largest work and impulse so far, and at first to what state.c has set. */
static void balance_driven(const sf_model *m, sf_state *s, double held, double carried, double dt_v) {
    sf_ledger *l = &s->ledger;
    double pressed = dt_v * sf_missile_contact_force(m, &s->missile);
    l->reference = fmax(l->reference, fabs(l->external));
    l->error = (total_energy(l) - l->external) / l->reference;

    l->impulse += pressed + dt_v * held;
    l->momentum_reference += fabs(pressed);
    l->momentum_error = (carried - l->impulse) / l->momentum_reference;
}

void sf_ledger_close(const sf_model *m, sf_state *s, const double constraint_force[3], double dt_v) {
    sf_ledger *l = &s->ledger;
    double potential = 0, drift = 0, momentum[3] = {0}, fastest = 0;
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
        fastest = fmax(fastest, p->fastest);
        if (p->jacobian < s->smallest_jacobian) {
            s->smallest_jacobian = p->jacobian;
            s->jacobian_node = p->jacobian_node;
        }
        for (int c = 0; c < 3; c++)
            momentum[c] += p->momentum[c];
    }
    s->largest_compression = 1 - shortest;
    s->fastest = sqrt(fastest);
    l->stabilisation_drift += drift;
    l->stabilisation = potential - l->stabilisation_drift;

    double held = sf_missile_along(m, constraint_force), carried = sf_missile_along(m, momentum);
    if (sf_missile_is_driven(m))
        balance_driven(m, s, held, carried, dt_v);
    else
        balance_free(m, s, held, carried, dt_v);
    l->largest_error = fmax(l->largest_error, fabs(l->error));
}
