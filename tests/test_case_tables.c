/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables that a case names: compression curves and motions, what they give and the sentence that each
 * fault gets. */
#include "case/curves.h"
#include "case/read.h"
#include "case_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

static void assert_curve_refused(const char *text, const char *part) {
    sf_error err = SF_ERROR_INIT;
    sf_case_curve curve;
    case_write("bad.csv", text);
    if (sf_case_curve_read(case_path("bad.csv"), &curve, &err) == SF_OK)
        fail_msg("accepted: %s", text);
    assert_int_equal(err.status, SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "bad.csv"));
    if (!strstr(err.text, part))
        fail_msg("the sentence is '%s' and lacks '%s'", err.text, part);
}

static void curves_at_several_rates_ascend(void **state) {
    (void)state;
    SF_OWNED_BY(sf_case_free) sf_case c = {0};
    case_read_good(
        GEOMETRY MISSILE SOLVER
        "material: { density = \"35 kg/m3\"; E = \"0.4 MPa\"; curves = (\n"
        "{ rate = \"0.01 1/s\"; file = \"foam.csv\"; }, { rate = \"100 1/s\"; file = \"fast.csv\"; } ); };\n",
        NULL, &c);
    const sf_foam_card *foam = sf_foam_card_of(&c.material);
    assert_int_equal(foam->curves.curve_count, 2);
    assert_int_equal(foam->curves.curve_points, 8);
    assert_int_equal(foam->curves.curve_ptr[1], 4);
    assert_int_equal(foam->curves.curve_ptr[2], 8);
    assert_true(foam->curves.curve_rate[0] == 0.01 && foam->curves.curve_rate[1] == 100.0);
    assert_true(foam->curves.curve_strain[7] == 0.7 && foam->curves.curve_stress[7] == 1.5e6 &&
                foam->curves.curve_stress[3] == 9e5);
}

static void rate_curves_are_checked(void **state) {
    (void)state;
    case_assert_refused(GOOD, "material.curves=( { rate = \"1 1/s\"; file = \"foam.csv\"; } )",
                        "material has both curve and curves", NULL);
#define RATES(list)                                                                                          \
    GEOMETRY MISSILE SOLVER "material: { density = \"35 kg/m3\"; E = \"0.4 MPa\"; curves = " list "; };\n"
    case_assert_refused(RATES("( )"), NULL, "material.curves must be a list", NULL);
    case_assert_refused(GOOD, "material.rate_factor=0.1", "material.rate_reference is missing", NULL);
    case_assert_refused(
        GEOMETRY MISSILE SOLVER
        "material: { density = \"35 kg/m3\"; E = \"0.4 MPa\";\n"
        "rate_factor = 0.1; rate_reference = \"1 1/s\"; curves = (\n"
        "{ rate = \"1 1/s\"; file = \"foam.csv\"; }, { rate = \"9 1/s\"; file = \"fast.csv\"; } ); };\n",
        NULL, "case.cfg:5: material.rate_factor is 0.1 and there are 2 curves at several rates", NULL);
    case_assert_refused(
        RATES("( { rate = \"1 1/s\"; file = \"fast.csv\"; }, { rate = \"9 1/s\"; file = \"foam.csv\"; } )"),
        NULL, "the stress falls with the rate", "(fast.csv) to",
        "(foam.csv): are the rates or the files exchanged?", NULL);
    case_assert_refused(RATES("( { rate = \"1 1/s\"; } )"), NULL, "each entry must be { rate", NULL);
    case_assert_refused(RATES("( { rate = \"1 1/s\"; file = \"\"; } )"), NULL,
                        "the name of a curve's CSV file", NULL);
    case_assert_refused(RATES("( { rate = 1; file = \"foam.csv\"; } )"), NULL, "the rate must be a text",
                        NULL);
    case_assert_refused(RATES("( { rate = \"1 s\"; file = \"foam.csv\"; } )"), NULL,
                        "is a time; expected a rate", NULL);
    case_assert_refused(
        RATES("( { rate = \"9 1/s\"; file = \"foam.csv\"; }, { rate = \"1 1/s\"; file = \"fast.csv\"; } )"),
        NULL, "the rate 1 s-1 is not above 9 s-1 before it", NULL);
}

static void curve_faults_name_file_line_and_value(void **state) {
    (void)state;
#define HEAD "strain,stress_kPa\n"
    assert_curve_refused("# nothing\n", "is empty: it needs a heading");
    assert_curve_refused(HEAD "0,0\n0.1,2\n0.2,3\n", "3 points; at least 4 are needed");
    assert_curve_refused("eps,stress_kPa\n0,0\n", ":1: the heading has no column of strain, such as strain");
    assert_curve_refused("strain,stress\n0,0\n",
                         ":1: the heading has no column of stress, such as stress_kPa");
    assert_curve_refused("strain,stress_kPa,stress_Pa\n0,0,0\n", "two stress columns");
    assert_curve_refused("#\n" HEAD "0,0\n0.1,abc\n", ":4: stress \"abc\" is not a finite number");
    assert_curve_refused(HEAD "0,0\n0.1,2 kPa\n", ":3: stress \"2 kPa\" is not a finite number");
    assert_curve_refused(HEAD "0,0\n0,1,2\n", ":3: 3 values where the heading has 2 columns");
    assert_curve_refused(HEAD "0,0\n0.1\n", ":3: 1 values where the heading has 2 columns");
    assert_curve_refused(HEAD "0,0\n0.1,2\n0.1,3\n", ":4: strain 0.1 is not above the one before it (0.1)");
    assert_curve_refused(HEAD "0,0\n0.1,2\n0.2,1.5\n", ":4: stress 1.5 is below the one before it (2)");
    assert_curve_refused(HEAD "0,0\n0.1,nan\n", ":3: stress \"nan\" is not a finite");
    assert_curve_refused(HEAD "0,0\n-0.1,-2\n", ":3: strain -0.1 is negative; compression is positive");
    assert_curve_refused(HEAD "0,0\n0.1,-2\n", ":3: stress -2 is negative");
    assert_curve_refused(HEAD "0,0\n1.2,5\n", ":3: strain 1.2 means a compression to nothing");
    assert_curve_refused(HEAD "0,4\n0.1,5\n", ":2: stress 4 at zero strain; the curve must start at (0, 0)");
    assert_curve_refused(HEAD "0,0\n0.1,0\n0.2,0\n0.3,0\n", "the stress is zero everywhere");
}

#define DRIVEN(rest) GEOMETRY MATERIAL SOLVER "missile: { motion = \"press.csv\"; " rest "};\n"

static void motion_replaces_mass_and_speed(void **state) {
    (void)state;
    sf_case c;
    case_write("press.csv", "# a press\nforce_N,displacement_mm,time_ms\n1,0,0\n2,25,50\n3,-5.5,80\n");
    case_read_good(DRIVEN(""), NULL, &c);
    assert_int_equal(c.motion_count, 3);
    assert_true(c.motion_time[0] == 0.0 && c.motion_displacement[0] == 0.0);
    assert_true(fabs(c.motion_time[1] - 0.05) < 1e-16 && fabs(c.motion_time[2] - 0.08) < 1e-16);
    assert_true(fabs(c.motion_displacement[1] - 0.025) < 1e-16);
    assert_true(fabs(c.motion_displacement[2] + 0.0055) < 1e-16);
    assert_true(c.missile_card.mass == 0.0 && c.missile_card.speed == 0.0 && c.missile_card.gravity == 0.0);
    assert_non_null(strstr(c.parameters, "3 points, to 0.08 s"));
    sf_case_free(&c);
    case_write("press.csv", "time_s,displacement_m\n0,0\n0.04,0.025\n"); /* may end with the run */
    case_read_good(DRIVEN("gap = \"1 mm\"; friction = 0.5; "), NULL, &c);
    assert_true(c.motion_displacement[1] == 0.025 && c.missile_card.gap == 1e-3);
    sf_case_free(&c);
    case_assert_refused(DRIVEN("mass = \"4.6 kg\"; "), NULL, "case.cfg:4: missile.mass has no meaning", NULL);
    case_assert_refused(DRIVEN(""), "missile.velocity=4 m/s",
                        "--set missile.velocity=4 m/s: missile.velocity has no meaning", NULL);
    case_assert_refused(DRIVEN(""), "missile.gravity=1 m/s2", "missile.gravity has no meaning", NULL);
    case_assert_refused(DRIVEN(""), "solver.end_time=41 ms",
                        "solver.end_time: 0.041 s lies beyond the end of missile.motion (0.04 s)", NULL);
    case_assert_refused(DRIVEN(""), "missile.motion=none.csv", "the motion",
                        "none.csv cannot be read: No such file", "(named at --set missile.motion=none.csv)",
                        NULL);
    case_assert_refused(DRIVEN(""), "missile.motion=materials", "is not a plain file", NULL);
    case_assert_refused(DRIVEN(""), "missile.motion=3", "missile.motion: expected the name of a CSV file",
                        NULL);
}

static void motion_faults_name_file_line_and_value(void **state) {
    (void)state;
    static const struct {
        const char *text, *part;
    } faults[] = {
        {"", "0 points; at least 2 are needed"},
        {"0,0\n", "1 points; at least 2 are needed"},
        {"1,0\n2,1\n", ":2: time 1 in the first point; a motion starts at (0, 0)"},
        {"0,1\n2,1\n", ":2: displacement 1 in the first point; a motion starts at (0, 0)"},
        {"0,0\n2,1\n2,3\n", ":4: time 2 is not above the one before it (2)"},
        {"0,0\n2,1\n1,3\n", ":4: time 1 is not above the one before it (2)"},
        {"0,0\n2,x\n", ":3: displacement \"x\" is not a finite number"},
        {"0,0\ninf,1\n", ":3: time \"inf\" is not a finite"},
        {"0,0\n2\n", ":3: 1 values where the heading has 2 columns"},
        {"0,0\n1,201\n", ":3: displacement 201 after 0 means a speed of 201 m/s"},
        {"0,0\n50,0\n", "the displacement is zero everywhere"},
    };
    for (size_t k = 0; k < sizeof faults / sizeof faults[0]; k++) {
        char text[256];
        snprintf(text, sizeof text, "time_ms,displacement_mm\n%s", faults[k].text);
        case_write("press.csv", text);
        case_assert_refused(DRIVEN(""), NULL, "press.csv", faults[k].part, "(named at ", "case.cfg:4)", NULL);
    }
    case_write("press.csv", "time,displacement_mm\n0,0\n");
    case_assert_refused(DRIVEN(""), NULL, ":1: the heading has no column of time, such as time_ms", NULL);
    case_write("press.csv", "time_s,displacement\n0,0\n");
    case_assert_refused(DRIVEN(""), NULL,
                        ":1: the heading has no column of displacement, such as displacement_mm", NULL);
    case_write("press.csv", "time_s,time_ms,displacement_m\n0,0\n");
    case_assert_refused(DRIVEN(""), NULL, "two time columns", NULL);
}

static void curve_without_origin_is_extended_to_it(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_case_curve curve;
    case_write(
        "late.csv",
        "\xEF\xBB\xBF# from a spreadsheet\r\n time , strain_percent , stress_Pa \r\n1,5,100\r\n2,10,200\r\n"
        "3,20,300\r\n\r\n4,30,300\r\n");
    if (sf_case_curve_read(case_path("late.csv"), &curve, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(curve.extended);
    assert_int_equal(curve.count, 5);
    assert_true(curve.strain[0] == 0.0 && curve.stress[0] == 0.0 && fabs(curve.strain[1] - 0.05) < 1e-16);
    assert_true(curve.stress[4] == 300.0);
    sf_case_curve_free(&curve);
}

static void note_sentence(void *user, sf_severity severity, const char *sentence) {
    assert_int_equal(severity, SF_FACT);
    strcat(user, sentence);
}

/* What a curve is read as is a fact for the report; a file of another form names the command that reads it.
 */
static void what_a_curve_is_read_as_is_told(void **state) {
    (void)state;
    char told[2048] = "";
    const sf_sink sink = {note_sentence, told};
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    const char *override = "material.curve=lab.csv";
    case_write(
        "lab.csv",
        "# softfall read lab.xlsx: sheet \"A\"\nstress_MPa,Strain [%]\r\n0,0\r\n0.02,10.5\r\n0.1,50\r\n0.9,80\r\n");
    case_write("press.csv", "time_s,displacement_m\n0,0\n0.04,0.025\n");
    case_write("case.cfg", DRIVEN(""));
    if (sf_case_read(case_path("case.cfg"), 1, &override, &sink, &c, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(sf_foam_card_of(&c.material)->curves.curve_strain[1] == 0.105 &&
                sf_foam_card_of(&c.material)->curves.curve_stress[3] == 0.9e6);
    assert_non_null(strstr(
        told, "lab.csv: nominal stress over nominal strain in compression, columns 2 and 1, strain in %, "
              "stress in MPa (softfall read lab.xlsx: sheet \"A\")"));
    sf_case_free(&c);
    case_write("lab.csv", "Strain [%];Stress [N/mm2]\r\n0;0\r\n10,5;0,02\r\n50;0,1\r\n80;0,9\r\n");
    assert_int_equal(sf_case_read(case_path("case.cfg"), 1, &override, NULL, &c, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "lab.csv --kind compression -o clean.csv reads other forms"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curves_at_several_rates_ascend),
        cmocka_unit_test(rate_curves_are_checked),
        cmocka_unit_test(curve_faults_name_file_line_and_value),
        cmocka_unit_test(motion_replaces_mass_and_speed),
        cmocka_unit_test(motion_faults_name_file_line_and_value),
        cmocka_unit_test(curve_without_origin_is_extended_to_it),
        cmocka_unit_test(what_a_curve_is_read_as_is_told),
    };
    return cmocka_run_group_tests(tests, case_set_up, case_tear_down);
}
