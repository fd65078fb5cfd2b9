/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves at several temperatures, between which the pad's lies. */
#include "model_fixture.h"
#include "program_fixture.h"

#include "material/foam_card.h"
#include "model/model_io.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

static program_result make(const program_place *p, const char *curves, const char *temperature) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "geometry: { file = \"geo/pad.geo\"; missile_file = \"geo/hemisphere.geo\"; length_unit = \"mm\";\n"
        "parameters = { fine_spacing = 20.0; outer_spacing = 25.0; }; };\n"
        "material: { density = \"35 kg/m3\"; E = \"0.4 MPa\"; curves = ( %s ); };\n"
        "pad: { mesh_error_limit = 10.0; %s };\nmissile: { mass = \"4.6 kg\"; velocity = \"2 m/s\"; };\n"
        "solver: { end_time = \"1 ms\"; };\n",
        curves, temperature);
    program_write_text(p, "t.cfg", text);
    return program_run(p, "pre", "t.cfg -o t.h5 --force");
}

/* The cold curve is 4 times the warm one, and longer, with other strains. */
static int set_up(void **state) {
    program_group_example(state);
    const program_place *p = *state;
    program_write_text(p, "cold.csv", "strain,stress_kPa\n0,0\n0.1,80\n0.5,160\n0.7,400\n0.8,800\n");
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
    assert_int_equal(card->curve_count, 1);
    assert_int_equal(card->curve_points, 5);
    double factor = card->curve_stress[4] / 100e3;
    const double warm[] = {0, 10e3, 20e3, 40e3, 100e3};
    assert_true(fabs(card->curve_strain[4] - 0.7) < 1e-12);
    for (int i = 0; i < 5; i++)
        assert_true(fabs(card->curve_stress[i] - factor * warm[i]) < 1e-6);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stresses_lie_between_by_their_logarithm),
        cmocka_unit_test(what_the_data_do_not_say_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
