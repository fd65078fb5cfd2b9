/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Identification from drops: the refusals of the input, and whole fits on a coarse mesh. */
#include "extreme.h"
#include "study/fit/drop/drop_fit.h"
#include "study/fit/form/form.h"
#include "foam_fixture.h"
#include "io/folder.h"
#include "post/figures/signal.h"
#include "post_check.h"
#include "fit_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

static const sf_gas_curve eva = {0.4136e6, 7.4e3, 134e3, 23e3, 2.8, 0};

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
    fputs("Zeit;Beschleunigung\r\nms;m/s2\r\n", file);
    for (int i = 0; i <= 600; i++) {
        double t = 0.05 * i, x = (t - 5) / 20;
        double a = (x > 0 && x < 1 ? 60 * sin(M_PI * x) : 0) + noise * sin(M_PI / 2 * i);
        fprintf(file, "%d,%02d;%.0f\r\n", i / 20, i % 20 * 5, sign * 9.80665 * a);
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

static void bad_input_gets_one_sentence(void **state) {
    (void)state;
    static const struct {
        const char *text, *sentence;
    } bad[] = {
        {MATERIAL, "drops is missing"},
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
        {GOOD "curve_form = \"foam\";\n", "one of gas|"},
        {GOOD "curve_form = \"gas_solid\";\n", "needs solid_density"},
        {GOOD "solid_density = \"60 kg/m3\";\n", "solids that foams are made of"},
        {GOOD "unknown = ( { name = \"avalle_A\"; } );\n", "is no parameter of curve_form = \"gas\""},
        {GOOD "name = \"a/b\";\n", "no slashes"},
        {GOOD "name = \"fit-curve\";\n", "not fit..."},
        {GOOD "start: { p0 = \"600 kPa\"; };\n", "is not below E"},
        {GOOD "start: { E = \"3e5 MPa\"; };\n", "E is above 1e+10"},
        {GOOD "start: { p0 = \"3 kg\"; };\n", "p0: "},
        {GOOD "start: { q0 = \"3 kPa\"; };\n", "\"q0\" is no parameter of the foam"},
        {GOOD "start: { m = 0.5; };\n", "m is 0.5, outside 1.001 to 10"},
        {GOOD "start = 3;\n", "start must be a group"},
        {GOOD "solid_density = \"940 kg/m3\";\n", "solid_density is given, but curve_form = \"gas\" has no"},
        {GOOD
         "curve_form = \"gas_solid\"; solid_density = \"940 kg/m3\"; start: { solid_fraction = 0.3; };\n",
         "the solid fraction is given twice"},
        {GOOD "start: { eta = \"1 Pa s\"; };\n"
              "forms = ( { curve = \"spline\"; rate = \"both\"; unknown = ( " ALL_OF_SPLINE " ); } );\n",
         "would be one more than 20 unknown parameters"},
        {"material = \"rates.cfg\"; forms = ( { curve = \"table\"; rate = \"factor\"; } );\n" DROPS(
             "a_max_g = 60.0;"),
         "rates.cfg, which has 2 curves at several rates; a foam has one or the other"},
        {GOOD "unknown = ( { name = \"p1\"; } );\n", "\"p1\" is no parameter of the foam"},
        {GOOD "unknown = ( { name = \"stress_scale\"; } );\n", "is no parameter of curve_form = \"gas\""},
        {GOOD "unknown = ( { name = \"eta\"; } );\n", "eta is 0 in the start material"},
        {GOOD "unknown = ( { name = \"p0\"; }, { name = \"p0\"; } );\n", "p0 is unknown twice"},
        {GOOD "unknown = ( { name = \"p0\"; prior_sd = 0.0; } );\n", "prior_sd is 0, outside"},
        {GOOD "start: { avalle_A = \"40 kPa\"; };\n",
         "fit.cfg:3: start: avalle_A is no parameter of curve_form = \"gas\""},
        {GOOD "start: { solid_fraction = 0.05; };\n", "start: solid_fraction is no parameter of"},
        {GOOD
         "start: { rusch_A = \"40 kPa\"; }; forms = ( { curve = \"gas\"; }, { curve = \"avalle\"; } );\n",
         "start: rusch_A is a parameter of none of the forms"},
        {GOOD
         "start: { avalle_A = \"40 kPa\"; };\n"
         "forms = ( { curve = \"gas\"; start: { avalle_A = \"40 kPa\"; }; }, { curve = \"avalle\"; } );\n",
         "fit.cfg:4: start: avalle_A is no parameter of curve = \"gas\""},
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
        {GOOD "start = ;\n", "syntax error"},
    };
    program_place place;
    program_set_up(&place);
    put_case(&place);
    program_shell(
        &place,
        "ln -s case.cfg link.cfg && cp case.cfg copy.cfg && sed 's/4.5 m/5.2 m/' case.cfg > fast.cfg");
    put_measured(&place, "lab.csv", 1, 5);
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        program_write_text(&place, "fit.cfg", bad[k].text);
        program_result r = program_run(&place, "fit", "drop fit.cfg -o out");
        if (r.code == 0 || !strstr(r.err, bad[k].sentence) || strchr(r.err, '\n') != strrchr(r.err, '\n'))
            fail_msg("%s\nexit code %d, expected \"%s\", got: %s", bad[k].text, r.code, bad[k].sentence,
                     r.err);
    }
    program_tear_down(&place);
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
        {"curve = \"lab.csv\"; curve_column = \"CH2\";", "lab.csv:1: the header has no column", 0, 0},
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
            assert_non_null(
                strstr(input.drop[0].interpretation, "separator \";\", decimal comma, time in ms"));
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

/* A fit that begins at the least SHAPE that a case allows beside its ALPHA goes no further, nor do its draws.
 */
static void no_foam_is_one_that_a_case_refuses(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    put_case(&place);
    program_shell(&place, "sed -i 's/$/ SHAPE = 0.051; ALPHA = 0.4;/' start.cfg");
    program_write_text(&place, "fit.cfg",
                       "material = \"start.cfg\"; unknown = ( { name = \"SHAPE\"; }, { name = \"p0\"; } );\n"
                       "drops = ( { name = \"a\"; case = \"case.cfg\"; a_max_g = 60.0; HIC = 150.0; } );\n");
    program_result fit = program_run(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_int_equal(fit.code, 0);
    program_result draws =
        program_shell(&place, "grep -l 'SHAPE = 0\\.0[0-4]' out/material.cfg out/posterior/*.cfg");
    assert_string_equal(draws.out, "");
    assert_int_equal(program_shell(&place, "test \"$(ls out/posterior/*.cfg | wc -l)\" = 200").code, 0);
    program_succeed(&place, "pre", "case.cfg --set material=@out/posterior/draw-001.cfg -o m.h5");
    program_tear_down(&place);
}

/* The number after `before`, in text that begins there. */
static double number_after(const char *text, const char *before) {
    const char *at = strstr(text, before);
    if (!at)
        fail_msg("no \"%s\" in: %s", before, text);
    return strtod(at + strlen(before), NULL);
}

/* Each draw of out/posterior has the errors of the responses of its row in out/posterior.csv, and the size
 * that kappa says; they are not the same in all. */
static void assert_response_errors(const program_place *place) {
    double kappa[200], hic[200], hic_sd[200], a_max_sd[200], least = INFINITY, greatest = -INFINITY;
    program_result r = program_shell(
        place,
        "sed 's/\"[^\"]*\"/model/' out/posterior.csv | awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) at[$k] = k; next } { print $at[\"kappa\"], "
        "$at[\"HIC_error\"], $at[\"HIC_error_sd\"], $at[\"a_max_error_sd\"] }'");
    assert_int_equal(r.code, 0);
    char *at = r.out;
    for (int k = 0; k < 200; k++) {
        char name[64];
        double *const row[] = {&kappa[k], &hic[k], &hic_sd[k], &a_max_sd[k]};
        for (int c = 0; c < 4; c++)
            *row[c] = strtod(at, &at);
        snprintf(name, sizeof name, "out/posterior/draw-%03d.cfg", k + 1);
        program_bytes file = program_read_file(program_path(place, name));
        assert_true(fabs(number_after(file.data, "; HIC_sd = ") - hic_sd[k]) < 1e-8);
        assert_true(fabs(number_after(file.data, " HIC = ") - hic[k]) < 1e-8);
        assert_true(fabs(hic_sd[k] - 0.02 * kappa[k]) < 1e-8 && fabs(a_max_sd[k] - 0.01 * kappa[k]) < 1e-8);
        least = smaller(least, hic[k]);
        greatest = larger(greatest, hic[k]);
        free(file.data);
    }
    assert_true(least < greatest && kappa[0] > 0);
}

/* No foam of this thickness has 15 g: the peak is least at some stress, where the columns still expect less. */
static void what_no_foam_has_does_not_converge(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    put_case(&place);
    program_write_text(&place, "fit.cfg",
                       "material = \"start.cfg\"; curve_form = \"table\"; posterior = false;\n"
                       "unknown = ( { name = \"stress_scale\"; prior_sd = 2.0; } );\n"
                       "drops = ( { name = \"a\"; case = \"case.cfg\"; a_max_g = 15.0; } );\n");
    program_result fit = program_run(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_int_equal(fit.code, 5);
    assert_non_null(strstr(fit.err, "no step that the columns propose lowers the objective"));
    assert_non_null(strstr(fit.err, "1 of 1 fits did not converge: the files are written"));
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    assert_non_null(strstr(json.data, "\"converged\": false"));
    free(json.data);
    program_bytes material = program_read_file(program_path(&place, "out/material.cfg"));
    assert_non_null(strstr(material.data, "NOT CONVERGED: no step that the columns propose"));
    free(material.data);
    program_tear_down(&place);
}

/* The cushion curve of examples/foams/pe.cfg by the form avalle: avalle_n cannot be below 1, where the misfit
 * would be least. The minimum within the bounds is found, and said to be there. */
static void a_fit_ends_at_the_bound_of_a_parameter(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    program_shell(
        &place,
        "cp \"$SF_SOURCE_DIR\"/examples/foams/pe_start.cfg \"$SF_SOURCE_DIR\"/examples/foams/foam_start.csv .");
    program_write_text(
        &place, "fit.cfg",
        "name = \"pe\"; material = \"pe_start.cfg\"; curve_form = \"avalle\"; posterior = false;\n"
        "cushions = ( { name = \"PE\"; stress_energy: { A = \"68.04 kPa\"; B = 0.015664; from = "
        "\"10 kPa\"; to = \"150 kPa\"; }; thickness = \"50 mm\"; drop_height = \"0.6 m\"; } );\n");
    program_result fit = program_run(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_int_equal(fit.code, 0);
    assert_non_null(strstr(fit.out, "avalle_n stands at its bound"));
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    assert_true(number_after(json.data, "\"misfit\": ") < 4);
    free(json.data);
    program_tear_down(&place);
}

/* Coarse drops with a hidden foam are identified: the responses are met, the second run simulates nothing. */
static void hidden_foam_is_found(void **state) {
    (void)state;
    static const char *const speed[2] = {"4.5 m/s", "6.2 m/s"};
    program_place place;
    double a_max[2], hic[2], window[2], begin[2], end[2], contact[2], left[2], rebound[2];
    char text[1536];
    program_set_up(&place);
    put_case(&place);
    program_write_text(
        &place, "hidden.cfg",
        "density = \"35 kg/m3\"; E = \"0.4136 MPa\"; curve = \"hidden.csv\"; HU = 0.01; ED = \"3 MPa\"; "
        "BETA1 = \"5000 1/s\";\n");
    FILE *curve = fopen(program_path(&place, "hidden.csv"), "w");
    assert_non_null(curve);
    fputs("strain,stress_Pa\n", curve);
    for (int k = 0; k <= 95; k++)
        fprintf(curve, "%g,%.9g\n", 0.01 * k, sf_gas_curve_stress(&eva, 0.01 * k));
    fclose(curve);
    for (int k = 0; k < 2; k++) {
        program_succeed(&place, "pre",
                        "case.cfg --set material=@hidden.cfg --set missile.velocity='%s' -o m.h5 --force",
                        speed[k]);
        program_succeed(&place, "solve", "m.h5 -o r.h5 --force");
        program_succeed(&place, "post", "r.h5 -o post --force");
        program_bytes json = program_read_file(program_path(&place, "post/summary.json"));
        assert_int_equal(sscanf(strstr(json.data, "\"a_max_g\":"), "\"a_max_g\": %lf", &a_max[k]), 1);
        assert_int_equal(sscanf(strstr(json.data, "\"hic\":"), "\"hic\": %lf", &hic[k]), 1);
        begin[k] = program_json_number(json.data, NULL, "hic_t1_ms");
        end[k] = program_json_number(json.data, NULL, "hic_t2_ms");
        contact[k] = program_json_number(json.data, NULL, "contact_time_ms");
        left[k] = program_json_number(json.data, NULL, "rebound_time_ms");
        rebound[k] = program_json_number(json.data, NULL, "v_rebound_m_s");
        window[k] = end[k] - begin[k];
        free(json.data);
    }
    program_shell(&place, "sed 's/4.5 m/6.2 m/' case.cfg > fast.cfg");
    snprintf(
        text, sizeof text,
        "material = \"start.cfg\";\nunknown = ( { name = \"p0\"; }, { name = \"B\"; }, { name = \"ED\"; "
        "} );\n"
        "start: { m = 2.8; s0 = \"7.4 kPa\"; };\n"
        "drops = ( { name = \"slow\"; case = \"case.cfg\"; a_max_g = %.9g; HIC = %.9g; HIC_window_ms = %.9g; "
        "HIC_window_resolution_ms = 0.5; v_rebound_m_s = %.9g; contact_time_ms = %.9g; },\n"
        "{ name = \"fast\"; case = \"fast.cfg\"; a_max_g = %.9g; HIC = %.9g; } );\n",
        a_max[0], hic[0], window[0], rebound[0], left[0] - contact[0], a_max[1], hic[1]);
    program_write_text(&place, "fit.cfg", text);
    program_succeed(&place, "fit", "drop fit.cfg -o out -t 1");
    program_assert_page(&place, "out/report.html", "softfall-fit drop fit.cfg -o out -t 1");
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    const char *at = json.data;
    for (int k = 0; k < 2; k++) { /* within a fifth of a standard deviation of the data */
        double a, h;
        at = strstr(at, "\"a_max_g\":");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "\"a_max_g\": %lf", &a), 1);
        at = strstr(at, "\"hic\":");
        assert_int_equal(sscanf(at, "\"hic\": %lf", &h), 1);
        assert_true(fabs(a / a_max[k] - 1) < 0.004 && fabs(h / hic[k] - 1) < 0.008);
    }
    assert_non_null(strstr(json.data, "\"converged\": true"));
    assert_true(fabs(program_json_number(json.data, NULL, "hic_window_measured_sd") -
                     0.5 / sqrt(6) / window[0]) < 1e-6);
    assert_true(fabs(program_json_number(json.data, NULL, "hic_window_ms") / window[0] - 1) < 0.01);
    assert_true(fabs(program_json_number(json.data, NULL, "v_rebound_m_s") / rebound[0] - 1) < 0.015);
    assert_true(fabs(program_json_number(json.data, NULL, "contact_time_ms") / (left[0] - contact[0]) - 1) <
                0.01);
    assert_true(program_json_number(json.data, NULL, "hic_window_from_others_ms") > 0);
    const double hidden[3] = {134e3, 23e3, 3e6}; /* p0, B, ED */
    at = strstr(json.data, "\"parameters\":");
    for (int k = 0; k < 3; k++) {
        double low, high;
        at = strstr(at, "\"low95_SI\":");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "\"low95_SI\": %lf, \"high95_SI\": %lf", &low, &high), 2);
        assert_true(low < hidden[k] && hidden[k] < high && high < 10 * low);
        at++;
    }
    assert_non_null(strstr(json.data, "\"criteria_reached\": true"));
    free(json.data);
    assert_int_equal(program_shell(&place,
                                   "test \"$(ls out/posterior/*.cfg | wc -l)\" = 200 && test \"$(wc -l < "
                                   "out/posterior.csv)\" = 201 && cp -r out first")
                         .code,
                     0);
    program_succeed(&place, "pre", "case.cfg --set material=@out/posterior/draw-100.cfg -o m.h5 --force");
    assert_response_errors(&place);
    program_result again = program_run(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_true(again.code == 2 && strstr(again.err, "--force"));
    again = program_succeed(&place, "fit", "drop fit.cfg -o out -t 2 --force");
    assert_non_null(strstr(again.out, "\n0 drops simulated"));
    assert_int_equal(program_shell(&place, "cmp first/posterior.csv out/posterior.csv && cmp "
                                           "first/posterior/draw-007.csv out/posterior/draw-007.csv")
                         .code,
                     0);
    program_succeed(&place, "pre", "case.cfg --set material=@out/material.cfg -o m.h5 --force");
    /* The strains that the drops inform are data of the material, and each drop has its grade. */
    assert_int_equal(program_shell(&place, "grep -q '^informed_strain = 0\\.[2-9]' out/material.cfg").code,
                     0);
    assert_int_equal(program_shell(&place, "test \"$(grep -c '\"grade\": \"valid' out/fit.json)\" = 2").code,
                     0);
    /* What was measured must be in the simulation. */
    program_shell(&place, "sed 's/end_time = \"[^\"]*\"/end_time = \"24 ms\"/' case.cfg > early.cfg && sed "
                          "'s/\"case.cfg\"/\"early.cfg\"/' fit.cfg > bad.cfg");
    program_result early = program_run(&place, "fit", "drop bad.cfg -o bad -t 1");
    assert_int_equal(early.code, SF_ERR_NUMERIC);
    assert_non_null(strstr(early.err, "v_rebound_m_s of the drop slow was measured, but its simulation ends "
                                      "without rebound within its time: raise solver.end_time"));
    /* A drop that ends before its peak is no measure. */
    program_shell(&place, "sed 's/end_time = \"[^\"]*\"/end_time = \"4 ms\"/' case.cfg > short.cfg && sed "
                          "'s/\"case.cfg\"/\"short.cfg\"/' fit.cfg > bad.cfg");
    program_result refused = program_run(&place, "fit", "drop bad.cfg -o bad -t 1");
    assert_int_equal(refused.code, SF_ERR_NUMERIC);
    assert_non_null(strstr(refused.err, "the drop slow: do not use: deceleration left at the end"));
    program_tear_down(&place);
}

/* A prediction is of a single pad and drop: speed and thickness of its case scatter. */
static void a_predicted_drop_scatters(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    put_case(&place);
    program_shell(&place,
                  "sed 's/4.5 m/5 m/' case.cfg > fast.cfg; sed 's/^missile: {/& speed_scatter = 0.0;/' "
                  "fast.cfg > exact.cfg; echo 'pad: { thickness_tolerance = \"0 mm\"; };' >> exact.cfg");
    program_write_text(
        &place, "fit.cfg",
        "material = \"start.cfg\"; curve_form = \"table\"; posterior = false;\n"
        "unknown = ( { name = \"stress_scale\"; } );\n"
        "drops = ( { name = \"a\"; case = \"case.cfg\"; a_max_g = 66.0; } );\n"
        "predict = ( { name = \"fast\"; case = \"fast.cfg\"; }, { name = \"exact\"; case = \"exact.cfg\"; } );\n");
    program_result r = program_succeed(&place, "fit", "drop fit.cfg -o out -t 1");
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    const char *told = strstr(r.out, "\nConverged"), *fast = strstr(json.data, "\"fast\""),
               *exact = strstr(json.data, "\"exact\"");
    double by_parameters = program_json_number(fast, NULL, "a_max_sd_by_parameters"),
           scatter = program_json_number(fast, NULL, "a_max_scatter"),
           both = number_after(strstr(told, "  fast "), "± "),
           alone = number_after(strstr(told, "  exact "), "± ");
    assert_true(scatter > 0.005 && program_json_number(exact, NULL, "a_max_scatter") == 0);
    assert_close(alone, 196 * by_parameters, 0.06); /* printed with one digit */
    assert_close(both, 196 * hypot(by_parameters, scatter), 0.06);
    free(json.data);
    program_tear_down(&place);
}

/* The record of a drop on a mount of 100 Hz tells the mount's frequency beside the foam, and a fit that takes
 * the mount for rigid does not describe it. */
static void the_mount_of_the_accelerometer_is_found(void **state) {
    (void)state;
    static const char *const chain[] = {"mount = \"f = 130 Hz, damping = 0.4\"; mount_frequency_sd = 0.3;\n",
                                        ""};
    program_place place;
    double misfit[2];
    program_set_up(&place);
    put_case(&place);
    program_succeed(&place, "pre", "case.cfg -o m.h5");
    program_succeed(&place, "solve", "m.h5 -o r.h5");
    program_succeed(&place, "post", "r.h5 -o post --mount 'f = 100 Hz, damping = 0.4'");
    for (int k = 0; k < 2; k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "material = \"start.cfg\"; curve_form = \"table\"; posterior = false;\n"
                 "unknown = ( { name = \"stress_scale\"; } );\n%s"
                 "drops = ( { name = \"a\"; case = \"case.cfg\"; curve = \"post/history.csv\"; "
                 "curve_column = \"acceleration_cfc1000_g\"; curve_sd = 0.005; } );\n",
                 chain[k]);
        program_write_text(&place, "fit.cfg", text);
        program_result r = program_run(&place, "fit", "drop fit.cfg -o out%d -t 1", k);
        assert_int_equal(r.code, 0);
        if (k == 0) {
            assert_relative(number_after(r.out, "accelerometer's mount: frequency "), 100, 0.03);
            assert_relative(number_after(r.out, "stress_scale"), 1, 0.01);
            program_bytes page = program_read_file(program_path(&place, "out0/report.html"));
            assert_non_null(strstr(page.data, "mount: frequency"));
            free(page.data);
        }
        misfit[k] = number_after(r.out, "misfit ");
    }
    assert_true(misfit[1] > 10 * misfit[0]);
    program_tear_down(&place);
}

static void a_second_fit_in_the_folder_is_refused(void **state) {
    (void)state;
    program_place place;
    sf_error err = SF_ERROR_INIT;
    int lock = -1;
    program_set_up(&place);
    put_case(&place);
    program_write_text(&place, "fit.cfg",
                       "material = \"start.cfg\";\nunknown = ( { name = \"E\"; } );\n"
                       "drops = ( { name = \"slow\"; case = \"case.cfg\"; a_max_g = 50.0; } );\n");
    program_shell(&place, "mkdir taken");
    assert_int_equal(sf_folder_lock(program_path(&place, "taken"), &lock, &err), SF_OK);
    program_result r = program_run(&place, "fit", "drop fit.cfg -o taken");
    assert_int_equal(r.code, SF_ERR_INPUT);
    if (!strstr(r.err, "another campaign is at work in taken"))
        fail_msg("%s", r.err);
    assert_int_equal(program_shell(&place, "test -e taken/runs").code, 1);
    close(lock);
    program_tear_down(&place);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_input_gets_one_sentence),
        cmocka_unit_test(every_unknown_is_identified),
        cmocka_unit_test(common_start_values_are_for_the_models_that_use_them),
        cmocka_unit_test(measured_curves_are_read_and_filtered),
        cmocka_unit_test(medians_follow_the_modulus_of_the_start),
        cmocka_unit_test(no_foam_is_one_that_a_case_refuses),
        cmocka_unit_test(what_no_foam_has_does_not_converge),
        cmocka_unit_test(a_fit_ends_at_the_bound_of_a_parameter),
        cmocka_unit_test(hidden_foam_is_found),
        cmocka_unit_test(a_predicted_drop_scatters),
        cmocka_unit_test(the_mount_of_the_accelerometer_is_found),
        cmocka_unit_test(a_second_fit_in_the_folder_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
