/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/missile.h"

#include "base/mat3.h"
#include "model/flight.h"
#include "model/motion.h"

static double mobility(const sf_model *m) {
    return sf_missile_is_driven(m) ? 0 : sf_model_whole(m) / m->missile.mass;
}

/* Height of the lowest point of a missile that turns, at this place of its centre. */
static double find_lowest(const sf_model *m, const double centre[3], const double quaternion[4]) {
    const sf_missile_card *card = &m->missile;
    double low = INFINITY, x[3], r[3], down[3];
    sf_rotate_back(quaternion, (const double[3]){0, 0, -1}, down);
    if (card->shape == SF_SHAPE_SPHERE && sf_dot3(down, card->direction) >= card->sphere_cap_cosine) {
        sf_sub3(card->sphere_centre, card->centre, r);
        return centre[2] - sf_dot3(down, r) - card->sphere_radius;
    }
    for (int64_t i = 0; i < m->surface_node_count; i++) {
        sf_sub3(&m->surface_position[3 * i], card->centre, x);
        low = fmin(low, centre[2] - sf_dot3(down, x));
    }
    return low;
}

static double find_radius(const sf_model *m) {
    const sf_missile_card *card = &m->missile;
    double square = 0, r[3];
    for (int64_t i = 0; i < m->surface_node_count; i++) {
        sf_sub3(&m->surface_position[3 * i], card->centre, r);
        square = fmax(square, sf_dot3(r, r));
    }
    sf_sub3(card->sphere_centre, card->centre, r);
    return fmax(sqrt(square), card->shape == SF_SHAPE_SPHERE ? sqrt(sf_dot3(r, r)) + card->sphere_radius : 0);
}

static void begin_turning(const sf_model *m, sf_missile *missile) {
    const sf_missile_card *card = &m->missile;
    const double identity[4] = {1, 0, 0, 0}, flight = sf_flight_time(card);
    sf_flight_start_velocity(card, missile->rate);
    memcpy(missile->rate_now, missile->rate, sizeof missile->rate);
    if (flight > 0)
        sf_flight_displacement(card, flight, missile->translation);
    sf_flight_orientation(card, flight, missile->quaternion);
    sf_rigid_product(card->inertia, card->angular_velocity, missile->spin);
    memcpy(missile->spin_now, missile->spin, sizeof missile->spin);
    missile->radius = find_radius(m);
    missile->lowest = find_lowest(m, card->centre, identity);
}

void sf_missile_begin(const sf_model *m, sf_missile *missile) {
    memset(missile, 0, sizeof *missile);
    missile->velocity =
        sf_missile_is_driven(m) ? sf_motion_velocity(m, 0) : sf_flight_start_speed(&m->missile);
    missile->velocity_now = missile->velocity;
    missile->contact_time = missile->release_time = missile->rim_time = NAN;
    missile->quaternion[0] = 1;
    if (sf_missile_turns(m))
        begin_turning(m, missile);
}

/* ---- pose and velocity ---- */

static void scale(double factor, const double direction[3], double out[3]) {
    for (int r = 0; r < 3; r++)
        out[r] = factor * direction[r];
}

/* The centre of mass now; without turning only its translation matters. */
static void find_centre(const sf_model *m, const sf_missile *missile, double out[3]) {
    sf_missile_translation(m, missile, out);
    for (int r = 0; r < 3; r++)
        out[r] += m->missile.centre[r];
}

/* x in the frame of the surface, the missile's pose at t = 0, if its centre is at `centre`. */
static void turn_back(const sf_model *m, const double centre[3], const double quaternion[4],
                      const double x[3], double out[3]) {
    double r[3];
    sf_sub3(x, centre, r);
    sf_rotate_back(quaternion, r, out);
    for (int k = 0; k < 3; k++)
        out[k] += m->missile.centre[k];
}

static void move_back(const sf_model *m, const sf_missile *missile, const double x[3], double out[3]) {
    double centre[3];
    if (sf_missile_turns(m)) {
        find_centre(m, missile, centre);
        turn_back(m, centre, missile->quaternion, x, out);
        return;
    }
    for (int r = 0; r < 3; r++)
        out[r] = x[r] - missile->displacement * m->missile.direction[r];
}

const double *sf_missile_direction(const sf_model *m) {
    return m->missile.direction;
}

void sf_missile_translation(const sf_model *m, const sf_missile *missile, double out[3]) {
    if (sf_missile_turns(m))
        memcpy(out, missile->translation, sizeof missile->translation);
    else
        scale(missile->displacement, m->missile.direction, out);
}

void sf_missile_orient(const sf_model *m, const sf_missile *missile, const double rest[3], double out[3]) {
    if (sf_missile_turns(m))
        sf_rotate(missile->quaternion, rest, out);
    else
        memcpy(out, rest, 3 * sizeof *out);
}

void sf_missile_place(const sf_model *m, const sf_missile *missile, const double rest[3], double out[3]) {
    double arm[3], centre[3];
    sf_sub3(rest, m->missile.centre, arm);
    sf_missile_orient(m, missile, arm, out);
    find_centre(m, missile, centre);
    for (int r = 0; r < 3; r++)
        out[r] += centre[r];
}

/* x from the centre. */
static void find_arm(const sf_model *m, const sf_missile *missile, const double x[3], double arm[3]) {
    find_centre(m, missile, arm);
    sf_sub3(x, arm, arm);
}

void sf_missile_motion_at(const sf_model *m, const sf_missile *missile, const double x[3], double out[3]) {
    static const double upright[4] = {1, 0, 0, 0};
    double arm[3], before[3], turn[4], across[3];
    if (!sf_missile_turns(m)) {
        scale(missile->displacement - missile->displacement_old, m->missile.direction, out);
        return;
    }
    find_arm(m, missile, x, arm);
    sf_rotation_advance(upright, missile->turn, turn);
    sf_rotate_back(turn, arm, before);
    for (int r = 0; r < 3; r++)
        before[r] = 0.5 * (before[r] + arm[r]);
    sf_cross3(missile->turn, before, across);
    for (int r = 0; r < 3; r++)
        out[r] = missile->translation[r] - missile->translation_old[r] + across[r];
}

double sf_missile_fastest(const sf_model *m, const sf_missile *missile) {
    double mobility_of[6], square = 0;
    if (!sf_missile_turns(m))
        return fabs(missile->velocity);
    sf_rigid_mobility(m->missile.inertia, missile->quaternion, mobility_of);
    for (int k = 0; k < 6; k++)
        square += (k < 3 ? 1 : 2) * mobility_of[k] * mobility_of[k];
    return sqrt(sf_dot3(missile->rate, missile->rate)) +
           missile->radius * sqrt(square * sf_dot3(missile->spin, missile->spin));
}

bool sf_missile_near(const sf_model *m, const sf_missile *missile, const sf_body *body, const double x[3],
                     double margin) {
    double back[3];
    move_back(m, missile, x, back);
    return sf_body_is_near(body, back, margin);
}

static bool gap_of(const sf_body *body, const double back[3], const double quaternion[4], double *gap,
                   double normal[3]) {
    double turned[3];
    if (!sf_body_gap(body, back, gap, turned))
        return false;
    sf_rotate(quaternion, turned, normal);
    return true;
}

bool sf_missile_gap(const sf_model *m, const sf_missile *missile, const sf_body *body, const double x[3],
                    double *gap, double normal[3]) {
    double back[3];
    move_back(m, missile, x, back);
    if (sf_missile_turns(m))
        return gap_of(body, back, missile->quaternion, gap, normal);
    return sf_body_gap(body, back, gap, normal);
}

/* ---- its part in one contact solve ---- */

static void predict_turning(const sf_model *m, const sf_missile *missile, double dt, double dt_v,
                            sf_missile_response *response) {
    const sf_missile_card *card = &m->missile;
    double gravity[3];
    sf_flight_gravity(card, gravity);
    response->turns = true;
    find_centre(m, missile, response->centre);
    for (int r = 0; r < 3; r++)
        response->step[r] = dt * (missile->rate[r] + dt_v * gravity[r]);
    sf_rigid_turn(card->inertia, missile->quaternion, missile->spin, dt, response->turn);
    sf_rigid_mobility(card->inertia, missile->quaternion, response->angular);
}

sf_missile_response sf_missile_predict(const sf_model *m, const sf_missile *missile, double time, double dt,
                                       double dt_old) {
    double dt_v = 0.5 * (dt_old + dt);
    sf_missile_response response = {
        .missile = missile, .direction = m->missile.direction, .mobility = mobility(m)};
    response.travel = sf_missile_is_driven(m) ? sf_motion_displacement(m, time + dt) - missile->displacement
                                              : dt * (missile->velocity + dt_v * sf_flight_pull(&m->missile));
    if (sf_missile_turns(m))
        predict_turning(m, missile, dt, dt_v, &response);
    return response;
}

void sf_missile_free_motion(const sf_missile_response *response, const double x[3], double out[3]) {
    static const double upright[4] = {1, 0, 0, 0};
    double arm[3], after[3], turn[4];
    if (!response->turns) {
        scale(response->travel, response->direction, out);
        return;
    }
    sf_sub3(x, response->centre, arm);
    sf_rotation_advance(upright, response->turn, turn);
    sf_rotate(turn, arm, after);
    for (int r = 0; r < 3; r++)
        after[r] = 0.5 * (after[r] + arm[r]);
    sf_cross3(response->turn, after, out);
    for (int r = 0; r < 3; r++)
        out[r] += response->step[r];
}

bool sf_missile_gap_ahead(const sf_model *m, const sf_missile_response *response, const sf_body *body,
                          const double x[3], const double step[3], double *gap, double normal[3]) {
    const sf_missile *missile = response->missile;
    double next[3], back[3], centre[3], quaternion[4];
    if (response->turns) {
        sf_rotation_advance(missile->quaternion, response->turn, quaternion);
        for (int r = 0; r < 3; r++) {
            next[r] = x[r] + step[r];
            centre[r] = response->centre[r] + response->step[r];
        }
        turn_back(m, centre, quaternion, next, back);
        return gap_of(body, back, quaternion, gap, normal);
    }
    move_back(m, missile, x, next);
    for (int r = 0; r < 3; r++)
        next[r] = next[r] + step[r] - response->travel * response->direction[r];
    return sf_body_gap(body, next, gap, normal);
}

static void load_turning(sf_missile_response *response, const double x[3], const double force[3]) {
    double arm[3], moment[3];
    sf_sub3(x, response->centre, arm);
    sf_cross3(arm, force, moment);
    for (int r = 0; r < 3; r++) {
        response->force[r] += force[r];
        response->moment[r] += moment[r];
    }
}

void sf_missile_load(sf_missile_response *response, const double x[3], const double force[3]) {
    response->load += sf_dot3(force, response->direction);
    if (response->turns)
        load_turning(response, x, force);
}

void sf_missile_recoil(const sf_missile_response *response, const double x[3], double out[3]) {
    double arm[3], angular[3];
    if (!response->turns) {
        scale(response->mobility * response->load, response->direction, out);
        return;
    }
    sf_sub3(x, response->centre, arm);
    sf_rigid_product(response->angular, response->moment, angular);
    sf_cross3(angular, arm, out);
    for (int r = 0; r < 3; r++)
        out[r] += response->mobility * response->force[r];
}

double sf_missile_mobility(const sf_missile_response *response, const double x[3], const double n[3]) {
    double arm[3], lever[3], angular[3];
    if (!response->turns) {
        double lean = sf_dot3(n, response->direction);
        return response->mobility * lean * lean;
    }
    sf_sub3(x, response->centre, arm);
    sf_cross3(arm, n, lever);
    sf_rigid_product(response->angular, lever, angular);
    return response->mobility + sf_dot3(lever, angular);
}

double sf_missile_looseness(const sf_missile_response *response, const double x[3]) {
    double arm[3];
    if (!response->turns)
        return 0;
    sf_sub3(x, response->centre, arm);
    return response->mobility + sf_dot3(arm, arm) * sf_sym3_largest(response->angular);
}

/* ---- forces and the step ---- */

void sf_missile_clear(sf_missile *missile) {
    memset(missile->force, 0, sizeof missile->force);
    memset(missile->torque, 0, sizeof missile->torque);
    missile->friction = 0;
}

void sf_missile_apply(const sf_model *m, sf_missile *missile, const double x[3], const double n[3],
                      const double force[3]) {
    double normal = sf_dot3(force, n), arm[3], moment[3];
    find_arm(m, missile, x, arm);
    sf_cross3(arm, force, moment);
    for (int r = 0; r < 3; r++) {
        missile->force[r] += force[r];
        missile->torque[r] += moment[r];
        missile->friction -= (force[r] - normal * n[r]) * m->missile.direction[r];
    }
}

/* True if the missile has turned so far that the rim of its spherical cap is lower than the cap. */
static bool rim_leads(const sf_model *m, const sf_missile *missile) {
    double down[3];
    if (!sf_missile_turns(m) || m->missile.shape != SF_SHAPE_SPHERE)
        return false;
    sf_rotate_back(missile->quaternion, (const double[3]){0, 0, -1}, down);
    return sf_dot3(down, m->missile.direction) < m->missile.sphere_cap_cosine;
}

void sf_missile_touch(const sf_model *m, sf_missile *missile, double time) {
    if (isnan(missile->rim_time) && rim_leads(m, missile))
        missile->rim_time = time;
    if (isnan(missile->contact_time))
        missile->contact_time = time;
    missile->release_time = time;
}

void sf_missile_accelerate(const sf_model *m, sf_missile *missile) {
    missile->acceleration =
        sf_missile_is_driven(m)
            ? 0
            : sf_flight_pull(&m->missile) + mobility(m) * sf_dot3(missile->force, m->missile.direction);
    double gravity[3];
    sf_flight_gravity(&m->missile, gravity);
    for (int r = 0; r < 3 && sf_missile_turns(m); r++)
        missile->pull[r] = mobility(m) * missile->force[r] + gravity[r];
}

static void kick_turning(const sf_model *m, sf_missile *missile, double dt, double dt_old) {
    for (int r = 0; r < 3; r++) {
        missile->rate_now[r] = missile->rate[r] + 0.5 * dt_old * missile->pull[r];
        missile->rate[r] += 0.5 * (dt_old + dt) * missile->pull[r];
        missile->spin_now[r] = missile->spin[r] + 0.5 * dt_old * missile->torque[r];
        missile->spin[r] += 0.5 * (dt_old + dt) * missile->torque[r];
    }
    missile->velocity_now = sf_missile_along(m, missile->rate_now);
    missile->velocity = sf_missile_along(m, missile->rate);
}

void sf_missile_kick(const sf_model *m, sf_missile *missile, double time, double dt, double dt_old) {
    if (sf_missile_is_driven(m)) {
        missile->velocity_now = sf_motion_velocity(m, time);
        missile->velocity = (sf_motion_displacement(m, time + dt) - missile->displacement) / dt;
    } else if (sf_missile_turns(m)) {
        kick_turning(m, missile, dt, dt_old);
    } else {
        missile->velocity_now = missile->velocity + 0.5 * dt_old * missile->acceleration;
        missile->velocity += 0.5 * (dt_old + dt) * missile->acceleration;
    }
}

static void drift_turning(const sf_model *m, sf_missile *missile, double dt) {
    double next[4];
    memcpy(missile->translation_old, missile->translation, sizeof missile->translation);
    for (int r = 0; r < 3; r++)
        missile->translation[r] += dt * missile->rate[r];
    sf_rigid_turn(m->missile.inertia, missile->quaternion, missile->spin, dt, missile->turn);
    sf_rotation_advance(missile->quaternion, missile->turn, next);
    memcpy(missile->quaternion, next, sizeof next);
    missile->displacement = sf_missile_along(m, missile->translation);
}

void sf_missile_drift(const sf_model *m, sf_missile *missile, double time, double dt) {
    missile->displacement_old = missile->displacement;
    if (sf_missile_is_driven(m))
        missile->displacement = sf_motion_displacement(m, time);
    else if (sf_missile_turns(m))
        drift_turning(m, missile, dt);
    else
        missile->displacement += dt * missile->velocity;
}

/* ---- figures ---- */

double sf_missile_mass(const sf_model *m) {
    return m->missile.mass / sf_model_whole(m);
}

double sf_missile_weight(const sf_model *m) {
    return sf_missile_mass(m) * sf_flight_pull(&m->missile);
}

double sf_missile_along(const sf_model *m, const double vector[3]) {
    return sf_dot3(vector, m->missile.direction);
}

double sf_missile_momentum(const sf_model *m, const sf_missile *missile) {
    return sf_missile_mass(m) * missile->velocity;
}

/* 1/2 (m v . v' + L . J L'), with the values before and after the present time. */
static double kinetic_turning(const sf_model *m, const sf_missile *missile, double dt_v) {
    double before[3], spin[3], omega[3];
    for (int r = 0; r < 3; r++) {
        before[r] = missile->rate[r] - dt_v * missile->pull[r];
        spin[r] = missile->spin[r] - dt_v * missile->torque[r];
    }
    sf_rigid_angular_velocity(m->missile.inertia, missile->quaternion, missile->spin, omega);
    return 0.5 * (sf_missile_mass(m) * sf_dot3(before, missile->rate) + sf_dot3(spin, omega));
}

double sf_missile_kinetic(const sf_model *m, const sf_missile *missile, double dt_v) {
    if (sf_missile_turns(m))
        return kinetic_turning(m, missile, dt_v);
    double before = missile->velocity - dt_v * missile->acceleration;
    return 0.5 * sf_missile_mass(m) * before * missile->velocity;
}

void sf_missile_momenta(const sf_model *m, const sf_missile *missile, double linear[3], double angular[3]) {
    double centre[3], orbital[3];
    memset(linear, 0, 3 * sizeof *linear);
    memset(angular, 0, 3 * sizeof *angular);
    if (!sf_missile_turns(m))
        return;
    scale(sf_missile_mass(m), missile->rate, linear);
    find_centre(m, missile, centre);
    sf_cross3(centre, linear, orbital);
    for (int r = 0; r < 3; r++)
        angular[r] = orbital[r] + missile->spin[r];
}

void sf_missile_outside(const sf_model *m, const sf_missile *missile, double force[3], double moment[3]) {
    double centre[3];
    bool turns = sf_missile_turns(m);
    double gravity[3];
    sf_flight_gravity(&m->missile, gravity);
    for (int r = 0; r < 3; r++)
        force[r] = turns ? sf_missile_mass(m) * gravity[r] : -missile->force[r];
    find_centre(m, missile, centre);
    sf_cross3(centre, force, moment);
    for (int r = 0; r < 3 && !turns; r++)
        moment[r] -= missile->torque[r];
}

double sf_missile_gravity_work(const sf_model *m, const sf_missile *missile) {
    double start[3] = {0}, flight = sf_flight_time(&m->missile);
    if (flight > 0)
        sf_flight_displacement(&m->missile, flight, start);
    double gravity[3], moved[3];
    sf_flight_gravity(&m->missile, gravity);
    sf_sub3(missile->translation, start, moved);
    if (sf_missile_turns(m))
        return sf_missile_mass(m) * sf_dot3(gravity, moved) + 0; /* not -0 */
    return sf_missile_weight(m) * missile->displacement;
}

double sf_missile_reading(const sf_model *m, const sf_missile *missile) {
    return 0 - mobility(m) * sf_missile_along(m, missile->force); /* not -0 */
}

double sf_missile_contact_force(const sf_model *m, const sf_missile *missile) {
    return -sf_missile_along(m, missile->force);
}

double sf_missile_depth(const sf_model *m, const sf_missile *missile) {
    double centre[3];
    find_centre(m, missile, centre);
    if (sf_missile_turns(m))
        return missile->lowest - find_lowest(m, centre, missile->quaternion) - m->missile.clearance;
    return sf_missile_card_depth(&m->missile, missile->displacement);
}

static bool turns_away(const sf_model *m, const sf_missile *missile) {
    double centre[3], omega[3], top = missile->lowest - m->missile.clearance;
    find_centre(m, missile, centre);
    sf_rigid_angular_velocity(m->missile.inertia, missile->quaternion, missile->spin, omega);
    bool rises = missile->rate[2] >= missile->radius * sqrt(sf_dot3(omega, omega));
    return missile->rate[2] > 0 && (rises || centre[2] - missile->radius > top);
}

bool sf_missile_is_leaving(const sf_model *m, const sf_missile *missile) {
    if (sf_missile_turns(m))
        return turns_away(m, missile);
    return !sf_missile_is_driven(m) && missile->velocity < 0;
}

/* J (torque - omega x L) */
static void look_at_rotation(const sf_model *m, const sf_missile *missile, sf_missile_view *view) {
    const double *inertia = m->missile.inertia;
    double gyroscopic[3], net[3];
    sf_rigid_angular_velocity(inertia, missile->quaternion, missile->spin_now, view->angular_velocity);
    sf_cross3(view->angular_velocity, missile->spin_now, gyroscopic);
    sf_sub3(missile->torque, gyroscopic, net);
    sf_rigid_angular_velocity(inertia, missile->quaternion, net, view->angular_acceleration);
}

sf_missile_view sf_missile_read(const sf_model *m, const sf_missile *missile) {
    sf_missile_view view = {.translation = {0}};
    bool turns = sf_missile_turns(m);
    double reading = sf_missile_reading(m, missile);
    sf_missile_translation(m, missile, view.translation);
    memcpy(view.quaternion, missile->quaternion, sizeof view.quaternion);
    for (int r = 0; r < 3; r++) {
        double e = m->missile.direction[r];
        view.velocity[r] = turns ? missile->rate_now[r] : missile->velocity_now * e;
        view.specific_force[r] = 0 + (turns ? mobility(m) * missile->force[r] : -reading * e); /* not -0 */
    }
    if (turns)
        look_at_rotation(m, missile, &view);
    return view;
}
