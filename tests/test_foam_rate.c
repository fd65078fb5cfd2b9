/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rate-dependent parts of the foam law: Maxwell, Kelvin, DAMP; lanes. */
#include "extreme.h"
#include "material/low_density_foam.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "foam_fixture.h"
#include "post_check.h"

/* An EVA-like foam with the given Maxwell branch, Kelvin viscosity and DAMP. */
static void make_foam(sf_foam *foam, double maxwell, double maxwell_rate, double kelvin, double damp) {
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 60, 0.8, 1);
    card.card.shared.maxwell_modulus = maxwell;
    card.card.shared.maxwell_rate = maxwell_rate;
    card.card.shared.kelvin_viscosity = kelvin;
    card.card.shared.damp = damp;
    foam_build(&card, foam);
}

/* Upper triangular F with FtF = I + 2 t A, A = (xx, yy, zz, xy, yz, xz): the Green strain t A. */
static void green_strain(const double a[6], double t, double f[9]) {
    double c[9] = {1 + 2 * t * a[0], 2 * t * a[3], 2 * t * a[5], 0, 1 + 2 * t * a[1], 2 * t * a[4], 0, 0,
                   1 + 2 * t * a[2]};
    memset(f, 0, 9 * sizeof *f);
    f[0] = sqrt(c[0]);
    f[1] = c[1] / f[0];
    f[2] = c[2] / f[0];
    f[4] = sqrt(c[4] - f[1] * f[1]);
    f[5] = (c[5] - f[1] * f[2]) / f[4];
    f[8] = sqrt(c[8] - f[2] * f[2] - f[5] * f[5]);
}

/* P - P(elastic) of lane 0 against F S with S = factor x A. */
static void assert_extra_stress(const sf_foam *foam, sf_law_batch *batch, const double f[9],
                                const double a[6], double factor) {
    const double s[9] = {a[0], a[3], a[5], a[3], a[1], a[4], a[5], a[4], a[2]};
    double p[9], expected[9];
    foam_point elastic = foam_elastic(foam, f, batch->history[SF_FOAM_PEAK][0]);
    foam_get(batch->p, 0, p);
    point_product(f, s, expected);
    for (int k = 0; k < 9; k++)
        expected[k] = elastic.p[k] + factor * expected[k];
    assert_close(point_distance(9, p, expected), 0, 1e-10 * point_norm(9, expected));
}

static const double DIRECTION[6] = {-40, -15, 8, 10, -6, 4}; /* s-1, a rate of Green strain */

/* S = ED/BETA1 dE/dt (1 - exp(-BETA1 t)), whatever the steps; then exp decay at rest. */
static void maxwell_branch_follows_closed_form_and_relaxes(void **state) {
    (void)state;
    const double steps[3] = {1e-5, 1e-4, 2e-3};
    for (int k = 0; k < 3; k++) {
        sf_foam foam;
        sf_law_batch batch;
        double f[9], t = 0, ed = 3.4e6, beta = 1500;
        make_foam(&foam, ed, beta, 0, 0);
        foam_reset(&batch);
        while (t < 8e-3 - 1e-9) {
            t += steps[k];
            green_strain(DIRECTION, t, f);
            foam_step(&foam, steps[k], f, &batch);
            double gain = ed / beta * -expm1(-beta * t);
            for (int i = 0; i < 6; i++)
                assert_close(batch.history[SF_FOAM_MAXWELL + i][0], gain * DIRECTION[i], 1e-9 * gain * 40);
            assert_extra_stress(&foam, &batch, f, DIRECTION, gain);
        }
        double gain = ed / beta * -expm1(-beta * t), rest = 0;
        for (int n = 0; n < 5; n++) {
            rest += 3 * steps[k];
            foam_step(&foam, 3 * steps[k], f, &batch);
            assert_extra_stress(&foam, &batch, f, DIRECTION, gain * exp(-beta * rest));
            assert_close(batch.work[0], 0, 0);
        }
        sf_foam_free(&foam);
    }
}

/* Contraction of A with itself. */
static double square(const double a[6]) {
    return a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + 2 * (a[3] * a[3] + a[4] * a[4] + a[5] * a[5]);
}

/* Work at a constant rate: ED/BETA1 |dE/dt|^2 (t - (1 - exp(-BETA1 t))/BETA1) of Maxwell, eta |dE/dt|^2 t of
 * Kelvin. */
static void viscous_work_follows_closed_form(void **state) {
    (void)state;
    sf_foam foam;
    sf_law_batch batch;
    double f[9], work = 0, ed = 3.4e6, beta = 1500, eta = 70, dt = 2e-6;
    make_foam(&foam, ed, beta, eta, 0);
    foam_reset(&batch);
    for (int k = 1; k <= 4000; k++) {
        green_strain(DIRECTION, k * dt, f);
        foam_step(&foam, dt, f, &batch);
        work += batch.work[0];
    }
    double t = 4000 * dt;
    assert_relative(work, square(DIRECTION) * (ed / beta * (t + expm1(-beta * t) / beta) + eta * t), 1e-6);
    sf_foam_free(&foam);
}

static void kelvin_stress_is_viscosity_times_rate(void **state) {
    (void)state;
    sf_foam foam;
    sf_law_batch batch;
    double f[9];
    make_foam(&foam, 0, 0, 690, 0);
    foam_reset(&batch);
    for (int k = 1; k <= 10; k++) {
        green_strain(DIRECTION, k * 5e-4, f);
        foam_step(&foam, 5e-4, f, &batch);
        assert_extra_stress(&foam, &batch, f, DIRECTION, 690);
    }
    foam_step(&foam, 5e-4, f, &batch); /* at rest: nothing */
    assert_extra_stress(&foam, &batch, f, DIRECTION, 0);
    sf_foam_free(&foam);
}

static void no_time_no_viscous_stress(void **state) {
    (void)state;
    sf_foam foam;
    sf_law_batch batch;
    double f[9], p[9];
    make_foam(&foam, 3e6, 5000, 690, 0.35);
    foam_reset(&batch);
    foam_uniaxial(0.6, f);
    foam_step(&foam, 0, f, &batch);
    foam_get(batch.p, 0, p);
    sf_foam bare;
    make_foam(&bare, 0, 0, 0, 0);
    foam_point elastic = foam_elastic(&bare, f, 0);
    assert_close(point_distance(9, p, elastic.p), 0, 0);
    assert_close(batch.work[0], 0, 0);
    sf_foam_free(&bare);
    sf_foam_free(&foam);
}

/* ---- DAMP ---- */

/* Stress of DAMP alone at f, coming from `old` within dt. */
static void damp_stress(const sf_foam *foam, double dt, const double old[9], const double f[9], double length,
                        double p[9], double *work) {
    sf_law_batch batch;
    foam_reset(&batch);
    foam_set(batch.f, 0, f);
    foam_set(batch.f_old, 0, old);
    batch.length[0] = length;
    sf_foam_update(foam, dt, &batch);
    foam_get(batch.p, 0, p);
    foam_point elastic = foam_elastic(foam, f, 0);
    for (int k = 0; k < 9; k++)
        p[k] -= elastic.p[k];
    *work = batch.work[0];
}

/* J = stretch: P = DAMP L sqrt(rho x stiffness) x rate, exactly, compressed or not. */
static void damp_in_uniaxial_strain_is_a_dashpot_of_fixed_impedance(void **state) {
    (void)state;
    const double damp = 0.35, length = 5e-3, dt = 1e-6, rate = -90;
    sf_foam foam;
    make_foam(&foam, 0, 0, 0, damp);
    double first_slope, none;
    sf_curve_evaluate(&foam.curve[0], 0, &none, &first_slope, &none);
    for (double stretch = 0.15; stretch < 1.3; stretch += 0.1) {
        double f[9], old[9], p[9], work, slope = 0.4e6, stress, energy;
        foam_uniaxial(stretch, f);
        foam_uniaxial(stretch - rate * dt, old);
        damp_stress(&foam, dt, old, f, length, p, &work);
        if (stretch < 1)
            sf_curve_evaluate(&foam.curve[0], 1 - stretch, &stress, &slope, &energy);
        double expected = damp * length * sqrt(35 * fmax(slope, fmax(0.4e6, first_slope))) * rate;
        foam_point elastic = foam_elastic(&foam, f, 0);
        double noise = 1e-14 * point_norm(9, elastic.p);
        assert_close(p[0], expected, 1e-8 * fabs(expected) + noise);
        assert_close(point_norm(8, p + 1), 0, 1e-10 * fabs(expected) + noise);
        assert_relative(work, expected * rate * dt, 1e-8);
    }
    sf_foam_free(&foam);
}

/* J sigma = DAMP L sqrt(rho g) J^2 D of any motion: sigma = P Ft / J is symmetric, D is the rate of
 * deformation. */
static void damp_stress_is_proportional_to_rate_of_deformation(void **state) {
    (void)state;
    const double damp = 0.5, length = 0.01, dt = 1e-7;
    sf_foam foam;
    uint64_t seed = 7;
    make_foam(&foam, 0, 0, 0, damp);
    for (int trial = 0; trial < 200; trial++) {
        double f[9], l[9], old[9], p[9], turned[9], tau[9], expected[9], work, change[9];
        point_deformation(&seed, 0.4, 1.2, f);
        for (int k = 0; k < 9; k++)
            l[k] = point_random(&seed, -100, 100); /* velocity gradient: F' = L F */
        point_product(l, f, change);
        for (int k = 0; k < 9; k++)
            old[k] = f[k] - dt * change[k];
        damp_stress(&foam, dt, old, f, length, p, &work);
        point_transpose(f, turned);
        point_product(p, turned, tau); /* J sigma */
        double j = f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) +
                   f[2] * (f[3] * f[7] - f[4] * f[6]);
        double eta = damp * length * sqrt(35 * foam_elastic(&foam, f, 0).stiffness), power = 0;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) {
                double d = 0.5 * (l[3 * i + k] + l[3 * k + i]);
                expected[3 * i + k] = eta * j * j * d;
                power += expected[3 * i + k] * d;
            }
        assert_close(point_distance(9, tau, expected), 0, 1e-7 * point_norm(9, expected));
        assert_relative(work, power * dt, 1e-6);
    }
    sf_foam_free(&foam);
}

/* Rotating at a constant rate: the backward difference leaves a stress proportional to dt. */
static void damp_of_a_rigid_rotation_vanishes_with_the_step(void **state) {
    (void)state;
    const double axis[3] = {0.48, 0.6, 0.64}, damp = 0.35, length = 0.005, omega = 200;
    const double stretch[9] = {0.5, 0.1, 0, 0, 0.9, 0.2, 0.05, 0, 1.1};
    sf_foam foam;
    make_foam(&foam, 0, 0, 0, damp);
    double size[3];
    for (int k = 0; k < 3; k++) {
        double dt = 1e-5 * pow(0.5, k), q[9], old[9], f[9], p[9], work;
        point_rotation_about(axis, 0.3, q);
        point_product(q, stretch, old);
        point_rotation_about(axis, 0.3 + omega * dt, q);
        point_product(q, stretch, f);
        damp_stress(&foam, dt, old, f, length, p, &work);
        size[k] = point_norm(9, p);
        /* what the same rate would give as a deformation, times the angle of the step */
        double deforming = damp * length * sqrt(35 * foam_elastic(&foam, f, 0).stiffness) * omega;
        assert_true(size[k] < deforming * omega * dt);
    }
    assert_relative(size[1] / size[0], 0.5, 0.01);
    assert_relative(size[2] / size[1], 0.5, 0.01);
    sf_foam_free(&foam);
}

static void viscous_stresses_turn_with_the_observer(void **state) {
    (void)state;
    sf_foam foam;
    uint64_t seed = 8;
    make_foam(&foam, 3e6, 5000, 300, 0.35);
    for (int trial = 0; trial < 100; trial++) {
        double f[9], old[9], q[9], p[2][9], turned[9], work[2];
        point_deformation(&seed, 0.2, 1.2, f);
        for (int k = 0; k < 9; k++)
            old[k] = f[k] + point_random(&seed, -1e-3, 1e-3);
        point_rotation(&seed, q);
        for (int side = 0; side < 2; side++) {
            double now[9], before[9];
            point_product(q, f, now);
            point_product(q, old, before);
            damp_stress(&foam, 1e-5, side ? before : old, side ? now : f, 0.005, p[side], &work[side]);
        }
        point_product(q, p[0], turned);
        assert_close(point_distance(9, turned, p[1]), 0, 1e-9 * point_norm(9, p[0]));
        assert_relative(work[1], work[0], 1e-9);
    }
    sf_foam_free(&foam);
}

/* Second law: DAMP's work is never negative, and is P : dF. */
static void damp_dissipates(void **state) {
    (void)state;
    sf_foam foam;
    uint64_t seed = 9;
    make_foam(&foam, 0, 0, 0, 0.35);
    for (int trial = 0; trial < 500; trial++) {
        double f[9], old[9], p[9], work, done = 0;
        point_deformation(&seed, 0.2, 1.2, f);
        for (int k = 0; k < 9; k++)
            old[k] = f[k] + point_random(&seed, -1e-2, 1e-2);
        damp_stress(&foam, 1e-5, old, f, 0.005, p, &work);
        for (int k = 0; k < 9; k++)
            done += p[k] * (f[k] - old[k]);
        assert_true(work > 0);
        assert_relative(done, work, 1e-8);
    }
    sf_foam_free(&foam);
}

/* ---- bounds ---- */

/* Largest eigenvalue of dP/d(rate of F) at F, by moving f_old. */
static double numerical_viscosity(const sf_foam *foam, const double f[9], double length, double *bound) {
    const double dt = 1e-3, h = 1e-4;
    double matrix[81];
    for (int column = 0; column < 9; column++) {
        double p[2][9];
        for (int side = 0; side < 2; side++) {
            sf_law_batch batch;
            double old[9];
            memcpy(old, f, sizeof old);
            old[column] -= side ? h : -h;
            foam_reset(&batch);
            foam_set(batch.f, 0, f);
            foam_set(batch.f_old, 0, old);
            batch.length[0] = length;
            sf_foam_update(foam, dt, &batch);
            foam_get(batch.p, 0, p[side]);
            *bound = batch.viscosity[0];
        }
        for (int row = 0; row < 9; row++)
            matrix[9 * row + column] = (p[1][row] - p[0][row]) / (2 * h / dt);
    }
    return point_largest_eigenvalue(9, matrix);
}

static void viscosity_bounds_the_numerical_viscosity(void **state) {
    (void)state;
    uint64_t seed = 10;
    for (int kind = 0; kind < 3; kind++) { /* Kelvin, DAMP, both */
        sf_foam foam;
        double tightest = 0;
        make_foam(&foam, 0, 0, kind == 1 ? 0 : 100, kind == 0 ? 0 : 0.35);
        for (int trial = 0; trial < 200; trial++) {
            double f[9], bound;
            point_deformation(&seed, 0.3, 1.3, f);
            double largest = numerical_viscosity(&foam, f, 0.05, &bound);
            assert_true(largest <= bound * (1 + 1e-6));
            tightest = larger(tightest, largest / bound);
        }
        assert_true(tightest > 0.8);
        sf_foam_free(&foam);
    }
}

static void tangent_bounds_maxwell_too(void **state) {
    (void)state;
    sf_foam foam;
    uint64_t seed = 11;
    make_foam(&foam, 3.4e6, 5000, 0, 0);
    for (int trial = 0; trial < 300; trial++)
        foam_assert_tangent_bounds(&foam, &seed, 1e-5);
    sf_foam_free(&foam);
}

/* ---- lanes ---- */

/* Every output of lane l, as one list. */
static void outputs(const sf_law_batch *b, int l, double out[32]) {
    int n = 0;
    for (int k = 0; k < 9; k++)
        out[n++] = b->p[k][l];
    for (int k = 0; k < 6; k++)
        out[n++] = b->history[SF_FOAM_MAXWELL + k][l];
    for (int k = 0; k < 3; k++)
        out[n++] = b->stretch[k][l];
    const double rest[] = {b->history[SF_FOAM_PEAK][l],
                           b->history[SF_FOAM_RATE][l],
                           b->jacobian[l],
                           b->energy[l],
                           b->factor[l],
                           b->stiffness[l],
                           b->tangent[l],
                           b->viscosity[l],
                           b->work[l]};
    for (size_t k = 0; k < sizeof rest / sizeof rest[0]; k++)
        out[n++] = rest[k];
    while (n < 32)
        out[n++] = 0;
}

/* A point gives the same in any lane, whatever the others hold: other deformations, or NaN. */
static void lanes_are_independent(void **state) {
    (void)state;
    static point_card card;
    sf_foam foam;
    uint64_t seed = 13;
    point_card_init(&card);
    point_card_add_eva(&card, 1, 60, 0.8, 1);
    point_card_add_eva(&card, 100, 60, 0.8, 1.5);
    card.card.shared.maxwell_modulus = 3e6;
    card.card.shared.maxwell_rate = 5000;
    card.card.shared.kelvin_viscosity = 50;
    card.card.shared.damp = 0.35;
    card.card.shared.hysteresis_hu = 0.01;
    foam_build(&card, &foam);
    for (int trial = 0; trial < 100; trial++) {
        sf_law_batch mixed;
        foam_reset(&mixed);
        for (int l = 0; l < SF_LANES; l++) {
            double f[9];
            point_deformation(&seed, 0.2, 1.2, f);
            foam_set(mixed.f, l, f);
            for (int k = 0; k < 9; k++)
                mixed.f_old[k][l] = f[k] + point_random(&seed, -1e-3, 1e-3);
            mixed.length[l] = point_random(&seed, 1e-3, 1e-2);
            mixed.history[SF_FOAM_PEAK][l] = point_random(&seed, 0, 1e6);
            mixed.history[SF_FOAM_RATE][l] = point_random(&seed, 0, 100);
            for (int k = 0; k < 6; k++)
                mixed.history[SF_FOAM_MAXWELL + k][l] = point_random(&seed, -1e5, 1e5);
        }
        if (trial % 2)
            mixed.f[4][trial % SF_LANES] = NAN;
        sf_law_batch before = mixed;
        sf_foam_update(&foam, 1e-5, &mixed);
        for (int l = 0; l < SF_LANES; l++) {
            sf_law_batch alone;
            double together[32], single[32];
            if (trial % 2 && l == trial % SF_LANES) {
                assert_true(isnan(mixed.p[4][l]));
                continue;
            }
            foam_reset(&alone);
            int to = (l + 3) % SF_LANES;
            for (int k = 0; k < 9; k++) {
                alone.f[k][to] = before.f[k][l];
                alone.f_old[k][to] = before.f_old[k][l];
            }
            for (int k = 0; k < 6; k++)
                alone.history[SF_FOAM_MAXWELL + k][to] = before.history[SF_FOAM_MAXWELL + k][l];
            alone.length[to] = before.length[l];
            alone.history[SF_FOAM_PEAK][to] = before.history[SF_FOAM_PEAK][l];
            alone.history[SF_FOAM_RATE][to] = before.history[SF_FOAM_RATE][l];
            sf_foam_update(&foam, 1e-5, &alone);
            outputs(&mixed, l, together);
            outputs(&alone, to, single);
            assert_close(point_distance(9, together, single), 0, 1e-11 * point_norm(9, single));
            assert_close(point_distance(6, together + 9, single + 9), 0, 1e-12 * point_norm(6, single + 9));
            for (int k = 15; k < 32; k++)
                assert_close(together[k], single[k], 1e-11 * fabs(single[k]));
        }
    }
    sf_foam_free(&foam);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maxwell_branch_follows_closed_form_and_relaxes),
        cmocka_unit_test(viscous_work_follows_closed_form),
        cmocka_unit_test(kelvin_stress_is_viscosity_times_rate),
        cmocka_unit_test(no_time_no_viscous_stress),
        cmocka_unit_test(damp_in_uniaxial_strain_is_a_dashpot_of_fixed_impedance),
        cmocka_unit_test(damp_stress_is_proportional_to_rate_of_deformation),
        cmocka_unit_test(damp_of_a_rigid_rotation_vanishes_with_the_step),
        cmocka_unit_test(viscous_stresses_turn_with_the_observer),
        cmocka_unit_test(damp_dissipates),
        cmocka_unit_test(viscosity_bounds_the_numerical_viscosity),
        cmocka_unit_test(tangent_bounds_maxwell_too),
        cmocka_unit_test(lanes_are_independent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
