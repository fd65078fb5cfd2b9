/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/missile.h"

#include "core/mat3.h"
#include "core/motion.h"
#include <string.h>

double sf_missile_free_fall(const sf_model *m) {
    return -m->missile.gravity * m->missile.direction[2];
}

static double mobility(const sf_model *m) {
    return sf_missile_is_driven(m) ? 0 : sf_model_whole(m) / m->missile.mass;
}

void sf_missile_begin(const sf_model *m, sf_missile *missile) {
    memset(missile, 0, sizeof *missile);
    missile->velocity = sf_missile_is_driven(m) ? sf_motion_velocity(m, 0) : m->missile.speed;
    missile->velocity_now = missile->velocity;
    missile->contact_time = missile->release_time = NAN;
}

/* ---- pose and velocity ---- */

static void scale(double factor, const double direction[3], double out[3]) {
    for (int r = 0; r < 3; r++)
        out[r] = factor * direction[r];
}

/* x in the frame of the surface: the missile's position at t = 0. */
static void move_back(const sf_model *m, const sf_missile *missile, const double x[3], double out[3]) {
    for (int r = 0; r < 3; r++)
        out[r] = x[r] - missile->displacement * m->missile.direction[r];
}

const double *sf_missile_direction(const sf_model *m) {
    return m->missile.direction;
}

void sf_missile_translation(const sf_model *m, const sf_missile *missile, double out[3]) {
    scale(missile->displacement, m->missile.direction, out);
}

void sf_missile_velocity_at(const sf_model *m, const sf_missile *missile, const double x[3], double out[3]) {
    (void)x; /* it does not turn: the same everywhere */
    scale(missile->velocity_now, m->missile.direction, out);
}

void sf_missile_motion_at(const sf_model *m, const sf_missile *missile, const double x[3], double out[3]) {
    (void)x;
    scale(missile->displacement - missile->displacement_old, m->missile.direction, out);
}

double sf_missile_fastest(const sf_missile *missile) {
    return fabs(missile->velocity);
}

bool sf_missile_near(const sf_model *m, const sf_missile *missile, const sf_missile_surface *surface,
                     const double x[3], double margin) {
    double back[3];
    move_back(m, missile, x, back);
    return sf_missile_surface_near(surface, back, margin);
}

bool sf_missile_gap(const sf_model *m, const sf_missile *missile, const sf_missile_surface *surface,
                    const double x[3], double *gap, double normal[3]) {
    double back[3];
    move_back(m, missile, x, back);
    return sf_missile_surface_gap(surface, back, gap, normal);
}

/* ---- its part in one contact solve ---- */

sf_missile_response sf_missile_predict(const sf_model *m, const sf_missile *missile, double time, double dt,
                                       double dt_old) {
    double dt_v = 0.5 * (dt_old + dt);
    sf_missile_response response = {.direction = m->missile.direction, .mobility = mobility(m)};
    response.travel = sf_missile_is_driven(m) ? sf_motion_displacement(m, time + dt) - missile->displacement
                                              : dt * (missile->velocity + dt_v * sf_missile_free_fall(m));
    return response;
}

void sf_missile_free_motion(const sf_missile_response *response, const double x[3], double out[3]) {
    (void)x;
    scale(response->travel, response->direction, out);
}

bool sf_missile_gap_ahead(const sf_model *m, const sf_missile *missile, const sf_missile_response *response,
                          const sf_missile_surface *surface, const double x[3], const double step[3],
                          double *gap, double normal[3]) {
    double next[3];
    move_back(m, missile, x, next);
    for (int r = 0; r < 3; r++)
        next[r] = next[r] + step[r] - response->travel * response->direction[r];
    return sf_missile_surface_gap(surface, next, gap, normal);
}

void sf_missile_load(sf_missile_response *response, const double x[3], const double force[3]) {
    (void)x; /* it cannot turn: no moment */
    response->load += sf_dot3(force, response->direction);
}

void sf_missile_reload(sf_missile_response *response, const double x[3], const double old[3],
                       const double force[3]) {
    (void)x;
    for (int r = 0; r < 3; r++)
        response->load += (force[r] - old[r]) * response->direction[r];
}

void sf_missile_recoil(const sf_missile_response *response, const double x[3], double out[3]) {
    (void)x;
    scale(response->mobility * response->load, response->direction, out);
}

double sf_missile_mobility(const sf_missile_response *response, const double x[3], const double n[3]) {
    (void)x;
    double lean = sf_dot3(n, response->direction);
    return response->mobility * lean * lean;
}

/* ---- forces and the step ---- */

void sf_missile_clear(sf_missile *missile) {
    memset(missile->force, 0, sizeof missile->force);
    missile->friction = 0;
}

void sf_missile_apply(const sf_model *m, sf_missile *missile, const double x[3], const double n[3],
                      const double force[3]) {
    (void)x;
    double normal = sf_dot3(force, n);
    for (int r = 0; r < 3; r++) {
        missile->force[r] += force[r];
        missile->friction -= (force[r] - normal * n[r]) * m->missile.direction[r];
    }
}

void sf_missile_touch(sf_missile *missile, double time) {
    if (isnan(missile->contact_time))
        missile->contact_time = time;
    missile->release_time = time;
}

void sf_missile_accelerate(const sf_model *m, sf_missile *missile) {
    missile->acceleration =
        sf_missile_is_driven(m)
            ? 0
            : sf_missile_free_fall(m) + mobility(m) * sf_dot3(missile->force, m->missile.direction);
}

void sf_missile_kick(const sf_model *m, sf_missile *missile, double time, double dt, double dt_old) {
    if (sf_missile_is_driven(m)) {
        missile->velocity_now = sf_motion_velocity(m, time);
        missile->velocity = (sf_motion_displacement(m, time + dt) - missile->displacement) / dt;
        return;
    }
    missile->velocity_now = missile->velocity + 0.5 * dt_old * missile->acceleration;
    missile->velocity += 0.5 * (dt_old + dt) * missile->acceleration;
}

void sf_missile_drift(const sf_model *m, sf_missile *missile, double time, double dt) {
    missile->displacement_old = missile->displacement;
    if (sf_missile_is_driven(m))
        missile->displacement = sf_motion_displacement(m, time);
    else
        missile->displacement += dt * missile->velocity;
}

/* ---- figures ---- */

double sf_missile_mass(const sf_model *m) {
    return m->missile.mass / sf_model_whole(m);
}

double sf_missile_weight(const sf_model *m) {
    return sf_missile_mass(m) * sf_missile_free_fall(m);
}

double sf_missile_along(const sf_model *m, const double vector[3]) {
    return sf_dot3(vector, m->missile.direction);
}

double sf_missile_momentum(const sf_model *m, const sf_missile *missile) {
    return sf_missile_mass(m) * missile->velocity;
}

double sf_missile_kinetic(const sf_model *m, const sf_missile *missile, double dt_v) {
    double before = missile->velocity - dt_v * missile->acceleration;
    return 0.5 * sf_missile_mass(m) * before * missile->velocity;
}

double sf_missile_gravity_work(const sf_model *m, const sf_missile *missile) {
    return sf_missile_weight(m) * missile->displacement;
}

double sf_missile_work(const sf_model *m, const sf_missile *missile, const double x[3],
                       const double force[3]) {
    (void)x;
    return sf_missile_along(m, force) * (missile->displacement - missile->displacement_old);
}

double sf_missile_reading(const sf_model *m, const sf_missile *missile) {
    return 0 - mobility(m) * sf_missile_along(m, missile->force); /* not -0 */
}

double sf_missile_contact_force(const sf_model *m, const sf_missile *missile) {
    return -sf_missile_along(m, missile->force);
}

double sf_missile_depth(const sf_model *m, const sf_missile *missile) {
    return sf_missile_card_depth(&m->missile, missile->displacement);
}

bool sf_missile_is_leaving(const sf_model *m, const sf_missile *missile) {
    return !sf_missile_is_driven(m) && missile->velocity < 0;
}
