/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predictions by a Gaussian process, against formulas. */
#include "study/column.h"
#include <gsl/gsl_rng.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <cmocka.h>

enum { INPUTS = 3, POINTS = 60 };
static const bool words[INPUTS] = {false, false, true};

/* A smooth function of two numbers, with another phase and size for each of three words. */
static double function(const double *x, double phase) {
    return (1 + 0.2 * x[2]) * sin(3 * x[0] + phase) + x[1] * x[1] + 0.5 * x[0] * x[1] + 0.3 * x[2];
}

static void draw_point(gsl_rng *random, double *x) {
    x[0] = gsl_rng_uniform(random);
    x[1] = gsl_rng_uniform(random);
    x[2] = (double)gsl_rng_uniform_int(random, 3);
}

static void fit(gsl_rng *random, double phase, double scatter, double *x, double *y, sf_predictor *p) {
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < POINTS; k++) {
        draw_point(random, x + k * INPUTS);
        y[k] = function(x + k * INPUTS, phase) + scatter * (gsl_rng_uniform(random) - 0.5);
    }
    if (sf_predictor_fit(INPUTS, words, POINTS, x, y, p, &err) != SF_OK)
        fail_msg("%s", err.text);
}

static void a_process_meets_its_points_and_knows_nothing_far_away(void **state) {
    (void)state;
    double x[POINTS * INPUTS], y[POINTS], room[POINTS], mean, deviation, far[INPUTS] = {1e4, 1e4, 7};
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    sf_predictor p;
    fit(random, 0.3, 0, x, y, &p);
    for (int k = 0; k < POINTS; k++) {
        sf_predictor_at(&p, x + k * INPUTS, room, &mean, &deviation);
        assert_true(fabs(mean - y[k]) < 1e-3);
    }
    sf_predictor_at(&p, far, room, &mean, &deviation);
    assert_true(fabs(mean - p.mean) < 1e-9);
    assert_true(deviation >= p.calibration * p.deviation);
    sf_predictor_free(&p);
    gsl_rng_free(random);
}

static void an_input_without_influence_gets_a_long_length(void **state) {
    (void)state;
    const bool numbers[2] = {false, false};
    double x[2 * POINTS], y[POINTS];
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    sf_error err = SF_ERROR_INIT;
    sf_predictor p;
    for (int k = 0; k < POINTS; k++) {
        x[2 * k] = gsl_rng_uniform(random);
        x[2 * k + 1] = gsl_rng_uniform(random);
        y[k] = sin(6 * x[2 * k]);
    }
    assert_int_equal(sf_predictor_fit(2, numbers, POINTS, x, y, &p, &err), SF_OK);
    assert_true(p.length[1] > 10 * p.length[0]);
    assert_true(p.nugget < 1e-3);
    sf_predictor_free(&p);
    gsl_rng_free(random);
}

/* Over 40 functions, with and without scatter: the 95 % intervals hold 93 to 99.5 % of 8000 other points. */
static void intervals_hold_what_they_say(void **state) {
    (void)state;
    double x[POINTS * INPUTS], y[POINTS], room[POINTS], mean, deviation, at[INPUTS];
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    for (int scattered = 0; scattered < 2; scattered++) {
        int held = 0, all = 0;
        for (int trial = 0; trial < 40; trial++) {
            double phase = 6 * gsl_rng_uniform(random), scatter = scattered ? 0.05 : 0;
            sf_predictor p;
            fit(random, phase, scatter, x, y, &p);
            for (int k = 0; k < 100; k++, all++) {
                draw_point(random, at);
                sf_predictor_at(&p, at, room, &mean, &deviation);
                double value = function(at, phase) + scatter * (gsl_rng_uniform(random) - 0.5);
                held += fabs(mean - value) <= SF_PREDICTOR_SIDES * deviation;
            }
            sf_predictor_free(&p);
        }
        printf("intervals of 95 %%%s hold %.1f %%\n", scattered ? " with scatter" : "", 100. * held / all);
        assert_in_range(held, 0.93 * all, 0.995 * all);
    }
    gsl_rng_free(random);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_process_meets_its_points_and_knows_nothing_far_away),
        cmocka_unit_test(an_input_without_influence_gets_a_long_length),
        cmocka_unit_test(intervals_hold_what_they_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
