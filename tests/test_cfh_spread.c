/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interval of the critical fall height from draws of the foam: against drops of the columns themselves,
 * against closed forms of the random errors, and at its open ends. The "simulated" drops are the columns
 * times a known function of the height. */
#include "extreme.h"
#include "model_fixture.h"

#include "study/cfh/cfh_report.h"
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

enum { DRAWS = 41, FEW = 20, POINTS = 6 };

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
    fixture_case(&c, NULL);
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

/* What the solver would give: the columns, of which `exaggerated` takes a part of what they say of foams and
 * heights, times a power of the height. */
static double exaggerated = 1;
static void simulate(const sf_cfh_pad *pad, const sf_material_law *law, double height,
                     double value[SF_CFH_CRITERIA]) {
    drop(pad, law, height, value);
    value[SF_CFH_A_MAX] = 200 * pow(value[SF_CFH_A_MAX] / 200, exaggerated) * 0.85 * pow(height, 0.1);
    value[SF_CFH_HIC] = 1000 * pow(value[SF_CFH_HIC] / 1000, exaggerated) * 0.8 * pow(height, 0.2);
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
        assert_relative(s.draw[d].crossing[SF_CFH_FIRST], direct[d], 2e-3);
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

/* Of foams that are all the same the interval holds mesh, fit and columns only, each of its closed form, and
 * its median is the height simulated. */
static void without_a_spread_of_the_foam_the_other_errors_are_left(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0);
    pad.mesh_error = 0.03;
    sf_cfh_spread s = build(&pad, &draws, &draws.draw[0].law, limit);
    double value[2][SF_CFH_CRITERIA], h = direct_height(&pad, &draws.draw[0].law);
    simulate(&pad, &draws.draw[0].law, 0.97 * h, value[0]);
    simulate(&pad, &draws.draw[0].law, 1.03 * h, value[1]);
    double slope = log(value[1][SF_CFH_HIC] / value[0][SF_CFH_HIC]) / log(1.03 / 0.97);
    s.fit_scatter[SF_CFH_HIC] = 0;
    evaluate(&s);
    assert_int_equal(s.draw[0].crossing[SF_CFH_HIC] < s.draw[0].crossing[SF_CFH_A_MAX], 1); /* HIC decides */
    assert_relative(s.part[SF_CFH_PART_FOAM][SF_CFH_FIRST].low, h, 1e-3);
    assert_relative(s.part[SF_CFH_PART_FOAM][SF_CFH_FIRST].high, h, 1e-3);
    const sf_cfh_interval *mesh = &s.part[SF_CFH_PART_MESH][SF_CFH_FIRST];
    for (int side = -1; side <= 1; side++) {
        double error = 1.96 * side * SF_CFH_MESH_SIZE * pad.mesh_error;
        double expected = h * exp(SF_CFH_MESH_HIC * error / slope);
        assert_relative(side < 0 ? mesh->low : side == 0 ? mesh->median : mesh->high, expected, 2e-3);
    }
    s.mesh_error = 0;
    s.fit_scatter[SF_CFH_HIC] = 0.02;
    evaluate(&s);
    const sf_cfh_interval *fit = &s.part[SF_CFH_PART_FIT][SF_CFH_FIRST];
    assert_close(log(fit->high / fit->low), 2 * 1.96 * 0.02 / slope, 0.12 * 2 * 1.96 * 0.02 / slope);
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

static sf_cfh_spread build_with_checks(const sf_cfh_pad *pad, const sf_cfh_draws *draws, int checks) {
    sf_cfh_spread s = build(pad, draws, &draws->draw[FEW / 2].law, limit);
    sf_cfh_spread_choose(&s, checks, 1e-3);
    assert_int_equal(s.checks, checks);
    for (int k = 0; k < checks; k++) {
        sf_cfh_check *check = &s.check[k];
        double value[SF_CFH_CRITERIA];
        simulate(pad, &draws->draw[check->draw].law, check->height, value);
        sf_cfh_check_take(value, check);
        for (int c = 0; c < SF_CFH_CRITERIA && exaggerated == 1; c++)
            assert_close(check->error[c], 0, 3e-3); /* the columns miss nothing here */
        assert_relative(check->columns[check->first], limit[check->first], 0.01);
        assert_true(k == 0 || check->height > s.check[k - 1].height);
    }
    return s;
}

/* Errors of the responses: those of HIC that all drops share are stratified normal numbers of this size. */
static void give_responses(sf_cfh_draws *draws, double shared_sd, double own_sd) {
    draws->with_response = true;
    for (int d = 0; d < draws->count; d++) {
        sf_response_error *e = &draws->draw[d].response;
        *e = (sf_response_error){.given[SF_FIT_HIC] = true, .given[SF_FIT_A_MAX] = true};
        e->shared[SF_FIT_HIC] = shared_sd * gsl_cdf_ugaussian_Pinv((d + 0.5) / draws->count);
        e->own_sd[SF_FIT_HIC] = own_sd;
        e->own_sd[SF_FIT_A_MAX] = 0.5 * own_sd;
    }
}

/* d ln HIC / d ln h of the corrected columns at the height where HIC reaches its limit. */
static double slope_of_hic(const sf_cfh_pad *pad, const sf_material_law *law, double h) {
    double value[2][SF_CFH_CRITERIA];
    simulate(pad, law, 0.97 * h, value[0]);
    simulate(pad, law, 1.03 * h, value[1]);
    return log(value[1][SF_CFH_HIC] / value[0][SF_CFH_HIC]) / log(1.03 / 0.97);
}

/* Of foams that are all the same and errors of the responses of known size the interval is that of the errors
 * over d ln HIC / d ln h; a share of it is that of the mesh, if there is an error of that. */
static void response_errors_give_the_interval(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0);
    const double shared = 0.03, own = 0.04;
    double h = direct_height(&pad, &draws.draw[0].law), slope = slope_of_hic(&pad, &draws.draw[0].law, h);
    pad.mesh_error = 0;
    give_responses(&draws, shared, 0); /* fixed in a draw: the outermost draws are the ends */
    sf_cfh_spread s = build(&pad, &draws, &draws.draw[0].law, limit);
    evaluate(&s);
    const sf_cfh_interval *whole = sf_cfh_spread_whole(&s, SF_CFH_FIRST),
                          *foam = &s.part[SF_CFH_PART_FOAM][SF_CFH_FIRST];
    double outermost = shared * gsl_cdf_ugaussian_Pinv(0.5 / FEW) / slope;
    assert_relative(whole->low, h * exp(outermost), 3e-3);
    assert_relative(whole->high, h * exp(-outermost), 3e-3);
    assert_relative(foam->high, h, 1e-3);
    assert_relative(foam->low, h, 1e-3);
    assert_close(sf_cfh_spread_share(&s, SF_CFH_PART_RESPONSE), 1, 1e-9);
    assert_close(sf_cfh_spread_share(&s, SF_CFH_PART_FOAM), 0, 1e-9);
    sf_cfh_spread_free(&s);

    give_responses(&draws, 0, own);
    s = build(&pad, &draws, &draws.draw[0].law, limit);
    evaluate(&s);
    whole = sf_cfh_spread_whole(&s, SF_CFH_FIRST);
    assert_relative(whole->median, h, 3e-3);
    assert_close(log(whole->high / whole->low), 2 * 1.96 * own / slope, 0.1 * 2 * 1.96 * own / slope);
    sf_cfh_spread_free(&s);

    give_responses(&draws, shared, own);
    pad.mesh_error = 0.03;
    s = build(&pad, &draws, &draws.draw[0].law, limit);
    evaluate(&s);
    const sf_cfh_interval *both = &s.part[SF_CFH_PART_RESPONSE][SF_CFH_FIRST];
    double response = hypot(shared, own), mesh = SF_CFH_MESH_HIC * SF_CFH_MESH_SIZE * pad.mesh_error,
           share = response * response / (response * response + mesh * mesh), sum = 0;
    assert_close(log(both->high / both->low), 2 * 1.96 * response / slope, 0.1 * 2 * 1.96 * response / slope);
    assert_close(sf_cfh_spread_share(&s, SF_CFH_PART_RESPONSE), share, 0.12);
    for (int part = 0; part < SF_CFH_PARTS; part++)
        sum += sf_cfh_spread_share(&s, (sf_cfh_part)part);
    assert_close(sum, 1, 1e-12);
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

/* A single pad and drop scatter about the whole interval, which does not hold them. */
static void a_single_drop_scatters_about_the_whole(void **state) {
    (void)state;
    const double scatter = 0.1;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0);
    double h = direct_height(&pad, &draws.draw[0].law),
           expected = 2 * 1.96 * scatter / slope_of_hic(&pad, &draws.draw[0].law, h);
    pad.mesh_error = 0;
    sf_cfh_spread s = build(&pad, &draws, &draws.draw[0].law, limit);
    evaluate(&s);
    sf_cfh_interval whole = *sf_cfh_spread_whole(&s, SF_CFH_FIRST);
    for (int k = 0; k < s.grid; k++)
        s.scatter[SF_CFH_HIC][k] = scatter;
    evaluate(&s);
    const sf_cfh_interval *single = &s.part[SF_CFH_PARTS][SF_CFH_FIRST];
    assert_memory_equal(sf_cfh_spread_whole(&s, SF_CFH_FIRST), &whole, sizeof whole);
    assert_close(log(single->high / single->low), expected, 0.1 * expected);
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

/* Errors of size zero give the bits of draws that state none. */
static void no_response_errors_change_no_bit(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0.1);
    pad.mesh_error = 0.02;
    sf_cfh_spread without = build_with_checks(&pad, &draws, 4);
    without.fit_scatter[SF_CFH_HIC] = 0.01;
    evaluate(&without);
    give_responses(&draws, 0, 0);
    sf_cfh_spread with = build_with_checks(&pad, &draws, 4);
    with.fit_scatter[SF_CFH_HIC] = 0.01;
    evaluate(&with);
    assert_true(with.with_response && !without.with_response);
    assert_memory_equal(with.part, without.part, sizeof with.part);
    assert_memory_equal(with.part[SF_CFH_PART_FOAM], with.part[SF_CFH_PART_RESPONSE],
                        sizeof with.part[SF_CFH_PART_FOAM]);
    assert_non_null(
        strstr(sf_cfh_response_text(&without), "errors of the responses are not in the interval"));
    assert_string_equal(sf_cfh_response_text(&with), "");
    sf_cfh_spread_free(&with);
    sf_cfh_spread_free(&without);
    sf_cfh_draws_free(&draws);
}

/* Columns that exaggerate what the foam does: with the simulated draws every draw has its true height, within
 * the error that is stated, and the interval is that of direct drops; without them it is not. */
static void simulated_draws_correct_the_others(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0.2);
    double direct[FEW], worst[2] = {0};
    pad.mesh_error = 0;
    exaggerated = 0.85;
    sf_cfh_spread s = build_with_checks(&pad, &draws, 5);
    for (int round = 0; round < 2; round++) {
        for (int d = 0; d < FEW; d++) {
            direct[d] = direct_height(&pad, &draws.draw[d].law);
            double error = log(s.draw[d].crossing[SF_CFH_FIRST] / direct[d]);
            worst[round] = larger(worst[round], fabs(error));
            if (round > 0) /* HIC decides, by a slope of about two */
                assert_true(fabs(error) < 2 * s.draw[d].columns_sd[SF_CFH_HIC] + 5e-4);
        }
        evaluate(&s);
    }
    printf("heights are wrong by %.2f %% at most, with simulated draws by %.2f %%\n", 100 * worst[0],
           100 * worst[1]);
    assert_true(worst[0] > 5e-3 && worst[1] < 1e-3);
    qsort(direct, FEW, sizeof *direct, compare);
    const sf_cfh_interval *foam = &s.part[SF_CFH_PART_FOAM][SF_CFH_FIRST];
    assert_true(foam->low > direct[0] * 0.997 && foam->low < direct[1] * 1.003);
    assert_true(foam->high > direct[FEW - 2] * 0.997 && foam->high < direct[FEW - 1] * 1.003);
    exaggerated = 1;
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

/* What the simulated draws scatter about every process of the columns is an error of the others. */
static void scatter_of_the_checks_widens_the_interval(void **state) {
    (void)state;
    static const double zigzag[9] = {0.03, -0.03, 0.03, -0.03, 0.03, -0.03, 0.03, -0.03, 0.03};
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0.05);
    pad.mesh_error = 0;
    sf_cfh_spread s = build_with_checks(&pad, &draws, 9);
    evaluate(&s);
    const sf_cfh_interval before = *sf_cfh_spread_whole(&s, SF_CFH_HIC), *whole = &before;
    double calm = sf_cfh_columns_error(&s, SF_CFH_HIC);
    assert_true(calm < 2e-3);
    assert_int_equal(s.freedom, POINTS + 9 - 1);
    for (int k = 0; k < 9; k++)
        s.check[k].drop.value[SF_CFH_HIC] += zigzag[k];
    evaluate(&s);
    whole = sf_cfh_spread_whole(&s, SF_CFH_HIC);
    assert_true(sf_cfh_columns_error(&s, SF_CFH_HIC) > 0.01);
    assert_true(sf_cfh_columns_error(&s, SF_CFH_A_MAX) < 2e-3);
    assert_true(whole->high > before.high * 1.004 && whole->low < before.low * 0.996);
    s.check[1].failed = true; /* it has no figures */
    evaluate(&s);
    assert_int_equal(s.freedom, POINTS + 8 - 1);
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

/* Without a check that has figures the columns' error is not known, not 0. */
static void without_a_check_the_columns_error_is_not_known(void **state) {
    (void)state;
    char text[SF_CFH_NOTE_SIZE];
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0.1);
    pad.mesh_error = 0;
    sf_cfh_spread s = build_with_checks(&pad, &draws, 3);
    s.check[0].failed = s.check[1].failed = s.check[2].failed = true;
    evaluate(&s);
    assert_true(s.freedom == 0 && isnan(sf_cfh_columns_error(&s, SF_CFH_HIC)));
    assert_true(isfinite(sf_cfh_spread_whole(&s, SF_CFH_FIRST)->high));
    sf_cfh_draws_text(&s, text, sizeof text);
    assert_string_equal(text, "3 of the 3 simulated draws failed: there the columns are not confirmed.");
    s.own_height *= 1.3;
    sf_cfh_draws_text(&s, text, sizeof text);
    assert_non_null(strstr(text, "lies outside of 95 % of the draws"));
    s.checks = 0;
    evaluate(&s);
    assert_true(isnan(sf_cfh_columns_error(&s, SF_CFH_A_MAX)));
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

/* The share of the draws below a check counts those without a height too. */
static void checks_at_an_edge(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0.1);
    pad.mesh_error = 0;
    sf_cfh_spread s = build_with_checks(&pad, &draws, 1);
    for (int d = 0; d < 5; d++)
        for (int c = 0; c <= SF_CFH_FIRST; c++)
            s.draw[d].crossing[c] = d < 4 ? 0 : INFINITY;
    s.below = 4;
    s.above = 1;
    sf_cfh_spread_choose(&s, 1, 1e-3);
    assert_close(s.check[0].share, (4 + 7) / (double)FEW, 1e-12); /* the middle one of the other 15 */
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

/* What is printed and what is written of an interval. */
static void assert_bound(const sf_cfh_spread *s, const char *words, const char *json_words) {
    char text[64], *written = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&written, &size);
    sf_json json = {.file = file};
    const sf_cfh_interval *whole = sf_cfh_spread_whole(s, SF_CFH_FIRST);
    assert_string_equal(sf_cfh_interval_text(whole, text, sizeof text), words);
    sf_json_open(&json, NULL, '{');
    sf_cfh_put_interval_json(&json, "height", whole);
    sf_json_close(&json);
    fclose(file);
    assert_string_equal(written, json_words);
    free(written);
}

/* Limits that draws do not reach, or exceed from the start, leave the end of the interval open. */
static void ends_that_draws_do_not_reach_are_open(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0.1);
    const double beyond[SF_CFH_CRITERIA] = {1e5, 1e7}, trivial[SF_CFH_CRITERIA] = {1, 1};
    char text[400];
    pad.mesh_error = 0;
    sf_cfh_spread s = build(&pad, &draws, &draws.draw[10].law, beyond);
    evaluate(&s);
    assert_int_equal(s.above, FEW);
    assert_true(isinf(sf_cfh_spread_whole(&s, SF_CFH_FIRST)->high));
    assert_bound(
        &s, "above 3.45 m",
        "{\n  \"height_low_m\": 3.45,\n  \"height_median_m\": null,\n  \"height_high_m\": null,\n  \"height_open\": \"above\"\n}\n");
    sf_cfh_draws_text(&s, text, sizeof text);
    assert_non_null(strstr(text, "20 of the 20 draws reach no limit"));
    sf_cfh_spread_choose(&s, 3, 1e-3);
    assert_int_equal(s.checks, 0);
    sf_cfh_spread_free(&s);
    s = build(&pad, &draws, &draws.draw[10].law, trivial);
    evaluate(&s);
    assert_int_equal(s.below, FEW);
    assert_bound(
        &s, "below 0.800 m",
        "{\n  \"height_low_m\": null,\n  \"height_median_m\": null,\n  \"height_high_m\": 0.8,\n  \"height_open\": \"below\"\n}\n");
    sf_cfh_draws_text(&s, text, sizeof text);
    assert_non_null(strstr(text, "20 of the 20 draws exceed a limit at the lowest height"));
    sf_cfh_spread_free(&s);
    const double between[SF_CFH_CRITERIA] = {limit[SF_CFH_A_MAX], 1e7};
    s = build(&pad, &draws, &draws.draw[10].law, between);
    for (int k = 0; k < s.draws; k++) /* as if most draws collapsed at the tenth height */
        s.draw[k].reach = k < 15 ? 10 : s.draw[k].reach;
    evaluate(&s);
    assert_relative(sf_cfh_spread_whole(&s, SF_CFH_FIRST)->median, s.height[9], 1e-12);
    for (int k = 0; k < s.draws; k++) /* half of them have no height: between that and one there is nothing */
        s.draw[k].reach = k < FEW / 2 ? 0 : 10;
    evaluate(&s);
    assert_true(sf_cfh_spread_whole(&s, SF_CFH_FIRST)->median <= 0);
    assert_relative(sf_cfh_spread_whole(&s, SF_CFH_FIRST)->high, s.height[9], 1e-12);
    sf_cfh_spread_free(&s);
    sf_cfh_draws_free(&draws);
}

static void threads_change_no_bit(void **state) {
    (void)state;
    sf_cfh_pad pad = test_pad();
    sf_cfh_draws draws = make_draws(FEW, 0.1);
    sf_cfh_interval whole[2];
    int before = omp_get_max_threads();
    give_responses(&draws, 0.02, 0.03);
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
        cmocka_unit_test(response_errors_give_the_interval),
        cmocka_unit_test(a_single_drop_scatters_about_the_whole),
        cmocka_unit_test(no_response_errors_change_no_bit),
        cmocka_unit_test(simulated_draws_correct_the_others),
        cmocka_unit_test(scatter_of_the_checks_widens_the_interval),
        cmocka_unit_test(without_a_check_the_columns_error_is_not_known),
        cmocka_unit_test(checks_at_an_edge),
        cmocka_unit_test(ends_that_draws_do_not_reach_are_open),
        cmocka_unit_test(threads_change_no_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
