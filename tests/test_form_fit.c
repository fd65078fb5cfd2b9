/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit compression with a form of the loading curve: a foam of known parameters, tested by the
 * solver's law at two rates, is found; the main facts of docs/foams.md about foams of public
 * sources; refusals and files. */
#include "study/fit/compression/form_fit.h"
#include "study/fit/form/form.h"
#include "material/laws.h"
#include "program_fixture.h"
#include "material/low_density_foam.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Fits what `text` says; DATA in it is examples/data. The configuration must outlive the fit. */
static void fit_text(const program_place *place, const char *text, sf_compression_config *config,
                     sf_form_fit *fit) {
    char whole[4096];
    sf_error err = SF_ERROR_INIT;
    const char *source = getenv("SF_SOURCE_DIR");
    assert_non_null(source);
    whole[0] = 0;
    for (const char *at = text, *data; *at; at = data ? data + 4 : at + strlen(at)) {
        data = strstr(at, "DATA");
        size_t used = strlen(whole);
        snprintf(whole + used, sizeof whole - used, "%.*s%s%s", data ? (int)(data - at) : (int)strlen(at), at,
                 data ? source : "", data ? "/examples/data" : "");
    }
    if (sf_compression_config_read(program_write_text(place, "fit.cfg", whole), config, &err) != SF_OK ||
        sf_form_fit_run(config, fit, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* rms of loading of a fit whose other results are of no interest. */
static double rms_of(const program_place *place, const char *text, int parameters) {
    sf_compression_config config;
    sf_form_fit fit;
    fit_text(place, text, &config, &fit);
    assert_int_equal(config.form.unknown_count, parameters);
    double rms = fit.loading_rms;
    sf_form_fit_free(&fit);
    sf_compression_config_free(&config);
    return rms;
}

/* ---- a known foam ---- */

/* A test by the solver's law at a material point, to 75 % and back, with the digits of a machine. */
static void press(const program_place *place, const char *name, const sf_foam_card *card, double rate) {
    enum { LOADING = 75, COUNT = 149 };
    double strain[COUNT], stress[COUNT];
    sf_material_law law;
    sf_error err = SF_ERROR_INIT;
    const sf_material material = sf_foam_material(card);
    FILE *file = fopen(program_path(place, name), "w");
    assert_non_null(file);
    for (int k = 0; k < COUNT; k++)
        strain[k] = 0.01 * (k < LOADING ? k + 1 : 2 * LOADING - k - 1);
    assert_int_equal(sf_material_law_build(&material, &law, &err), SF_OK);
    sf_material_point_drive(&law, rate, 1e-4, COUNT, strain, stress);
    sf_material_law_free(&law);
    fputs("strain,stress_kPa\n", file);
    for (int k = 0; k < COUNT; k++)
        fprintf(file, "%.4f,%.4f\n", strain[k], 1e-3 * stress[k]);
    assert_int_equal(fclose(file), 0);
}

static void assert_near(const sf_form_fit *fit, sf_foam_parameter p, double truth, double slack) {
    if (!(fabs(fit->value[p] / truth - 1) < slack))
        fail_msg("%s: %g found, %g true", sf_parameter_get(p)->name, fit->value[p], truth);
}

static void a_known_foam_is_found(void **state) {
    (void)state;
    const sf_foam_form form = {.curve = &sf_form_gas_solid,
                               .solid_density = 940,
                               .base = {.density = 60,
                                        .modulus = 0.5e6,
                                        .hysteresis_hu = 0.15,
                                        .hysteresis_shape = 0.8,
                                        .hysteresis_alpha = 0.4,
                                        .maxwell_rate = 5000,
                                        .tension_cutoff = 1e30,
                                        .rate_factor = 0.12,
                                        .rate_reference = 0.01,
                                        .rate_filter_time = 5e-4}};
    double truth[SF_PARAMETER_COUNT];
    sf_foam_card card;
    sf_error err = SF_ERROR_INIT;
    program_place place;
    sf_compression_config config;
    sf_form_fit fit;
    program_set_up(&place);
    sf_foam_form_start(&form, truth);
    truth[SF_PARAMETER_S0] = 17e3;
    truth[SF_PARAMETER_P0] = 115e3;
    assert_int_equal(sf_foam_form_card(&form, truth, &card, &err), SF_OK);
    press(&place, "slow.csv", &card, 0.01);
    press(&place, "fast.csv", &card, 10);
    press(&place, "between.csv", &card, 1);
    press(&place, "beyond.csv", &card, 1000); /* the factor's low pass is felt through the whole test */
    sf_foam_card_free(&card);
    fit_text(&place,
             "density = \"60 kg/m3\"; curve_form = \"gas_solid\"; solid_density = \"940 kg/m3\";\n"
             "rate_model = \"factor\"; tests = ( { file = \"slow.csv\"; rate = \"0.01 1/s\"; },\n"
             "{ file = \"fast.csv\"; rate = \"10 1/s\"; } );\n"
             "predict = ( { file = \"between.csv\"; rate = \"1 1/s\"; },\n"
             "{ file = \"beyond.csv\"; rate = \"1000 1/s\"; } );\n",
             &config, &fit);
    assert_near(&fit, SF_PARAMETER_E, 0.5e6, 0.02);
    assert_near(&fit, SF_PARAMETER_S0, 17e3, 0.02);
    assert_near(&fit, SF_PARAMETER_P0, 115e3, 0.02);
    assert_near(&fit, SF_PARAMETER_B, truth[SF_PARAMETER_B], 0.02);
    assert_near(&fit, SF_PARAMETER_M, truth[SF_PARAMETER_M], 0.02);
    assert_near(&fit, SF_PARAMETER_RATE_FACTOR, 0.12, 0.01);
    assert_near(&fit, SF_PARAMETER_HU, 0.15, 0.02);
    assert_near(&fit, SF_PARAMETER_SHAPE, 0.8, 0.02);
    assert_near(&fit, SF_PARAMETER_ALPHA, 0.4, 0.02);
    assert_true(fit.loading_rms < 1e-5 && fit.unloading.fit.rms < 1e-5 &&
                fit.unloading_of_one.fit.rms > 0.005);
    for (int k = 0; k < 2; k++)
        assert_true(fit.predicted[k].loading_rms < 1e-5 && fit.predicted[k].unloading_rms < 1e-5);
    assert_true(fabs(fit.test[0].returned_measured - fit.test[0].returned_fitted) < 2e-3);
    assert_true(fit.card.rate_factor == fit.value[SF_PARAMETER_RATE_FACTOR] &&
                fit.card.rate_reference == 0.01 && fit.card.hysteresis_alpha == fit.unloading.fit.value[2]);
    sf_form_fit_free(&fit);
    sf_compression_config_free(&config);
    program_tear_down(&place);
}

/* ---- foams of public sources ---- */

#define LEAP                                                                                                 \
    "density = \"100 kg/m3\"; tests = ( { file = \"DATA/leap_cycle1.csv\"; rate = \"0.01 1/s\"; } );\n"
#define VN600                                                                                                \
    "density = \"105 kg/m3\"; tests = ( { file = \"DATA/vn600_quasistatic.csv\"; rate = \"0.001 1/s\"; } );\n"
#define GAS_ALONE "start = { B = \"1 Pa\"; };\n"
#define ZORBIUM(rate) "{ file = \"DATA/zorbium_" rate "_per_s.csv\"; rate = \"" rate " 1/s\"; }"

/* The gas's room beside the solid is what the running-shoe foam needs. */
static void leap_is_a_gas_foam_with_solid_fraction(void **state) {
    (void)state;
    program_place place;
    sf_compression_config config;
    sf_form_fit fit;
    program_set_up(&place);
    fit_text(&place,
             LEAP "curve_form = \"gas_solid\"; unknown = ( \"E\", \"s0\", \"solid_fraction\" );\n" GAS_ALONE,
             &config, &fit);
    assert_true(config.form.unknown_count == 3 && fit.loading_rms < 0.007);
    assert_true(fit.value[SF_PARAMETER_SOLID_FRACTION] > 0.07 &&
                fit.value[SF_PARAMETER_SOLID_FRACTION] < 0.11);
    /* its loop needs ALPHA, and returns 70 % of the energy */
    assert_true(fit.unloading.factor_rms < 0.027 && fit.unloading_of_one.factor_rms > 0.03);
    assert_true(fit.unloading.fit.value[2] > 0.1 && fit.unloading.fit.value[2] < 0.6);
    assert_true(fabs(fit.test[0].returned_measured - 0.70) < 0.01);
    assert_true(fabs(fit.test[0].returned_fitted - 0.70) < 0.01);
    sf_form_fit_free(&fit);
    sf_compression_config_free(&config);
    double none = rms_of(&place, LEAP "curve_form = \"gas\"; unknown = ( \"E\", \"s0\" );\n" GAS_ALONE, 2);
    assert_true(none > 0.025 && none < 0.035);
    double rusch = rms_of(&place,
                          LEAP "curve_form = \"rusch\"; start = { E = \"1000 MPa\"; };\n"
                               "unknown = ( \"rusch_A\", \"rusch_m\", \"rusch_B\", \"rusch_n\" );\n",
                          4);
    assert_true(rusch > 0.010 && rusch < 0.013);
    double avalle = rms_of(&place, LEAP "curve_form = \"avalle\";\n", 5);
    assert_true(avalle > 0.004 && avalle < 0.006);
    program_tear_down(&place);
}

/* Slowly, the gas escapes or is not what bears the load: the solid fraction would have to be twice the true
 * one. */
static void vn600_is_no_gas_foam(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    assert_true(rms_of(&place,
                       VN600 "curve_form = \"gas_solid\"; solid_density = \"1100 kg/m3\";\n"
                             "unknown = ( \"E\", \"s0\" );\n" GAS_ALONE,
                       2) > 0.03);
    assert_true(rms_of(&place, VN600 "curve_form = \"avalle\";\n", 5) < 0.006);
    program_tear_down(&place);
}

/* One curve times a factor of the rate serves three decades; a left-out rate is predicted. */
static void zorbium_has_a_master_curve(void **state) {
    (void)state;
    program_place place;
    sf_compression_config config;
    sf_form_fit fit;
    program_set_up(&place);
    const char all[] = "density = \"60 kg/m3\"; curve_form = \"avalle\";\n"
                       "tests = ( " ZORBIUM("0.0002") ", " ZORBIUM("0.02") ", " ZORBIUM("0.2") " );\n";
    char text[1024];
    assert_true(rms_of(&place, all, 5) > 0.08);
    snprintf(text, sizeof text, "%srate_model = \"factor\";\n", all);
    assert_true(rms_of(&place, text, 6) < 0.02);
    fit_text(&place,
             "density = \"60 kg/m3\"; curve_form = \"avalle\"; rate_model = \"factor\";\n"
             "tests = ( " ZORBIUM("0.0002") ", " ZORBIUM("0.02") " ); predict = ( " ZORBIUM("0.2") " );\n",
             &config, &fit);
    assert_true(fit.predicted[0].loading_rms < 0.05 && isnan(fit.predicted[0].unloading_rms));
    sf_form_fit_free(&fit);
    sf_compression_config_free(&config);
    program_tear_down(&place);
}

/* ---- the program ---- */

static void put_data(const program_place *place, const char *name, double factor) {
    FILE *file = fopen(program_path(place, name), "w");
    assert_non_null(file);
    const sf_gas_curve curve = {0.4e6, 8e3, 101e3, 25e3, 3, 0};
    fputs("strain,stress_kPa\n", file);
    for (int k = 1; k <= 70; k++)
        fprintf(file, "%.3f,%.4f\n", 0.01 * k, 1e-3 * factor * sf_gas_curve_stress(&curve, 0.01 * k));
    assert_int_equal(fclose(file), 0);
}

#define TWO                                                                                                  \
    "density = \"35 kg/m3\"; curve_form = \"gas\"; tests = ( { file = \"t.csv\"; rate = \"0.01 1/s\"; },\n"  \
    "{ file = \"t2.csv\"; rate = \"0.1 1/s\"; } );\n"
#define GOOD "density = \"35 kg/m3\"; tests = ( { file = \"t.csv\"; rate = \"0.01 1/s\"; } );\n"

static void bad_input_gets_one_sentence(void **state) {
    (void)state;
    static const struct {
        const char *text, *sentence;
    } bad[] = {
        {GOOD "curve_form = \"foam\";", "fit.cfg:2: curve_form is \"foam\"; expected free or one of gas|"},
        {GOOD "curve_form = \"table\";", "but not table"},
        {GOOD "curve_form = \"gas_solid\";", "needs solid_density"},
        {GOOD "curve_form = \"gas_solid\"; solid_density = \"50 kg/m3\";", "solids that foams are made of"},
        {GOOD "curve_form = \"gas_solid\"; solid_density = \"1e5 kg/m3\";", "solids that foams are made of"},
        {"density = \"300 kg/m3\"; tests = ( { file = \"t.csv\"; rate = \"0.01 1/s\"; } );\n"
         "curve_form = \"gas_solid\"; solid_density = \"500 kg/m3\";",
         "less than half solid"},
        {GOOD "curve_form = \"gas\"; rate_model = \"factor\";", "needs tests at two rates"},
        {GOOD "curve_form = \"gas\"; rate_model = \"log\";", "it must be one of none, factor, maxwell, both"},
        {GOOD "curve_form = \"gas\"; unknown = ( \"rusch_A\" );", "neither E nor a parameter of"},
        {GOOD "curve_form = \"gas\"; unknown = ( \"HU\" );", "neither E nor a parameter of"},
        {GOOD "curve_form = \"gas\"; unknown = \"E\";", "unknown must be a list"},
        {GOOD "curve_form = \"gas\"; start = { HU = 0.1; };", "start: \"HU\" is neither E"},
        {TWO "rate_model = \"factor\"; rate_reference = \"0.1 1/s\";", "the fastest test has 0.1 1/s"},
        {TWO "rate_model = \"factor\"; rate_reference = \"1e3 1/s\";", "the fastest test has 0.1 1/s"},
        {TWO "rate_model = \"factor\"; rate_reference = \"1e-10 1/s\";", "it must be at least 1e-09"},
        {TWO "rate_model = \"maxwell\"; rate_reference = \"0.01 1/s\";",
         "rate_reference is given, but rate_model = \"maxwell\" has none"},
        {TWO "start = { ED = \"1 MPa\"; };", "ED is given, but rate_model = \"none\" has none"},
        {TWO "rate_model = \"factor\"; start = { BETA1 = \"10 1/s\"; };",
         "BETA1 is given, but rate_model = \"factor\" has none: give rate_model = \"maxwell\" or"},
        {TWO "start = { rate_factor = 0.5; };",
         "rate_factor is given, but rate_model = \"none\" has none: give rate_model = \"factor\" or"},
        {TWO "unknown = ();", "there is nothing to fit"},
        {GOOD "curve_form = \"gas\"; solid_density = \"940 kg/m3\";", "has no solid fraction"},
        {GOOD "curve_form = \"gas_solid\"; solid_density = \"940 kg/m3\"; start = { solid_fraction = 0.1; };",
         "given twice: by solid_density, which makes it 0.0372"},
        {GOOD "curve_form = \"gas_solid\"; start = { solid_fraction = 0.3; };",
         "t.csv reaches a strain of 0.7, but with solid_fraction = 0.3"},
        {GOOD
         "curve_form = \"gas_solid\"; unknown = ( \"solid_fraction\" ); start = { solid_fraction = 0.45; };",
         "ends at 0.37: it is too large"},
        {GOOD "curve_form = \"gas\"; densification = \"H1\";", "unknown key \"densification\""},
        {GOOD "predict = ( { file = \"t.csv\"; rate = \"1 1/s\"; } );", "unknown key \"predict\""},
        {GOOD "solid_density = \"940 kg/m3\";", "unknown key \"solid_density\""},
    };
    program_place place;
    program_set_up(&place);
    put_data(&place, "t.csv", 1);
    put_data(&place, "t2.csv", 1.001);
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        program_write_text(&place, "fit.cfg", bad[k].text);
        program_result r = program_run(&place, "fit", "compression fit.cfg -o out");
        if (r.code == 0 || !strstr(r.err, bad[k].sentence) || strchr(r.err, '\n') != strrchr(r.err, '\n'))
            fail_msg("%s\nexit code %d, expected \"%s\", got: %s", bad[k].text, r.code, bad[k].sentence,
                     r.err);
    }
    program_tear_down(&place);
}

static void the_files_are_written(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    put_data(&place, "t.csv", 1);
    put_data(&place, "t2.csv", 1.001);
    program_write_text(&place, "fit.cfg", GOOD "curve_form = \"gas\"; name = \"foam of a test\";\n");
    program_result r = program_succeed(&place, "fit", "compression fit.cfg -o out");
    assert_non_null(strstr(r.out, "with 5 parameters"));
    program_bytes json = program_read_file(program_path(&place, "out/fit.json")),
                  material = program_read_file(program_path(&place, "out/material.cfg")),
                  points = program_read_file(program_path(&place, "out/fit.csv"));
    assert_non_null(strstr(json.data, "\"curve_form\": \"gas\""));
    assert_non_null(strstr(json.data, "\"parameter_count\": 5"));
    assert_non_null(strstr(material.data, "informed_strain = 0.7"));
    assert_non_null(
        strstr(points.data, "test,use,rate_1_s,branch,strain,measured_kPa,law_kPa\n1,fitted,0.01,"));
    free(json.data);
    free(material.data);
    free(points.data);
    r = program_run(&place, "fit", "compression fit.cfg -o out"); /* not without --force */
    assert_true(r.code != 0);
    program_tear_down(&place);
}

/* A law with a factor has the filter and the damping that cost no time step; DAMP is the user's if given. */
static void the_factor_brings_its_filter_and_damping(void **state) {
    (void)state;
    static const struct {
        const char *keys;
        double filter, damp;
    } cases[] = {{"rate_model = \"none\";", 1e-4, 0},
                 {"rate_model = \"maxwell\";", 1e-4, 0},
                 {"rate_model = \"factor\";", 5e-4, 0.05},
                 {"rate_model = \"both\";", 5e-4, 0.05},
                 {"rate_model = \"factor\"; DAMP = 0.2;", 5e-4, 0.2},
                 {"rate_model = \"factor\"; DAMP = 0.0;", 5e-4, 0}};
    program_place place;
    program_set_up(&place);
    put_data(&place, "t.csv", 1);
    put_data(&place, "t2.csv", 1.001);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_compression_config config;
        sf_foam_card card;
        sf_error err = SF_ERROR_INIT;
        char text[1024];
        snprintf(text, sizeof text, "%s%s", TWO, cases[k].keys);
        if (sf_compression_config_read(program_write_text(&place, "fit.cfg", text), &config, &err) != SF_OK ||
            sf_foam_form_card(&config.form.form, config.form.start, &card, &err) != SF_OK)
            fail_msg("%s", err.text);
        assert_true(card.rate_filter_time == cases[k].filter && card.damp == cases[k].damp);
        sf_foam_card_free(&card);
        sf_compression_config_free(&config);
    }
    program_tear_down(&place);
}

/* What the tests do not determine, what is at a bound and what the law cannot say is marked where it stands.
 */
static void weak_results_are_marked(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    put_data(&place, "t.csv", 1);
    put_data(&place, "t2.csv", 1.001);
    put_data(&place, "fast.csv", 1.1);
    program_write_text(&place, "fit.cfg",
                       "density = \"35 kg/m3\"; curve_form = \"gas\"; rate_model = \"factor\";\n"
                       "tests = ( { file = \"t.csv\"; rate = \"0.01 1/s\"; },\n"
                       "{ file = \"fast.csv\"; rate = \"0.1 1/s\"; } );\n"
                       "predict = ( { file = \"t.csv\"; rate = \"0.001 1/s\"; },\n"
                       "{ file = \"fast.csv\"; rate = \"0.1 1/s\"; } );\n");
    program_result r = program_succeed(&place, "fit", "compression fit.cfg -o out");
    assert_non_null(strstr(r.err, "at 0.001 1/s is below rate_reference = 0.01 1/s"));
    assert_null(strstr(r.err, "at 0.1 1/s is below"));
    program_bytes material = program_read_file(program_path(&place, "out/material.cfg"));
    assert_non_null(strstr(material.data, "at 0.001 1/s (below rate_reference"));
    assert_non_null(strstr(material.data, "rate_filter_time = \"0.5 ms\""));
    assert_null(strstr(material.data, "do not determine"));
    free(material.data);
    /* without B the search takes s0 to its bound, where E has no effect */
    program_write_text(&place, "fit.cfg",
                       GOOD "curve_form = \"gas\"; unknown = ( \"E\", \"s0\", \"p0\", \"m\" );\n"
                            "start = { B = \"0.01 Pa\"; };\n");
    program_succeed(&place, "fit", "compression fit.cfg -o out --force");
    material = program_read_file(program_path(&place, "out/material.cfg"));
    assert_non_null(strstr(material.data, "(these tests do not determine it), modulus"));
    assert_non_null(strstr(material.data, "kPa (at its bound), yield stress"));
    free(material.data);
    program_tear_down(&place);
}

/* HU ends at its least with ALPHA = 1, and is inside with ALPHA free. */
static void unloading_at_a_bound_is_marked_in_json(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    program_succeed(&place, "fit", "compression %s/examples/foams/vn600_gas.cfg -o out",
                    getenv("SF_SOURCE_DIR"));
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    const char *one = strstr(json.data, "\"unloading_with_ALPHA_1\""),
               *all = strstr(json.data, "\"unloading\"");
    assert_true(one && all);
    const char *mark = strstr(one, "\"at_bound\": ["), *end = mark ? strchr(mark, ']') : NULL;
    assert_true(end && strstr(mark, "\"HU\"") && strstr(mark, "\"HU\"") < end);
    mark = strstr(all, "\"at_bound\": [");
    assert_true(mark && !memchr(mark + 13, '"', (size_t)(strchr(mark, ']') - mark - 13)));
    free(json.data);
    program_tear_down(&place);
}

/* The files of examples/foams say what docs/identification.md says of them. */
static void examples_of_foams(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int parameters;
        double least, most; /* rms of loading */
        bool poor;
    } cases[] = {{"leap", 3, 0.0055, 0.0065, false},
                 {"zorbium", 6, 0.015, 0.017, false},
                 {"vn600", 5, 0.0043, 0.0053, false},
                 {"vn600_gas", 2, 0.046, 0.048, false}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_compression_config config;
        sf_form_fit fit;
        sf_error err = SF_ERROR_INIT;
        char path[1024];
        snprintf(path, sizeof path, "%s/examples/foams/%s.cfg", getenv("SF_SOURCE_DIR"), cases[k].name);
        if (sf_compression_config_read(path, &config, &err) != SF_OK ||
            sf_form_fit_run(&config, &fit, &err) != SF_OK)
            fail_msg("%s", err.text);
        assert_int_equal(config.form.unknown_count, cases[k].parameters);
        if (!(fit.loading_rms > cases[k].least && fit.loading_rms < cases[k].most))
            fail_msg("%s: rms %g", cases[k].name, fit.loading_rms);
        assert_true(sf_form_fit_is_poor(&fit) == cases[k].poor);
        sf_form_fit_free(&fit);
        sf_compression_config_free(&config);
    }
}

/* Each material of examples/materials makes a model of a pad. */
static void the_library_makes_models(void **state) {
    (void)state;
    static const char *const names[] = {"eva35", "leap", "vn600", "zorbium", "pe", "tile"};
    program_place place;
    program_set_up(&place);
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
        program_succeed(
            &place, "pre",
            "'%s/examples/eva50-v4.5/case.cfg' -o m.h5 --force --set pad.mesh_error_limit=1 "
            "--set 'material=@%s/examples/materials/%s.cfg' --set geometry.parameters.fine_spacing=20.0 "
            "--set geometry.parameters.outer_spacing=30.0",
            getenv("SF_SOURCE_DIR"), getenv("SF_SOURCE_DIR"), names[k]);
    program_tear_down(&place);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_known_foam_is_found),
        cmocka_unit_test(leap_is_a_gas_foam_with_solid_fraction),
        cmocka_unit_test(vn600_is_no_gas_foam),
        cmocka_unit_test(zorbium_has_a_master_curve),
        cmocka_unit_test(bad_input_gets_one_sentence),
        cmocka_unit_test(the_files_are_written),
        cmocka_unit_test(the_factor_brings_its_filter_and_damping),
        cmocka_unit_test(weak_results_are_marked),
        cmocka_unit_test(unloading_at_a_bound_is_marked_in_json),
        cmocka_unit_test(examples_of_foams),
        cmocka_unit_test(the_library_makes_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
