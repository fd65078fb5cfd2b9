/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A foam block between platens whose motion is prescribed, against the material's law in closed form: the
 * curve on loading, the curve times (14) on unloading and reloading, the returned energy (17), the ledger. */
#include "extreme.h"
#include "model_fixture.h"

#include "material/curve.h"
#include "base/mat3.h"
#include "model/motion.h"
#include "solver/run/recorder.h"
#include "solver/step.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double HEIGHT = 0.05, AREA = 0.06 * 0.06, SPEED = 0.5;

/* Gives the case the motion of `count` points instead of mass and speed. */
static void drive(sf_case *c, int count, const double *time, const double *displacement) {
    sf_error err = SF_ERROR_INIT;
    c->motion_count = count;
    c->motion_time = sf_alloc(&err, (unsigned long)count, sizeof(double), "motion");
    c->motion_displacement = sf_alloc(&err, (unsigned long)count, sizeof(double), "motion");
    assert_int_equal(err.status, SF_OK);
    memcpy(c->motion_time, time, (size_t)count * sizeof(double));
    memcpy(c->motion_displacement, displacement, (size_t)count * sizeof(double));
    c->missile_card.mass = c->missile_card.speed = c->missile_card.gravity = 0;
    c->run.end_time = time[count - 1];
    c->run.step_limit = 20e-6; /* fine enough for the comparison with the law */
}

/* A quarter of a block of 60 x 60 x 50 mm, without the Maxwell branch, under a platen with this motion. The
 * law has no Poisson effect, so that base and friction change nothing but hold the block: between smooth
 * platens it buckles. */
static void start_cube(fixture *f, double friction, int count, const double *time,
                       const double *displacement) {
    const fixture_block block = {.cells = {3, 3, 5}, .spacing = 0.01};
    sf_case c;
    fixture_case(&c, NULL);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    fixture_mirror(&c, 2);
    c.symmetry_given = true;
    sf_foam_card_of(&c.material)->shared.maxwell_modulus = 0;
    c.missile_card.friction = friction;
    drive(&c, count, time, displacement);
    fixture_under_plate(&c, &block, 0.2, 0, 0, f);
    fixture_start(f);
}

/* Nominal stress between platens. */
static double stress_now(const fixture *f) {
    double whole = (double)f->model.symmetry_factor;
    return -whole * sf_dot3(f->state.missile.force, f->model.missile.direction) / AREA;
}

/* The law in uniaxial compression: `deepest` is the largest strain so far. */
static double law(const fixture *f, const sf_curve *curve, double strain, double deepest) {
    const sf_foam_card *foam = sf_foam_card_of(&f->model.material[0]);
    double stress, slope, energy, unused, largest;
    sf_curve_evaluate(curve, strain, &stress, &slope, &energy);
    sf_curve_evaluate(curve, deepest, &unused, &slope, &largest);
    double part = strain < deepest ? pow(energy / largest, foam->shared.hysteresis_shape) : 1;
    return stress * (1 - (1 - foam->shared.hysteresis_hu) * (1 - part));
}

static double energy_to(const sf_curve *curve, double strain) {
    double stress, slope, energy;
    sf_curve_evaluate(curve, strain, &stress, &slope, &energy);
    return energy;
}

/* To 80 %, slowly at first contact and round the turn, where the dense foam carries waves; up to 25 mm above
 * the pad, and to 60 % again. */
static void stress_follows_the_law_when_loaded_released_and_loaded_again(void **state) {
    (void)state;
    enum { POINTS = 9, TURN = 4, TOP = 7, END = 8 };
    static const double time[POINTS] = {0, 0.01, 0.076, 0.096, 0.136, 0.176, 0.196, 0.314, 0.424};
    static const double displacement[POINTS] = {0, 0.001, 0.034, 0.038, 0.04, 0.038, 0.034, -0.025, 0.03};
    fixture f;
    sf_curve curve;
    sf_error err = SF_ERROR_INIT;
    start_cube(&f, 0.5, POINTS, time, displacement);
    sf_state *s = &f.state;
    assert_int_equal(sf_curve_build(sf_foam_card_of(&f.model.material[0]), 0, &curve, &err), SF_OK);
    double largest = law(&f, &curve, 0.8, 0.8), worst[3] = {0}, released = 0, work = 0;
    bool again = false;
    for (fixture_step(&f); s->time < time[END]; sf_step_advance(&f.model, s), fixture_step(&f)) {
        double strain = s->missile.displacement / HEIGHT;
        int phase = s->time <= time[TURN] ? 0 : s->time <= time[TOP] ? 1 : 2;
        work = larger(work, s->ledger.external);
        assert_close(s->ledger.error, 0, 1e-3);
        assert_close(s->ledger.momentum_error, 0, 1e-10);
        if (s->contact_count == 0 && phase == 1)
            released = released > 0 ? released : s->time;
        if (s->contact_count == 0)
            continue;
        again = again || (released > 0 && phase == 2);
        double expected = law(&f, &curve, strain, phase == 0 ? strain : 0.8);
        worst[phase] = larger(worst[phase], fabs(stress_now(&f) - expected) / largest);
    }
    for (int phase = 0; phase < 3; phase++)
        assert_close(worst[phase], 0, 0.005);
    assert_true(released > time[TURN] && again);
    assert_close(s->missile.displacement, 0.03, SPEED * 20e-6); /* the last step passes the end */
    assert_relative(stress_now(&f), law(&f, &curve, 0.6, 0.8), 0.01);
    assert_relative(4 * work, AREA * HEIGHT * energy_to(&curve, 0.8), 0.005);
    sf_curve_free(&curve);
    fixture_free(&f);
}

/* What the machine gets back, until the platen is clear of the cube: (17) but for the viscous part. */
static void a_release_returns_the_energy_of_the_law(void **state) {
    (void)state;
    static const double time[] = {0, 0.08, 0.2}, displacement[] = {0, 0.04, -0.02};
    fixture f;
    start_cube(&f, 0, 3, time, displacement);
    sf_state *s = &f.state;
    const sf_foam_card *foam = sf_foam_card_of(&f.model.material[0]);
    double work = 0;
    for (fixture_step(&f); s->time < 0.2; sf_step_advance(&f.model, s), fixture_step(&f)) {
        work = larger(work, s->ledger.external);
        if (s->step ==
            1) /* of the work that catches the surface up it keeps one half, contact loses the other */
            assert_relative(s->ledger.contact, s->ledger.kinetic_pad, 1e-3);
    }
    double hu = foam->shared.hysteresis_hu, expected = hu + (1 - hu) / (1 + foam->shared.hysteresis_shape);
    assert_int_equal(s->contact_count, 0);
    assert_close((work - s->ledger.external) / work, expected, 0.005);
    assert_relative(s->ledger.hysteresis + s->ledger.viscous + s->ledger.contact + s->ledger.kinetic_pad +
                        s->ledger.stored + s->ledger.stabilisation,
                    s->ledger.external, 1e-3);
    fixture_free(&f);
}

/* The motion is met at every time, with pieces and a gap, whatever the forces; friction does not spoil the
 * books. */
static void missile_follows_its_table_without_drift(void **state) {
    (void)state;
    static const double time[] = {0, 0.004, 0.04, 0.048, 0.08}, displacement[] = {0, 0, 0.018, 0.018, 0.006};
    static const double speed[] = {0, 0.5, 0, -0.375};
    fixture f;
    start_cube(&f, 0.3, 5, time, displacement);
    sf_state *s = &f.state;
    double friction = 0;
    for (fixture_step(&f); s->time < 0.08; sf_step_advance(&f.model, s), fixture_step(&f)) {
        int k = s->time < 0.004 ? 0 : s->time < 0.04 ? 1 : s->time < 0.048 ? 2 : 3;
        assert_close(s->missile.displacement, displacement[k] + speed[k] * (s->time - time[k]), 1e-15);
        assert_close(s->missile.velocity_now, speed[k], 1e-12);
        assert_true(s->missile.acceleration == 0);
        assert_close(s->ledger.error, 0, 1e-3);
        assert_close(s->ledger.momentum_error, 0, 1e-10);
        assert_true(s->ledger.kinetic_missile == 0);
        if (s->contact_count == 0)
            assert_true(s->time < 0.0041 || s->time > 0.06);
        friction = larger(friction, s->ledger.friction);
    }
    assert_true(friction >= 0);
    assert_close(sf_motion_displacement(&f.model, 0.084), 0.0045, 1e-15); /* the last piece goes on */
    assert_close(sf_motion_measure(&f.model).speed, SPEED, 1e-12);
    fixture_free(&f);
}

/* The history's column: none without points in contact, all of the block's top under a platen that covers it.
 */
static void area_in_contact_is_that_of_the_covered_top(void **state) {
    (void)state;
    static const double time[] = {0, 0.004, 0.04}, displacement[] = {0, 0, 0.018};
    fixture f;
    sf_recorder recorder;
    sf_error err = SF_ERROR_INIT;
    start_cube(&f, 0.3, 3, time, displacement);
    sf_state *s = &f.state;
    sf_recorder_begin(&recorder);
    for (fixture_step(&f); s->time < 0.03; sf_step_advance(&f.model, s), fixture_step(&f))
        assert_int_equal(sf_recorder_add(&recorder, &f.model, s, &err), SF_OK);
    const sf_history *h = &recorder.history;
    for (int64_t i = 0; i < h->rows; i++)
        assert_true((h->contact_area[i] > 0) == (h->contact_nodes[i] > 0));
    assert_close(h->contact_area[h->rows - 1], AREA, 1e-15);
    sf_recorder_free(&recorder);
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stress_follows_the_law_when_loaded_released_and_loaded_again),
        cmocka_unit_test(a_release_returns_the_energy_of_the_law),
        cmocka_unit_test(missile_follows_its_table_without_drift),
        cmocka_unit_test(area_in_contact_is_that_of_the_covered_top),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
