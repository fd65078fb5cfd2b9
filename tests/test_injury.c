/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "post/figures/injury.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#include "post_check.h"

enum { FINE = 40001 };

typedef double (*pulse)(double x); /* unit pulse over 0 <= x <= 1 */

static double square(double x) {
    (void)x;
    return 1;
}
static double half_sine(double x) {
    return sin(M_PI * x);
}
static double triangle(double x) {
    return 1 - fabs(2 * x - 1);
}
static double parabola(double x) {
    return 4 * x * (1 - x);
}
static double haversine(double x) {
    return sin(M_PI * x) * sin(M_PI * x);
}

static sf_series sampled(pulse shape, double peak, double duration, int64_t count) {
    sf_error err = SF_ERROR_INIT;
    sf_series curve;
    assert_int_equal(sf_series_create(count, &curve, &err), SF_OK);
    for (int64_t i = 0; i < count; i++) {
        double x = (double)i / (double)(count - 1);
        curve.time[i] = 0.01 + x * duration;
        curve.value[i] = peak * shape(x);
    }
    return curve;
}

static sf_hic hic_of(const sf_series *curve, double window) {
    sf_error err = SF_ERROR_INIT;
    sf_hic hic;
    assert_int_equal(sf_hic_evaluate(curve, window, &hic, &err), SF_OK);
    return hic;
}

static void hic_closed_forms_of_pulses(void **state) {
    (void)state;
    const struct {
        pulse shape;
        double coefficient;
        double window; /* of the duration; 0 = not tabulated */
    } cases[5] = {
        {square, 1, 1},
        {half_sine, 0.4146456495, 0.6702296636},
        {triangle, 0.2464006574, 4.0 / 7},
        {parabola, 0.4482619614, 0},
        {haversine, 0.30293885, 0},
    };
    const double peak = 80, duration = 0.025;
    for (int k = 0; k < 5; k++) {
        sf_series curve = sampled(cases[k].shape, peak, duration, FINE);
        sf_hic hic = hic_of(&curve, INFINITY);
        assert_relative(hic.value, cases[k].coefficient * pow(peak, 2.5) * duration, 1e-7);
        assert_close((hic.t1 + hic.t2) / 2, 0.01 + duration / 2, 1e-7);
        if (cases[k].window > 0)
            assert_relative(hic.t2 - hic.t1, cases[k].window * duration, 1e-6);
        sf_series_free(&curve);
    }
}

static void hic_of_a_three_point_triangle_is_exact(void **state) {
    (void)state;
    double time[3] = {0, 0.007, 0.02}, value[3] = {0, 90, 0};
    sf_series curve = {3, time, value};
    sf_hic hic = hic_of(&curve, INFINITY);
    assert_relative(hic.value, 0.2464006574 * pow(90, 2.5) * 0.02, 1e-9); /* skew does not matter */
    assert_relative(hic.t2 - hic.t1, 0.02 * 4 / 7, 1e-9);
}

static void half_sine_100_g_40_ms(void **state) {
    (void)state;
    sf_series curve = sampled(half_sine, 100, 0.04, FINE);
    assert_relative(hic_of(&curve, INFINITY).value, 1658.58, 3e-6); /* as many digits as are tabulated */
    assert_relative(hic_of(&curve, 0.036).value, 1658.58, 3e-6);
    sf_hic hic15 = hic_of(&curve, 0.015);
    assert_relative(hic15.value, 1295.868, 5e-7);
    assert_relative(hic15.t2 - hic15.t1, 0.015, 1e-9);
    sf_series_free(&curve);
}

/* The best window of a half-sine of 60 ms has 40 ms, so that 15 and 36 ms bound it: around the middle the
 * mean over w is 2 T / (pi w) sin(pi w / 2 T) of the peak. */
static void windows_of_15_and_36_ms_bound_a_long_pulse(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_injury injury;
    const double peak = 50, duration = 0.06;
    sf_series curve = sampled(half_sine, peak, duration, FINE);
    assert_int_equal(sf_injury_evaluate(&curve, &injury, &err), SF_OK);
    const sf_hic found[2] = {injury.hic15, injury.hic36};
    const double window[2] = {0.015, 0.036};
    for (int k = 0; k < 2; k++) {
        double half = M_PI * window[k] / (2 * duration), mean = peak * sin(half) / half;
        assert_relative(found[k].value, window[k] * pow(mean, 2.5), 1e-7);
        assert_relative(found[k].t2 - found[k].t1, window[k], 1e-9);
    }
    assert_relative(injury.hic.t2 - injury.hic.t1, 0.6702296636 * duration, 1e-6);
    sf_series_free(&curve);
}

static void optimum_window_has_equal_ends_and_mean_of_five_thirds(void **state) {
    (void)state;
    /* Skew and double-peaked: no symmetry helps. */
    sf_series curve = sampled(half_sine, 70, 0.03, 3001);
    for (int64_t i = 0; i < curve.count; i++) {
        double x = (double)i / 3000;
        curve.value[i] = 300 * x * (1 - x) * (1 - x) + 12 * sin(3 * M_PI * x) * x;
    }
    sf_hic hic = hic_of(&curve, INFINITY);
    double left = sf_series_at(&curve, hic.t1), right = sf_series_at(&curve, hic.t2);
    double mean = pow(hic.value / (hic.t2 - hic.t1), 0.4);
    assert_relative(left, right, 1e-8);
    assert_relative(mean, 5.0 / 3 * left, 1e-8);
    sf_series_free(&curve);
}

/* Every pair of points of a jagged curve, one by one. */
static void hic_search_is_never_below_brute_force(void **state) {
    (void)state;
    enum { POINTS = 600 };
    uint64_t random = 12345;
    for (int round = 0; round < 10; round++) {
        sf_series curve = sampled(half_sine, 50, 0.04, POINTS);
        double integral[POINTS] = {0};
        for (int64_t i = 0; i < POINTS; i++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            curve.value[i] += ((double)(random >> 40) / (1 << 24) - 0.5) * 30 * round;
            if (i > 0)
                integral[i] = integral[i - 1] +
                              (curve.time[i] - curve.time[i - 1]) * (curve.value[i] + curve.value[i - 1]) / 2;
        }
        for (int k = 0; k < 2; k++) {
            double limit = k ? 0.01 : INFINITY, best = 0;
            for (int64_t i = 0; i < POINTS; i++) {
                for (int64_t j = i + 1; j < POINTS && curve.time[j] - curve.time[i] <= limit; j++) {
                    double dt = curve.time[j] - curve.time[i];
                    best = larger(best, dt * pow(fmax(integral[j] - integral[i], 0) / dt, 2.5));
                }
            }
            sf_hic hic = hic_of(&curve, limit);
            assert_true(hic.value >= best * (1 - 1e-9));
            assert_true(hic.value <= best * 1.05); /* moving the ends within one interval gains little */
            assert_true(hic.t2 - hic.t1 <= limit * (1 + 1e-12));
        }
        sf_series_free(&curve);
    }
}

static void hic_of_an_accelerating_curve_is_zero(void **state) {
    (void)state;
    sf_series curve = sampled(half_sine, -10, 0.02, 101);
    sf_hic hic = hic_of(&curve, INFINITY);
    assert_close(hic.value, 0, 0);
    assert_true(isnan(hic.t1) && isnan(hic.t2));
    sf_series_free(&curve);
}

static sf_injury figures_of(const sf_series *curve) {
    sf_error err = SF_ERROR_INIT;
    sf_injury injury;
    assert_int_equal(sf_injury_evaluate(curve, &injury, &err), SF_OK);
    return injury;
}

/* int sin^2.5 over half a period = T/pi * B(7/4, 1/2); a triangle gives T/3.5. */
static void gadd_closed_forms(void **state) {
    (void)state;
    sf_series curve = sampled(half_sine, 60, 0.03, FINE);
    double beta = exp(lgamma(1.75) + lgamma(0.5) - lgamma(2.25));
    assert_relative(figures_of(&curve).gadd, pow(60, 2.5) * 0.03 / M_PI * beta, 1e-8);
    sf_series_free(&curve);
    double time[4] = {0, 0.01, 0.03, 0.05}, value[4] = {0, 60, 0, -60};
    curve = (sf_series){4, time, value};
    assert_relative(figures_of(&curve).gadd, pow(60, 2.5) * 0.03 / 3.5, 1e-12);
    value[0] = value[1] = value[2] = value[3] = 60;
    assert_relative(figures_of(&curve).gadd, pow(60, 2.5) * 0.05, 1e-12);
}

static void clip_of_one_pulse_cuts_3_ms_below_its_top(void **state) {
    (void)state;
    sf_series curve = sampled(half_sine, 100, 0.02, FINE);
    double expected = 100 * cos(M_PI * 1.5 / 20);
    assert_relative(figures_of(&curve).clip_contiguous_g, expected, 1e-7);
    assert_relative(figures_of(&curve).clip_cumulative_g, expected, 1e-7);
    sf_series_free(&curve);
}

static void clip_adds_stretches_only_when_cumulative(void **state) {
    (void)state;
    /* Two equal triangles of 10 ms: 3 ms at a stretch cuts one at 70 %, 1.5 ms of each at 85 %. */
    double time[5] = {0, 0.005, 0.01, 0.015, 0.02}, value[5] = {0, 100, 0, 100, 0};
    sf_series curve = {5, time, value};
    assert_relative(figures_of(&curve).clip_contiguous_g, 70, 1e-9);
    assert_relative(figures_of(&curve).clip_cumulative_g, 85, 1e-9);
    double brief[5] = {0, 0.0005, 0.001, 0.0015, 0.002};
    curve.time = brief;
    assert_true(isnan(figures_of(&curve).clip_contiguous_g));
}

static void evaluation_gathers_the_same_figures(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_injury injury;
    sf_series curve = sampled(half_sine, 100, 0.04, FINE);
    assert_int_equal(sf_injury_evaluate(&curve, &injury, &err), SF_OK);
    assert_relative(injury.a_max_g, 100, 1e-9);
    assert_close(injury.a_max_time, 0.03, 2e-6);
    assert_close(injury.hic.value, hic_of(&curve, INFINITY).value, 0);
    assert_close(injury.hic15.value, hic_of(&curve, 0.015).value, 0);
    assert_close(injury.hic36.value, hic_of(&curve, 0.036).value, 0);
    assert_relative(injury.clip_contiguous_g, 100 * cos(M_PI * 1.5 / 40), 1e-6);
    sf_series_free(&curve);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hic_closed_forms_of_pulses),
        cmocka_unit_test(hic_of_a_three_point_triangle_is_exact),
        cmocka_unit_test(half_sine_100_g_40_ms),
        cmocka_unit_test(windows_of_15_and_36_ms_bound_a_long_pulse),
        cmocka_unit_test(optimum_window_has_equal_ends_and_mean_of_five_thirds),
        cmocka_unit_test(hic_search_is_never_below_brute_force),
        cmocka_unit_test(hic_of_an_accelerating_curve_is_zero),
        cmocka_unit_test(gadd_closed_forms),
        cmocka_unit_test(clip_of_one_pulse_cuts_3_ms_below_its_top),
        cmocka_unit_test(clip_adds_stretches_only_when_cumulative),
        cmocka_unit_test(evaluation_gathers_the_same_figures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
