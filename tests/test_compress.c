/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foams of material files by include/softfall/softfall.h: points under compression against closed forms, and
 * models that hold hyperfoams of up to six terms. */
#include "program_fixture.h"

#include "softfall/softfall.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

enum { COUNT = 401 };

static const char CURVE[] = "strain,stress_kPa\n0,0\n0.1,40\n0.3,55\n0.5,90\n0.7,240\n";
static const char FOAM[] = "law = \"low_density_foam\"; density = \"50 kg/m3\"; E = \"0.4 MPa\"; curve = "
                           "\"foam.csv\";\n";
static const char TERM[] =
    "law = \"hyperfoam\"; density = \"50 kg/m3\"; term_1 = { mu = \"60 kPa\"; alpha = 8.0; nu = 0.2; };\n";

static softfall_material *read(const program_place *p, const char *head, const char *more) {
    softfall_material *material;
    softfall_error error;
    char text[1024];
    program_write_text(p, "foam.csv", CURVE);
    snprintf(text, sizeof text, "%s%s", head, more);
    if (softfall_material_read(program_write_text(p, "foam.cfg", text), 0, &material, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    return material;
}

/* Loads to `most` at this rate and unloads; the stress of both ways. */
static void cycle(const softfall_material *material, int free_sides, double most, double rate,
                  double strain[COUNT], double stress[COUNT]) {
    double time[COUNT];
    softfall_error error;
    for (int i = 0; i < COUNT; i++) {
        double way = 2. * i / (COUNT - 1);
        strain[i] = most * (way <= 1 ? way : 2 - way);
        time[i] = most * way / rate;
    }
    if (softfall_compress(material, free_sides, time, strain, COUNT, stress, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
}

static double work(const double strain[COUNT], const double stress[COUNT], int from, int to) {
    double sum = 0;
    for (int i = from; i < to; i++)
        sum += 0.5 * (stress[i] + stress[i + 1]) * (strain[i + 1] - strain[i]);
    return sum;
}

/* Loading passes the points of the table, unloading returns the part of the energy of theory (17). */
static void a_loop_has_the_curve_and_the_energy_of_the_theory(void **state) {
    double strain[COUNT], stress[COUNT], rate;
    const double *at, *curve;
    softfall_material *material = read(*state, FOAM, "HU = 0.2; SHAPE = 3.0;\n");
    cycle(material, 0, 0.6, 1, strain, stress);
    assert_int_equal(softfall_material_curve(material, 0, &rate, &at, &curve), 5);
    assert_int_equal(softfall_material_curve(material, 1, &rate, &at, &curve), 0);
    for (int k = 1; k < 4; k++) {
        int i = (int)lround(at[k] / 0.6 * (COUNT - 1) / 2);
        assert_true(fabs(strain[i] - at[k]) < 2e-3 && fabs(stress[i] / curve[k] - 1) < 0.02);
    }
    double lost = work(strain, stress, 0, COUNT / 2), back = -work(strain, stress, COUNT / 2, COUNT - 1);
    assert_true(fabs(back / lost - (0.2 + 0.8 / 4)) < 1e-3);
    assert_non_null(strstr(softfall_material_parameters(material), "material.SHAPE"));
    softfall_material_free(material);
}

/* Stress of one term in uniaxial compression: with free sides the lateral stretch is x^-nu. */
static double book_stress(double x, double side) {
    double volume = x * side * side, beta = 0.2 / (1 - 2 * 0.2);
    return 2 * 60e3 / 8 / x * (pow(volume, -8 * beta) - pow(x, 8));
}

static void a_hyperfoam_bulges_where_its_sides_are_free(void **state) {
    double strain[COUNT], stress[COUNT];
    softfall_material *material = read(*state, TERM, "");
    for (int free_sides = 0; free_sides < 2; free_sides++) {
        cycle(material, free_sides, 0.7, 10, strain, stress);
        for (int i = 0; i < COUNT; i++) {
            double x = 1 - strain[i], expected = book_stress(x, free_sides ? pow(x, -0.2) : 1);
            assert_true(fabs(stress[i] - expected) <= 1e-9 * expected + 1e-6);
        }
    }
    softfall_material_free(material);
}

/* Theory (O4), once the low pass has reached the rate. */
static void the_rate_factor_counts_decades(void **state) {
    double strain[COUNT], slow[COUNT], fast[COUNT];
    softfall_material *material = read(
        *state, FOAM, "rate_factor = 0.3; rate_reference = \"0.1 1/s\"; rate_filter_time = \"1e-6 ms\";\n");
    cycle(material, 0, 0.6, 0.1, strain, slow);
    cycle(material, 0, 0.6, 100, strain, fast);
    for (int i = 20; i < COUNT / 2; i++)
        assert_true(fabs(fast[i] / slow[i] - 1.9) < 2e-3);
    softfall_material_free(material);
}

static void wrong_paths_and_files_are_refused(void **state) {
    softfall_error error;
    softfall_material *material = read(*state, FOAM, ""), *none;
    static const struct {
        double time[3], strain[3];
        int count;
        const char *words;
    } wrong[] = {{{0, 1, 2}, {0.1, 0.2, 0.3}, 3, "begins with 0"},
                 {{0, 1, 1}, {0, 0.2, 0.3}, 3, "time 3 is 1 s"},
                 {{0, 1, 2}, {0, 0.2, 1}, 3, "strain 3 is 1"},
                 {{0, 1, 2}, {0, NAN, 0.3}, 3, "strain 2 is"},
                 {{0, 1, 2}, {0, 0.1, 0.3}, 1, "has 1 points"}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        double stress[3];
        assert_int_equal(
            softfall_compress(material, 0, wrong[k].time, wrong[k].strain, wrong[k].count, stress, &error),
            SOFTFALL_INPUT);
        if (!strstr(error.text, wrong[k].words))
            fail_msg("%s", error.text);
    }
    softfall_material_free(material);
    assert_int_equal(softfall_material_read(program_path(*state, "none.cfg"), 0, &none, &error),
                     SOFTFALL_INPUT);
    assert_true(none == NULL && strstr(error.text, "none.cfg"));
    softfall_material_free(NULL);
}

/* A model of six terms is written and read, by its hash; one of three has the datasets that it had before. */
static void models_keep_six_terms(void **state) {
    static const char *const terms[] = {
        "", "term_2 = { mu = \"9 kPa\"; alpha = -3.0; };",
        "term_6 = { mu = \"8 kPa\"; alpha = 2.5; beta = 0.1; }; term_4 = { mu = \"7 kPa\"; alpha = 5.0; nu = 0.1; };"};
    char text[1024];
    for (int k = 0; k < 3; k++) {
        snprintf(text, sizeof text, "%s%s", TERM, terms[k]);
        program_write_text(*state, "foam.cfg", text);
        program_succeed(
            *state, "pre",
            "good.cfg -o six.h5 --force --set material=@foam.cfg --set 'solver.end_time=\"1 ms\"' %s",
            program_coarse(25));
        program_succeed(*state, "solve", "six.h5 -o six-results.h5 --force");
        sf_h5 *h5 = program_open_h5(*state, "six.h5");
        assert_true(sf_h5_exists(h5, "/material/0/term_3_mu"));
        assert_int_equal(sf_h5_exists(h5, "/material/0/term_6_beta"), k == 2);
        assert_false(sf_h5_exists(h5, "/material/0/term_5_mu"));
        sf_h5_drop(&h5);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_loop_has_the_curve_and_the_energy_of_the_theory),
        cmocka_unit_test(a_hyperfoam_bulges_where_its_sides_are_free),
        cmocka_unit_test(the_rate_factor_counts_decades),
        cmocka_unit_test(wrong_paths_and_files_are_refused),
        cmocka_unit_test(models_keep_six_terms),
    };
    return cmocka_run_group_tests(tests, program_group_example, program_group_tear_down);
}
