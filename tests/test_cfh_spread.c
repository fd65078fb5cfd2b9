/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interval of the critical fall height from draws of the foam: against drops of the columns themselves,
 * against closed forms of the random errors, and at its open ends. The "simulated" drops are the columns
 * times a known function of the height. */
#include "model_fixture.h"

#include "case/case.h"
#include "cfh/spread_report.h"
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

enum { DRAWS = 41, POINTS = 6 };

static const double heights[POINTS] = {1.2, 1.4, 1.6, 1.8, 2.0, 2.3};
static const double limit[SF_CFH_CRITERIA] = {200, 1000};

/* A sphere of radius 80 mm, 4.6 kg, on 50 mm. */
static sf_cfh_pad test_pad(void) {
    sf_cfh_pad pad = {.columns = {.mass = 4.6, .thickness = 0.05, .count = 12}};
    for (int k = 0; k < pad.columns.count; k++) {
        pad.columns.gap[k] = 0.05 * (k + 0.5) / pad.columns.count;
        pad.columns.area[k] = 2 * M_PI * (0.08 - pad.columns.gap[k]) * 0.05 / pad.columns.count;
    }
    return pad;
}

/* The foam of the examples with its stress times `factor`. */
static void read_foam(double factor, sf_cfh_draw *draw) {
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    if (sf_case_read(fixture_source("examples/eva50-v4.5/case.cfg"), 0, NULL, NULL, &c, &err) != SF_OK)
        fail_msg("%s", err.text);
    draw->material = c.material;
    c.material = (sf_material){0};
    sf_case_free(&c);
    sf_law_curves *curves = sf_material_curves(&draw->material);
    for (int64_t k = 0; k < curves->curve_points; k++)
        curves->curve_stress[k] *= factor;
    assert_int_equal(sf_material_law_build(&draw->material, &draw->law, &err), SF_OK);
}

/* `count` foams of a log-normal factor of this scatter, from low to high. */
static sf_cfh_draws make_draws(int count, double scatter) {
    sf_cfh_draws draws = {
        .folder = "here", .count = count, .draw = calloc((size_t)count, sizeof *draws.draw)};
    for (int d = 0; d < count; d++)
        read_foam(exp(scatter * gsl_cdf_ugaussian_Pinv((d + 0.5) / count)), &draws.draw[d]);
    return draws;
}

static void drop(const sf_cfh_pad *pad, const sf_material_law *law, double height,
                 double value[SF_CFH_CRITERIA]) {
    sf_columns columns = pad->columns;
    sf_columns_figures figures;
    sf_error err = SF_ERROR_INIT;
    columns.speed = sf_cfh_speed(height);
    if (sf_columns_respond(&columns, law, &figures, NULL, &err) != SF_OK)
        fail_msg("%s", err.text);
    value[SF_CFH_A_MAX] = figures.a_max_g;
    value[SF_CFH_HIC] = figures.hic;
}

/* What the solver would give, of any foam: the columns times a power of the height. */
static void simulate(const sf_cfh_pad *pad, const sf_material_law *law, double height,
                     double value[SF_CFH_CRITERIA]) {
    drop(pad, law, height, value);
    value[SF_CFH_A_MAX] *= 0.85 * pow(height, 0.1);
    value[SF_CFH_HIC] *= 0.8 * pow(height, 0.2);
}

static sf_cfh_points simulate_points(const sf_cfh_pad *pad, const sf_material_law *law) {
    sf_cfh_points points = {0};
    for (int k = 0; k < POINTS; k++) {
        sf_cfh_point p = {.height = heights[k], .speed = sf_cfh_speed(heights[k])};
        simulate(pad, law, heights[k], p.value);
        sf_cfh_points_add(&points, &p);
    }
    return points;
}

static sf_cfh_spread build(const sf_cfh_pad *pad, const sf_cfh_draws *draws, const sf_material_law *own,
                           const double *limits) {
    sf_error err = SF_ERROR_INIT;
    sf_cfh_points points = simulate_points(pad, own);
    sf_cfh_result result;
    sf_cfh_spread spread;
    sf_cfh_evaluate(&points, limits, &result);
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        result.crossing[c].fit.rms = 0; /* but of the tests that give it one */
    if (sf_cfh_spread_build(pad, draws, own, &points, &result, limits, &spread, &err) != SF_OK)
        fail_msg("%s", err.text);
    return spread;
}

static void evaluate(sf_cfh_spread *spread) {
    sf_error err = SF_ERROR_INIT;
    const sf_cfh_rig rig = sf_cfh_free_fall();
    assert_int_equal(sf_cfh_spread_evaluate(spread, &rig, &err), SF_OK);
}

/* The lowest height at which the foam reaches a limit, by bisection. */
static double direct_height(const sf_cfh_pad *pad, const sf_material_law *law) {
    double low = 0.8, high = 3.4;
    while (high / low > 1 + 1e-5) {
        double middle = sqrt(low * high), value[SF_CFH_CRITERIA];
        simulate(pad, law, middle, value);
        if (value[SF_CFH_A_MAX] >= limit[SF_CFH_A_MAX] || value[SF_CFH_HIC] >= limit[SF_CFH_HIC])
            high = middle;
        else
            low = middle;
    }
    return high;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Foams of a known spread: each height, and the interval, are those of drops of each foam. */
static void the_interval_is_that_of_direct_drops(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(DRAWS, 0.2);
    sf_cfh_draw own = {0};
    double direct[DRAWS];
    read_foam(1, &own);
    pad.mesh_error = NAN; /* not estimated: none */
    sf_cfh_spread s = build(&pad, &draws, &own.law, limit);
    for (int d = 0; d < DRAWS; d++) {
        direct[d] = direct_height(&pad, &draws.draw[d].law);
        assert_relative(s.crossing[d * (SF_CFH_FIRST + 1) + SF_CFH_FIRST], direct[d], 2e-3);
    }
    evaluate(&s);
    qsort(direct, DRAWS, sizeof *direct, compare);
    const sf_cfh_interval *whole = sf_cfh_spread_whole(&s, SF_CFH_FIRST);
    assert_true(direct[DRAWS - 2] / direct[1] > 1.03); /* the foams differ */
    assert_relative(whole->low, direct[1], 2e-3);      /* the second and the last but one of 41 */
    assert_relative(whole->median, direct[DRAWS / 2], 2e-3);
    assert_relative(whole->high, direct[DRAWS - 2], 2e-3);
    assert_int_equal(s.above + s.below + s.collapsed + s.beyond, 0);
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
    sf_cfh_draws_free(&(sf_cfh_draws){.count = 1, .draw = memcpy(malloc(sizeof own), &own, sizeof own)});
}

/* Of foams that are all the same the interval holds mesh, fit and columns only, each of its closed form. */
static void without_a_spread_of_the_foam_the_other_errors_are_left(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(SF_CFH_LEAST_DRAWS, 0);
    pad.mesh_error = 0.03;
    sf_cfh_spread s = build(&pad, &draws, &draws.draw[0].law, limit);
    double value[2][SF_CFH_CRITERIA], h = direct_height(&pad, &draws.draw[0].law);
    simulate(&pad, &draws.draw[0].law, 0.97 * h, value[0]);
    simulate(&pad, &draws.draw[0].law, 1.03 * h, value[1]);
    double slope = log(value[1][SF_CFH_HIC] / value[0][SF_CFH_HIC]) / log(1.03 / 0.97);
    s.fit_scatter[SF_CFH_HIC] = 0;
    evaluate(&s);
    assert_int_equal(s.crossing[SF_CFH_HIC] < s.crossing[SF_CFH_A_MAX], 1); /* HIC decides */
    assert_relative(s.part[SF_CFH_PART_FOAM][SF_CFH_FIRST].low, h, 1e-3);
    assert_relative(s.part[SF_CFH_PART_FOAM][SF_CFH_FIRST].high, h, 1e-3);
    const sf_cfh_interval *mesh = &s.part[SF_CFH_PART_MESH][SF_CFH_FIRST];
    for (int side = -1; side <= 1; side++) {
        double q = SF_CFH_MESH_MEDIAN * exp(1.96 * side * SF_CFH_MESH_SCATTER);
        double expected = h * exp(SF_CFH_MESH_HIC * log(1 - q * pad.mesh_error) / slope);
        assert_relative(side < 0 ? mesh->high : side == 0 ? mesh->median : mesh->low, expected, 1.5e-3);
    }
    s.mesh_error = 0;
    s.fit_scatter[SF_CFH_HIC] = 0.02;
    evaluate(&s);
    const sf_cfh_interval *fit = &s.part[SF_CFH_PART_FIT][SF_CFH_FIRST];
    assert_close(log(fit->high / fit->low), 2 * 1.96 * 0.02 / slope, 0.12 * 2 * 1.96 * 0.02 / slope);
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

/* A draw that the columns miss widens the interval by how far its height moves. */
static void the_checks_widen_the_interval(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(SF_CFH_LEAST_DRAWS, 0.1);
    pad.mesh_error = 0;
    sf_cfh_spread s = build(&pad, &draws, &draws.draw[10].law, limit);
    sf_cfh_spread_choose(&s, 3, 1e-3);
    assert_int_equal(s.checks, 3);
    assert_true(s.check[0].height < s.check[1].height && s.check[1].height < s.check[2].height);
    for (int k = 0; k < 3; k++) {
        sf_cfh_check *check = &s.check[k];
        simulate(&pad, &draws.draw[check->draw].law, check->height, check->simulated);
        sf_cfh_check_compare(&s, check);
        assert_close(check->shift, 0, 1e-3); /* the columns miss nothing here */
        assert_relative(check->columns[check->first], limit[check->first], 0.01);
    }
    evaluate(&s);
    sf_cfh_interval before = *sf_cfh_spread_whole(&s, SF_CFH_FIRST);
    for (int k = 0; k < 3; k++) {
        s.check[k].simulated[SF_CFH_HIC] *= 1.1;
        sf_cfh_check_compare(&s, &s.check[k]);
        assert_true(s.check[k].shift < -0.03 && s.check[k].shift > -0.06); /* 10 % of HIC, slope about 2.4 */
    }
    evaluate(&s);
    const sf_cfh_interval *after = sf_cfh_spread_whole(&s, SF_CFH_FIRST);
    assert_true(after->low < before.low * exp(-0.02) && after->high > before.high * exp(0.02));
    s.check[0].failed = s.check[1].failed = s.check[2].failed = true; /* no figures: no scatter known */
    evaluate(&s);
    assert_close(s.columns_scatter, 0, 0);
    char text[SF_CFH_NOTE_SIZE];
    sf_cfh_draws_text(&s, text, sizeof text);
    assert_string_equal(text, "3 of the 3 simulated draws failed: there the columns are not confirmed.");
    s.own_height *= 1.3;
    sf_cfh_draws_text(&s, text, sizeof text);
    assert_non_null(strstr(text, "lies outside of 95 % of the draws"));
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

/* Limits that draws do not reach, or exceed from the start, leave the end of the interval open. */
static void ends_that_draws_do_not_reach_are_open(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(SF_CFH_LEAST_DRAWS, 0.1);
    const double beyond[SF_CFH_CRITERIA] = {1e5, 1e7}, trivial[SF_CFH_CRITERIA] = {1, 1};
    char text[400];
    pad.mesh_error = 0;
    sf_cfh_spread s = build(&pad, &draws, &draws.draw[10].law, beyond);
    evaluate(&s);
    assert_int_equal(s.above, SF_CFH_LEAST_DRAWS);
    assert_true(isinf(sf_cfh_spread_whole(&s, SF_CFH_FIRST)->high));
    sf_cfh_draws_text(&s, text, sizeof text);
    assert_non_null(strstr(text, "20 of the 20 draws reach no limit"));
    assert_non_null(
        strstr(sf_cfh_interval_text(sf_cfh_spread_whole(&s, SF_CFH_FIRST), text, sizeof text), "open above"));
    sf_cfh_spread_choose(&s, 3, 1e-3);
    assert_int_equal(s.checks, 0);
    sf_cfh_spread_free(&s);
    s = build(&pad, &draws, &draws.draw[10].law, trivial);
    evaluate(&s);
    assert_int_equal(s.below, SF_CFH_LEAST_DRAWS);
    assert_close(sf_cfh_spread_whole(&s, SF_CFH_FIRST)->low, 0, 0);
    sf_cfh_draws_text(&s, text, sizeof text);
    assert_non_null(strstr(text, "20 of the 20 draws exceed a limit at the lowest height"));
    sf_cfh_spread_free(&s);
    const double between[SF_CFH_CRITERIA] = {limit[SF_CFH_A_MAX], 1e7};
    s = build(&pad, &draws, &draws.draw[10].law, between);
    for (int k = 0; k < s.draws; k++) /* as if most draws collapsed at the tenth height */
        s.reach[k] = k < 15 ? 10 : s.reach[k];
    evaluate(&s);
    assert_relative(sf_cfh_spread_whole(&s, SF_CFH_FIRST)->median, s.height[9], 1e-12);
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

static void threads_change_no_bit(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(SF_CFH_LEAST_DRAWS, 0.1);
    sf_cfh_interval whole[2];
    int before = omp_get_max_threads();
    for (int run = 0; run < 2; run++) {
        omp_set_num_threads(run ? 3 : 1);
        pad.mesh_error = 0.01;
        sf_cfh_spread s = build(&pad, &draws, &draws.draw[10].law, limit);
        evaluate(&s);
        whole[run] = *sf_cfh_spread_whole(&s, SF_CFH_FIRST);
        sf_cfh_spread_free(&s);
    }
    omp_set_num_threads(before);
    assert_memory_equal(&whole[0], &whole[1], sizeof whole[0]);
    sf_cfh_draws_free(&draws);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_interval_is_that_of_direct_drops),
        cmocka_unit_test(without_a_spread_of_the_foam_the_other_errors_are_left),
        cmocka_unit_test(the_checks_widen_the_interval),
        cmocka_unit_test(ends_that_draws_do_not_reach_are_open),
        cmocka_unit_test(threads_change_no_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
