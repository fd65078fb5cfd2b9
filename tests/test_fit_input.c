/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The input of softfall-fit drop: what is refused, start values, measured curves. Nothing is simulated. */
#include "fit_fixture.h"
#include "study/fit/drop/drop_fit.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define DROPS(text) "drops = ( { name = \"a\"; case = \"case.cfg\"; " text " } );\n"
#define MATERIAL "material = \"start.cfg\";\n"
#define GOOD MATERIAL DROPS("a_max_g = 60.0; HIC = 180.0;")

/* The case of the fixture, and a material with curves at two rates. */
static void put_case(const program_place *place) {
    fit_fixture_put_case(place);
    program_write_text(
        place, "rates.cfg",
        "density = \"35 kg/m3\"; E = \"0.4136 MPa\"; curves = ( { rate = \"1 1/s\"; file = \"start.csv\"; },\n"
        "{ rate = \"100 1/s\"; file = \"fast.csv\"; } );\n");
    program_write_text(place, "fast.csv", "strain,stress_kPa\n0,0\n0.02,9\n0.5,90\n0.9,2200\n");
}

/* A half-sine of 60 g over 20 ms from 5 ms on, in the terms of a laboratory, with 20 g at 5 kHz. */
static void put_measured(const program_place *place, const char *name, double sign, double noise) {
    FILE *file = fopen(program_path(place, name), "w");
    assert_non_null(file);
    fputs("time_ms,acceleration_m_s2\r\n", file);
    for (int i = 0; i <= 600; i++) {
        double t = 0.05 * i, x = (t - 5) / 20;
        double a = (x > 0 && x < 1 ? 60 * sin(M_PI * x) : 0) + noise * sin(M_PI / 2 * i);
        fprintf(file, "%d.%02d,%.0f\r\n", i / 20, i % 20 * 5, sign * 9.80665 * a);
    }
    assert_int_equal(fclose(file), 0);
}

#define TEN "0123456789"
#define LONG_NAME TEN TEN TEN TEN TEN TEN TEN

#define ONE(name) "{ name = \"" name "\"; }, "
#define ALL_OF_SPLINE                                                                                        \
    ONE("spline_1")                                                                                          \
    ONE("spline_2")                                                                                          \
    ONE("spline_3")                                                                                          \
    ONE("spline_4")                                                                                          \
    ONE("spline_5")                                                                                          \
    ONE("spline_6")                                                                                          \
    ONE("spline_7")                                                                                          \
    ONE("spline_8")                                                                                          \
    ONE("spline_9")                                                                                          \
    ONE("s0")                                                                                                \
    ONE("p0")                                                                                                \
    ONE("B") ONE("m") ONE("E") ONE("HU") ONE("SHAPE") ONE("ALPHA") ONE("eta") "{ name = \"BETA1\"; }"

typedef struct refusal {
    const char *text, *sentence; /* of fit.cfg, and in the only line that softfall-fit writes */
} refusal;

static void assert_refusals(const refusal *bad, size_t count) {
    program_place place;
    program_set_up(&place);
    put_case(&place);
    program_shell(
        &place,
        "ln -s case.cfg link.cfg && cp case.cfg copy.cfg && sed 's/4.5 m/5.2 m/' case.cfg > fast.cfg");
    put_measured(&place, "lab.csv", 1, 5);
    for (size_t k = 0; k < count; k++) {
        program_write_text(&place, "fit.cfg", bad[k].text);
        program_result r = program_run(&place, "fit", "drop fit.cfg -o out");
        if (r.code == 0 || !strstr(r.err, bad[k].sentence) || strchr(r.err, '\n') != strrchr(r.err, '\n'))
            fail_msg("%s\nexit code %d, expected \"%s\", got: %s", bad[k].text, r.code, bad[k].sentence,
                     r.err);
    }
    program_tear_down(&place);
}

/* The file, and the drops with what was measured. */
static void bad_drops_are_refused(void **state) {
    (void)state;
    static const refusal bad[] = {
        {MATERIAL, "drops is missing"},
        {MATERIAL "drops = 3;\n", "drops must be a list"},
        {MATERIAL "drops = ( 3 );\n", "each entry must be a group"},
        {DROPS("a_max_g = 60.0;"), "material is missing"},
        {"material = \"none.cfg\";\n" DROPS("a_max_g = 60.0;"), "none.cfg cannot be read"},
        {MATERIAL DROPS(""), "the drop \"a\" has no a_max_g, no HIC, nothing else measured and no curve"},
        {MATERIAL DROPS("a_max_g = -3.0;"), "a_max_g is -3, outside"},
        {MATERIAL DROPS("a_max_g = \"60 g\";"), "a_max_g must be a number"},
        {MATERIAL DROPS("HIC = 100.0; HIC_sd = 0.0;"), "HIC_sd is 0, outside"},
        {MATERIAL DROPS("a_max_g = 60.0; HIC_window_resolution_ms = 0.5;"), "but no HIC_window_ms"},
        {MATERIAL DROPS("HIC_window_ms = 9.5; HIC_window_resolution_ms = 10.0;"), "is 10, outside"},
        {MATERIAL DROPS("a_max_g = 60.0; v_rebound_sd = 0.1;"),
         "v_rebound_sd is given, but no v_rebound_m_s"},
        {MATERIAL DROPS("contact_time_ms = \"20 ms\";"), "contact_time_ms must be a number"},
        {MATERIAL DROPS("amax = 60.0;"), "unknown key \"amax\"; the keys here are name, case, drop, a_max_g"},
        {MATERIAL DROPS("curve = \"none.csv\";"), "none.csv cannot be read"},
        {MATERIAL DROPS("curve = \"start.csv\";"), "start.csv"},
        {MATERIAL "drops = ( { name = \"a b\"; case = \"case.cfg\"; HIC = 3.0; } );\n", "begins file names"},
        {MATERIAL
         "drops = ( { name = \"a\"; case = \"case.cfg\"; HIC = 3.0; }, { name = \"a\"; case = \"case.cfg\"; "
         "HIC = 3.0; } );\n",
         "two drops are called \"a\""},
        {MATERIAL "drops = ( { name = \"a\"; case = \"case.cfg\"; HIC = 3.0; },\n"
                  "{ name = \"b\"; case = \"case.cfg\"; HIC = 3.5; },\n"
                  "{ name = \"c\"; case = \"./link.cfg\"; HIC = 3.0; HIC_sd = 0.1; } );\n",
         "fit.cfg:4: the drop \"c\" has the case and every measured value of \"a\": give the same data once"},
        {MATERIAL "drops = ( { name = \"a\"; case = \"case.cfg\"; HIC = 3.0; },\n"
                  "{ name = \"b\"; case = \"copy.cfg\"; HIC = 3.0; } );\n",
         "fit.cfg:3: the drop \"b\" has the case and every measured value of \"a\""},
        {MATERIAL "drops = ( { name = \"a\"; case = \"case.cfg\"; curve = \"lab.csv\"; },\n"
                  "{ name = \"b\"; case = \"fast.cfg\"; curve = \"lab.csv\"; a_max_g = 60.0; } );\n",
         "fit.cfg:3: the curve of the drop \"b\" is that of \"a\", sample by sample"},
        {MATERIAL DROPS("HIC = 3.0; curve = \"start.csv\"; curve_filter = \"60|180\";"), "must be one of"},
        {MATERIAL DROPS("HIC = 3.0; x = 1; y = 2; z = 3;"), "unknown key \"x\"; unknown too: y, z; the keys"},
        {MATERIAL "drops = ( { name = \"" LONG_NAME "\"; case = \"case.cfg\"; HIC = 3.0; } );\n",
         "is longer than 63 characters"},
        {GOOD "name = \"" LONG_NAME "\";\n", "longer than 63 and 159 characters"},
        {MATERIAL "drops = ( { case = \"none.cfg\"; HIC = 3.0; } );\n", "none.cfg cannot be read"},
        {GOOD "colour = 3;\n", "unknown key \"colour\""},
        {GOOD "name = \"a/b\";\n", "no slashes"},
        {GOOD "name = \"fit-curve\";\n", "not fit..."},
        {GOOD "start = ;\n", "syntax error"},
    };
    assert_refusals(bad, sizeof bad / sizeof bad[0]);
}

/* The form of the curve, its parameters and their start values. */
static void bad_parameters_are_refused(void **state) {
    (void)state;
    static const refusal bad[] = {
        {GOOD "curve_form = \"foam\";\n", "one of gas|"},
        {GOOD "curve_form = \"gas_solid\";\n", "needs solid_density"},
        {GOOD "solid_density = \"60 kg/m3\";\n", "solids that foams are made of"},
        {GOOD "unknown = ( { name = \"avalle_A\"; } );\n", "is not a parameter of curve_form = \"gas\""},
        {GOOD "start: { E = \"3e5 MPa\"; };\n", "E is above 1e+10"},
        {GOOD "start: { p0 = \"3 kg\"; };\n", "p0: "},
        {GOOD "start: { q0 = \"3 kPa\"; };\n", "unknown parameter \"q0\" of the foam"},
        {GOOD "start: { m = 0.5; };\n", "m is 0.5, outside 1.001 to 10"},
        {GOOD "start = 3;\n", "start must be a group"},
        {GOOD "solid_density = \"940 kg/m3\";\n", "solid_density is given, but curve_form = \"gas\" has no"},
        {GOOD
         "curve_form = \"gas_solid\"; solid_density = \"940 kg/m3\"; start: { solid_fraction = 0.3; };\n",
         "the solid fraction is given twice"},
        {GOOD "unknown = ( { name = \"p1\"; } );\n", "unknown parameter \"p1\" of the foam"},
        {GOOD "unknown = ( { name = \"stress_scale\"; } );\n", "is not a parameter of curve_form = \"gas\""},
        {GOOD "unknown = ( { name = \"eta\"; } );\n", "eta is 0 in the start material"},
        {GOOD "unknown = ( { name = \"p0\"; }, { name = \"p0\"; } );\n", "unknown: p0 is given twice"},
        {GOOD "unknown = ( { name = \"p0\"; prior_sd = 0.0; } );\n", "prior_sd is 0, outside"},
        {GOOD "start: { avalle_A = \"40 kPa\"; };\n",
         "fit.cfg:3: start: avalle_A is not a parameter of curve_form = \"gas\""},
        {GOOD "start: { solid_fraction = 0.05; };\n", "start: solid_fraction is not a parameter of"},
    };
    assert_refusals(bad, sizeof bad / sizeof bad[0]);
}

/* Several forms, and the terms of the rate. */
static void bad_models_are_refused(void **state) {
    (void)state;
    static const refusal bad[] = {
        {MATERIAL "forms = ( { rate = \"none\"; } );\n" DROPS("a_max_g = 60.0;"),
         "fit.cfg:2: curve is missing"},
        {MATERIAL "curve_form = \"gas\"; forms = ( { curve = \"gas\"; } );\n" DROPS("a_max_g = 60.0;"),
         "give either forms or curve_form"},
        {MATERIAL "forms = ( { curve = \"gas\"; }, { curve = \"rusch\"; } ); posterior = false;\n" DROPS(
             "a_max_g = 60.0;"),
         "posterior must be true"},
        {MATERIAL "forms = ( { curve = \"gas\"; rate = \"fast\"; } );\n" DROPS("a_max_g = 60.0;"),
         "must be one of none, factor, maxwell, both"},
        {MATERIAL "forms = ( { curve = \"gas\"; }, { curve = \"gass\"; } );\n" DROPS("a_max_g = 60.0;"),
         "curve is \"gass\""},
        {GOOD "start: { eta = \"1 Pa s\"; };\n"
              "forms = ( { curve = \"spline\"; rate = \"both\"; unknown = ( " ALL_OF_SPLINE " ); } );\n",
         "would be unknown number 21; at most 20 are allowed"},
        {"material = \"rates.cfg\"; forms = ( { curve = \"table\"; rate = \"factor\"; } );\n" DROPS(
             "a_max_g = 60.0;"),
         "rates.cfg, which has 2 curves at several rates; a foam has one or the other"},
        {GOOD
         "start: { rusch_A = \"40 kPa\"; }; forms = ( { curve = \"gas\"; }, { curve = \"avalle\"; } );\n",
         "start: rusch_A is a parameter of none of the forms"},
        {GOOD
         "start: { avalle_A = \"40 kPa\"; };\n"
         "forms = ( { curve = \"gas\"; start: { avalle_A = \"40 kPa\"; }; }, { curve = \"avalle\"; } );\n",
         "fit.cfg:4: start: avalle_A is not a parameter of curve = \"gas\""},
        {GOOD "forms = ( { curve = \"gas\"; rate = \"maxwell\"; start: { rate_factor = 0.2; }; } );\n",
         "fit.cfg:3: start: rate_factor is of the rate factor, which a model with rate = \"maxwell\""},
        {GOOD "forms = ( { curve = \"gas\"; rate = \"none\"; start: { rate_factor = 0.2; }; } );\n",
         "start: rate_factor is of the rate factor"},
        {GOOD "forms = ( { curve = \"gas\"; rate = \"factor\"; start: { ED = \"1 MPa\"; }; } );\n",
         "start: ED is of the Maxwell branch, which a model with rate = \"factor\" does not have"},
        {GOOD
         "unknown = ( { name = \"rate_factor\"; } ); forms = ( { curve = \"gas\"; rate = \"none\"; } );\n",
         "fit.cfg:3: rate_factor is of the rate factor, which a model with rate = \"none\""},
        {GOOD
         "unknown = ( { name = \"rate_factor\"; } ); forms = ( { curve = \"gas\"; rate = \"maxwell\"; } );\n",
         "rate_factor is of the rate factor, which a model with rate = \"maxwell\""},
        {GOOD "unknown = ( { name = \"ED\"; } ); forms = ( { curve = \"gas\"; rate = \"factor\"; } );\n",
         "ED is of the Maxwell branch, which a model with rate = \"factor\""},
    };
    assert_refusals(bad, sizeof bad / sizeof bad[0]);
}

/* The form with most parameters, with unloading and both terms of the rate: none is lost. */
static void every_unknown_is_identified(void **state) {
    (void)state;
    program_place place;
    sf_fit_input input;
    sf_error err = SF_ERROR_INIT;
    bool factor = false, maxwell = false;
    program_set_up(&place);
    put_case(&place);
    program_write_text(&place, "fit.cfg",
                       GOOD
                       "unknown = ( { name = \"HU\"; }, { name = \"SHAPE\"; }, { name = \"ALPHA\"; } );\n"
                       "forms = ( { curve = \"spline\"; rate = \"both\"; } );\n");
    if (sf_fit_input_read(program_path(&place, "fit.cfg"), 0, &input, &err) != SF_OK)
        fail_msg("%s", err.text);
    for (int k = 0; k < input.unknown_count; k++) {
        factor = factor || input.unknown[k] == SF_PARAMETER_RATE_FACTOR;
        maxwell = maxwell || input.unknown[k] == SF_PARAMETER_ED;
    }
    assert_int_equal(input.unknown_count, 15);
    assert_true(factor && maxwell);
    sf_fit_input_free(&input);
    program_tear_down(&place);
}

/* A start of all models is for those that use it; with `rate` as without it. */
static void common_start_values_are_for_the_models_that_use_them(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    put_case(&place);
    program_write_text(&place, "fit.cfg",
                       GOOD "start: { avalle_A = \"41 kPa\"; rate_factor = 0.2; ED = \"1 MPa\"; };\n"
                            "forms = ( { curve = \"gas\"; rate = \"none\"; }, { curve = \"avalle\"; rate = "
                            "\"factor\"; start: { rate_reference = \"2 1/s\"; }; } );\n");
    for (int m = 0; m < 2; m++) {
        sf_fit_input input;
        sf_error err = SF_ERROR_INIT;
        if (sf_fit_input_read(program_path(&place, "fit.cfg"), m, &input, &err) != SF_OK)
            fail_msg("%s", err.text);
        assert_true(input.start[SF_PARAMETER_ED] == 0);
        assert_true(input.start[SF_PARAMETER_RATE_FACTOR] == (m == 0 ? 0 : 0.2));
        assert_true(m == 0 || input.start[SF_PARAMETER_AVALLE_A] == 41e3);
        sf_fit_input_free(&input);
    }
    program_tear_down(&place);
}

/* Measured curves of drops are read and filtered as by softfall-post --reference. The model's side:
 * test_joint. */
static void measured_curves_are_read_and_filtered(void **state) {
    (void)state;
    static const struct {
        const char *text, *sentence;
        double peak, slack;
    } cases[] = {
        {"curve = \"lab.csv\";", NULL, 60, 0.8},
        {"curve = \"lab.csv\"; curve_filter = \"180\";", NULL, 60, 0.3},
        {"curve = \"lab.csv\"; curve_filter = \"none\";", NULL, 65, 0.3},
        {"curve = \"turned.csv\"; curve_invert = true;", NULL, 60, 0.8},
        {"curve = \"turned.csv\";", "looks inverted", 0, 0},
        {"curve = \"noise.csv\";", "a foam cannot be fitted to this record: do not use: noise", 0, 0},
        {"curve = \"lab.csv\"; curve_filter = \"500\";", "it must be one of none, 60", 0, 0},
        {"curve = \"lab.csv\"; curve_invert = 1;", "curve_invert must be true or false", 0, 0},
        {"curve = \"lab.csv\"; curve_column = \"CH2\";", "lab.csv:1: the heading has no column", 0, 0},
    };
    program_place place;
    program_set_up(&place);
    put_case(&place);
    put_measured(&place, "lab.csv", 1, 5);
    put_measured(&place, "turned.csv", -1, 5);
    put_measured(&place, "noise.csv", 1, 20);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char text[512];
        sf_fit_input input;
        sf_error err = SF_ERROR_INIT;
        snprintf(text, sizeof text, MATERIAL DROPS("%s"), cases[k].text);
        sf_fit_input_read(program_write_text(&place, "fit.cfg", text), 0, &input, &err);
        const char *sentence = cases[k].sentence;
        if (sentence ? !strstr(err.text, sentence) : err.status != SF_OK)
            fail_msg("%s: %s", cases[k].text, err.text);
        if (!sentence && !(fabs(input.drop[0].sample_scale - cases[k].peak) < cases[k].slack))
            fail_msg("%s: peak %g g", cases[k].text, input.drop[0].sample_scale);
        if (!sentence)
            assert_non_null(strstr(input.drop[0].interpretation, "time in ms, acceleration in m/s2"));
        sf_fit_input_free(&input);
    }
    program_tear_down(&place);
}

/* The medians of the curve follow the modulus and the solid fraction that `start` gives. */
static void medians_follow_the_modulus_of_the_start(void **state) {
    (void)state;
    program_place place;
    sf_fit_input input;
    sf_error err = SF_ERROR_INIT;
    program_set_up(&place);
    put_case(&place);
    assert_int_equal(
        sf_fit_input_read(program_write_text(&place, "fit.cfg", GOOD "start: { m = 2.0; E = \"4 MPa\"; };\n"),
                          0, &input, &err),
        SF_OK);
    assert_true(fabs(input.start[SF_PARAMETER_S0] / 80e3 - 1) < 1e-12 && input.start[SF_PARAMETER_M] == 2);
    sf_fit_input_free(&input);
    assert_int_equal(
        sf_fit_input_read(program_write_text(&place, "fit.cfg",
                                             GOOD "curve_form = \"spline\"; start: { solid_fraction "
                                                  "= 0.05; };\n"),
                          0, &input, &err),
        SF_OK);
    assert_true(input.start[SF_PARAMETER_M] == 2.5);
    sf_fit_input_free(&input);
    program_tear_down(&place);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_drops_are_refused),
        cmocka_unit_test(bad_parameters_are_refused),
        cmocka_unit_test(bad_models_are_refused),
        cmocka_unit_test(every_unknown_is_identified),
        cmocka_unit_test(common_start_values_are_for_the_models_that_use_them),
        cmocka_unit_test(measured_curves_are_read_and_filtered),
        cmocka_unit_test(medians_follow_the_modulus_of_the_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
