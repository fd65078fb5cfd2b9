/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile alone, with forces applied by hand: free fall, momentum, prescribed motion, symmetry. */
#include "solver/contact/shapes.h"
#include "solver/missile.h"

#include "base/mat3.h"
#include "model/motion.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double DT = 1e-5, SOMEWHERE[3] = {0.03, -0.02, 0.07}, UP[3] = {0, 0, 1};

static sf_model free_missile(double slant) {
    return (sf_model){.symmetry_factor = 1,
                      .missile = {.mass = 4.6,
                                  .speed = 4.5,
                                  .direction = {sin(slant), 0, -cos(slant)},
                                  .gravity = 9.81,
                                  .gap = 1e-3,
                                  .clearance = cos(slant) * 1e-3 - 2e-3}};
}

/* Down at 0.5 m/s, and half as fast up again. */
static double motion_time[] = {0, 2e-3, 6e-3}, motion_displacement[] = {0, 1e-3, 0};

static sf_model driven_missile(void) {
    return (sf_model){.symmetry_factor = 4,
                      .missile = {.direction = {0, 0, -1}},
                      .motion_count = 3,
                      .motion_time = motion_time,
                      .motion_displacement = motion_displacement};
}

/* One step under a constant force of the pad at SOMEWHERE, the second half of the last step's velocity
 * included. */
static void take_step(const sf_model *m, sf_missile *missile, int64_t step, const double force[3]) {
    double time = DT * (double)step, dt_old = step > 0 ? DT : 0;
    sf_missile_clear(missile);
    if (sf_dot3(force, force) > 0)
        sf_missile_apply(m, missile, SOMEWHERE, UP, force);
    sf_missile_accelerate(m, missile);
    sf_missile_kick(m, missile, time, DT, dt_old);
    sf_missile_drift(m, missile, time + DT, DT);
}

/* The leapfrog is exact for a constant acceleration: at every step, along any direction. */
static void a_free_missile_falls_by_the_closed_form(void **state) {
    (void)state;
    static const double none[3] = {0};
    for (int oblique = 0; oblique < 2; oblique++) {
        const double slant = oblique ? 0.6 : 0, along = 9.81 * cos(slant),
                     start = sqrt(4.5 * 4.5 - 2 * along * 1e-3); /* 4.5 m/s after its gap */
        const sf_model m = free_missile(slant);
        sf_missile missile;
        sf_missile_begin(&m, &missile);
        assert_true(isnan(missile.contact_time) && isnan(missile.release_time));
        for (int64_t step = 0; step < 2000; step++) {
            double time = DT * (double)step, translation[3];
            assert_close(missile.displacement, start * time + 0.5 * along * time * time, 1e-13);
            sf_missile_translation(&m, &missile, translation);
            assert_close(translation[0], missile.displacement * sin(slant), 1e-15);
            assert_close(translation[2], -missile.displacement * cos(slant), 1e-15);
            assert_close(sf_missile_depth(&m, &missile), cos(slant) * (missile.displacement - 1e-3) + 2e-3,
                         1e-15);
            take_step(&m, &missile, step, none);
            assert_close(missile.velocity_now, start + along * time, 1e-12);
            assert_close(missile.acceleration, along, 1e-12);
            assert_true(sf_missile_reading(&m, &missile) == 0 && !signbit(sf_missile_reading(&m, &missile)));
            double kinetic = 0.5 * 4.6 * missile.velocity_now * missile.velocity_now;
            if (step > 0) /* that is v(n-1/2) v(n+1/2), second order */
                assert_close(sf_missile_kinetic(&m, &missile, DT), kinetic, 4.6 * along * along * DT * DT);
        }
        double fall = 0.5 * 4.6 * (missile.velocity_now * missile.velocity_now - start * start);
        assert_close(sf_missile_gravity_work(&m, &missile), fall, 2 * 4.6 * along * 5 * DT);
    }
}

/* What the pad gives in forces, the missile loses in momentum, along its direction. */
static void forces_change_the_momentum_by_their_impulse(void **state) {
    (void)state;
    for (int oblique = 0; oblique < 2; oblique++) {
        sf_model m = free_missile(oblique ? 0.6 : 0);
        m.missile.gravity = 0;
        sf_missile missile;
        sf_missile_begin(&m, &missile);
        const double force[3] = {-120, 35, 900};
        double before = sf_missile_momentum(&m, &missile), impulse = 0;
        for (int64_t step = 0; step < 500; step++) {
            take_step(&m, &missile, step, force);
            impulse += (step > 0 ? DT : 0.5 * DT) * sf_missile_along(&m, missile.force);
        }
        assert_close(sf_missile_momentum(&m, &missile) - before, impulse, 1e-10);
        assert_close(sf_missile_contact_force(&m, &missile), -sf_dot3(force, m.missile.direction), 1e-12);
        /* friction: the part across UP, against the direction */
        assert_close(missile.friction, 120 * m.missile.direction[0], 1e-12);
    }
}

/* The response to trial forces is what the step then does with the same forces. */
static void the_response_foretells_the_step(void **state) {
    (void)state;
    const double first[3] = {3, 1, -400}, wrong[3] = {0, 0, -9}, second[3] = {-20, 5, -150};
    const sf_model m = free_missile(0.6);
    sf_missile missile;
    double away[3], recoil[3], force[3], moved[3], change[3];
    sf_missile_begin(&m, &missile);
    sf_missile_response response = sf_missile_predict(&m, &missile, 0, DT, 0);
    sf_missile_load(&response, SOMEWHERE, first);
    sf_missile_load(&response, UP, wrong);
    for (int r = 0; r < 3; r++)
        change[r] = second[r] - wrong[r];
    sf_missile_load(&response, UP, change);
    sf_missile_free_motion(&response, SOMEWHERE, away);
    sf_missile_recoil(&response, SOMEWHERE, recoil);
    for (int r = 0; r < 3; r++)
        force[r] = -first[r] - second[r]; /* on the missile */
    take_step(&m, &missile, 0, force);
    sf_missile_motion_at(&m, &missile, SOMEWHERE, moved);
    for (int r = 0; r < 3; r++)
        assert_close(moved[r], away[r] - DT * 0.5 * DT * recoil[r], 1e-18);
    /* a newton along the direction moves its mass, one across it nothing */
    const double across[3] = {cos(0.6), 0, sin(0.6)};
    assert_close(sf_missile_mobility(&response, SOMEWHERE, m.missile.direction), 1 / 4.6, 1e-15);
    assert_close(sf_missile_mobility(&response, SOMEWHERE, across), 0, 1e-15);
}

static void a_driven_missile_follows_its_motion_whatever_the_forces(void **state) {
    (void)state;
    const sf_model m = driven_missile();
    const double force[3] = {50, 0, 1e4};
    sf_missile missile;
    assert_true(sf_missile_is_driven(&m));
    sf_missile_begin(&m, &missile);
    assert_close(missile.velocity, 0.5, 1e-15);
    for (int64_t step = 0; step < 500; step++) {
        double time = DT * (double)step;
        assert_close(missile.displacement, sf_motion_displacement(&m, time), 1e-15);
        sf_missile_response response = sf_missile_predict(&m, &missile, time, DT, step > 0 ? DT : 0);
        assert_true(sf_missile_mobility(&response, SOMEWHERE, UP) == 0);
        take_step(&m, &missile, step, force);
        assert_true(missile.acceleration == 0 && !signbit(sf_missile_reading(&m, &missile)));
        assert_true(missile.velocity_now == sf_motion_velocity(&m, time));
        assert_close(missile.displacement - missile.displacement_old, response.travel, 1e-18);
        assert_false(sf_missile_is_leaving(&m, &missile)); /* it may come back */
        assert_true(sf_missile_contact_force(&m, &missile) == 1e4);
    }
    assert_true(missile.velocity < 0);
}

/* Guided: it does not turn. */
static void every_point_moves_as_the_whole(void **state) {
    (void)state;
    static const double points[3][3] = {{0, 0, 0}, {0.1, -0.2, 0.3}, {-5, 4, 3}};
    const sf_model m = free_missile(0.6);
    const double force[3] = {0, 0, 2000};
    sf_missile missile;
    sf_missile_begin(&m, &missile);
    for (int64_t step = 0; step < 1500; step++) {
        double before[3], after[3], motion[3];
        sf_missile_translation(&m, &missile, before);
        take_step(&m, &missile, step, force);
        sf_missile_translation(&m, &missile, after);
        for (int p = 0; p < 3; p++) {
            sf_missile_motion_at(&m, &missile, points[p], motion);
            for (int r = 0; r < 3; r++)
                assert_close(motion[r], after[r] - before[r], 1e-15);
            assert_true(sqrt(sf_dot3(motion, motion)) <= DT * sf_missile_fastest(&m, &missile) * (1 + 1e-9));
        }
    }
    assert_true(sf_missile_is_leaving(&m, &missile)); /* it was thrown back */
}

/* A sphere of 80 mm that has moved: the gap goes with it, and so does the gap ahead. */
static void the_surface_goes_with_the_pose(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_model m = free_missile(0.6);
    m.missile.shape = SF_SHAPE_SPHERE;
    m.missile.sphere_radius = 0.08;
    m.missile.sphere_cap_cosine = -1;
    sf_body surface;
    assert_int_equal(sf_body_build(&m, SF_BODY_MISSILE, &surface, &err), SF_OK);
    sf_missile missile;
    sf_missile_begin(&m, &missile);
    missile.displacement = 0.02;
    const double x[3] = {0.1, 0.05, -0.02}, step[3] = {1e-4, 0, 2e-5};
    sf_missile_response response = sf_missile_predict(&m, &missile, 0, DT, DT);
    double centre[3], r[3], away[3], gap, normal[3];
    sf_missile_translation(&m, &missile, centre);
    sf_missile_free_motion(&response, x, away);
    for (int ahead = 0; ahead < 2; ahead++) {
        for (int k = 0; k < 3; k++)
            r[k] = x[k] - centre[k] + (ahead ? step[k] - away[k] : 0);
        if (ahead)
            assert_true(sf_missile_gap_ahead(&m, &response, &surface, x, step, &gap, normal));
        else
            assert_true(sf_missile_gap(&m, &missile, &surface, x, &gap, normal));
        double distance = sqrt(sf_dot3(r, r));
        assert_close(gap, distance - 0.08, 1e-15);
        for (int k = 0; k < 3; k++)
            assert_close(normal[k], r[k] / distance, 1e-14);
        assert_true(sf_missile_near(&m, &missile, &surface, x, 1.001 * fabs(gap)) == (gap > 0 || !ahead));
    }
    sf_body_free(&surface);
}

/* A quarter of the missile under a quarter of the force moves as the whole; the whole's figures are four
 * times the modelled part's. */
static void symmetry_divides_mass_and_leaves_the_motion(void **state) {
    (void)state;
    const double force[3] = {0, 0, 1200}, quarter_force[3] = {0, 0, 300};
    sf_model whole = free_missile(0), quarter = free_missile(0);
    quarter.symmetry_factor = 4;
    sf_missile a, b;
    sf_missile_begin(&whole, &a);
    sf_missile_begin(&quarter, &b);
    for (int64_t step = 0; step < 500; step++) {
        take_step(&whole, &a, step, force);
        take_step(&quarter, &b, step, quarter_force);
        assert_true(a.displacement == b.displacement && a.velocity_now == b.velocity_now &&
                    a.acceleration == b.acceleration);
    }
    assert_true(sf_model_whole(&whole) == 1 && sf_model_whole(&quarter) == 4);
    assert_true(sf_missile_mass(&whole) == 4 * sf_missile_mass(&quarter));
    assert_true(sf_missile_weight(&whole) == 4 * sf_missile_weight(&quarter));
    assert_true(sf_missile_momentum(&whole, &a) == 4 * sf_missile_momentum(&quarter, &b));
    assert_true(sf_missile_kinetic(&whole, &a, DT) == 4 * sf_missile_kinetic(&quarter, &b, DT));
    assert_true(sf_missile_contact_force(&whole, &a) == 4 * sf_missile_contact_force(&quarter, &b));
    sf_missile_response response = sf_missile_predict(&quarter, &b, 0, DT, DT);
    assert_close(sf_missile_mobility(&response, SOMEWHERE, UP), 4 / 4.6, 1e-15);
}

static void contact_times_are_the_first_and_the_last(void **state) {
    (void)state;
    const sf_model m = free_missile(0);
    sf_missile missile;
    sf_missile_begin(&m, &missile);
    for (int k = 1; k < 4; k++)
        sf_missile_touch(&m, &missile, 1e-3 * k);
    assert_true(missile.contact_time == 1e-3 && missile.release_time == 3e-3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_free_missile_falls_by_the_closed_form),
        cmocka_unit_test(forces_change_the_momentum_by_their_impulse),
        cmocka_unit_test(the_response_foretells_the_step),
        cmocka_unit_test(a_driven_missile_follows_its_motion_whatever_the_forces),
        cmocka_unit_test(every_point_moves_as_the_whole),
        cmocka_unit_test(the_surface_goes_with_the_pose),
        cmocka_unit_test(symmetry_divides_mass_and_leaves_the_motion),
        cmocka_unit_test(contact_times_are_the_first_and_the_last),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
