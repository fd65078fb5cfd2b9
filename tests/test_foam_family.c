/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loading curves at several strain rates. */
#include "material/low_density_foam.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "foam_fixture.h"
#include "post_check.h"

static const double RATES[3] = {1, 30, 200}, FACTORS[3] = {1, 1.4, 1.9}; /* s-1; stress against the slowest */

static void make_family(sf_foam *foam) {
    static point_card card;
    point_card_init(&card);
    for (int k = 0; k < 3; k++)
        point_card_add_eva(&card, RATES[k], 60, 0.8, FACTORS[k]);
    foam_build(&card, foam);
}

/* Uniaxial compression at a constant rate to a strain of 0.6: nominal stress, compression positive, against
 * the slowest curve. */
static double stress_ratio(const sf_foam *foam, double rate) {
    sf_law_batch batch;
    double f[9], stress, slope, energy, dt = 1e-4 / rate;
    foam_reset(&batch);
    for (int k = 1; k <= 6000; k++) {
        foam_uniaxial(1 - 1e-4 * k, f);
        foam_step(foam, dt, f, &batch);
    }
    sf_curve_evaluate(&foam->curve[0], 0.6, &stress, &slope, &energy);
    assert_relative(batch.history[SF_FOAM_RATE][0], rate, 2e-4);
    return -batch.p[0][0] / stress;
}

static void sustained_rate_gives_the_curve_of_that_rate(void **state) {
    (void)state;
    sf_foam foam;
    make_family(&foam);
    foam.options.filter_time = 1e-5; /* far below the time of the fastest compression */
    assert_close(stress_ratio(&foam, 1), 1, 1e-4);
    assert_close(stress_ratio(&foam, 30), 1.4, 1e-4);
    assert_close(stress_ratio(&foam, 200), 1.9, 1e-4);
    assert_close(stress_ratio(&foam, sqrt(30)), 1.2, 1e-4); /* halfway in the logarithm */
    assert_close(stress_ratio(&foam, sqrt(30 * 200)), 1.65, 1e-4);
    assert_close(stress_ratio(&foam, 1000), 1.9, 1e-9); /* faster than all data: the fastest curve */
    assert_close(stress_ratio(&foam, 0.5), 1, 1e-9);    /* slower: the slowest */
    sf_foam_free(&foam);
}

/* The rate passes a low pass of time tau: after a stop the overstress fades with ln of exp(-t / tau). */
static void overstress_fades_after_a_stop(void **state) {
    (void)state;
    sf_foam foam;
    sf_law_batch batch;
    double f[9], stress, slope, energy, tau = 1e-4;
    make_family(&foam);
    foam_reset(&batch);
    for (int k = 1; k <= 5000; k++) {
        foam_uniaxial(1 - 1e-4 * k, f);
        foam_step(&foam, 1e-6, f, &batch); /* 100 s-1 */
    }
    double start = batch.history[SF_FOAM_RATE][0];
    sf_curve_evaluate(&foam.curve[0], 0.5, &stress, &slope, &energy);
    for (int k = 1; k <= 60; k++) {
        foam_step(&foam, 1e-5, f, &batch);
        double rate = start * exp(-k * 1e-5 / tau);
        double ratio = rate > 30  ? 1.4 + 0.5 * log(rate / 30) / log(200.0 / 30)
                       : rate > 1 ? 1 + 0.4 * log(rate) / log(30)
                                  : 1;
        assert_relative(batch.history[SF_FOAM_RATE][0], rate, 1e-9);
        assert_relative(-batch.p[0][0] / stress, ratio, 1e-9);
        assert_close(batch.work[0], 0, 0);
    }
    sf_foam_free(&foam);
}

/* The overstress's work is what the total work exceeds the energy of the slowest curve by. */
static void overstress_work_closes_the_balance(void **state) {
    (void)state;
    sf_foam foam;
    sf_law_batch batch;
    double f[9], viscous = 0, total = 0, old = 0, dt = 1e-6;
    make_family(&foam);
    foam_reset(&batch);
    for (int k = 1; k <= 6000; k++) {
        foam_uniaxial(1 - 1e-4 * k, f);
        foam_step(&foam, dt, f, &batch);
        total += 0.5 * (batch.p[0][0] + old) * -1e-4;
        old = batch.p[0][0];
        viscous += batch.work[0];
    }
    assert_relative(viscous, total - batch.energy[0], 1e-3); /* first order in the step */
    assert_true(viscous > 0.4 * batch.energy[0]);
    sf_foam_free(&foam);
}

/* From rest, and from a compressed state on the way back. */
static void extension_has_no_overstress(void **state) {
    (void)state;
    sf_foam foam;
    make_family(&foam);
    for (int compressed = 0; compressed < 2; compressed++) {
        sf_law_batch batch;
        double f[9], start = compressed ? 0.5 : 1;
        foam_reset(&batch);
        foam_uniaxial(start, f);
        foam_step(&foam, 0, f, &batch);
        for (int k = 1; k <= 1000; k++) {
            foam_uniaxial(start + 1e-4 * k, f);
            foam_step(&foam, 1e-6, f, &batch);
            assert_true(batch.history[SF_FOAM_RATE][0] <= 0);
            assert_close(batch.work[0], 0, 0);
        }
        foam_point elastic = foam_elastic(&foam, f, 0);
        assert_close(batch.p[0][0], elastic.p[0], 0);
    }
    sf_foam_free(&foam);
}

/* A fast, slightly compressed direction beside directions at rest, in a foam that is soft in tension: the
 * shear modulus between them, the secant of curve and overstress together, is above all slopes. */
static void tangent_bounds_shear_between_fast_and_resting_directions(void **state) {
    (void)state;
    sf_foam foam;
    make_family(&foam);
    foam.modulus = 1e4;
    for (double strain = 0.05; strain < 0.15; strain += 0.02) {
        sf_law_batch batch;
        double old[9], f[9], tangent[81], dt = 1e-6;
        foam_reset(&batch);
        foam_uniaxial(1 - strain, f);
        f[4] = f[8] = 1.001;
        memcpy(old, f, sizeof old);
        old[0] += 1000 * dt;
        foam_set(batch.f_old, 0, old);
        foam_set(batch.f, 0, f);
        batch.history[SF_FOAM_RATE][0] = 1000;
        sf_law_batch after = batch;
        sf_foam_update(&foam, dt, &after);
        foam_tangent(&foam, dt, &batch, tangent);
        double stress, slope, energy, largest = point_largest_eigenvalue(9, tangent);
        sf_curve_evaluate(&foam.curve[2], strain, &stress, &slope, &energy);
        double shear = (stress + foam.modulus * 1e-3) / (strain + 1e-3);
        assert_relative(largest, shear, 1e-6);
        foam_assert_bounds(&after, tangent);
    }
    sf_foam_free(&foam);
}

static void tangent_bounds_overstress_too(void **state) {
    (void)state;
    sf_foam foam;
    uint64_t seed = 12;
    make_family(&foam);
    for (int trial = 0; trial < 2000; trial++)
        foam_assert_tangent_bounds(&foam, &seed, 1e-6);
    sf_foam_free(&foam);
}

static void bad_curve_of_a_family_is_refused(void **state) {
    (void)state;
    static point_card card;
    sf_error err = SF_ERROR_INIT;
    sf_foam foam;
    point_card_init(&card);
    point_card_add_eva(&card, 1, 60, 0.8, 1);
    point_card_add_eva(&card, 100, 60, 0.6, 1.5);
    card.card.densification_start = 0.7; /* beyond the data of the second curve only */
    assert_int_equal(sf_foam_build(&card.card, &foam, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "strain 0.7"));
    assert_null(foam.curve);
    assert_null(foam.curve_rate);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sustained_rate_gives_the_curve_of_that_rate),
        cmocka_unit_test(overstress_fades_after_a_stop),
        cmocka_unit_test(overstress_work_closes_the_balance),
        cmocka_unit_test(extension_has_no_overstress),
        cmocka_unit_test(tangent_bounds_shear_between_fast_and_resting_directions),
        cmocka_unit_test(tangent_bounds_overstress_too),
        cmocka_unit_test(bad_curve_of_a_family_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
