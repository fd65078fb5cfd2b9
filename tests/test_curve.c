/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/curve.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "point_fixture.h"
#include "post_check.h"

static sf_curve built(const point_card *card) {
    sf_error err = SF_ERROR_INIT;
    sf_curve curve;
    if (sf_curve_build(&card->card, card->card.curves.curve_count - 1, &curve, &err) != SF_OK)
        fail_msg("%s", err.text);
    return curve;
}

static double stress_at(const sf_curve *curve, double strain) {
    double stress, slope, energy;
    sf_curve_evaluate(curve, strain, &stress, &slope, &energy);
    return stress;
}

static double slope_at(const sf_curve *curve, double strain) {
    double stress, slope, energy;
    sf_curve_evaluate(curve, strain, &stress, &slope, &energy);
    return slope;
}

static double energy_at(const sf_curve *curve, double strain) {
    double stress, slope, energy;
    sf_curve_evaluate(curve, strain, &stress, &slope, &energy);
    return energy;
}

/* Five-point derivative: exact for quartics, so for every piece of the table. */
static double derivative(double (*f)(const sf_curve *, double), const sf_curve *curve, double x, double h) {
    return (f(curve, x - 2 * h) - 8 * f(curve, x - h) + 8 * f(curve, x + h) - f(curve, x + 2 * h)) / (12 * h);
}

/* Stress and slope just inside the table's end, extrapolated over the last rounding unit. */
static void end_of_table(const sf_curve *curve, double *stress, double *slope) {
    double h = 1e-9 * curve->start, energy;
    sf_curve_evaluate(curve, curve->start - h, stress, slope, &energy);
    *stress += *slope * h;
}

static void passes_through_data_on_the_table(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 17, 0.8, 1); /* 16 intervals: the data fall on ends of pieces */
    sf_curve curve = built(&card);
    for (int k = 0; k < 17; k++)
        assert_close(stress_at(&curve, card.strain[k]), card.stress[k], 1e-10 * card.stress[16]);
    sf_curve_free(&curve);
}

/* A knot inside a piece is cut by at most step^2 / 16 times the jump of the second derivative there, and that
 * jump is below twice the change of slope over the two intervals beside it. */
static void passes_through_data_off_the_table(void **state) {
    (void)state;
    point_card card;
    const double strain[9] = {0, 0.013, 0.041, 0.13, 0.27, 0.44, 0.59, 0.71, 0.8};
    double stress[9];
    for (int k = 0; k < 9; k++)
        stress[k] = point_eva_stress(strain[k]);
    point_card_init(&card);
    point_card_add(&card, 0, 9, strain, stress);
    sf_curve curve = built(&card);
    for (int k = 1; k < 8; k++) {
        double left = (stress[k] - stress[k - 1]) / (strain[k] - strain[k - 1]);
        double right = (stress[k + 1] - stress[k]) / (strain[k + 1] - strain[k]);
        double jump = 12 * fmax(left, right) / fmin(strain[k] - strain[k - 1], strain[k + 1] - strain[k]);
        assert_close(stress_at(&curve, strain[k]), stress[k], jump * curve.step * curve.step / 16);
        assert_relative(stress_at(&curve, strain[k]), stress[k], 1e-3);
    }
    assert_close(stress_at(&curve, 0), 0, 0);
    assert_close(energy_at(&curve, 0), 0, 0);
    sf_curve_free(&curve);
}

static void smooth_foam_curve_is_reproduced_between_points(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 161, 0.8, 1);
    sf_curve curve = built(&card);
    for (double strain = 0.1; strain < 0.79; strain += 0.007)
        assert_relative(stress_at(&curve, strain), point_eva_stress(strain), 2e-4);
    sf_curve_free(&curve);
}

static void assert_rising(const sf_curve *curve) {
    double last = 0, scale = stress_at(curve, curve->start);
    for (int k = 0; k < 8 * SF_CURVE_INTERVALS; k++) {
        double strain = ((double)k + 0.5) * curve->step / 8, stress = stress_at(curve, strain);
        if (!(stress >= last - 1e-12 * scale))
            fail_msg("the stress falls from %.9g to %.9g Pa at strain %.6g", last, stress, strain);
        last = stress;
    }
}

/* Random rising data with flat stretches and jumps; few points, and more points than pieces. */
static void rising_data_give_a_rising_curve(void **state) {
    (void)state;
    uint64_t seed = 1;
    const int64_t counts[4] = {6, 40, 700, 6000};
    for (int trial = 0; trial < 60; trial++) {
        static point_card card;
        static double strain[POINT_CURVE_ROOM], stress[POINT_CURVE_ROOM];
        int64_t count = counts[trial % 4];
        for (int64_t k = 1; k < count; k++) {
            strain[k] = 0.85 * ((double)k + point_random(&seed, -0.4, 0.4)) / (double)count;
            double rise = point_random(&seed, -1, 1);
            stress[k] = stress[k - 1] + (k + 1 == count || rise > 0.9 ? 1e5 : rise > 0 ? 1e3 * rise : 0);
        }
        point_card_init(&card);
        point_card_add(&card, 0, count, strain, stress);
        sf_curve curve = built(&card);
        assert_rising(&curve);
        sf_curve_free(&curve);
    }
}

static void slope_is_derivative_of_stress_and_stress_of_energy(void **state) {
    (void)state;
    for (int exponent = 0; exponent < 3; exponent++) {
        point_card card;
        point_card_init(&card);
        point_card_add_eva(&card, 0, 30, 0.8, 1);
        card.card.densification_exponent = 1.5 * exponent;
        sf_curve curve = built(&card);
        for (int k = 0; k < SF_CURVE_INTERVALS; k++) {
            double strain = ((double)k + 0.5) * curve.step, h = curve.step / 5;
            assert_relative(derivative(energy_at, &curve, strain, h), stress_at(&curve, strain), 1e-8);
            assert_close(derivative(stress_at, &curve, strain, h), slope_at(&curve, strain),
                         1e-8 * slope_at(&curve, 0.75));
        }
        for (double left = 0.19; 1 - left < curve.straight.start; left *= 0.8) {
            double strain = 1 - left, h = 1e-4 * left;
            assert_relative(derivative(energy_at, &curve, strain, h), stress_at(&curve, strain), 1e-8);
            assert_relative(derivative(stress_at, &curve, strain, h), slope_at(&curve, strain), 1e-8);
        }
        sf_curve_free(&curve);
    }
}

static void energy_stress_and_slope_have_no_jump_anywhere(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 25, 0.8, 1);
    card.card.densification_start = 0.77;
    card.card.densification_exponent = 2.2;
    sf_curve curve = built(&card);
    assert_close(curve.start, 0.77, 0);
    for (int k = 1; k <= SF_CURVE_INTERVALS; k++) {
        double strain = k < SF_CURVE_INTERVALS ? k * curve.step : curve.start, h = 1e-11;
        double slope = slope_at(&curve, strain), stress = stress_at(&curve, strain);
        assert_close(energy_at(&curve, strain + h) - energy_at(&curve, strain - h), 2 * h * stress, 1e-9);
        assert_close(stress_at(&curve, strain + h) - stress_at(&curve, strain - h), 2 * h * slope, 1e-7);
        assert_relative(slope_at(&curve, strain + h), slope_at(&curve, strain - h), 1e-7);
    }
    sf_curve_free(&curve);
}

static void rule_h1_without_exponent_is_a_pure_power(void **state) {
    (void)state;
    const double start[3] = {0, 0.5, 0.7};
    for (int k = 0; k < 3; k++) {
        point_card card;
        point_card_init(&card);
        point_card_add_eva(&card, 0, 33, 0.8, 1);
        card.card.densification_start = start[k];
        sf_curve curve = built(&card);
        double e = start[k] > 0 ? start[k] : 0.8, stress, slope;
        assert_close(curve.start, e, 0);
        end_of_table(&curve, &stress, &slope);
        double n = (1 - e) * slope / stress;
        assert_relative(curve.beyond.exponent, n, 1e-6);
        assert_close(curve.beyond.constant, 0, 1e-9 * stress);
        for (double strain = e; strain < curve.straight.start; strain += 0.01)
            assert_relative(stress_at(&curve, strain), stress * pow((1 - e) / (1 - strain), n), 1e-5);
        sf_curve_free(&curve);
    }
}

/* sigma = A + B / (eps_L - eps)^m with A and B from the stress and slope at the start. */
static void assert_power_law(double limit, double exponent) {
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 33, 0.8, 1);
    card.card.densification_limit = limit;
    card.card.densification_exponent = exponent;
    sf_curve curve = built(&card);
    double stress, slope, room = limit - 0.8;
    end_of_table(&curve, &stress, &slope);
    double b = slope * pow(room, exponent + 1) / exponent, a = stress - b / pow(room, exponent);
    double energy = energy_at(&curve, 0.8);
    for (double left = 0.999 * room; limit - left < curve.straight.start; left *= 0.9) {
        double x = limit - left,
               singular = exponent == 1
                              ? b * log(room / left)
                              : b * (pow(left, 1 - exponent) - pow(room, 1 - exponent)) / (exponent - 1);
        assert_relative(stress_at(&curve, x), a + b / pow(left, exponent), 1e-5);
        assert_relative(slope_at(&curve, x), exponent * b / pow(left, exponent + 1), 1e-5);
        assert_relative(energy_at(&curve, x), energy + a * (x - 0.8) + singular, 1e-5);
    }
    sf_curve_free(&curve);
}

static void user_exponent_and_rule_h2_follow_their_power_law(void **state) {
    (void)state;
    assert_power_law(1, 3);
    assert_power_law(1, 0.5);
    assert_power_law(1, 1);
    assert_power_law(0.95, 1);
    assert_power_law(0.95, 2.5);
}

static void energy_is_continuous_in_the_exponent_at_one(void **state) {
    (void)state;
    double energy[3];
    for (int k = 0; k < 3; k++) {
        point_card card;
        point_card_init(&card);
        point_card_add_eva(&card, 0, 33, 0.8, 1);
        card.card.densification_exponent = 1 + 3e-9 * (k - 1);
        sf_curve curve = built(&card);
        energy[k] = energy_at(&curve, 0.98);
        sf_curve_free(&curve);
    }
    assert_relative(energy[0], energy[1], 1e-6);
    assert_relative(energy[2], energy[1], 1e-6);
}

static void straight_line_has_its_modulus_and_energy(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_line(&card, 2e5, 0.7);
    sf_curve curve = built(&card);
    for (double strain = 0.001; strain < 0.7; strain += 0.0173) {
        assert_relative(stress_at(&curve, strain), 2e5 * strain, 1e-11);
        assert_relative(slope_at(&curve, strain), 2e5, 1e-10);
        assert_relative(energy_at(&curve, strain), 1e5 * strain * strain, 1e-10);
    }
    sf_curve_free(&curve);
}

/* Before the pole the curve becomes a straight line: where 5 % of the way to it is left, or the slope is 1000
 * times that at the start; with the pole at 1 at 1 % or a million times. A point that a step throws beyond
 * the pole has a finite stress. */
static void finite_at_any_strain_and_straight_near_the_pole(void **state) {
    (void)state;
    const double limit[4] = {1, 1, 0.9, 0.9}, exponent[4] = {0, 40, 2, 0.5};
    for (int k = 0; k < 4; k++) {
        point_card card;
        point_card_init(&card);
        point_card_add_eva(&card, 0, 33, 0.8, 1);
        card.card.densification_limit = limit[k];
        card.card.densification_exponent = exponent[k];
        sf_curve curve = built(&card);
        double at = curve.straight.start, steep = slope_at(&curve, at), room = limit[k] - 0.8,
               h = 1e-9 * room;
        assert_true(at > 0.8 && at < limit[k]);
        double least = k < 2 ? 0.01 : 0.05, most = k < 2 ? 1e6 : 1e3;
        assert_relative(fmax(steep / slope_at(&curve, 0.8) / most, least * room / (limit[k] - at)), 1, 1e-6);
        assert_relative(slope_at(&curve, at - h), steep, 1e-5);
        assert_relative(stress_at(&curve, at - h) + h * steep, stress_at(&curve, at), 1e-9);
        for (double strain = at; strain < 1.6; strain += 0.013) {
            double past = strain - at, stress = stress_at(&curve, at);
            assert_relative(stress_at(&curve, strain), stress + steep * past, 1e-12);
            assert_relative(slope_at(&curve, strain), steep, 1e-12);
            assert_relative(energy_at(&curve, strain),
                            energy_at(&curve, at) + past * (stress + 0.5 * steep * past), 1e-12);
        }
        sf_curve_free(&curve);
    }
}

/* A curve whose law takes little energy on the way to full compression ends in a stop: it takes 5 MJ/m3, that
 * of a solid polymer, begins where the law has its value and slope, and rises ever more steeply. */
static void a_weak_law_is_stopped_before_full_compression(void **state) {
    (void)state;
    static const struct {
        double end, limit, exponent;
    } weak[] = {{0.5, 1, 0.4}, {0.5, 1, 1}, {0.9, 1, 0.4}, {0.99, 1, 1}, {0.5, 0.999, 0.3}};
    for (size_t k = 0; k < sizeof weak / sizeof weak[0]; k++) {
        point_card card;
        point_card_init(&card);
        point_card_add_line(&card, 24e3, weak[k].end);
        card.card.densification_rule = weak[k].limit < 1 ? SF_DENSIFICATION_H2 : SF_DENSIFICATION_H1;
        card.card.densification_limit = weak[k].limit;
        card.card.densification_exponent = weak[k].exponent;
        sf_curve curve = built(&card);
        double at = curve.straight.start, h = 1e-7, before = 0;
        assert_true(at >= weak[k].end && at < 0.991 && curve.straight.stop > 0);
        assert_relative(energy_at(&curve, 1), 5e6, 1e-9);
        assert_relative(stress_at(&curve, at + h), stress_at(&curve, at - h), 1e-3);
        assert_relative(slope_at(&curve, at + 1e-12), slope_at(&curve, at - 1e-12), 0.05);
        for (double strain = at; strain < 1.1; strain += 0.001) {
            assert_true(slope_at(&curve, strain) >= before);
            before = slope_at(&curve, strain);
            assert_relative(energy_at(&curve, strain + h) - energy_at(&curve, strain - h),
                            2 * h * stress_at(&curve, strain), 1e-5);
            if (strain > at)
                assert_relative(stress_at(&curve, strain + h) - stress_at(&curve, strain - h), 2 * h * before,
                                1e-5);
        }
        sf_curve_free(&curve);
    }
}

/* That of the examples takes more by itself, and is left as it is. */
static void a_strong_law_has_no_stop(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 120, 0.975, 1);
    sf_curve curve = built(&card);
    assert_true(curve.straight.stop == 0);
    sf_curve_free(&curve);
}

/* All lanes as one by one, on all parts of the curve. */
static void lanes_are_finite_beyond_the_pole(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 33, 0.8, 1);
    card.card.densification_limit = 0.9;
    card.card.densification_exponent = 0.7;
    sf_curve curve = built(&card);
    double strain[SF_LANES], stress[SF_LANES], slope[SF_LANES], energy[SF_LANES];
    for (int l = 0; l < SF_LANES; l++)
        strain[l] = 0.75 + 0.03 * l;
    sf_curve_evaluate_lanes(&curve, strain, stress, slope, energy);
    for (int l = 0; l < SF_LANES; l++) {
        assert_true(isfinite(stress[l]) && isfinite(slope[l]) && isfinite(energy[l]));
        assert_relative(stress[l], stress_at(&curve, strain[l]), 1e-12);
        assert_relative(slope[l], slope_at(&curve, strain[l]), 1e-12);
        assert_relative(energy[l], energy_at(&curve, strain[l]), 1e-12);
    }
    sf_curve_free(&curve);
}

static void each_curve_of_a_family_is_built_from_its_own_points(void **state) {
    (void)state;
    point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 1, 17, 0.8, 1);
    point_card_add_eva(&card, 100, 33, 0.6, 1.7);
    sf_error err = SF_ERROR_INIT;
    sf_curve slow, fast;
    assert_int_equal(sf_curve_build(&card.card, 0, &slow, &err), SF_OK);
    assert_int_equal(sf_curve_build(&card.card, 1, &fast, &err), SF_OK);
    assert_close(slow.start, 0.8, 0);
    assert_close(fast.start, 0.6, 0);
    assert_relative(stress_at(&slow, 0.3), point_eva_stress(0.3), 1e-10);
    assert_relative(stress_at(&fast, 0.3), 1.7 * point_eva_stress(0.3), 1e-10);
    sf_curve_free(&slow);
    sf_curve_free(&fast);
}

static void assert_refused(const point_card *card, sf_status status, const char *part, const char *other) {
    sf_error err = SF_ERROR_INIT;
    sf_curve curve;
    assert_int_equal(sf_curve_build(&card->card, 0, &curve, &err), status);
    assert_null(curve.piece);
    if (!strstr(err.text, part) || !strstr(err.text, other))
        fail_msg("\"%s\" does not hold \"%s\" and \"%s\"", err.text, part, other);
}

static void bad_cards_are_refused_with_a_sentence(void **state) {
    (void)state;
    static point_card card;
    point_card_init(&card);
    point_card_add_eva(&card, 0, 33, 0.8, 1);
    card.card.densification_start = 0.83;
    assert_refused(&card, SF_ERR_INPUT, "starts at strain 0.83", "ends at 0.8");
    card.card.densification_start = 0.75;
    card.card.densification_limit = 0.75;
    assert_refused(&card, SF_ERR_INPUT, "limit 0.75", "not beyond its start 0.75");

    const double strain[5] = {0, 0.2, 0.4, 0.6, 0.8}, flat[5] = {0, 1e4, 2e4, 3e4, 3e4};
    point_card_init(&card);
    point_card_add(&card, 0, 5, strain, flat);
    assert_refused(&card, SF_ERR_INPUT, "flat", "strain 0.8");
    card.card.densification_start = 0.5; /* before the flat part */
    sf_error err = SF_ERROR_INIT;
    sf_curve curve;
    assert_int_equal(sf_curve_build(&card.card, 0, &curve, &err), SF_OK);
    sf_curve_free(&curve);

    const double back[5] = {0, 0.2, 0.2, 0.6, 0.8}, rising[5] = {0, 1e4, 2e4, 3e4, 4e4};
    point_card_init(&card);
    point_card_add(&card, 0, 5, back, rising);
    assert_refused(&card, SF_ERR_INPUT, "curve 0", "0.2 after 0.2");
    point_card_init(&card);
    point_card_add(&card, 0, 2, strain, rising); /* two points are too few for the interpolant */
    assert_refused(&card, SF_ERR_INPUT, "curve 0", "2 points");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(passes_through_data_on_the_table),
        cmocka_unit_test(passes_through_data_off_the_table),
        cmocka_unit_test(smooth_foam_curve_is_reproduced_between_points),
        cmocka_unit_test(rising_data_give_a_rising_curve),
        cmocka_unit_test(slope_is_derivative_of_stress_and_stress_of_energy),
        cmocka_unit_test(energy_stress_and_slope_have_no_jump_anywhere),
        cmocka_unit_test(rule_h1_without_exponent_is_a_pure_power),
        cmocka_unit_test(user_exponent_and_rule_h2_follow_their_power_law),
        cmocka_unit_test(energy_is_continuous_in_the_exponent_at_one),
        cmocka_unit_test(straight_line_has_its_modulus_and_energy),
        cmocka_unit_test(finite_at_any_strain_and_straight_near_the_pole),
        cmocka_unit_test(a_weak_law_is_stopped_before_full_compression),
        cmocka_unit_test(a_strong_law_has_no_stop),
        cmocka_unit_test(lanes_are_finite_beyond_the_pole),
        cmocka_unit_test(each_curve_of_a_family_is_built_from_its_own_points),
        cmocka_unit_test(bad_cards_are_refused_with_a_sentence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
