/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sobol' indices, response surfaces and intervals, by closed forms. */
#include "model_fixture.h"
#include "post_check.h"

#include "study/sweep/analysis.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static double ishigami(const double *x) {
    return sin(x[0]) + 7 * sin(x[1]) * sin(x[1]) + 0.1 * pow(x[2], 4) * sin(x[0]);
}

/* The indices in closed form, of a = 7 and b = 0.1. */
static void assert_indices_of_ishigami(uint64_t seed) {
    enum { N = 1024, D = 3 };
    const double pi = acos(-1), a = 7, b = 0.1, v1 = 0.5 * pow(1 + b * pow(pi, 4) / 5, 2), v2 = a * a / 8,
                 v13 = b * b * pow(pi, 8) * (1.0 / 18 - 1.0 / 50), v = v1 + v2 + v13;
    const double first[D] = {v1 / v, v2 / v, 0}, total[D] = {(v1 + v13) / v, v2 / v, v13 / v};
    double *u = malloc(N * (D + 2) * D * sizeof *u), *y = malloc(N * (D + 2) * sizeof *y);
    sf_index index[D];
    sf_error err = SF_ERROR_INIT;
    long long used = 0;
    sf_sample(SF_SAMPLING_SALTELLI, D, N, seed, u, &err);
    for (int k = 0; k < N * (D + 2); k++) {
        double x[D];
        for (int i = 0; i < D; i++)
            x[i] = pi * (2 * u[k * D + i] - 1);
        y[k] = 1000 + ishigami(x); /* the mean must not matter */
    }
    y[N + 5] = NAN; /* a run that failed takes its sample with it */
    assert_int_equal(sf_indices(D, N, y, 1, index, &used, &err), SF_OK);
    assert_int_equal(used, N - 1);
    for (int i = 0; i < D; i++) {
        assert_true(index[i].first_low <= first[i] && first[i] <= index[i].first_high);
        assert_true(index[i].total_low <= total[i] && total[i] <= index[i].total_high);
        assert_true(index[i].first_high - index[i].first_low < 0.25);
        assert_true(index[i].total_high - index[i].total_low < 0.25);
        assert_close(index[i].first, first[i], 0.03);
        assert_close(index[i].total, total[i], 0.03);
    }
    for (int k = 0; k < N; k++) /* a tenth of the samples, not at random */
        if (y[k] > 1007)
            y[k] = NAN;
    sf_indices(D, N, y, 1, index, &used, &err);
    assert_true(used < N - N / 20 && used > N / 2);
    assert_true(isnan(index[0].first) && isnan(index[2].total_high));
    for (int k = 0; k < N * (D + 2); k++)
        y[k] = 3;
    sf_indices(D, N, y, 1, index, &used, &err);
    assert_true(isnan(index[0].first)); /* nothing varies */
    free(u);
    free(y);
}

/* The sequence, and the sequence moved. */
static void indices_of_ishigami_lie_in_their_intervals(void **state) {
    (void)state;
    assert_indices_of_ishigami(1);
    assert_indices_of_ishigami(7);
}

/* With many samples a factor of 0.97 on an index is far outside the bound. */
static void indices_converge_to_the_closed_form(void **state) {
    enum { N = 16384, D = 2 };
    double *u = malloc(N * (D + 2) * D * sizeof *u), *y = malloc(N * (D + 2) * sizeof *y);
    sf_index index[D];
    sf_error err = SF_ERROR_INIT;
    long long used = 0;
    (void)state;
    sf_sample(SF_SAMPLING_SALTELLI, D, N, 1, u, &err);
    for (int k = 0; k < N * (D + 2); k++) /* variances of x, y and xy: 1/12, 1/12, 1/144 times 1, 4, 36 */
        y[k] = (u[k * D] - 0.5) + 2 * (u[k * D + 1] - 0.5) + 6 * (u[k * D] - 0.5) * (u[k * D + 1] - 0.5);
    assert_int_equal(sf_indices(D, N, y, 1, index, &used, &err), SF_OK);
    assert_close(index[0].first, 1.0 / 8, 0.002);
    assert_close(index[1].first, 4.0 / 8, 0.002);
    assert_close(index[0].total, 4.0 / 8, 0.002);
    assert_close(index[1].total, 7.0 / 8, 0.002);
    free(u);
    free(y);
}

static double quadratic(const double *x) {
    return 3 - 0.5 * x[0] + 0.02 * x[1] + 0.1 * x[0] * x[0] - 0.003 * x[1] * x[1] + 0.04 * x[0] * x[1] +
           5 * x[2];
}

enum { SURFACE_ROWS = 30 };

/* Two numbers and a column of 0 and 1. */
static void fill_surface(double *x, double *y, double noise) {
    uint64_t seed = 3;
    for (int k = 0; k < SURFACE_ROWS; k++) {
        x[3 * k] = 4 + fixture_random(&seed);
        x[3 * k + 1] = 50 + 20 * fixture_random(&seed);
        x[3 * k + 2] = k % 2;
        y[k] = quadratic(x + 3 * k) + noise * fixture_random(&seed);
    }
}

static void a_response_surface_is_exact_for_a_quadratic(void **state) {
    (void)state;
    double x[3 * SURFACE_ROWS], y[SURFACE_ROWS];
    const double elsewhere[3] = {4.3, 61, 1};
    sf_quadratic s;
    sf_error err = SF_ERROR_INIT;
    fill_surface(x, y, 0);
    assert_int_equal(sf_quadratic_fit(2, 1, SURFACE_ROWS, x, y, &s, NULL, &err), SF_OK);
    assert_string_equal(s.problem, "");
    assert_int_equal(s.terms, 7);
    assert_relative(sf_quadratic_at(&s, elsewhere), quadratic(elsewhere), 1e-9);
    assert_true(s.rms < 1e-9 && s.left_out_rms < 1e-9);
    assert_true(s.q2 > 1 - 1e-12);
}

/* Against surfaces that are fitted without each row. */
static void the_error_at_rows_left_out_is_that_of_surfaces_without_them(void **state) {
    (void)state;
    double x[3 * SURFACE_ROWS], y[SURFACE_ROWS], left_out[SURFACE_ROWS], press = 0;
    sf_quadratic whole, part;
    sf_error err = SF_ERROR_INIT;
    fill_surface(x, y, 0.5);
    sf_quadratic_fit(2, 1, SURFACE_ROWS, x, y, &whole, left_out, &err);
    for (int out = 0; out < SURFACE_ROWS; out++) {
        double fewer_x[3 * SURFACE_ROWS], fewer_y[SURFACE_ROWS];
        int n = 0;
        for (int k = 0; k < SURFACE_ROWS; k++)
            if (k != out) {
                memcpy(fewer_x + 3 * n, x + 3 * k, 3 * sizeof *x);
                fewer_y[n++] = y[k];
            }
        sf_quadratic_fit(2, 1, n, fewer_x, fewer_y, &part, NULL, &err);
        double value = sf_quadratic_at(&part, x + 3 * out);
        assert_relative(left_out[out], value, 1e-8);
        press += (y[out] - value) * (y[out] - value) / SURFACE_ROWS;
    }
    assert_relative(whole.left_out_rms, sqrt(press), 1e-8);
    assert_true(whole.left_out_rms > whole.rms);
}

/* Rows of one x are left out together: each row twice, with other noise. */
static void repeated_rows_are_left_out_together(void **state) {
    (void)state;
    double x[6 * SURFACE_ROWS], y[2 * SURFACE_ROWS], left_out[2 * SURFACE_ROWS];
    uint64_t seed = 5;
    sf_quadratic whole, part;
    sf_error err = SF_ERROR_INIT;
    fill_surface(x, y, 0.5);
    memcpy(x + 3 * SURFACE_ROWS, x, 3 * SURFACE_ROWS * sizeof *x);
    for (int k = 0; k < SURFACE_ROWS; k++)
        y[SURFACE_ROWS + k] = y[k] + 0.5 * fixture_random(&seed);
    sf_quadratic_fit(2, 1, 2 * SURFACE_ROWS, x, y, &whole, left_out, &err);
    for (int out = 0; out < SURFACE_ROWS; out++) {
        double fewer_x[6 * SURFACE_ROWS], fewer_y[2 * SURFACE_ROWS];
        int n = 0;
        for (int k = 0; k < 2 * SURFACE_ROWS; k++)
            if (k % SURFACE_ROWS != out) {
                memcpy(fewer_x + 3 * n, x + 3 * k, 3 * sizeof *x);
                fewer_y[n++] = y[k];
            }
        sf_quadratic_fit(2, 1, n, fewer_x, fewer_y, &part, NULL, &err);
        double value = sf_quadratic_at(&part, x + 3 * out);
        assert_relative(left_out[out], value, 1e-8);
        assert_relative(left_out[out + SURFACE_ROWS], value, 1e-8);
    }
}

/* Two places, many rows: a straight line needs both. */
static void a_surface_that_needs_every_place_has_no_known_error(void **state) {
    (void)state;
    double x[SURFACE_ROWS], y[SURFACE_ROWS];
    uint64_t seed = 7;
    sf_quadratic s;
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < SURFACE_ROWS; k++) {
        x[k] = 3 + k % 2;
        y[k] = x[k] + 0.1 * fixture_random(&seed);
    }
    assert_int_equal(sf_quadratic_fit(1, 0, SURFACE_ROWS, x, y, &s, NULL, &err), SF_OK);
    assert_int_equal(s.terms, 2);
    assert_true(isnan(s.left_out_rms) && isnan(s.q2));
    assert_non_null(strstr(s.problem, "its error at runs left out is not known"));
}

static void a_surface_that_the_rows_do_not_determine_says_so(void **state) {
    (void)state;
    double x[3 * SURFACE_ROWS], y[SURFACE_ROWS];
    sf_quadratic s;
    sf_error err = SF_ERROR_INIT;
    fill_surface(x, y, 0);
    assert_int_equal(sf_quadratic_fit(2, 1, 8, x, y, &s, NULL, &err), SF_OK);
    assert_non_null(strstr(s.problem, "7 terms need at least 9 runs"));
    for (int k = 0; k < SURFACE_ROWS; k++)
        x[3 * k + 1] = 10 * x[3 * k];
    assert_int_equal(sf_quadratic_fit(2, 1, SURFACE_ROWS, x, y, &s, NULL, &err), SF_OK);
    assert_non_null(strstr(s.problem, "do not determine"));
}

/* Intervals of Clopper and Pearson: none of ten has the closed form 1 - 0.025^(1/10); three of ten is
 * tabulated. */
static void probabilities_have_the_interval_of_their_counts(void **state) {
    (void)state;
    sf_probability none = {.above = 10}, all = {.below = 10}, some = {.below = 3, .above = 7},
                   unknown = {.below = 3, .above = 6, .unknown = 1};
    sf_probability_judge(&none, INFINITY);
    sf_probability_judge(&all, INFINITY);
    sf_probability_judge(&some, INFINITY);
    sf_probability_judge(&unknown, INFINITY);
    assert_close(none.low, 0, 0);
    assert_close(none.high, 1 - pow(0.025, 0.1), 1e-9);
    assert_close(all.low, pow(0.025, 0.1), 1e-9);
    assert_close(all.high, 1, 0);
    assert_close(some.low, 0.06674, 5e-6);
    assert_close(some.high, 0.65245, 5e-6);
    sf_probability crossed = {.below = 30, .above = 70}; /* ten draws, each with ten others */
    sf_probability_judge(&crossed, 10);
    assert_close(crossed.share, 0.3, 1e-12);
    assert_close(crossed.high, some.high, 1e-12);
    assert_close(unknown.share, 0.3, 1e-12);    /* an unknown one is not shown to be below */
    assert_close(unknown.low, some.low, 1e-12); /* the unknown one above */
    assert_true(unknown.high > some.high);      /* and below */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(indices_of_ishigami_lie_in_their_intervals),
        cmocka_unit_test(indices_converge_to_the_closed_form),
        cmocka_unit_test(a_response_surface_is_exact_for_a_quadratic),
        cmocka_unit_test(the_error_at_rows_left_out_is_that_of_surfaces_without_them),
        cmocka_unit_test(repeated_rows_are_left_out_together),
        cmocka_unit_test(a_surface_that_needs_every_place_has_no_known_error),
        cmocka_unit_test(a_surface_that_the_rows_do_not_determine_says_so),
        cmocka_unit_test(probabilities_have_the_interval_of_their_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
