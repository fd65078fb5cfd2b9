/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of compression tests and the FIT.cfg of softfall-fit compression: what is read of them, and what
 * is refused. */
#include "study/fit/compression/compression_config.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

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

static sf_status read_sheet(const sheet *s, sf_compression_source source, sf_compression_test *test,
                            sf_error *err) {
    source.path = sheet_write(&place, "good.csv", s);
    return sf_compression_test_read(&source, test, err);
}

static void assert_refused(const sheet *s, const char *part, int line) {
    char where[600];
    sf_compression_test test;
    sf_error err = SF_ERROR_INIT;
    const char *path = sheet_write(&place, "bad.csv", s);
    assert_int_equal(sf_compression_test_read(&(sf_compression_source){.path = path, .rate = 1}, &test, &err),
                     SF_ERR_INPUT);
    snprintf(where, sizeof where, line ? "%s:%d: " : "%s: ", path, line);
    if (!strstr(err.text, part) || !strstr(err.text, where))
        fail_msg("\"%s\" and \"%s\" are expected in: %s", where, part, err.text);
    assert_null(test.strain);
}

/* Row i stands in line i + 3. */
static void wrong_tests_are_refused_with_their_line(void **state) {
    (void)state;
    const sheet good = sheet_good(1);
    sheet s = good;
    s.strain[100] = s.strain[99] + 0.01;
    assert_refused(&s, "rises again", 103);
    s = good;
    s.strain[20] = s.strain[19] - 0.001;
    assert_refused(&s, "rises again", 24);
    s = good;
    s.header = "strain,stress_N";
    assert_refused(&s, "no column of stress, such as stress_kPa", 2);
    s = good;
    s.header = "elongation,stress_kPa";
    assert_refused(&s, "no column of strain, such as strain; it has \"elongation\"", 2);
    static const char *const others[] = {"Log strain (1),Stress (kPa)", "Strain (1),True stress (kPa)",
                                         "Hencky strain (1),Cauchy stress (kPa)",
                                         "Wahre Dehnung (1),Spannung (kPa)"};
    for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
        s.header = others[k];
        assert_refused(
            &s, "and what is read is nominal stress over nominal strain in compression: softfall read", 2);
    }
    s = good;
    s.unloading = 3 - SHEET_POINTS;
    assert_refused(&s, "points of loading", 0);
    s = good;
    s.unloading = 3;
    assert_refused(&s, "unloading has 3 points", 63);
    s = good;
    for (int i = 0; i < 2 * SHEET_POINTS; i++)
        s.stress[i] = -s.stress[i];
    assert_refused(&s, "compression is positive", 17);
    s = good;
    s.strain[0] = -0.1;
    assert_refused(&s, "compression is positive", 3);
    s = good;
    s.stress[50] = 0.8 * s.stress[49];
    assert_refused(&s, "fallen by more than a tenth", 53);
    s = good;
    s.stress[61] = 1.2 * s.stress[58];
    assert_refused(&s, "above the loading stress", 64);
    s = good;
    for (int i = 0; i < 2 * SHEET_POINTS; i++)
        s.strain[i] *= 100;
    assert_refused(&s, "strain_percent", 6);
    s = good;
    s.header = "strain_percent,stress_kPa";
    assert_refused(&s, "must reach 10 %", 0);
    s = good;
    memset(s.stress, 0, sizeof s.stress);
    assert_refused(&s, "zero everywhere", 0);
}

static void scatter_about_zero_and_percent_are_read(void **state) {
    (void)state;
    sheet s = sheet_good(1);
    sf_compression_test test;
    sf_error err = SF_ERROR_INIT;
    s.header = "strain_percent,stress_MPa";
    for (int i = 0; i < 2 * SHEET_POINTS; i++) {
        s.strain[i] *= 100;
        s.stress[i] *= 1e-3;
    }
    s.stress[2 * SHEET_POINTS - 1] = -1e-4;
    assert_int_equal(read_sheet(&s, (sf_compression_source){.rate = 2}, &test, &err), SF_OK);
    assert_int_equal(test.loading, SHEET_POINTS);
    assert_int_equal(test.count, 2 * SHEET_POINTS);
    assert_close(test.largest_strain, 0.8, 1e-12);
    assert_relative(test.largest_stress, 1e3 * sheet_stress(0.8), 1e-6);
    sf_compression_test_free(&test);
}

/* 1201 points up and 1200 down: means of three, the turn as it is. */
static void long_branches_are_condensed_to_means(void **state) {
    (void)state;
    sf_compression_test test;
    sf_error err = SF_ERROR_INIT;
    const char *path = program_path(&place, "long.csv");
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fputs("strain,stress_kPa\n", out);
    for (int i = 1; i <= 2401; i++) {
        double e = 0.6 * (i <= 1201 ? i : 2402 - i) / 1201;
        fprintf(out, "%.12g,%.12g\n", e, 100 * e);
    }
    assert_int_equal(fclose(out), 0);
    assert_int_equal(sf_compression_test_read(&(sf_compression_source){.path = path, .rate = 2}, &test, &err),
                     SF_OK);
    assert_int_equal(test.loading, 401);
    assert_int_equal(test.count, 801);
    assert_close(test.strain[400], 0.6, 1e-12);
    assert_close(test.strain[0], 0.6 * 2 / 1201, 1e-12);
    for (int i = 0; i < test.count; i++)
        assert_close(test.stress[i], 1e5 * test.strain[i], 1e-6);
    sf_compression_test_free(&test);
}

/* A displacement that trembles by 0.02 % of the thickness does not turn; its points come in order. */
static void jitter_of_the_strain_is_sorted(void **state) {
    (void)state;
    sf_compression_test test;
    sf_error err = SF_ERROR_INIT;
    const char *path = program_path(&place, "jitter.csv");
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fputs("strain,stress_kPa\n", out);
    for (int i = 0; i <= 900; i++) {
        double e = (i <= 450 ? i : 900 - i) * 1e-3 + 2e-4 +
                   (i % 3 == 0   ? 2e-4
                    : i % 3 == 1 ? -9e-4
                                 : 0) *
                       1.2;
        fprintf(out, "%.7f,%.6f\n", e, 100 * e * (i <= 450 ? 1 : 0.8));
    }
    assert_int_equal(fclose(out), 0);
    const sf_compression_source source = {.path = path, .rate = 1};
    assert_int_equal(sf_compression_test_read(&source, &test, &err), SF_OK);
    assert_in_range(test.loading, 449, 452);
    assert_int_equal(test.count, 901);
    for (int i = 1; i < test.count; i++) {
        assert_true(i < test.loading ? test.strain[i] >= test.strain[i - 1]
                                     : test.strain[i] <= test.strain[i - 1]);
        assert_close(test.stress[i], 1e5 * test.strain[i] * (i < test.loading ? 1 : 0.8), 0.02);
    }
    assert_non_null(strstr(test.interpretation, "jitter of"));
    sf_compression_test_free(&test);
}

/* ---- machines' files ---- */

/* The good sheet as displacement and force of a cylinder of 60 mm and 40 mm height, both channels with
 * `sign`.
 */
static const char *write_machine(const char *name, double sign) {
    const sheet s = sheet_good(1);
    const char *path = program_path(&place, name);
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fputs("# test 7\ntime_s,displacement_mm,force_N\r\n", out);
    for (int i = 0; i < SHEET_POINTS + s.unloading; i++) {
        fprintf(out, "%d,%.6f,%.6f\r\n", i, sign * 40 * s.strain[i],
                sign * 1e3 * s.stress[i] * M_PI / 4 * 0.06 * 0.06);
    }
    assert_int_equal(fclose(out), 0);
    return path;
}

#define MACHINE(more)                                                                                        \
    "density = \"35 kg/m3\";\ntests = ( { file = \"machine.csv\"; rate = \"40 mm/min\"; " more "} );\n"

static void displacement_and_force_become_strain_and_stress(void **state) {
    (void)state;
    static const char *const configs[] = {
        MACHINE("specimen = { diameter = \"60 mm\"; thickness = \"4 cm\"; }; "),
        "specimen = { area = \"28.2743339 cm2\"; thickness = \"40 mm\"; };\n" MACHINE("invert = \"both\"; "),
        "specimen = { side = \"90 mm\"; thickness = \"1 mm\"; };\n" MACHINE(
            "specimen = { side = \"31.41592654 mm\"; width = \"90 mm\"; thickness = \"40 mm\"; }; "),
    };
    const sheet s = sheet_good(1);
    for (size_t k = 0; k < sizeof configs / sizeof *configs; k++) {
        sf_compression_config config;
        sf_error err = SF_ERROR_INIT;
        write_machine("machine.csv", k == 1 ? -1 : 1);
        if (sf_compression_config_read(program_write_text(&place, "fit.cfg", configs[k]), &config, &err) !=
            SF_OK)
            fail_msg("%zu: %s", k, err.text);
        const sf_compression_test *t = &config.test[0];
        assert_relative(t->rate, 1.0 / 60, 1e-9);
        assert_int_equal(t->count, 2 * SHEET_POINTS);
        for (int i = 0; i < t->count; i++) {
            assert_close(t->strain[i], s.strain[i], 1e-7);
            assert_close(t->stress[i], 1e3 * s.stress[i], 1e-6 * 1e3 * s.stress[i] + 1e-3);
        }
        assert_non_null(
            strstr(t->interpretation,
                   "force over displacement in compression, columns 2 and 3, displacement in mm, force in N, "
                   "over 2827.4 mm2 and 40 mm"));
        sf_compression_config_free(&config);
    }
}

static void incomplete_specimens_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {MACHINE("specimen = { thickness = \"40 mm\"; }; "), "give the specimen"},
        {MACHINE("specimen = { diameter = \"60 mm\"; }; "), "give the specimen's thickness"},
        {MACHINE("specimen = { diameter = \"60 mm\"; side = \"5 mm\"; thickness = \"40 mm\"; }; "),
         "give side (with width, if the face is no square), diameter or area"},
        {MACHINE("specimen = { diameter = \"60 mm\"; thickness = \"30 mm\"; }; "),
         "machine.csv:60: displacement 30.41"},
        {MACHINE("specimen = { diameter = \"60 mm\"; thickness = \"40 mm\"; }; invert = \"strain\"; "),
         "displacement -0.1947"},
        {MACHINE("toe_correction = 1; specimen = { area = \"1 cm2\"; thickness = \"40 mm\"; }; "),
         "toe_correction must be true or false"},
    };
    write_machine("machine.csv", 1);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_compression_config config;
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(
            sf_compression_config_read(program_write_text(&place, "fit.cfg", cases[k].text), &config, &err),
            SF_ERR_INPUT);
        if (!strstr(err.text, cases[k].part))
            fail_msg("\"%s\" is expected in: %s", cases[k].part, err.text);
    }
}

/* A foam of 400 kPa up to 4 %, whose platens meet only by and by: up to 4 kPa a toe of 2 % closes. */
static double law_with_plateau(double e) {
    return e < 0.04 ? 400 * e : 16 + 20 * (e - 0.04) + 300 * pow(e - 0.04, 3);
}

static const char *write_toe(const char *name) {
    const char *path = program_path(&place, name);
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fputs("Strain (%),Stress (kPa)\n", out);
    for (int i = 0; i <= 300; i++) {
        double e = 0.002 * i, stress = law_with_plateau(e), open = fmax(0, 1 - stress / 4);
        fprintf(out, "%.9f,%.9f\n", 100 * (e + 0.02 * (1 - open * open)), stress);
    }
    assert_int_equal(fclose(out), 0);
    return path;
}

static void toe_is_removed_on_request(void **state) {
    (void)state;
    sf_compression_test test;
    sf_error err = SF_ERROR_INIT;
    sf_compression_source source = {.path = write_toe("toe.csv"), .rate = 1};
    assert_int_equal(sf_compression_test_read(&source, &test, &err), SF_OK);
    assert_close(test.toe, 0, 0);
    assert_close(test.largest_strain, 0.62, 1e-9);
    sf_compression_test_free(&test);
    source.toe = true;
    assert_int_equal(sf_compression_test_read(&source, &test, &err), SF_OK);
    assert_close(test.toe, 0.02, 1e-7);
    assert_close(test.largest_strain, 0.6, 1e-7);
    assert_in_range(test.loading, 290, 298);
    for (int i = 0; i < test.count; i++)
        assert_close(test.stress[i], 1e3 * law_with_plateau(test.strain[i]), 0.1);
    assert_non_null(strstr(test.interpretation, "toe of 2 % taken away"));
    sf_compression_test_free(&test);
}

static void toe_without_a_straight_part_is_refused(void **state) {
    (void)state;
    sf_compression_test test;
    sf_error err = SF_ERROR_INIT;
    sheet s = sheet_good(1);
    for (int i = 0; i < SHEET_POINTS; i++)
        s.stress[i] = 300 * s.strain[i] * s.strain[i];
    s.unloading = 0;
    assert_int_equal(read_sheet(&s, (sf_compression_source){.rate = 1, .toe = true}, &test, &err),
                     SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the toe cannot be corrected"));
}

/* ---- FIT.cfg ---- */

static void wrong_files_are_refused_with_their_line(void **state) {
    (void)state;
    static const struct {
        const char *text, *part;
        int line;
    } cases[] = {
        {SHEET_TEST_LIST, "density is missing", 0},
        {"density = 35;\n" SHEET_TEST_LIST, "a text with its unit", 1},
        {"density = \"35 g\";\n" SHEET_TEST_LIST, "a density", 1},
        {"density = \"35 kg/m3\";\n", "tests is missing", 0},
        {"density = \"35 kg/m3\";\ntests = ( { file = \"slow.csv\"; } );\n", "rate is missing", 2},
        {"density = \"35 kg/m3\";\ntests = ( { file = \"slow.csv\"; rate = \"0.1 1/min\"; },\n"
         "{ file = \"slow.csv\"; rate = \"6 1/h\"; } );\n",
         "give each rate once", 3},
        {"density = \"35 kg/m3\";\ntests = ( { file = \"slow.csv\"; rate = \"0.1 1/min\"; },\n"
         "{ file = \"copy.csv\"; rate = \"10 1/min\"; } );\n",
         "give the same data once", 3},
        {"density = \"35 kg/m3\";\ntests = ( { file = \"slow.csv\"; rate = \"10 1/min\"; },\n"
         "{ file = \"stiff.csv\"; rate = \"0.1 1/min\"; } );\n",
         "are the rates exchanged", 0},
        {"density = \"35 kg/m3\";\ntests = ( { file = \"slow.csv\"; rate = \"0.1 mm\"; } );\n", "a rate", 2},
        {"density = \"35 kg/m3\";\ntests = ( { file = \"slow.csv\"; rate = \"-1 1/min\"; } );\n",
         "must be above 0", 2},
        {"density = \"35 kg/m3\";\ntests = ( { file = \"none.csv\"; rate = \"1 1/min\"; } );\n", "none.csv",
         2},
        {"density = \"35 kg/m3\";\nspeed = 1;\n" SHEET_TEST_LIST, "unknown key \"speed\"", 2},
        {"density = \"35 kg/m3\";\nrate_model = \"linear\";\n" SHEET_TEST_LIST, "one of none, log", 2},
        {"density = \"35 kg/m3\";\nrate_model = \"none|log\";\n" SHEET_TEST_LIST, "one of none, log", 2},
        {"density = \"35 kg/m3\";\nrate_model = \"log\";\n" SHEET_TEST_LIST, "needs tests at two rates", 0},
        {"density = \"35 kg/m3\";\nE_range = 2.0;\n" SHEET_TEST_LIST, "outside 0.001 to 0.2", 2},
        {"density = \"35 kg/m3\";\nE_range = 0.002;\n" SHEET_TEST_LIST, "at least 4 are needed", 0},
        {"density = \"35 kg/m3\";\ndensification_start = 0.79;\n" SHEET_TEST_LIST, "leaves no data", 0},
        {"density = = 3;\n", "syntax error", 1},
    };
    const sheet s = sheet_good(1);
    sheet_write(&place, "slow.csv", &s);
    sheet_write(&place, "copy.csv", &s);
    const sheet stiff = sheet_good(1.1);
    sheet_write(&place, "stiff.csv", &stiff);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_compression_config config;
        sf_error err = SF_ERROR_INIT;
        char where[64];
        assert_int_equal(
            sf_compression_config_read(program_write_text(&place, "fit.cfg", cases[k].text), &config, &err),
            SF_ERR_INPUT);
        snprintf(where, sizeof where, "fit.cfg:%d", cases[k].line);
        if (!strstr(err.text, cases[k].part) || (cases[k].line && !strstr(err.text, where)))
            fail_msg("\"%s\" and \"%s\" are expected in: %s", where, cases[k].part, err.text);
        assert_int_equal(config.test_count, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wrong_tests_are_refused_with_their_line),
        cmocka_unit_test(scatter_about_zero_and_percent_are_read),
        cmocka_unit_test(long_branches_are_condensed_to_means),
        cmocka_unit_test(jitter_of_the_strain_is_sorted),
        cmocka_unit_test(displacement_and_force_become_strain_and_stress),
        cmocka_unit_test(incomplete_specimens_are_refused),
        cmocka_unit_test(toe_is_removed_on_request),
        cmocka_unit_test(toe_without_a_straight_part_is_refused),
        cmocka_unit_test(wrong_files_are_refused_with_their_line),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
