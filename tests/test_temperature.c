/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves at several temperatures, between which the pad's lies. */
#include "check.h"
#include "extreme.h"
#include "model_fixture.h"
#include "post_check.h"
#include "program_fixture.h"

#include "material/laws.h"
#include "model/model_io.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static program_result make_of(const program_place *p, const char *material, const char *temperature) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "geometry: { file = \"geo/pad.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
        "parameters = { fine_spacing = 20.0; outer_spacing = 25.0; }; };\n"
        "material: { density = \"35 kg/m3\"; %s };\n"
        "pad: { mesh_error_limit = 10.0; %s };\nmissile: { mass = \"4.6 kg\"; velocity = \"2 m/s\"; };\n"
        "solver: { end_time = \"1 ms\"; };\n",
        material, temperature);
    program_write_text(p, "t.cfg", text);
    return program_run(p, "pre", "t.cfg -o t.h5 --force");
}

static program_result make(const program_place *p, const char *curves, const char *temperature) {
    char material[1024];
    snprintf(material, sizeof material, "E = \"0.4 MPa\"; curves = ( %s );", curves);
    return make_of(p, material, temperature);
}

/* The cold curve is 4 times the warm one, and longer, with other strains. */
static int set_up(void **state) {
    program_group_case(state);
    const program_place *p = *state;
    program_write_text(p, "cold.csv", "strain,stress_kPa\n0,0\n0.1,80\n0.5,160\n0.7,400\n0.8,800\n");
    program_write_text(p, "quick.csv", "strain,stress_kPa\n0,0\n0.05,20\n0.1,45\n0.5,70\n0.7,210\n");
    program_write_text(p, "warm.csv", "strain,stress_kPa\n0,0\n0.05,10\n0.1,20\n0.5,40\n0.7,100\n");
    return 0;
}

static const char TWO[] =
    "{ temperature = \"-5 degC\"; file = \"cold.csv\"; }, { temperature = \"45 degC\"; file = \"warm.csv\"; }";

static double factor_at(const program_place *p, const char *temperature) {
    sf_model m = {0};
    sf_error err = SF_ERROR_INIT;
    program_result r = make(p, TWO, temperature);
    if (r.code != 0)
        fail_msg("%s", r.err);
    assert_int_equal(sf_model_read(program_path(p, "t.h5"), &m, NULL, &err), SF_OK);
    const sf_foam_card *card = sf_foam_card_of(&m.material[0]);
    assert_int_equal(card->curves.curve_count, 1);
    assert_int_equal(card->curves.curve_points, 5);
    double factor = card->curves.curve_stress[4] / 100e3;
    const double warm[] = {0, 10e3, 20e3, 40e3, 100e3};
    assert_true(fabs(card->curves.curve_strain[4] - 0.7) < 1e-12);
    for (int i = 0; i < 5; i++)
        assert_true(fabs(card->curves.curve_stress[i] - factor * warm[i]) < 1e-6);
    sf_model_free(&m);
    return factor;
}

static void stresses_lie_between_by_their_logarithm(void **state) {
    const program_place *p = *state;
    assert_true(fabs(factor_at(p, "temperature = \"-5 degC\";") - 4) < 1e-9);
    assert_true(fabs(factor_at(p, "temperature = \"20 degC\";") - 2) < 1e-9);
    assert_true(fabs(factor_at(p, "temperature = \"293.15 K\";") - 2) < 1e-9);
    assert_true(fabs(factor_at(p, "temperature = \"45 degC\";") - 1) < 1e-9);
}

static void expect(program_result r, const char *words) {
    if (r.code == 0 || !strstr(r.err, words))
        fail_msg("exit code %d, expected \"%s\", said: %s", r.code, words, r.err);
}

static void what_the_data_do_not_say_is_refused(void **state) {
    const program_place *p = *state;
    expect(make(p, TWO, "temperature = \"49 degC\";"), "there is no extrapolation");
    expect(make(p, TWO, "temperature = \"-5.1 degC\";"), "there is no extrapolation");
    expect(make(p, TWO, ""), "pad.temperature, such as");
    expect(make(p, TWO, "temperature = \"23 m\";"), "a temperature");
    expect(make(p, TWO, "temperature = \"23\";"), "no unit");
    expect(make(p, "{ temperature = \"5 degC\"; file = \"cold.csv\"; }", "temperature = \"5 degC\";"),
           "two of them");
    expect(
        make(
            p,
            "{ temperature = \"45 degC\"; file = \"warm.csv\"; }, { temperature = \"-5 degC\"; file = \"cold.csv\"; }",
            "temperature = \"5 degC\";"),
        "ascend");
    expect(
        make(p,
             "{ temperature = \"5 degC\"; file = \"cold.csv\"; }, { rate = \"5 1/s\"; file = \"cold.csv\"; }",
             "temperature = \"5 degC\";"),
        "each entry must be { temperature");
    expect(make(p, "{ rate = \"5 1/s\"; file = \"cold.csv\"; }", "temperature = \"5 degC\";"),
           "no curves at several temperatures");
}

/* ---- the shift of rates ---- */

#define RATES                                                                                                           \
    "E = \"0.4 MPa\"; ED = \"0.3 MPa\"; BETA1 = \"40 1/s\"; eta = \"20 Pa s\"; HU = 0.2; rate_filter_time = \"1 ns\"; " \
    "curves = ( { rate = \"0.5 1/s\"; file = \"warm.csv\"; }, { rate = \"50 1/s\"; file = \"quick.csv\"; } ); "
#define TERMS                                                                                                \
    "law = \"hyperfoam\"; term_1 = { mu = \"60 kPa\"; alpha = 8.0; }; HU = 0.3; rate_factor = 0.2; "         \
    "rate_reference = \"0.5 1/s\"; rate_filter_time = \"1 ns\"; "
static const char WLF[] = "shift = { C1 = 8.0; C2 = \"120 K\"; T_ref = \"23 degC\"; };",
                  ARRHENIUS[] = "shift = { E_a = \"60 kJ/mol\"; T_ref = \"23 degC\"; };";

/* The uniaxial stress of a material along a path, whose times are all multiplied by `slower`. */
static void follow(const sf_model *m, double slower, double stress[40]) {
    sf_material_law law;
    sf_error err = SF_ERROR_INIT;
    sf_uniaxial point = {0};
    double strain = 0;
    assert_int_equal(sf_material_law_build(&m->material[0], &law, &err), SF_OK);
    for (int k = 0; k < 40; k++) {
        strain += 0.05 * sin(0.3 * k) * (1 + 0.2 * (k % 3));
        stress[k] =
            law.law->uniaxial(law.numbers, slower * 1e-3 * (1 + k % 5), fmin(0.65, fmax(strain, 0)), &point);
    }
    sf_material_law_free(&law);
}

/* At T a path has the stresses of the same path at T_ref, run through `shift` times as fast. */
static void assert_shifts(const program_place *p, const char *material, const char *law, double shift) {
    sf_model there = {0}, here = {0};
    sf_error err = SF_ERROR_INIT;
    double a[40], b[40], c[40];
    char text[1024];
    snprintf(text, sizeof text, "%s %s", material, law);
    assert_int_equal(make_of(p, text, "").code, 0);
    assert_int_equal(sf_model_read(program_path(p, "t.h5"), &here, NULL, &err), SF_OK);
    program_result r = make_of(p, text, "temperature = \"5 degC\";");
    assert_int_equal(r.code, 0);
    assert_non_null(strstr(r.err, "a rate at 5 degC acts as"));
    assert_int_equal(sf_model_read(program_path(p, "t.h5"), &there, NULL, &err), SF_OK);
    assert_true(there.run.temperature == 278.15 && here.run.temperature == 0);
    follow(&there, 1, a);
    follow(&here, 1 / shift, b);
    follow(&here, 1, c);
    double differ = 0;
    for (int k = 0; k < 40; k++) {
        assert_true(fabs(a[k] - b[k]) <= 1e-9 * (1e3 + fabs(b[k])));
        differ = larger(differ, c[k] != 0 ? fabs(a[k] / c[k] - 1) : 0);
    }
    assert_true(differ > 0.05);
    sf_model_free(&there);
    sf_model_free(&here);
}

static void a_shift_of_the_rate_is_one_of_time(void **state) {
    const program_place *p = *state;
    double arrhenius = exp(60e3 / 8.31446261815324 * (1 / 278.15 - 1 / 296.15));
    assert_shifts(p, RATES, WLF, pow(10, 8.0 * 18 / (120 - 18)));
    assert_shifts(p, RATES, ARRHENIUS, arrhenius);
    assert_shifts(p, TERMS, ARRHENIUS, arrhenius);
}

static void a_shift_needs_rates_and_a_place(void **state) {
    const program_place *p = *state;
    static const char at[] = "temperature = \"5 degC\";";
    expect(make_of(p, RATES "shift = { C1 = 8.0; T_ref = \"23 degC\"; };", at), "both C1 and C2");
    expect(make_of(p, RATES "shift = { C1 = 8.0; C2 = \"120 K\"; };", ""), "needs T_ref");
    expect(make_of(p, RATES "shift = { T_ref = \"23 degC\"; };", at), "needs T_ref, and with it");
    expect(make_of(p, RATES "shift = { C1 = 8.0; C2 = \"51 K\"; E_a = \"60 kJ/mol\"; T_ref = \"23 degC\"; };",
                   at),
           "one of the two");
    expect(make_of(p, RATES "shift = { C1 = 8.0; C2 = \"51.6 degC\"; T_ref = \"23 degC\"; };", at),
           "out of bounds");
    expect(make_of(p, RATES "shift = { E_a = \"60 kJ\"; T_ref = \"23 degC\"; };", at),
           "an activation energy");
    expect(make_of(p, RATES "shift = { C1 = 8.0; C2 = \"20 K\"; T_ref = \"23 degC\"; };",
                   "temperature = \"0 degC\";"),
           "6 decades");
    expect(make_of(p, RATES "shift = { E_a = \"900 kJ/mol\"; T_ref = \"23 degC\"; };", at), "6 decades");
    expect(
        make_of(
            p,
            "E = \"0.4 MPa\"; curve = \"warm.csv\"; shift = { E_a = \"60 kJ/mol\"; T_ref = \"23 degC\"; };",
            at),
        "moves nothing");
    char both[1024];
    snprintf(both, sizeof both, "E = \"0.4 MPa\"; ED = \"1 kPa\"; BETA1 = \"9 1/s\"; curves = ( %s ); %s",
             TWO, ARRHENIUS);
    expect(make_of(p, both, at), "act twice");
}

static void a_rate_outside_the_data_is_told(void **state) {
    const program_place *p = *state;
    static const char fast[] = "shift = { E_a = \"200 kJ/mol\"; T_ref = \"23 degC\"; };";
    char text[1024];
    snprintf(text, sizeof text, "%s %s", RATES, fast);
    assert_int_equal(make_of(p, text, "temperature = \"49 degC\";").code, 0); /* 0.5 1/s becomes 345 1/s */
    program_result r = program_run(p, "solve", "t.h5 -o t-warm.h5 --force");
    assert_int_equal(r.code, 0);
    assert_non_null(strstr(r.err, "at 49 degC the rate of the impact"));
    assert_non_null(strstr(r.err, "below the lowest"));
    assert_int_equal(make_of(p, text, "temperature = \"5 degC\";").code, 0);
    assert_non_null(strstr(program_run(p, "solve", "t.h5 -o t-cold.h5 --force").err, "above the highest"));
    assert_int_equal(make_of(p, text, "").code, 0);
    assert_null(strstr(program_run(p, "solve", "t.h5 -o t-plain.h5 --force").err, "rate of the impact"));
}

/* ---- softfall-fit compression ---- */

/* Stress (kPa) and energy of a foam that a temperature makes stiffer by `factor`. */
static double stress_of(double factor, double e) {
    return factor * (8 * (1 - exp(-50 * e)) + 100 * e / (1 - e));
}

static double energy_of(double e) {
    return 8 * (e - (1 - exp(-50 * e)) / 50) + 100 * (-e - log(1 - e));
}

/* To a strain of 0.7 and back, with HU = 0.1 and SHAPE = 2 on the curve of this temperature. */
static void put_test(const program_place *p, const char *name, double factor) {
    FILE *file = fopen(program_path(p, name), "w");
    assert_non_null(file);
    fputs("strain,stress_kPa\n", file);
    for (int k = 1; k < 280; k++) {
        double e = 0.005 * (k <= 140 ? k : 280 - k), w = energy_of(e) / energy_of(0.7);
        fprintf(file, "%.6f,%.9g\n", e, stress_of(factor, e) * (k <= 140 ? 1 : 1 - 0.9 * (1 - w * w)));
    }
    assert_int_equal(fclose(file), 0);
}

#define AT(temperature, name, rate)                                                                          \
    "{ temperature = \"" temperature "\"; file = \"" name "\"; rate = \"" rate " 1/s\"; }"
#define FIT(tests) "density = \"35 kg/m3\"; tests = ( " tests " );\n"
#define THREE                                                                                                \
    AT("49 degC", "at49.csv", "0.1003")                                                                      \
    ", " AT("-4 degC", "at-4.csv", "0.1") ", " AT("23 degC", "at23.csv", "0.1")

/* One fit of three temperatures: one unloading and densification, a curve for each, which a case reads. */
static void one_fit_has_a_curve_for_each_temperature(void **state) {
    const program_place *p = *state;
    sf_model m = {0};
    sf_error err = SF_ERROR_INIT;
    put_test(p, "at-4.csv", 1.6);
    put_test(p, "at23.csv", 1);
    put_test(p, "at49.csv", 0.7);
    program_write_text(p, "fit.cfg", FIT(THREE));
    program_result r = program_succeed(p, "fit", "compression fit.cfg -o fitted");
    assert_non_null(strstr(r.out, "at-4.csv at 0.1 1/s and -4 degC, to a strain of 0.7"));
    program_bytes json = program_read_file(program_path(p, "fitted/fit.json"));
    assert_true(fabs(program_json_number(strstr(json.data, "at49.csv"), NULL, "temperature_K") - 322.15) <
                1e-9);
    for (int k = 0; k < 2; k++)
        assert_true(program_json_number(strstr(json.data, k ? "at49.csv" : "at-4.csv"), NULL,
                                        "loading_rms_percent") < 1);
    assert_true(program_json_number(json.data, NULL, "card_difference_percent") < 1);
    free(json.data);
    assert_int_equal(make(p, TWO, "temperature = \"-4 degC\";").code, 0);
    const struct {
        const char *at;
        double factor;
    } cases[] = {{"23 degC", 1}, {"36 degC", sqrt(0.7)}, {"-4 degC", 1.6}};
    for (int k = 0; k < 3; k++) {
        program_succeed(
            p, "pre", "t.cfg -o t.h5 --force --set material=@fitted/material.cfg --set pad.temperature='%s'",
            cases[k].at);
        assert_int_equal(sf_model_read(program_path(p, "t.h5"), &m, NULL, &err), SF_OK);
        const sf_foam_card *card = sf_foam_card_of(&m.material[0]);
        assert_int_equal(card->curves.curve_count, 1);
        assert_close(card->shared.hysteresis_hu, 0.1, 0.01);
        assert_close(card->shared.hysteresis_shape, 2, 0.1);
        assert_close(card->modulus, 320e3, 30e3); /* of 23 degC; the others have 1.6 and 0.7 times that */
        for (int64_t i = 1; i < card->curves.curve_points; i++)
            if (card->curves.curve_strain[i] > 0.02 && card->curves.curve_strain[i] < 0.69)
                assert_relative(card->curves.curve_stress[i],
                                1e3 * stress_of(cases[k].factor, card->curves.curve_strain[i]), 0.02);
        sf_model_free(&m);
    }
    expect(program_run(p, "pre",
                       "t.cfg -o x.h5 --set material=@fitted/material.cfg --set pad.temperature='50 degC'"),
           "outside the curves' -4 to 49 degC");
}

static void tests_at_temperatures_are_all_alike(void **state) {
    const program_place *p = *state;
    static const char *const bad[][2] = {
        {FIT(THREE ", { file = \"warm.csv\"; rate = \"0.1 1/s\"; }"), "give it to all or to none"},
        {FIT(AT("23 degC", "at23.csv", "0.1") ", " AT("23 degC", "at49.csv", "0.1")), "have each its own"},
        {FIT(AT("23 degC", "at23.csv", "0.1") ", " AT("49 degC", "at49.csv", "1")), "and all the same rate"},
        {FIT(AT("23 degC", "at23.csv", "0.1")), "a material needs curves at two or more"},
        {FIT(THREE) "rate_model = \"log\";\n", "rate_model is for tests at several rates"},
        {FIT(THREE) "curve_form = \"gas\";\n", "use softfall fit compression bad.cfg"},
        {FIT(AT("23 kg", "at23.csv", "0.1")), "temperature: "},
        {FIT(AT("23 degC", "at23.csv", "0.1") ", " AT("5000 K", "at49.csv", "0.1")), "outside 100 to 600 K"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        program_write_text(p, "bad.cfg", bad[k][0]);
        expect(program_run(p, "fit", "compression bad.cfg -o bad"), bad[k][1]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stresses_lie_between_by_their_logarithm),
        cmocka_unit_test(what_the_data_do_not_say_is_refused),
        cmocka_unit_test(a_shift_of_the_rate_is_one_of_time),
        cmocka_unit_test(a_shift_needs_rates_and_a_place),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_rate_outside_the_data_is_told),
        cmocka_unit_test(one_fit_has_a_curve_for_each_temperature),
        cmocka_unit_test(tests_at_temperatures_are_all_alike),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
