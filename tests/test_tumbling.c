/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile with six degrees of freedom, alone: tumbling without torque, response to forces, inertia. */
#include "extreme.h"

#include "base/mat3.h"
#include "solver/contact/shapes.h"
#include "solver/missile.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double PI = 3.14159265358979323846;
static const double SOMEWHERE[3] = {0.03, -0.02, 0.07}, UP[3] = {0, 0, 1};

/* Mass 4.6 kg at 4.5 m/s, its centre off the origin. */
static sf_model body(const double inertia[6], const double angular_velocity[3]) {
    sf_model m = {.symmetry_factor = 1,
                  .thickness = 0.05,
                  .missile = {.mass = 4.6,
                              .speed = 4.5,
                              .direction = {0.6, 0, -0.8},
                              .gravity = 9.81,
                              .freedom = SF_MISSILE_FREE,
                              .centre = {0.01, 0.02, 0.1}}};
    memcpy(m.missile.inertia, inertia, sizeof m.missile.inertia);
    memcpy(m.missile.angular_velocity, angular_velocity, sizeof m.missile.angular_velocity);
    return m;
}

/* One step under a constant force of the pad at SOMEWHERE. */
static void take_step(const sf_model *m, sf_missile *missile, int64_t step, double dt,
                      const double force[3]) {
    double time = dt * (double)step, dt_old = step > 0 ? dt : 0;
    sf_missile_clear(missile);
    if (force)
        sf_missile_apply(m, missile, SOMEWHERE, UP, force);
    sf_missile_accelerate(m, missile);
    sf_missile_kick(m, missile, time, dt, dt_old);
    sf_missile_drift(m, missile, time + dt, dt);
}

static double rotational_energy(const sf_model *m, const sf_missile *missile) {
    double omega[3];
    sf_rigid_angular_velocity(m->missile.inertia, missile->quaternion, missile->spin, omega);
    return 0.5 * sf_dot3(omega, missile->spin);
}

/* Near the unstable axis, so that it turns over again and again: 1000 turns of 200 steps. */
static void tumbling_keeps_energy_and_angular_momentum(void **state) {
    (void)state;
    const double inertia[6] = {0.02, 0.035, 0.045, 0.002, -0.001, 0.003}, spin[3] = {0.3, 30, 0.2};
    const sf_model m = body(inertia, spin);
    const double dt = 2 * PI / 30 / 200;
    sf_missile missile;
    sf_missile_begin(&m, &missile);
    const double energy = rotational_energy(&m, &missile);
    double before[3], worst = 0, body_axis[3], most_turned = 1;
    memcpy(before, missile.spin, sizeof before);
    for (int64_t step = 0; step < 1000 * 200; step++) {
        take_step(&m, &missile, step, dt, NULL);
        worst = larger(worst, fabs(rotational_energy(&m, &missile) / energy - 1));
        sf_rotate_back(missile.quaternion, before, body_axis);
        most_turned = smaller(most_turned, body_axis[1] / sqrt(sf_dot3(before, before)));
    }
    assert_true(worst < 1e-10);
    assert_true(memcmp(before, missile.spin, sizeof before) == 0); /* nothing but torque changes it */
    assert_true(most_turned < -0.9);                               /* it did turn over */
    double norm = 0;
    for (int k = 0; k < 4; k++)
        norm += missile.quaternion[k] * missile.quaternion[k];
    assert_close(norm, 1, 1e-14);
}

/* The axis of an axisymmetric body (moments 0.02, 0.02, 0.03 about z) goes round L at |L| / 0.02; the body
 * turns about it at omega_z (1 - 0.03 / 0.02) less than that. Returns the largest distance of two of its
 * points from the closed form. */
static double axisymmetric_error(double turns, int steps) {
    const double inertia[6] = {0.02, 0.02, 0.03, 0, 0, 0}, omega[3] = {12, 0, 25};
    const sf_model m = body(inertia, omega);
    const double momentum[3] = {0.02 * 12, 0, 0.03 * 25}, size = sqrt(sf_dot3(momentum, momentum));
    const double precession = size / 0.02, spin = 25 * (1 - 1.5), dt = turns * 2 * PI / precession / steps;
    double worst = 0;
    sf_missile missile;
    sf_missile_begin(&m, &missile);
    for (int64_t step = 0; step < steps; step++)
        take_step(&m, &missile, step, dt, NULL);
    double about_axis = 0.5 * spin * dt * steps, about_momentum = 0.5 * precession * dt * steps;
    for (int p = 0; p < 2; p++) {
        const double point[3] = {p == 0, p == 1, 0.3};
        const double first[4] = {cos(about_axis), 0, 0, sin(about_axis)};
        double second[4] = {cos(about_momentum)}, x[3], exact[3], found[3];
        for (int k = 0; k < 3; k++)
            second[k + 1] = sin(about_momentum) * momentum[k] / size;
        sf_rotate(first, point, x);
        sf_rotate(second, x, exact);
        sf_rotate(missile.quaternion, point, found);
        for (int k = 0; k < 3; k++)
            worst = larger(worst, fabs(found[k] - exact[k]));
    }
    return worst;
}

static void an_axisymmetric_body_precesses_by_the_closed_form(void **state) {
    (void)state;
    double coarse = axisymmetric_error(1, 200), fine = axisymmetric_error(1, 400);
    assert_true(fine < 1e-3);
    assert_close(coarse / fine, 4, 0.02); /* second order */
    assert_true(axisymmetric_error(1, 40000) < 1e-7);
}

/* Forces at a point change momentum and angular momentum by their impulse, and the energy by their work on
 * the material point. */
static void forces_change_momentum_angular_momentum_and_energy(void **state) {
    (void)state;
    const double inertia[6] = {0.02, 0.035, 0.045, 0.002, -0.001, 0.003}, spin[3] = {3, -5, 10};
    const double dt = 1e-6, force[3] = {-120, 35, 900};
    sf_model m = body(inertia, spin);
    sf_missile missile;
    double start[2][3], end[2][3], impulse[3] = {0}, moment[3] = {0}, work = 0, across[3], before = 0;
    sf_missile_begin(&m, &missile);
    sf_missile_momenta(&m, &missile, start[0], start[1]);
    for (int64_t step = 0; step < 20000; step++) {
        double share = step > 0 ? dt : 0.5 * dt, weight[3], of_weight[3], moved[3];
        sf_missile_outside(&m, &missile, weight, of_weight);
        sf_cross3(SOMEWHERE, force, across);
        for (int k = 0; k < 3; k++) {
            impulse[k] += share * (force[k] + weight[k]);
            moment[k] += share * (across[k] + of_weight[k]);
        }
        sf_missile_clear(&missile);
        sf_missile_apply(&m, &missile, SOMEWHERE, UP, force);
        sf_missile_accelerate(&m, &missile);
        sf_missile_kick(&m, &missile, dt * (double)step, dt, step > 0 ? dt : 0);
        double kinetic = sf_missile_kinetic(&m, &missile, share);
        if (step > 1) /* the first step has half a kick */
            assert_close(kinetic - before, work, 1e-5 * dt * 900 * 4.5);
        before = kinetic;
        sf_missile_momenta(&m, &missile, end[0], end[1]);
        for (int k = 0; k < 3; k++) {
            assert_close(end[0][k] - start[0][k], impulse[k], 1e-11);
            assert_close(end[1][k] - start[1][k], moment[k], 1e-11);
        }
        double gravity = sf_missile_gravity_work(&m, &missile);
        sf_missile_drift(&m, &missile, dt * (double)(step + 1), dt);
        sf_missile_motion_at(&m, &missile, SOMEWHERE, moved);
        work = sf_dot3(force, moved) + sf_missile_gravity_work(&m, &missile) - gravity;
    }
}

/* The response to trial forces is what the step then does with the same forces. */
static void the_response_foretells_the_step(void **state) {
    (void)state;
    const double dt = 1e-5, first[3] = {3, 1, -400}, wrong[3] = {0, 0, -9}, second[3] = {-20, 5, -150},
                 inertia[6] = {0.02, 0.035, 0.045, 0.002, -0.001, 0.003}, spin[3] = {3, -5, 10};
    const sf_model m = body(inertia, spin);
    double away[3], recoil[3], moved[3], gained[3], back[3], change[3];
    sf_missile missile;
    sf_missile_begin(&m, &missile);
    sf_missile_response response = sf_missile_predict(&m, &missile, 0, dt, 0);
    sf_missile_load(&response, SOMEWHERE, first);
    sf_missile_load(&response, UP, wrong);
    for (int r = 0; r < 3; r++)
        change[r] = second[r] - wrong[r];
    sf_missile_load(&response, UP, change);
    sf_missile_free_motion(&response, SOMEWHERE, away);
    sf_missile_recoil(&response, SOMEWHERE, recoil);
    sf_missile_clear(&missile);
    for (int k = 0; k < 3; k++)
        gained[k] = -first[k];
    sf_missile_apply(&m, &missile, SOMEWHERE, UP, gained);
    for (int k = 0; k < 3; k++)
        gained[k] = -second[k];
    sf_missile_apply(&m, &missile, UP, UP, gained);
    sf_missile_accelerate(&m, &missile);
    sf_missile_kick(&m, &missile, 0, dt, 0);
    sf_missile_drift(&m, &missile, dt, dt);
    /* the material point that was at SOMEWHERE is now moved away by `moved` of the last step at its place */
    double arrived[3];
    for (int k = 0; k < 3; k++)
        arrived[k] = SOMEWHERE[k] + away[k] - 0.5 * dt * dt * recoil[k];
    sf_missile_motion_at(&m, &missile, arrived, moved);
    for (int k = 0; k < 3; k++)
        assert_close(arrived[k] - moved[k], SOMEWHERE[k], 1e-3 * 0.5 * dt * dt * 200);

    /* mobility is the recoil of a unit force, along any direction, and looseness bounds it */
    for (int axis = 0; axis < 3; axis++) {
        sf_missile_response unit = sf_missile_predict(&m, &missile, dt, dt, dt);
        double n[3] = {axis == 0, axis == 1, axis == 2};
        sf_missile_load(&unit, SOMEWHERE, n);
        sf_missile_recoil(&unit, SOMEWHERE, recoil);
        assert_close(sf_missile_mobility(&unit, SOMEWHERE, n), sf_dot3(recoil, n), 1e-12);
        assert_true(sf_dot3(recoil, n) > 1 / 4.6);
        assert_true(sf_missile_looseness(&unit, SOMEWHERE) >= sf_dot3(recoil, n));
        for (int k = 0; k < 3; k++)
            change[k] = -n[k];
        sf_missile_load(&unit, SOMEWHERE, change);
        sf_missile_recoil(&unit, SOMEWHERE, back);
        assert_close(sf_dot3(back, back), 0, 1e-24);
    }
}

/* A sphere off the centre of mass goes round it. */
static void the_surface_turns_with_the_body(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    const double inertia[6] = {0.02, 0.02, 0.02, 0, 0, 0}, spin[3] = {0, 50, 0}, dt = 1e-5;
    sf_model m = body(inertia, spin);
    m.missile.gravity = 0;
    m.missile.shape = SF_SHAPE_SPHERE;
    m.missile.sphere_radius = 0.08;
    m.missile.sphere_cap_cosine = -1;
    m.missile.sphere_centre[0] = m.missile.centre[0] + 0.03;
    m.missile.sphere_centre[1] = m.missile.centre[1];
    m.missile.sphere_centre[2] = m.missile.centre[2];
    sf_body surface;
    assert_int_equal(sf_body_build(&m, SF_BODY_MISSILE, &surface, &err), SF_OK);
    sf_missile missile;
    sf_missile_begin(&m, &missile);
    assert_close(missile.radius, 0.11, 1e-15);
    double lead = missile.lowest;
    assert_close(lead, 0.02, 1e-15);
    for (int64_t step = 0; step < 2000; step++) {
        double time = dt * (double)step, angle = 50 * time, gap, normal[3], moved[3];
        const double centre[3] = {m.missile.sphere_centre[0] - 0.03 + 0.03 * cos(angle) + 4.5 * 0.6 * time,
                                  m.missile.centre[1],
                                  m.missile.centre[2] - 0.03 * sin(angle) - 4.5 * 0.8 * time};
        const double x[3] = {centre[0], centre[1] + 0.01, centre[2] - 0.09};
        assert_true(sf_missile_gap(&m, &missile, &surface, x, &gap, normal));
        assert_close(gap, sqrt(0.09 * 0.09 + 1e-4) - 0.08, 1e-7); /* the turn's second-order error */
        assert_close(normal[2], -0.09 / sqrt(0.09 * 0.09 + 1e-4), 1e-6);
        assert_close(sf_missile_depth(&m, &missile), lead - (centre[2] - 0.08), 1e-7);
        assert_true(sf_missile_near(&m, &missile, &surface, x, 1.001 * gap));
        sf_missile_response response = sf_missile_predict(&m, &missile, time, dt, step > 0 ? dt : 0);
        const double step_of[3] = {1e-5, 0, 2e-5};
        double ahead[3], foreseen, found, turned[3];
        assert_true(sf_missile_gap_ahead(&m, &response, &surface, x, step_of, &foreseen, normal));
        for (int k = 0; k < 3; k++)
            ahead[k] = x[k] + step_of[k];
        take_step(&m, &missile, step, dt, NULL);
        assert_true(sf_missile_gap(&m, &missile, &surface, ahead, &found, turned));
        assert_close(found, foreseen, 1e-15);
        assert_close(sf_dot3(turned, normal), 1, 1e-14);
        sf_missile_motion_at(&m, &missile, x, moved);
        assert_true(sqrt(sf_dot3(moved, moved)) <= dt * sf_missile_fastest(&m, &missile));
    }
    sf_body_free(&surface);
}

/* What instruments see: Euler's equations, and the centre alone for the specific force. */
static void instruments_read_the_centre_and_the_rotation(void **state) {
    (void)state;
    const double inertia[6] = {0.02, 0.035, 0.045, 0, 0, 0}, spin[3] = {3, -5, 10},
                 force[3] = {-120, 35, 900};
    const double dt = 1e-7;
    const sf_model m = body(inertia, spin);
    sf_missile missile;
    sf_missile_begin(&m, &missile);
    take_step(&m, &missile, 0, dt, force);
    sf_missile_view first = sf_missile_read(&m, &missile);
    double arm[3], torque[3];
    for (int k = 0; k < 3; k++) {
        assert_close(first.specific_force[k], force[k] / 4.6, 1e-12);
        arm[k] = SOMEWHERE[k] - m.missile.centre[k];
    }
    sf_cross3(arm, force, torque);
    const double moment[3] = {inertia[0], inertia[1], inertia[2]};
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        double exact = (torque[k] + (moment[a] - moment[b]) * spin[a] * spin[b]) / moment[k];
        assert_close(first.angular_acceleration[k], exact, 1e-4 * fabs(exact));
    }
}

static void an_impossible_inertia_is_told(void **state) {
    (void)state;
    double principal[3];
    const double good[6] = {0.02, 0.035, 0.045, 0.002, -0.001, 0.003}, plate[6] = {1, 1, 2, 0, 0, 0},
                 uneven[6] = {1, 1, 2.01, 0, 0, 0}, negative[6] = {1, 1, -0.1, 0, 0, 0},
                 skew[6] = {1, 1, 1, 1.2, 0, 0}, rod[6] = {0, 1, 1, 0, 0, 0};
    assert_true(sf_missile_inertia_is_possible(good, principal));
    assert_true(principal[0] <= principal[1] && principal[1] <= principal[2]);
    assert_close(principal[0] + principal[1] + principal[2], 0.1, 1e-15);
    assert_true(sf_missile_inertia_is_possible(plate, principal));
    assert_false(sf_missile_inertia_is_possible(uneven, principal));
    assert_false(sf_missile_inertia_is_possible(negative, principal));
    assert_false(sf_missile_inertia_is_possible(skew, principal));
    assert_false(sf_missile_inertia_is_possible(rod, principal));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tumbling_keeps_energy_and_angular_momentum),
        cmocka_unit_test(an_axisymmetric_body_precesses_by_the_closed_form),
        cmocka_unit_test(forces_change_momentum_angular_momentum_and_energy),
        cmocka_unit_test(the_response_foretells_the_step),
        cmocka_unit_test(the_surface_turns_with_the_body),
        cmocka_unit_test(instruments_read_the_centre_and_the_rotation),
        cmocka_unit_test(an_impossible_inertia_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
