/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/flight.h"

#include "base/mat3.h"

static const double LARGEST_TURN =
    2e-3; /* rad, of one step of the rotation: its error is below 1e-6 rad a turn */

void sf_flight_gravity(const sf_missile_card *card, double g[3]) {
    bool given = sf_dot3(card->down, card->down) > 0;
    for (int k = 0; k < 3; k++)
        g[k] = given ? card->gravity * card->down[k] : k == 2 ? -card->gravity : 0;
}

double sf_flight_pull(const sf_missile_card *card) {
    double g[3];
    sf_flight_gravity(card, g);
    return sf_dot3(g, card->direction);
}

double sf_flight_time(const sf_missile_card *card) {
    double square = card->speed * card->speed - 2 * sf_flight_pull(card) * card->gap;
    if (!(card->gap > 0) || !(card->speed > 0)) /* no gap, or a prescribed motion */
        return 0;
    return square >= 0 ? 2 * card->gap / (card->speed + sqrt(square)) : NAN;
}

double sf_flight_start_speed(const sf_missile_card *card) {
    return card->speed - sf_flight_pull(card) * sf_flight_time(card);
}

void sf_flight_start_velocity(const sf_missile_card *card, double velocity[3]) {
    bool free = card->freedom == SF_MISSILE_FREE;
    double speed = free ? card->speed : sf_flight_start_speed(card);
    double g[3];
    sf_flight_gravity(card, g);
    for (int k = 0; k < 3; k++)
        velocity[k] = speed * card->direction[k] - (free ? g[k] * sf_flight_time(card) : 0);
}

void sf_flight_displacement(const sf_missile_card *card, double before, double displacement[3]) {
    bool free = card->freedom == SF_MISSILE_FREE;
    double fallen = 0.5 * before * before,
           along = card->gap - card->speed * before + (free ? 0 : sf_flight_pull(card) * fallen), g[3];
    sf_flight_gravity(card, g);
    for (int k = 0; k < 3; k++)
        displacement[k] = along * card->direction[k] + (free ? g[k] * fallen : 0);
}

void sf_flight_orientation(const sf_missile_card *card, double before, double quaternion[4]) {
    double spin[3], rate = sqrt(sf_dot3(card->angular_velocity, card->angular_velocity));
    long steps = 1 + (long)(rate * before / LARGEST_TURN);
    quaternion[0] = 1;
    quaternion[1] = quaternion[2] = quaternion[3] = 0;
    if (!(rate * before > 0))
        return;
    sf_rigid_product(card->inertia, card->angular_velocity, spin);
    for (long k = 0; k < steps; k++) {
        double turn[3], next[4];
        sf_rigid_turn(card->inertia, quaternion, spin, -before / (double)steps, turn);
        sf_rotation_advance(quaternion, turn, next);
        for (int c = 0; c < 4; c++)
            quaternion[c] = next[c];
    }
}

double sf_flight_energy(const sf_missile_card *card, double mass) {
    double v[3];
    if (!(sf_flight_time(card) > 0))
        return 0;
    sf_flight_start_velocity(card, v);
    return 0.5 * mass * (card->speed * card->speed - sf_dot3(v, v));
}

double sf_flight_momentum(const sf_missile_card *card, double mass) {
    return mass * sf_flight_pull(card) * sf_flight_time(card);
}
