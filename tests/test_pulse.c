/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HIC of single pulses against the global search. */
#include "study/column.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { POINTS = 1500 };
static const double DURATION = 0.03, PI = 3.14159265358979323846;

static double half_sine(double x) {
    return 100 * sin(PI * x);
}

static double late_peak(double x) {
    return 800 * x * x * x * (1 - x) + (x < 0.1 ? 3 * sin(60 * PI * x) : 0);
}

static double triangle(double x) {
    return x < 0.3 ? 300 * x : 90 * (1 - x) / 0.7;
}

/* Not single: the search takes it. */
static double two_humps(double x) {
    return 60 * fabs(sin(2 * PI * x)) * (x < 0.5 ? 1 : 1.5);
}

/* Its best level is 3/5 of the mean and close to the foot. */
static double plateau(double x) {
    return 20 * fmin(1, fmin(40 * x, 40 * (1 - x))) + 180 * exp(-pow((x - 0.5) / 0.004, 2));
}

static void test_pulses(void **state) {
    (void)state;
    double (*const shape[])(double) = {half_sine, late_peak, triangle, two_humps, plateau};
    sf_error err = SF_ERROR_INIT;
    for (int s = 0; s < 5; s++) {
        sf_series a = {0};
        sf_hic exact, fast;
        assert_int_equal(sf_series_create(POINTS, &a, &err), SF_OK);
        a.count = POINTS;
        for (int k = 0; k < POINTS; k++) {
            a.time[k] = DURATION * k / (POINTS - 1);
            a.value[k] = shape[s]((double)k / (POINTS - 1));
        }
        assert_int_equal(sf_hic_evaluate(&a, INFINITY, &exact, &err), SF_OK);
        assert_int_equal(sf_pulse_hic(&a, &fast, &err), SF_OK);
        assert_true(fabs(fast.value - exact.value) < 1e-7 * exact.value);
        assert_true(fabs(fast.t1 - exact.t1) < 1e-5);
        assert_true(fabs(fast.t2 - exact.t2) < 1e-5);
        sf_series_free(&a);
    }
}

/* No pulse at all: as the search says. */
static void test_nothing(void **state) {
    (void)state;
    sf_series a = {0};
    sf_hic hic;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_series_create(POINTS, &a, &err), SF_OK);
    a.count = POINTS;
    for (int k = 0; k < POINTS; k++)
        a.time[k] = k;
    assert_int_equal(sf_pulse_hic(&a, &hic, &err), SF_OK);
    assert_true(hic.value == 0 && isnan(hic.t1));
    sf_series_free(&a);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_pulses), cmocka_unit_test(test_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
