/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compression tests and cushion curves as data of softfall-fit drop: a synthetic foam, whose test is that of
 * the solver's law and whose cushion curve is that of a block, from each and from both; refusals. */
#include "fit/drop/input.h"
#include "fit/material_point.h"
#include "program_fixture.h"
#include "solver/material/foam.h"
#include "surrogate/column.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const double TRUE_P0 = 110e3, TRUE_B = 24e3;

#define START                                                                                                \
    "material = \"start.cfg\"; start: { m = 2.8; s0 = \"8 kPa\"; };\n"                                       \
    "unknown = ( { name = \"p0\"; }, { name = \"B\"; } );\n"
#define TEST "compressions = ( { file = \"test.csv\"; rate = \"0.1 1/s\"; sd = 0.03; } );\n"
#define CUSHION "thickness = \"50 mm\"; drop_height = \"0.6 m\"; "

static void put_start(const program_place *place) {
    program_write_text(place, "start.cfg",
                       "density = \"35 kg/m3\"; E = \"0.4136 MPa\"; curve = \"start.csv\"; HU = 0.1;\n");
    program_write_text(place, "start.csv", "strain,stress_kPa\n0,0\n0.02,8\n0.5,80\n0.9,2000\n");
}

static void build_true(const program_place *place, sf_material_law *law) {
    sf_fit_input in;
    sf_foam_card card;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_fit_input_read(program_write_text(place, "true.cfg",
                                                          START "cushions = ( { " CUSHION
                                                                "points = ( [2.0, 60.0] ); } );\n"),
                                       0, &in, &err),
                     SF_OK);
    in.start[SF_PARAMETER_P0] = TRUE_P0;
    in.start[SF_PARAMETER_B] = TRUE_B;
    assert_int_equal(sf_foam_form_card(&in.form, in.start, &card, &err), SF_OK);
    const sf_material material = sf_foam_material(&card);
    assert_int_equal(sf_material_law_build(&material, law, &err), SF_OK);
    sf_foam_card_free(&card);
    sf_fit_input_free(&in);
}

/* To a strain of 0.6 and back, as the law of the solver gives it. */
static void put_test(const program_place *place, const sf_material_law *law) {
    enum { POINTS = 60 };
    double strain[2 * POINTS], stress[2 * POINTS];
    for (int k = 0; k < 2 * POINTS; k++)
        strain[k] = 0.01 * (k < POINTS ? k + 1 : 2 * POINTS - 1 - k);
    sf_material_point_drive(law, 0.1, 1e-3, 2 * POINTS, strain, stress);
    FILE *file = fopen(program_path(place, "test.csv"), "w");
    assert_non_null(file);
    fputs("strain_percent,stress_kPa\n", file);
    for (int k = 0; k < 2 * POINTS; k++)
        fprintf(file, "%.4f,%.6g\n", 100 * strain[k], fmax(0, 1e-3 * stress[k]));
    assert_int_equal(fclose(file), 0);
}

static void put_cushion(const program_place *place, const sf_material_law *law) {
    FILE *file = fopen(program_path(place, "cushion.csv"), "w");
    assert_non_null(file);
    fputs("Static stress (kPa);Peak deceleration (g)\n", file);
    for (int k = 0; k < 6; k++) {
        double s = 1e3 * (2 + 2 * k);
        const sf_columns block = {.mass = s / 9.80665,
                                  .speed = sqrt(2 * 9.80665 * 0.6),
                                  .thickness = 0.05,
                                  .count = 1,
                                  .area = {1}};
        sf_columns_figures figures;
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(sf_columns_respond(&block, law, &figures, NULL, &err), SF_OK);
        fprintf(file, "%g;%.5g\n", 1e-3 * s, figures.a_max_g);
    }
    assert_int_equal(fclose(file), 0);
}

/* Widths of the intervals of p0 and B as logarithms; the truth lies in both. */
static void identify(const program_place *place, const char *data, double width[2]) {
    char text[1024];
    const double hidden[2] = {TRUE_P0, TRUE_B};
    snprintf(text, sizeof text, START "%s", data);
    program_write_text(place, "fit.cfg", text);
    program_succeed(place, "fit", "drop fit.cfg -o out --force");
    program_bytes json = program_read_file(program_path(place, "out/fit.json"));
    const char *at = strstr(json.data, "\"parameters\":");
    for (int k = 0; k < 2; k++) {
        double low = 0, high = 0;
        at = strstr(at, "\"low95_SI\":");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "\"low95_SI\": %lf, \"high95_SI\": %lf", &low, &high), 2);
        assert_true(low < hidden[k] && hidden[k] < high);
        width[k] = log(high / low);
        at++;
    }
    free(json.data);
}

static void both_tell_more_than_each(void **state) {
    (void)state;
    program_place place;
    sf_material_law law;
    double test[2], cushion[2], both[2];
    program_set_up(&place);
    put_start(&place);
    build_true(&place, &law);
    put_test(&place, &law);
    put_cushion(&place, &law);
    sf_material_law_free(&law);
    identify(&place, TEST, test);
    identify(&place, "cushions = ( { " CUSHION "file = \"cushion.csv\"; } );\n", cushion);
    identify(&place, TEST "cushions = ( { " CUSHION "file = \"cushion.csv\"; } );\n", both);
    print_message("width of p0 and B: test %.3f %.3f, cushion %.3f %.3f, both %.3f %.3f\n", test[0], test[1],
                  cushion[0], cushion[1], both[0], both[1]);
    for (int k = 0; k < 2; k++)
        assert_true(both[k] < test[k] && both[k] < cushion[k]);
    program_tear_down(&place);
}

static void bad_data_get_one_sentence(void **state) {
    (void)state;
    static const struct {
        const char *text, *sentence;
    } bad[] = {
        {"", "drops is missing"},
        {"cushions = ( { " CUSHION "} );\n", "needs one of file, points and stress_energy"},
        {"cushions = ( { thickness = \"50 mm\"; points = ( [2.0, 60.0] ); } );\n", "drop_height is missing"},
        {"cushions = ( { " CUSHION "points = ( [2.0] ); } );\n", "must be a pair"},
        {"cushions = ( { " CUSHION "points = ( [2.0, 0.5] ); } );\n", "the peak above 1 g"},
        {"cushions = ( { " CUSHION "points = 3; } );\n", "points must be a list"},
        {"cushions = ( { " CUSHION "file = \"start.csv\"; } );\n", "start.csv"},
        {"cushions = ( { " CUSHION "file = \"none.csv\"; } );\n", "none.csv cannot be read"},
        {"cushions = ( { " CUSHION "colour = 3; } );\n", "unknown key \"colour\""},
        {"cushions = ( { " CUSHION "stress_energy: { A = \"60 kPa\"; B = 0.03; from = \"20 kPa\"; to = \"10 "
         "kPa\"; }; } );\n",
         "is not above from"},
        {"compressions = ( { file = \"start.csv\"; rate = \"0.1 1/s\"; } );\n", "points"},
        {"compressions = ( { file = \"start.csv\"; } );\n", "rate is missing"},
        {"compressions = ( { file = \"none.csv\"; rate = \"0.1 1/s\"; } );\n", "none.csv cannot be read"},
        {"compressions = ( { file = \"start.csv\"; rate = \"0.1 1/s\"; sd = 0.0; } );\n", "sd is 0, outside"},
    };
    program_place place;
    program_set_up(&place);
    put_start(&place);
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        char text[1024];
        sf_fit_input in;
        sf_error err = SF_ERROR_INIT;
        snprintf(text, sizeof text, START "%s", bad[k].text);
        assert_int_equal(sf_fit_input_read(program_write_text(&place, "fit.cfg", text), 0, &in, &err),
                         SF_ERR_INPUT);
        if (!strstr(err.text, bad[k].sentence) || strchr(err.text, '\n'))
            fail_msg("%s: %s", bad[k].text, err.text);
        sf_fit_input_free(&in);
    }
    program_tear_down(&place);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_tell_more_than_each),
        cmocka_unit_test(bad_data_get_one_sentence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
