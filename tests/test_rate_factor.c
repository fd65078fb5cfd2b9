/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rate factor of the low-density foam (theory eq. O4). */
#include "material/low_density_foam.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "extreme.h"
#include "foam_fixture.h"
#include "post_check.h"

static const double FACTOR = 0.15, REFERENCE = 1, TAU = 1e-4; /* -, s-1, s */

static void make_foam(double hu, double alpha, double maxwell, sf_foam *foam) {
    static point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 60, 0.8, 1);
    card.card.shared.hysteresis_hu = hu;
    card.card.shared.hysteresis_alpha = alpha;
    card.card.shared.maxwell_modulus = maxwell;
    card.card.shared.maxwell_rate = 5000;
    card.card.shared.rate_factor = FACTOR;
    card.card.shared.rate_reference = REFERENCE;
    card.card.shared.rate_filter_time = TAU;
    foam_build(&card, foam);
}

/* Nominal stress of the curve, Pa, and its energy, J m-3. */
static double curve_stress(const sf_foam *foam, double strain, double *energy) {
    double stress, slope;
    sf_curve_evaluate(&foam->curve[0], strain, &stress, &slope, energy);
    return stress;
}

static double gain_at(double rate) {
    return FACTOR * fmax(0, log10(rate / REFERENCE));
}

/* At a constant rate v of engineering strain the filtered rate is v (1 - exp(-t / tau)), the stress the
 * curve's times 1 + c log10(rate / reference). */
static void loading_at_a_constant_rate_is_the_closed_form(void **state) {
    (void)state;
    static const double speeds[] = {0.5, 5, 90, 400};
    sf_foam foam;
    make_foam(0.01, 1, 0, &foam);
    for (int k = 0; k < 4; k++) {
        sf_law_batch batch;
        sf_uniaxial point = {0};
        double f[9], energy, dt = 1e-4 / speeds[k];
        foam_reset(&batch);
        for (int n = 1; n <= 6000; n++) {
            double strain = 1e-4 * n, filtered = speeds[k] * -expm1(-n * dt / TAU);
            foam_uniaxial(1 - strain, f);
            foam_step(&foam, dt, f, &batch);
            double stress = curve_stress(&foam, strain, &energy) * (1 + gain_at(filtered));
            assert_relative(-batch.p[0][0], stress, 1e-4);
            assert_relative(sf_foam_uniaxial(&foam, dt, strain, &point), stress, 1e-4);
        }
        assert_true(k == 0 ||
                    -batch.p[0][0] > (1 + 0.9 * gain_at(speeds[k])) * curve_stress(&foam, 0.6, &energy));
    }
    sf_foam_free(&foam);
}

/* In unloading the factor of hysteresis acts on the curve alone; the gain ends when the filtered rate, which
 * has the sign of the motion, falls below the reference. */
static void unloading_acts_on_the_curve_alone(void **state) {
    (void)state;
    sf_foam foam;
    sf_law_batch batch;
    double f[9], energy, peak, dt = 1e-6;
    make_foam(0.1, 1, 0, &foam);
    foam_reset(&batch);
    for (int n = 1; n <= 5000; n++) {
        foam_uniaxial(1 - 1e-4 * n, f);
        foam_step(&foam, dt, f, &batch);
    }
    double start = batch.history[SF_FOAM_RATE][0];
    curve_stress(&foam, 0.5, &peak);
    for (int n = 1; n <= 900; n++) {
        double strain = 0.5 - 1e-4 * n, rate = start * exp(-n * dt / TAU) + 100 * expm1(-n * dt / TAU);
        foam_uniaxial(1 - strain, f);
        foam_step(&foam, dt, f, &batch);
        double stress = curve_stress(&foam, strain, &energy);
        double factor = 1 - 0.9 * (1 - energy / peak);
        assert_relative(-batch.p[0][0], stress * (factor + gain_at(rate)), 1e-3);
        assert_relative(batch.factor[0], factor, 1e-9);
        assert_relative(batch.stored[0] + batch.lost[0],
                        peak - (peak - energy) * (0.1 + 0.45 * (1 + energy / peak)), 1e-6);
    }
    sf_foam_free(&foam);
}

/* The work of the gain is what the total work exceeds stored and lost energy by: to second order in the step.
 */
typedef struct cycle {
    double gap, viscous, lost; /* J m-3; gap: the largest part of the total work that nothing explains */
} cycle;

static cycle run_cycle(double time, int steps) {
    cycle c = {0};
    sf_foam foam;
    sf_law_batch batch;
    double f[9], total = 0, old = 0, before = 0;
    make_foam(0.05, 0.5, 0, &foam);
    foam_reset(&batch);
    for (int n = 1; n <= steps; n++) {
        double strain = 0.35 * (1 - cos(2 * M_PI * n / steps));
        foam_uniaxial(1 - strain, f);
        foam_step(&foam, time / steps, f, &batch);
        total -= 0.5 * (batch.p[0][0] + old) * (strain - before);
        old = batch.p[0][0];
        before = strain;
        c.viscous += batch.work[0];
        c.gap = larger(c.gap, fabs(total - batch.stored[0] - batch.lost[0] - c.viscous));
    }
    c.lost = batch.lost[0];
    sf_foam_free(&foam);
    return c;
}

static void work_closes_the_balance_and_dissipates(void **state) {
    (void)state;
    for (double time = 1e-3; time < 0.2; time *= 3) {
        cycle c = run_cycle(time, 4000), fine = run_cycle(time, 16000);
        assert_true(c.gap < 2e-6 * c.lost);
        assert_true(fine.gap < 0.065 * c.gap); /* 1/16 */
        assert_true(fine.viscous > 0.02 * fine.lost);
    }
}

/* Along random ways, back and forth at up to 1000 /s in uniaxial compression and in random directions, the
 * work of the gain is never below 0: what it holds after a reversal it has taken before (theory, after eq.
 * 22). */
static void no_way_gets_energy_from_the_gain(void **state) {
    (void)state;
    const double dt = TAU / 100;
    sf_foam foam;
    uint64_t seed = 21;
    make_foam(0.05, 1, 0, &foam);
    for (int way = 0; way < 60; way++) {
        sf_law_batch batch;
        double f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, go[9] = {0}, viscous = 0, most = 0, least = 0;
        bool uniaxial = way % 2 == 0;
        foam_reset(&batch);
        for (int n = 0; n < 6000; n++) {
            if (n % (5 + 20 * (way % 7)) ==
                0) { /* a new direction and speed, towards the middle of what is allowed */
                double speed = pow(10, point_random(&seed, 0, 3));
                for (int k = 0; k < 9; k++)
                    go[k] = uniaxial ? (k == 0) * speed * (point_random(&seed, 0, 1) < f[0] - 0.1 ? -1 : 1)
                                     : speed * (point_random(&seed, -1, 1) -
                                                (k % 4 == 0 ? 1.5 * (f[k] - 0.6) : 1.5 * f[k]));
            }
            for (int k = 0; k < 9; k++)
                f[k] += dt * go[k];
            f[0] = smaller(larger(f[0], 0.1), 1.05);
            foam_step(&foam, dt, f, &batch);
            viscous += batch.work[0];
            most = larger(most, viscous);
            least = smaller(least, viscous);
        }
        assert_true(most > 0);
        if (!(least > (uniaxial ? -1e-6 : -1e-3) * most))
            fail_msg("way %d: the gain has given back %.3g of what it took", way, -least / most);
    }
    sf_foam_free(&foam);
}

/* A vibration beside a slow compression takes energy and leaves the mean rate alone. */
static void vibration_does_not_raise_the_filtered_rate(void **state) {
    (void)state;
    const double dt = 1e-7, slow = 20, amplitude = 1e-4, omega = 2 * M_PI / 5e-6; /* 126 /s to and fro */
    sf_foam foam;
    sf_law_batch batch;
    double f[9];
    make_foam(0.05, 1, 0, &foam);
    foam_reset(&batch);
    for (int n = 1; n <= 20000; n++) {
        foam_uniaxial(1 - slow * n * dt - amplitude * sin(omega * n * dt), f);
        foam_step(&foam, dt, f, &batch);
    }
    assert_relative(batch.history[SF_FOAM_RATE][0], slow, 0.1);
    sf_foam_free(&foam);
}

/* Curves that are the multiples 1 + c k at the reference times 10^k are the same law: stress, work and
 * filtered rate, in any motion; the tensile directions have no gain in either. */
static void curves_that_are_multiples_are_the_same_law(void **state) {
    (void)state;
    static point_card card;
    sf_foam factor, family;
    uint64_t seed = 3;
    make_foam(0.1, 1, 1e6, &factor);
    point_card_init(&card);
    for (int k = 0; k < 3; k++)
        point_card_add_eva(&card, REFERENCE * pow(10, k), 60, 0.8, 1 + FACTOR * k);
    card.card.shared.hysteresis_hu = 0.1;
    card.card.shared.maxwell_modulus = 1e6;
    card.card.shared.maxwell_rate = 5000;
    foam_build(&card, &family);
    for (int trial = 0; trial < 500; trial++) {
        double old[9], f[9];
        sf_law_batch a, b;
        point_deformation(&seed, 0.3, 1.2, old);
        for (int k = 0; k < 9; k++)
            f[k] = old[k] + point_random(&seed, -50, 50) * 1e-6;
        foam_reset(&a);
        foam_step(&factor, 0, old, &a);
        for (int l = 0; l < SF_LANES; l++)
            a.history[SF_FOAM_RATE][l] = point_random(&seed, 0, 90);
        b = a;
        foam_step(&factor, 1e-6, f, &a);
        foam_step(&family, 1e-6, f, &b);
        for (int l = 0; l < SF_LANES; l++) {
            double p[2][9];
            foam_get(a.p, l, p[0]);
            foam_get(b.p, l, p[1]);
            assert_true(point_distance(9, p[0], p[1]) < 1e-9 * point_norm(9, p[1]));
            assert_close(a.work[l], b.work[l], 1e-9 * point_norm(9, p[1]) * 1e-4);
            assert_true(a.history[SF_FOAM_RATE][l] == b.history[SF_FOAM_RATE][l]);
            assert_true(a.stored[l] == b.stored[l] && a.lost[l] == b.lost[l]);
        }
    }
    sf_foam_free(&factor);
    sf_foam_free(&family);
}

static void update(const void *numbers, double dt, sf_law_batch *batch) {
    sf_foam_update(numbers, dt, batch);
}

static void bounds_cover_the_numerical_tangent(void **state) {
    (void)state;
    uint64_t seed = 12;
    for (int variant = 0; variant < 4; variant++) {
        sf_foam foam;
        make_foam(variant ? 0.02 : 1, 1, variant == 2 ? 3e6 : 0, &foam);
        foam.modulus = variant == 3 ? 1e4 : foam.modulus;
        const point_law law = {
            .update = update, .numbers = &foam, .maxwell = foam.options.maxwell, .away = true};
        for (int trial = 0; trial < 1000; trial++)
            point_law_assert_bounds(&law, &seed, 0.2, 1.2, 1e-6);
        sf_foam_free(&foam);
    }
}

static void both_kinds_of_rate_are_refused(void **state) {
    (void)state;
    static point_card card;
    sf_error err = SF_ERROR_INIT;
    point_card_init(&card);
    point_card_add_eva(&card, 1, 60, 0.8, 1);
    point_card_add_eva(&card, 100, 60, 0.8, 1.5);
    card.card.shared.maxwell_rate = 5000;
    sf_material m = sf_foam_material(&card.card);
    assert_int_equal(sf_material_check(&m, 0, &err), SF_OK);
    card.card.shared.rate_factor = 0.1;
    card.card.shared.rate_reference = 1;
    assert_int_equal(sf_material_check(&m, 0, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "rate_factor is 0.1 and there are 2 curves"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loading_at_a_constant_rate_is_the_closed_form),
        cmocka_unit_test(unloading_acts_on_the_curve_alone),
        cmocka_unit_test(work_closes_the_balance_and_dissipates),
        cmocka_unit_test(no_way_gets_energy_from_the_gain),
        cmocka_unit_test(vibration_does_not_raise_the_filtered_rate),
        cmocka_unit_test(curves_that_are_multiples_are_the_same_law),
        cmocka_unit_test(bounds_cover_the_numerical_tangent),
        cmocka_unit_test(both_kinds_of_rate_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
