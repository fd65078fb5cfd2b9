/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The free flight of the missile over `missile.gap`. The case says how it arrives: its speed, its pose and
 * its angular velocity are those of first contact, whatever the gap. The flight is followed backwards from
 * there to t = 0, under gravity and without torque. Without a gap, and with a prescribed motion, nothing is
 * to be done. The model's surface stands in the pose of arrival, `gap` away along the direction. */
#pragma once
#include "model/model.h"

/* Acceleration of the missile by gravity (m s-2), and its part along the direction. */
void sf_flight_gravity(const sf_missile_card *card, double gravity[3]);
double sf_flight_pull(const sf_missile_card *card);

/* Time of flight (s); NaN: a fall over the gap alone makes the missile faster than its speed. */
double sf_flight_time(const sf_missile_card *card);

/* Speed (m s-1) along the direction at t = 0. */
double sf_flight_start_speed(const sf_missile_card *card);

/* Velocity (m s-1) of the centre at t = 0; a guided missile moves along its direction. */
void sf_flight_start_velocity(const sf_missile_card *card, double velocity[3]);

/* The place of the missile `before` (s) its arrival, against the model's surface: the displacement (m) of its
 * centre, and of a free missile the rotation of its axes about it (base/mat3.h). */
void sf_flight_displacement(const sf_missile_card *card, double before, double displacement[3]);
void sf_flight_orientation(const sf_missile_card *card, double before, double quaternion[4]);

/* The energy (J) and the momentum (kg m s-1, along the direction) that gravity adds to a missile of this mass
 * (kg) from t = 0 to its arrival. */
double sf_flight_energy(const sf_missile_card *card, double mass);
double sf_flight_momentum(const sf_missile_card *card, double mass);
