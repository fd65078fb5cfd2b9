/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-fit compression with law = "hyperfoam": tests of a known law, the measured VN600, refusals; and a
 * cube of the material, pressed by the solver, against the closed form. */
#include "case/read.h"
#include "study/fit/compression/compression_kind.h"
#include "extreme.h"
#include "post/results/results.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static sf_hyperfoam_card true_card(void) {
    return (sf_hyperfoam_card){
        .density = 100,
        .hysteresis_hu = 0.2,
        .hysteresis_shape = 1.3,
        .hysteresis_alpha = 0.5,
        .maxwell_rate = 5000,
        .rate_reference = 0.01,
        .rate_filter_time = 1e-4,
        .stable_to = 0.9,
        .term = {{.mu = 9e4, .alpha = 14, .nu = 0.1}, {.mu = 2e4, .alpha = -1.5, .nu = 0.3}}};
}

/* A laboratory file: strain, stress and lateral strain, loading to 70 % and back, three digits. */
static void write_test(const char *path, bool lateral) {
    sf_hyperfoam_card card = true_card();
    sf_hyperfoam foam = sf_hyperfoam_build(&card);
    double side = 0, peak, energy;
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    sf_hyperfoam_free_stress(&foam, 0.7, &side, &peak);
    fprintf(f, "strain,stress_kPa%s\n", lateral ? ",lateral_strain" : "");
    side = 0;
    for (int k = 1; k <= 130; k++) {
        double strain = 0.01 * (k <= 70 ? k : 140 - k);
        double stress = sf_hyperfoam_free_stress(&foam, strain, &side, &energy);
        if (k > 70)
            stress *= sf_unloading_factor(0.2, 1.3, 0.5, energy / peak);
        fprintf(f, "%.4f,%.3f", strain, 1e-3 * stress);
        if (lateral)
            fprintf(f, ",%.4f", side);
        fprintf(f, "\n");
    }
    fclose(f);
}

/* The card that softfall-pre reads from the material file. */
static void read_back(const program_place *place, const char *file, sf_case *c) {
    sf_error err = SF_ERROR_INIT;
    char material[700];
    program_write_text(place, "pad.geo", "// not meshed\n");
    snprintf(material, sizeof material, "material=@%s", program_path(place, file));
    const char *const overrides[] = {material};
    const char *path = program_write_text(place, "case.cfg",
                                          "geometry: { file = \"pad.geo\"; length_unit = \"mm\"; };\n"
                                          "missile: { mass = \"4.6 kg\"; velocity = \"4.5 m/s\"; };\n"
                                          "solver: { end_time = \"40 ms\"; };\n");
    if (sf_case_read(path, 1, overrides, NULL, c, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_ptr_equal(c->material.law, &sf_hyperfoam_law);
}

static void known_law_is_found_from_one_file(void **state) {
    program_place *place = *state;
    sf_case c;
    write_test(program_path(place, "test.csv"), true);
    program_write_text(
        place, "fit.cfg",
        "law = \"hyperfoam\"; density = \"100 kg/m3\"; terms = 2; DAMP = 0.2;\n"
        "tests = ( { file = \"test.csv\"; rate = \"0.01 1/s\"; lateral = \"test.csv\"; } );\n");
    program_result r = program_succeed(place, "fit", "compression fit.cfg -o out");
    assert_non_null(strstr(r.out, "hyperfoam of 2 terms"));
    read_back(place, "out/material.cfg", &c);
    const sf_hyperfoam_card *card = c.material.card;
    sf_hyperfoam_card known = true_card();
    sf_hyperfoam found = sf_hyperfoam_build(card), truth = sf_hyperfoam_build(&known);
    double side = 0, other = 0, energy;
    for (double strain = 0.02; strain < 0.7; strain += 0.04) {
        double a = sf_hyperfoam_free_stress(&found, strain, &side, &energy);
        double b = sf_hyperfoam_free_stress(&truth, strain, &other, &energy);
        assert_relative(a, b, 0.005);
        assert_close(side, other, 5e-4);
    }
    assert_close(card->hysteresis_hu, 0.2, 0.01);
    assert_close(card->hysteresis_shape, 1.3, 0.05);
    assert_close(card->hysteresis_alpha, 0.5, 0.02);
    assert_true(card->damp == 0.2);
    assert_relative(card->informed_strain, 0.7, 1e-12);
    sf_case_free(&c);
}

/* VN600 slowly: nu = 0.245, and both curves within their scatter. */
static void vn600_is_described(void **state) {
    program_place *place = *state;
    program_succeed(place, "fit", "compression %s/examples/fit/hyperfoam/vn600_quasistatic.cfg -o vn",
                    getenv("SF_SOURCE_DIR"));
    program_bytes json = program_read_file(program_path(place, "vn/fit.json"));
    static const struct {
        const char *key;
        double low, high;
    } expected[] = {{"\"poisson_at_1_percent\": ", 0.23, 0.26},
                    {"\"poisson_at_largest_strain\": ", 0.155, 0.175},
                    {"\"stress_rms\": ", 0, 0.02},
                    {"\"lateral_rms\": ", 0, 0.01},
                    {"\"unloading_rms\": ", 0, 0.01}};
    for (size_t k = 0; k < sizeof expected / sizeof *expected; k++) {
        const char *at = strstr(json.data, expected[k].key);
        assert_non_null(at);
        double value = strtod(at + strlen(expected[k].key), NULL);
        if (!(value >= expected[k].low && value <= expected[k].high))
            fail_msg("%s%g", expected[k].key, value);
    }
    assert_non_null(strstr(json.data, "\"HU_at_bound\": true"));
    assert_non_null(strstr(json.data, "\"SHAPE_at_bound\": false"));
    free(json.data);
}

/* The example's material is what the fit writes, and says which numbers are at a bound. */
static void vn600_slow_is_the_fit(void **state) {
    program_place *place = *state;
    sf_case fitted, example;
    const char *source = getenv("SF_SOURCE_DIR");
    program_result r = program_succeed(
        place, "fit", "compression %s/examples/fit/hyperfoam/vn600_quasistatic.cfg -o slow", source);
    assert_non_null(strstr(r.out, "nu 0.45 (at its bound)\n"));
    assert_null(strstr(r.out, "+- 0\n"));
    assert_null(strstr(r.err, "does not describe"));
    program_shell(place, "cp %s/examples/materials/vn600_slow.cfg .", source);
    assert_int_equal(program_shell(place, "grep -q 'nu 0.45 (at its bound)' vn600_slow.cfg").code, 0);
    read_back(place, "slow/material.cfg", &fitted);
    read_back(place, "vn600_slow.cfg", &example);
    const sf_hyperfoam_card *a = fitted.material.card, *b = example.material.card;
    for (int k = 0; k < 2; k++) {
        assert_relative(a->term[k].mu, b->term[k].mu, 1e-3);
        assert_relative(a->term[k].alpha, b->term[k].alpha, 1e-2);
        assert_relative(a->term[k].nu, b->term[k].nu, 1e-3);
    }
    assert_relative(a->hysteresis_shape, b->hysteresis_shape, 1e-3);
    assert_true(a->damp == b->damp);
    sf_case_free(&fitted);
    sf_case_free(&example);
}

/* At 10 per second no hyperfoam describes VN600: the program says so, and so does the file. */
static void poor_fit_is_marked(void **state) {
    program_place *place = *state;
    program_result r =
        program_succeed(place, "fit", "compression %s/examples/fit/hyperfoam/vn600_10_per_s.cfg -o fast",
                        getenv("SF_SOURCE_DIR"));
    assert_non_null(strstr(r.err, "does not describe this test"));
    assert_int_equal(
        program_shell(place, "grep -q 'does not describe this test.* 20 %%' fast/material.cfg").code, 0);
}

/* By the ratio of the whole law, not of a term: VN600 has a small term of 0.45. */
static void large_poisson_ratio_is_warned_of(void **state) {
    program_place *place = *state;
    static const char *const sets[] = {
        "", "--set material.term_1.nu=0.4",
        "--set material.term_1='{ mu = \"60 kPa\"; alpha = 8.0; beta = 2.0; }' --set material.term_2.nu=0.4",
        "--set material.term_1='{ mu = \"60 kPa\"; alpha = 8.0; beta = 1.1; }' --set material.term_2.nu=0.34"};
    static const bool warned[] = {false, true, true, false};
    for (int k = 0; k < 4; k++) {
        program_result r = program_succeed(
            place, "pre",
            "%s/examples/compression/vn600.cfg -f -o p.h5 --set geometry.parameters.spacing=25 %s",
            getenv("SF_SOURCE_DIR"), sets[k]);
        if ((strstr(r.err, "have a Poisson ratio of") != NULL) != warned[k])
            fail_msg("%s: %s", sets[k], r.err);
    }
}

static void bad_files_are_refused(void **state) {
    program_place *place = *state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"tests = ( { file = \"test.csv\"; rate = \"1 1/s\"; } );",
         "give the test a table of lateral strain"},
        {"nu = 0.2; tests = ( { file = \"test.csv\"; rate = \"1 1/s\"; lateral = \"test.csv\"; } );",
         "nu is given, and lateral strain is measured"},
        {"terms = 1.5; tests = ( { file = \"test.csv\"; rate = \"1 1/s\"; } );", "it must be 1, 2 or 3"},
        {"terms = 4; tests = ( { file = \"test.csv\"; rate = \"1 1/s\"; } );", "terms"},
        {"rate_model = \"log\"; tests = ( { file = \"test.csv\"; rate = \"1 1/s\"; } );", "rate_model"},
        {"tests = ( { file = \"test.csv\"; rate = \"1 1/s\"; lateral = \"none.csv\"; } );", "none.csv"},
        {"tests = ( { file = \"test.csv\"; rate = \"1 1/s\"; lateral = \"plain.csv\"; } );", "plain.csv"},
        {"tests = ( { file = \"test.csv\"; rate = \"1 1/s\"; }, { file = \"test.csv\"; rate = \"2 1/s\"; } );",
         "fitted to one test"},
    };
    write_test(program_path(place, "test.csv"), true);
    write_test(program_path(place, "plain.csv"), false);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[512];
        snprintf(text, sizeof text, "law = \"hyperfoam\"; density = \"100 kg/m3\";\n%s\n", cases[k].text);
        program_write_text(place, "bad.cfg", text);
        program_result r = program_run(place, "fit", "compression bad.cfg -o bad");
        assert_true(r.code != 0);
        if (!strstr(r.err, cases[k].words))
            fail_msg("%s", r.err);
        assert_int_equal(program_shell(place, "test ! -e bad/material.cfg").code, 0);
    }
}

/* The solver's cube between smooth platens bulges freely: its force is the closed form's, at every depth. */
static void pressed_cube_has_the_stress_of_free_sides(void **state) {
    program_place *place = *state;
    sf_error err = SF_ERROR_INIT;
    sf_results r;
    sf_case c;
    const char *source = getenv("SF_SOURCE_DIR");
    program_succeed(place, "pre",
                    "%s/examples/compression/vn600.cfg -o m.h5 --set geometry.parameters.spacing=12.5 --set "
                    "material.HU=1.0 --set solver.end_time='\"50 ms\"'",
                    source);
    program_succeed(place, "solve", "m.h5 -o r.h5");
    if (sf_results_open(program_path(place, "r.h5"), &r, &err) != SF_OK)
        fail_msg("%s", err.text);
    program_shell(place, "cp %s/examples/materials/vn600_slow.cfg .", source);
    read_back(place, "vn600_slow.cfg", &c);
    sf_hyperfoam foam = sf_hyperfoam_build(c.material.card);
    double side = 0, energy, worst = 0, sum[2] = {0};
    for (int64_t k = 0; k < r.history.rows; k++) {
        double strain = r.history.displacement[k] / 0.05;
        if (strain < 0.1 || strain > 0.48)
            continue;
        double closed = sf_hyperfoam_free_stress(&foam, strain, &side, &energy) * 0.05 * 0.05;
        worst = larger(worst, fabs(r.history.contact_force[k] / closed - 1));
        sum[0] += r.history.contact_force[k];
        sum[1] += closed;
    }
    assert_true(sum[1] > 0);
    if (!(fabs(sum[0] / sum[1] - 1) < 0.005 && worst < 0.05))
        fail_msg("mean force off by %.3g, at most by %.3g", sum[0] / sum[1] - 1, worst);
    sf_case_free(&c);
    sf_results_close(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_law_is_found_from_one_file),
        cmocka_unit_test(vn600_is_described),
        cmocka_unit_test(vn600_slow_is_the_fit),
        cmocka_unit_test(poor_fit_is_marked),
        cmocka_unit_test(large_poisson_ratio_is_warned_of),
        cmocka_unit_test(bad_files_are_refused),
        cmocka_unit_test(pressed_cube_has_the_stress_of_free_sides),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
