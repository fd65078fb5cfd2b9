/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/state.h"

#include "base/mat3.h"
#include "model/flight.h"

double sf_ledger_internal(const sf_ledger *l) {
    return l->stored + l->hysteresis + l->viscous + l->stabilisation;
}

static double total_energy(const sf_ledger *l) {
    return l->kinetic_missile + l->kinetic_pad + sf_ledger_internal(l) + l->contact + l->friction;
}

/* Pad and missile along its direction, against gravity, constraints and anvil. `held` (N): the outside
 * force on the pad along the direction; `carried` (kg m s-1): the pad's momentum along it. */
static void balance_free(const sf_model *m, sf_state *s, double held, double carried, double dt_v) {
    sf_ledger *l = &s->ledger;
    l->kinetic_missile = sf_missile_kinetic(m, &s->missile, dt_v);
    l->external = sf_missile_gravity_work(m, &s->missile);
    const sf_missile_card *card = &m->missile;
    double gain = sf_flight_energy(card, sf_missile_mass(m)),
           before = sf_flight_momentum(card, sf_missile_mass(m));
    l->error = (total_energy(l) - l->external - l->weight + gain) / l->reference - 1;

    l->impulse += dt_v * (sf_missile_weight(m) + held);
    double change = sf_missile_momentum(m, &s->missile) + carried - (l->momentum_reference - before);
    l->momentum_error = (change - l->impulse) / l->momentum_reference;
}

/* The pad alone, which starts at rest, against the missile and the constraints. There is no initial value, so
 * that the errors refer to the largest work and impulse so far, and at first to what state.c has set. */
static void balance_driven(const sf_model *m, sf_state *s, double held, double carried, double dt_v) {
    sf_ledger *l = &s->ledger;
    double pressed = dt_v * sf_missile_contact_force(m, &s->missile);
    l->reference = fmax(l->reference, fabs(l->external));
    l->error = (total_energy(l) - l->external - l->weight) / l->reference;

    l->impulse += pressed + dt_v * held;
    l->momentum_reference += fabs(pressed);
    l->momentum_error = (carried - l->impulse) / l->momentum_reference;
}

void sf_wrench_add(sf_wrench *w, const double x[3], const double force[3]) {
    double moment[3];
    sf_cross3(x, force, moment);
    for (int r = 0; r < 3; r++) {
        w->force[r] += force[r];
        w->moment[r] += moment[r];
    }
}

/* |now - (at t = 0 + impulses)| of momentum or angular momentum. */
static double imbalance(double impulse[3], const double outside[3], const double of_missile[3], double dt_v,
                        const double pad[3], const double missile[3]) {
    double rest[3];
    for (int r = 0; r < 3; r++) {
        impulse[r] += dt_v * (outside[r] + of_missile[r]);
        rest[r] = pad[r] + missile[r] - impulse[r];
    }
    return sqrt(sf_dot3(rest, rest));
}

static void balance_in_space(const sf_model *m, sf_state *s, const sf_wrench *outside, double dt_v,
                             const double momentum[3], const double angular[3]) {
    sf_ledger *l = &s->ledger;
    double linear_part[3], angular_part[3], force[3], moment[3];
    sf_missile_momenta(m, &s->missile, linear_part, angular_part);
    sf_missile_outside(m, &s->missile, force, moment);
    double scale = fabs(l->momentum_reference);
    l->vector_error =
        imbalance(l->impulse_linear, outside->force, force, dt_v, momentum, linear_part) / scale;
    l->angular_error = imbalance(l->impulse_angular, outside->moment, moment, dt_v, angular, angular_part) /
                       (scale * m->thickness);
}

void sf_ledger_close(const sf_model *m, sf_state *s, const sf_wrench *outside, double dt_v) {
    sf_ledger *l = &s->ledger;
    double back = s->rubbed_back, momentum[3] = {0}, angular[3] = {0}, fastest = 0;
    s->smallest_jacobian = INFINITY;
    double shortest = INFINITY;
    l->stored = s->membrane.energy;
    l->kinetic_pad = 0;
    l->hysteresis = -l->before;
    for (int64_t k = 0; k < s->chunk_count; k++) {
        const sf_partial *p = &s->partial[k];
        l->stored += p->stored;
        l->hysteresis += p->hysteresis;
        l->viscous += p->viscous;
        l->kinetic_pad += p->kinetic;
        l->stabilisation += p->stabilisation;
        back += p->given_back;
        shortest = fmin(shortest, p->shortest);
        fastest = fmax(fastest, p->fastest);
        if (p->jacobian < s->smallest_jacobian) {
            s->smallest_jacobian = p->jacobian;
            s->jacobian_node = p->jacobian_node;
        }
        for (int c = 0; c < 3; c++) {
            momentum[c] += p->momentum[c];
            angular[c] += p->angular[c];
        }
    }
    s->largest_compression = 1 - shortest;
    s->fastest = sqrt(fastest);
    s->given_back = fmax(s->given_back, back);

    double held = sf_missile_along(m, outside->force), carried = sf_missile_along(m, momentum);
    if (sf_missile_is_driven(m))
        balance_driven(m, s, held, carried, dt_v);
    else
        balance_free(m, s, held, carried, dt_v);
    balance_in_space(m, s, outside, dt_v, momentum, angular);
    l->largest_error = fmax(l->largest_error, fabs(l->error));
}
