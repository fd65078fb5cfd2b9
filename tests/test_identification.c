/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit compression: its spline, its model against the solver's law, and a fit from the files of tests to
 * a material that softfall-pre reads. */
#include "case/read.h"
#include "material/low_density_foam.h"
#include "study/fit/compression/compression_fit.h"
#include "material/laws.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "point_fixture.h"
#include "post_check.h"
#include "sheet_fixture.h"

static program_place place;

static int set_up(void **state) {
    (void)state;
    program_set_up(&place);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    program_tear_down(&place);
    return 0;
}

/* ---- spline ---- */

static void spline_rows_are_value_slope_and_integral(void **state) {
    (void)state;
    static const double breaks[] = {0, 0.05, 0.1, 0.3, 0.7};
    sf_spline spline;
    sf_error err = SF_ERROR_INIT;
    double row[SF_SPLINE_COEFFICIENTS], up[SF_SPLINE_COEFFICIENTS], down[SF_SPLINE_COEFFICIENTS];
    assert_int_equal(sf_spline_init(&spline, 5, breaks, &err), SF_OK);
    for (double x = 0.011; x < 0.69; x += 0.03) {
        const double h = 1e-5;
        sf_spline_value(&spline, x + h, up);
        sf_spline_value(&spline, x - h, down);
        sf_spline_slope(&spline, x, row);
        for (int j = 0; j < spline.count; j++)
            assert_close(row[j], (up[j] - down[j]) / (2 * h), 1e-4);
        sf_spline_integral(&spline, x + h, up);
        sf_spline_integral(&spline, x - h, down);
        sf_spline_value(&spline, x, row);
        for (int j = 0; j < spline.count; j++)
            assert_close(row[j], (up[j] - down[j]) / (2 * h), 1e-6);
    }
    sf_spline_integral(&spline, 0, row);
    for (int j = 0; j < spline.count; j++)
        assert_close(row[j], 0, 1e-15);
    sf_spline_free(&spline);
}

static void knots_ascend_and_leave_two_points_between(void **state) {
    (void)state;
    double x[30], breaks[SF_SPLINE_BREAKS];
    for (int i = 0; i < 30; i++)
        x[i] = 0.8 * (i + 1) / 30;
    const sf_spline_data data = {x, 30};
    for (int grading = SF_GRADING_ENDS; grading <= SF_GRADING_FOAM; grading++) {
        int count = sf_spline_place((sf_spline_grading)grading, 40, 0, 0.8, 1, &data, breaks);
        assert_in_range(count, 5, 16);
        assert_close(breaks[count - 1], 0.8, 0);
        for (int k = 1; k < count; k++) {
            int inside = 0;
            for (int i = 0; i < 30; i++)
                inside += x[i] >= breaks[k - 1] && x[i] < breaks[k];
            assert_in_range(inside, 2, 30);
        }
    }
}

/* ---- model ---- */

static void read_tests(sf_compression_config *config) {
    static const char text[] = "density = \"35 kg/m3\";\nname = \"test foam\";\ntests = (\n"
                               "{ file = \"fast.csv\"; rate = \"10 1/min\"; },\n"
                               "{ file = \"slow.csv\"; rate = \"0.1 1/min\"; } );\n";
    const sheet slow = sheet_good(1), fast = sheet_good(1 + 0.04 * log(100));
    sf_error err = SF_ERROR_INIT;
    sheet_write(&place, "slow.csv", &slow);
    sheet_write(&place, "fast.csv", &fast);
    if (sf_compression_config_read(program_write_text(&place, "fit.cfg", text), config, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_relative(config->test[0].rate, 0.1 / 60, 1e-12); /* in ascending order */
    assert_relative(config->test[1].rate, 10.0 / 60, 1e-12);
}

/* Stress of a branch of 1 Pa at a constant rate of the stretch, in closed form: the convolution of E' =
 * stretch stretch' with the decay. */
static double maxwell_leg(double decay_rate, double velocity, double held, double from, double time) {
    double x = decay_rate * time, per = velocity / decay_rate;
    double beyond = fabs(x) < 1e-3 ? x * x * (0.5 - x * (1.0 / 6 - x / 24)) : x + expm1(-x);
    return held * exp(-x) + per * (-from * expm1(-x) + per * beyond);
}

static double maxwell_exact(double decay_rate, double rate, double turn, double strain, bool unloading) {
    double s = maxwell_leg(decay_rate, -rate, 0, 1, (unloading ? turn : strain) / rate);
    if (unloading)
        s = maxwell_leg(decay_rate, rate, s, 1 - turn, (turn - strain) / rate);
    return -(1 - strain) * s;
}

static void maxwell_stress_is_that_of_the_solver(void **state) {
    (void)state;
    enum { N = 9 };
    static const double strain[N] = {0.01, 0.1, 0.3, 0.55, 0.8, 0.7, 0.5, 0.2, 0.01};
    double with[N], without[N];
    point_card line;
    point_card_init(&line);
    point_card_add_line(&line, 1e3, 0.9);
    sf_foam_card card = line.card;
    card.modulus = 1e3;
    card.shared.maxwell_rate = 0.7;
    card.densification_exponent = 1;
    for (double rate = 0.01; rate < 20; rate *= 10) {
        sf_foam foam;
        const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
        sf_error err = SF_ERROR_INIT;
        card.shared.maxwell_modulus = 0;
        assert_int_equal(sf_foam_build(&card, &foam, &err), SF_OK);
        sf_material_point_drive(&law, rate, 1e-4, N, strain, without);
        sf_foam_free(&foam);
        card.shared.maxwell_modulus = 5e4;
        assert_int_equal(sf_foam_build(&card, &foam, &err), SF_OK);
        sf_material_point_drive(&law, rate, 1e-4, N, strain, with);
        sf_foam_free(&foam);
        sf_compression_walk walk = {0};
        for (int i = 0; i < N; i++) {
            double unit = sf_compression_maxwell(0.7, rate, 0.8, strain[i], i > 4, &walk);
            assert_close(5e4 * unit, with[i] - without[i], 0.5);
            assert_close(unit, maxwell_exact(0.7, rate, 0.8, strain[i], i > 4), 1e-5);
        }
    }
}

/* ---- fits ---- */

static void check_card(const sf_compression_fit *fit) {
    sf_foam_card card;
    sf_foam foam;
    const sf_material_law law = {.law = &sf_low_density_foam, .numbers = &foam};
    sf_error err = SF_ERROR_INIT;
    const sf_compression_data *d = &fit->data;
    double *stress = calloc((size_t)d->count, sizeof *stress);
    assert_int_equal(sf_compression_card(fit, &card, &err), SF_OK);
    assert_int_equal(sf_foam_build(&card, &foam, &err), SF_OK);
    for (int k = 0, first = 0; k < d->config->test_count; first += d->config->test[k++].count) {
        const sf_compression_test *t = &d->config->test[k];
        sf_material_point_drive(&law, t->rate, 5e-4, t->count, &d->strain[first], &stress[first]);
        for (int i = first; i < first + t->count; i++)
            assert_close(stress[i], fit->stress[i], 0.005 * fabs(fit->stress[i]) + 20);
    }
    free(stress);
    sf_foam_free(&foam);
    sf_foam_card_free(&card);
}

/* Curves rise, and the densification goes on with value and slope. */
static void check_curve(sf_compression_fit *fit) {
    double last = -1, start = fit->data.start;
    for (int r = 0; r < fit->rate_count; r++, last = -1)
        for (int k = 0; k < fit->table_count; k++) {
            assert_true(fit->table_stress[r][k] > last);
            assert_true(k == 0 || fit->table_strain[k] > fit->table_strain[k - 1]);
            last = fit->table_stress[r][k];
        }
    const double h = 1e-6;
    double at = sf_compression_curve(&fit->model, fit->parameters, 0, start);
    double before = sf_compression_curve(&fit->model, fit->parameters, 0, start - h);
    double after = sf_compression_curve(&fit->model, fit->parameters, 0, start + h);
    assert_relative((after - at) / h, (at - before) / h, 1e-3);
}

static void every_form_gives_a_card_that_the_solver_follows(void **state) {
    (void)state;
    sf_compression_config config;
    read_tests(&config);
    for (int rate = 0; rate < SF_RATE_MODELS; rate++)
        for (int rule = SF_RULE_H1; rule <= SF_RULE_H2; rule++) {
            sf_compression_fit fit;
            sf_error err = SF_ERROR_INIT;
            config.rate_model = (sf_rate_model)rate;
            config.rule = (sf_rule_choice)rule;
            if (sf_compression_fit_run(&config, &fit, &err) != SF_OK)
                fail_msg("%s", err.text);
            check_curve(&fit);
            check_card(&fit);
            sf_compression_fit_free(&fit);
        }
    sf_compression_config_free(&config);
}

static void exact_data_give_their_parameters_back(void **state) {
    (void)state;
    sf_compression_config config;
    sf_compression_fit fit;
    sf_error err = SF_ERROR_INIT;
    read_tests(&config);
    if (sf_compression_fit_run(&config, &fit, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_int_equal(fit.model.form.rate, SF_RATE_LOG);
    assert_close(fit.estimate[SF_ESTIMATE_LOG_RATE].value, 0.04, 4e-4);
    assert_close(fit.estimate[SF_ESTIMATE_HU].value, 0.05, 2e-3);
    assert_close(fit.estimate[SF_ESTIMATE_SHAPE].value, 2.5, 0.03);
    assert_close(fit.estimate[SF_ESTIMATE_EXPONENT].value, 2.6, 0.1);
    sf_compression_fit_free(&fit);
    sf_compression_config_free(&config);
}

/* Puts another unloading into both tests: the loading stress at the strain times a factor of it. */
static void change_unloading(sf_compression_config *config, double (*factor)(double energy_ratio)) {
    for (int k = 0; k < config->test_count; k++) {
        sf_compression_test *t = &config->test[k];
        for (int i = t->loading; i < t->count; i++)
            t->stress[i] = 1e3 * sheet_stress(t->strain[i]) *
                           factor(sheet_energy(t->strain[i]) / sheet_energy(t->largest_strain));
    }
}

static double law_with_alpha(double ratio) {
    return 1 - 0.95 * pow(1 - pow(ratio, 2.5), 0.4);
}

/* Rises above half of loading where half of the energy is left, which no HU, SHAPE and ALPHA give. */
static double foreign_law(double ratio) {
    return ratio < 0.3 ? 0.5 : ratio < 0.6 ? 0.1 : 0.6;
}

static void alpha_is_found_where_the_data_have_one(void **state) {
    (void)state;
    sf_compression_config config;
    sf_compression_fit fit;
    sf_error err = SF_ERROR_INIT;
    read_tests(&config);
    change_unloading(&config, law_with_alpha);
    if (sf_compression_fit_run(&config, &fit, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(fit.estimate[SF_ESTIMATE_ALPHA].present);
    assert_close(fit.estimate[SF_ESTIMATE_ALPHA].value, 0.4, 0.02);
    assert_close(fit.estimate[SF_ESTIMATE_SHAPE].value, 2.5, 0.2);
    assert_close(fit.estimate[SF_ESTIMATE_HU].value, 0.05, 0.01);
    sf_compression_fit_free(&fit);
    sf_compression_config_free(&config);
}

/* The same loading curve and rate factor, but for the weights, whatever the unloading. */
static void unloading_does_not_bend_the_loading(void **state) {
    (void)state;
    sf_compression_config config;
    sf_compression_fit fit[2];
    sf_error err = SF_ERROR_INIT;
    read_tests(&config);
    config.rule = SF_RULE_H1;
    config.rate_model = SF_RATE_LOG;
    for (int k = 0; k < 2; k++) {
        if (k == 1)
            change_unloading(&config, foreign_law);
        if (sf_compression_fit_run(&config, &fit[k], &err) != SF_OK)
            fail_msg("%s", err.text);
    }
    assert_true(fit[1].side[1].of_largest > 0.01 && fit[1].side[1].misfit > 2);
    assert_true(fit[1].side[0].of_largest < 1e-3 && fit[0].side[1].of_largest < 1e-3);
    assert_close(fit[1].estimate[SF_ESTIMATE_LOG_RATE].value, 0.04, 4e-4);
    for (int i = 0; i < fit[0].table_count; i++)
        assert_relative(fit[1].table_stress[0][i] + 1, fit[0].table_stress[0][i] + 1, 5e-3);
    sf_compression_fit_free(&fit[0]);
    sf_compression_fit_free(&fit[1]);
    sf_compression_config_free(&config);
}

static void without_unloading_there_is_no_hysteresis_and_it_is_said(void **state) {
    (void)state;
    sheet s = sheet_good(1);
    sf_compression_config config;
    sf_compression_fit fit;
    sf_error err = SF_ERROR_INIT;
    s.unloading = 0;
    sheet_write(&place, "slow.csv", &s);
    assert_int_equal(sf_compression_config_read(
                         program_write_text(&place, "fit.cfg", "density = \"35 kg/m3\";\n" SHEET_TEST_LIST),
                         &config, &err),
                     SF_OK);
    if (sf_compression_fit_run(&config, &fit, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_close(fit.estimate[SF_ESTIMATE_HU].value, 1, 0);
    assert_true(isnan(fit.estimate[SF_ESTIMATE_HU].error));
    assert_non_null(strstr(fit.estimate[SF_ESTIMATE_HU].note, "no test unloads"));
    assert_int_equal(fit.model.form.rate, SF_RATE_NONE);
    sf_compression_fit_free(&fit);
    sf_compression_config_free(&config);
}

/* A curve that rises slowly at its end leaves next to no energy between the tests and full compression. */
static void an_exponent_below_one_is_said(void **state) {
    (void)state;
    static const char *const rules[] = {"H1", "H1_automatic"};
    sheet s = sheet_good(1);
    s.unloading = 0;
    for (int i = 0; i < SHEET_POINTS; i++)
        s.stress[i] = 9 * (1 - exp(-410 * s.strain[i] / 9)) + 60 * (pow(1 - s.strain[i], -0.4) - 1);
    sheet_write(&place, "slow.csv", &s);
    for (int k = 0; k < 2; k++) {
        char text[300];
        sf_compression_config config;
        sf_compression_fit fit;
        sf_error err = SF_ERROR_INIT;
        snprintf(text, sizeof text, "density = \"35 kg/m3\";\ndensification = \"%s\";\n" SHEET_TEST_LIST,
                 rules[k]);
        if (sf_compression_config_read(program_write_text(&place, "fit.cfg", text), &config, &err) != SF_OK ||
            sf_compression_fit_run(&config, &fit, &err) != SF_OK)
            fail_msg("%s", err.text);
        const sf_estimate *e = &fit.estimate[SF_ESTIMATE_EXPONENT];
        assert_true(e->value < 1);
        assert_non_null(strstr(e->note, "below 1"));
        sf_compression_fit_free(&fit);
        sf_compression_config_free(&config);
    }
}

/* ---- the program ---- */

static void written_material_is_the_card_of_the_fit(void **state) {
    (void)state;
    sf_compression_config config;
    sf_compression_fit fit;
    sf_foam_card card;
    sf_case c;
    sf_error err = SF_ERROR_INIT;
    char material[700];
    read_tests(&config);
    assert_int_equal(sf_compression_fit_run(&config, &fit, &err), SF_OK);
    assert_int_equal(sf_compression_card(&fit, &card, &err), SF_OK);
    program_result r = program_succeed(&place, "fit", "compression fit.cfg -o out");
    assert_non_null(strstr(r.out, "SHAPE"));
    program_write_text(&place, "pad.geo", "// not meshed\n");
    snprintf(material, sizeof material, "material=@%s", program_path(&place, "out/material.cfg"));
    const char *const overrides[] = {material};
    const char *path = program_write_text(&place, "case.cfg",
                                          "geometry: { file = \"pad.geo\"; length_unit = \"mm\"; };\n"
                                          "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\n"
                                          "solver: { end_time = \"40 ms\"; };\n");
    if (sf_case_read(path, 1, overrides, NULL, &c, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_int_equal(sf_foam_card_of(&c.material)->curves.curve_count, card.curves.curve_count);
    assert_int_equal(sf_foam_card_of(&c.material)->curves.curve_points, card.curves.curve_points);
    assert_relative(sf_foam_card_of(&c.material)->modulus, card.modulus, 1e-10);
    assert_relative(sf_foam_card_of(&c.material)->shared.hysteresis_hu, card.shared.hysteresis_hu, 1e-10);
    assert_relative(sf_foam_card_of(&c.material)->shared.hysteresis_shape, card.shared.hysteresis_shape,
                    1e-10);
    assert_relative(sf_foam_card_of(&c.material)->densification_start, card.densification_start, 1e-10);
    assert_relative(sf_foam_card_of(&c.material)->densification_exponent, card.densification_exponent, 1e-10);
    for (int64_t k = 0; k < card.curves.curve_points; k++)
        assert_close(sf_foam_card_of(&c.material)->curves.curve_stress[k], card.curves.curve_stress[k],
                     1e-9 * card.curves.curve_stress[k]);
    sf_case_free(&c);
    sf_foam_card_free(&card);
    sf_compression_fit_free(&fit);
    sf_compression_config_free(&config);
}

static void results_are_replaced_only_by_force(void **state) {
    (void)state;
    sf_compression_config config;
    read_tests(&config);
    sf_compression_config_free(&config);
    program_succeed(&place, "fit", "compression fit.cfg -o twice");
    assert_int_equal(program_run(&place, "fit", "compression fit.cfg -o twice").code, SF_ERR_INPUT);
    program_succeed(&place, "fit", "compression fit.cfg -o twice --force");
    assert_int_equal(program_run(&place, "fit", "guess fit.cfg -o other").code, 2);
    assert_int_equal(program_run(&place, "fit", "compression none.cfg -o other").code, SF_ERR_INPUT);
    assert_int_not_equal(access(program_path(&place, "other"), F_OK), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spline_rows_are_value_slope_and_integral),
        cmocka_unit_test(knots_ascend_and_leave_two_points_between),
        cmocka_unit_test(maxwell_stress_is_that_of_the_solver),
        cmocka_unit_test(every_form_gives_a_card_that_the_solver_follows),
        cmocka_unit_test(exact_data_give_their_parameters_back),
        cmocka_unit_test(alpha_is_found_where_the_data_have_one),
        cmocka_unit_test(unloading_does_not_bend_the_loading),
        cmocka_unit_test(without_unloading_there_is_no_hysteresis_and_it_is_said),
        cmocka_unit_test(an_exponent_below_one_is_said),
        cmocka_unit_test(written_material_is_the_card_of_the_fit),
        cmocka_unit_test(results_are_replaced_only_by_force),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
