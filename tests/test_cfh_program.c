/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-cfh on the example case with a coarse pad. */
#include "model_fixture.h"
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

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";
static const double SPACING = 15;

static char *read_text(const program_place *p, const char *name) {
    return program_read_file(program_path(p, name)).data;
}

static int count_of(const char *text, const char *part) {
    int count = 0;
    for (; (text = strstr(text, part)) != NULL; text++)
        count++;
    return count;
}

/* HIC is put out of reach, so that a_max decides; a drop from the height found must then reach 200 g. */
static void the_height_found_gives_the_limit_when_it_is_simulated(void **state) {
    const program_place *p = *state;
    program_result r =
        program_succeed(p, "cfh", "'%s' -o out -t 1 --limit-hic 1e6 %s --rig '%s'", fixture_source(EXAMPLE),
                        program_coarse(SPACING), fixture_source("examples/data/penta2018_table2_70mm.csv"));
    char *json = read_text(p, "out/cfh.json"), *report = read_text(p, "out/report.html");
    double height = program_json_number(json, "critical_fall_height", "height_m");
    double speed = program_json_number(json, "critical_fall_height", "speed_m_s");
    assert_non_null(strstr(json, "\"deciding\": \"a_max\""));
    assert_true(count_of(json, "\"speed_m_s\"") - 1 >= 4); /* points; one is the verdict's */
    assert_relative(speed * speed, 2 * 9.80665 * height, 1e-6);
    /* What the foam adds is not known: no interval in the headline, that of the fit below, named as such. */
    assert_true(isnan(program_json_number(json, "critical_fall_height", "height_low_m")));
    assert_true(isnan(program_json_number(json, "critical_fall_height", "height_high_m")));
    assert_true(program_json_number(json, "criteria", "fit_low_m") <= height);
    assert_true(program_json_number(json, "criteria", "fit_high_m") >= height);
    assert_non_null(strstr(r.out, "The uncertainty of the foam is not included."));
    assert_null(strstr(r.out, "interval"));
    program_assert_page(p, "out/report.html", "The uncertainty of the foam is not included.");
    program_assert_page(p, "out/report.html", "interval of the fit (m)");
    assert_relative(program_json_number(json, "critical_fall_height", "rig_height_m"),
                    height * 9.80665 / 7.9668, 1e-4);
    assert_non_null(strstr(report, "Indicative, not a certification"));
    program_assert_page(p, "out/report.html", "a_max reaches 200 g first");
    assert_non_null(strstr(r.out, "a_max reaches 200 g first"));
    assert_int_equal(
        program_shell(p, "test -s out/cfh.png && test -s out/cfh.gp && test -s out/cfh.csv").code, 0);

    program_succeed(p, "pre", "'%s' -o m.h5 %s --set missile.velocity='%.9g m/s'", fixture_source(EXAMPLE),
                    program_coarse(SPACING), speed);
    program_succeed(p, "solve", "m.h5 -o r.h5 --threads 1");
    program_succeed(p, "post", "r.h5 -o one");
    char *one = read_text(p, "one/summary.json");
    assert_relative(program_json_number(one, "{", "a_max_g"), 200, 0.01);
    free(one);
    free(json);
    free(report);
}

/* Goes on from the drops of the test before: nothing is simulated again, and the answer is the same. */
static void a_second_run_uses_every_drop_again(void **state) {
    const program_place *p = *state;
    program_bytes csv = program_read_file(program_path(p, "out/cfh.csv"));
    const char *pairs = fixture_source("examples/data/penta2018_table2_70mm.csv");
    program_result refused =
        program_run(p, "cfh", "'%s' -o out -t 1 %s", fixture_source(EXAMPLE), program_coarse(SPACING));
    assert_int_equal(refused.code, 2);
    assert_non_null(strstr(refused.err, "--force"));
    program_shell(p, "rm out/cfh.* out/report.html"); /* as after an interruption: only the drops are there */
    program_result r = program_succeed(p, "cfh", "'%s' -o out -t 1 --limit-hic 1e6 %s --rig '%s'",
                                       fixture_source(EXAMPLE), program_coarse(SPACING), pairs);
    assert_non_null(strstr(r.out, "\n0 drops simulated"));
    assert_true(count_of(r.out, "(was there)") >= 4);
    program_assert_unchanged(program_path(p, "out/cfh.csv"), &csv);
}

/* The heights do not depend on how many drops are simulated at once, and neither do their figures. */
static void drops_side_by_side_have_the_same_bits(void **state) {
    const program_place *p = *state;
    program_bytes csv = program_read_file(program_path(p, "out/cfh.csv"));
    program_result r = program_succeed(
        p, "cfh", "'%s' -o abreast -t 1 --jobs 2 --limit-hic 1e6 %s --rig '%s'", fixture_source(EXAMPLE),
        program_coarse(SPACING), fixture_source("examples/data/penta2018_table2_70mm.csv"));
    assert_non_null(strstr(r.out, "2 drops side by side, one thread each"));
    assert_null(strstr(r.out, "\n0 drops simulated"));
    program_assert_unchanged(program_path(p, "abreast/cfh.csv"), &csv);
}

/* `count` draws in `folder`: the foam of the examples, its stress times a log-normal factor of 10 %. */
static void write_draws(const program_place *p, const char *folder, int count) {
    const char *material = fixture_source("examples/materials/eva35.cfg");
    char curve[512];
    snprintf(curve, sizeof curve, "%s", fixture_source("examples/materials/eva35.csv"));
    program_result r = program_shell(
        p,
        "mkdir -p %s && for n in $(seq 1 %d); do k=$(printf '%%03d' $n); "
        "sed \"s/eva35.csv/draw-$k.csv/\" '%s' > %s/draw-$k.cfg && awk -F, -v n=$n -v count=%d "
        "'/^[0-9]/ { printf \"%%s,%%.12g\\n\", $1, $2 * exp(0.17 * (2 * (n - 0.5) / count - 1)); next } { print }' '%s' "
        "> %s/draw-$k.csv || exit 1; done",
        folder, count, material, folder, count, curve, folder);
    if (r.code != 0)
        fail_msg("%s", r.err);
}

/* The drops of the first test again, with draws of the foam: interval, checks, files; without them all of it
 * goes. */
static void draws_of_the_foam_give_the_interval(void **state) {
    const program_place *p = *state;
    char words[1200];
    write_draws(p, "posterior", 100);
    snprintf(words, sizeof words, "'%s' -o out -t 1 --force --limit-hic 1e6 %s", fixture_source(EXAMPLE),
             program_coarse(SPACING));
    program_result r = program_succeed(p, "cfh", "%s --rig '%s' --posterior posterior --check-drops 2", words,
                                       fixture_source("examples/data/penta2018_table2_70mm.csv"));
    assert_non_null(strstr(r.out, "\n2 drops simulated"));
    assert_non_null(
        strstr(r.out, " as simulated: a_max reaches 200 g first. With the uncertainty of foam and mesh: "));
    char *json = read_text(p, "out/cfh.json");
    double height = program_json_number(json, "critical_fall_height", "height_m");
    double low = program_json_number(json, "critical_fall_height", "height_low_m");
    double high = program_json_number(json, "critical_fall_height", "height_high_m");
    double foam_low = program_json_number(json, "\"posterior\"", "foam_low_m");
    double foam_high = program_json_number(json, "\"posterior\"", "foam_high_m");
    assert_true(low < foam_low && foam_low < height && height < foam_high);
    assert_true(high / low > foam_high / foam_low && high / low < 1.3);
    assert_true(program_json_number(json, "critical_fall_height", "rig_height_high_m") /
                    program_json_number(json, "critical_fall_height", "rig_height_low_m") >
                high / low);
    assert_true(program_json_number(json, "\"posterior\"", "draws") == 100);
    assert_non_null(strstr(json, "\"height_open\": \"no\""));
    assert_int_equal(count_of(json, "\"share_below\""), 2);
    assert_true(fabs(program_json_number(json, "\"checks\"", "a_max_error")) < 0.05);
    assert_relative(program_json_number(json, "\"checks\"", "a_max_columns_g"), 200, 0.01);
    char *band = read_text(p, "out/cfh_band.csv"), *draws = read_text(p, "out/cfh_draws.csv");
    assert_int_equal(strncmp(band, "height_m,a_max_low_g,", 21), 0);
    assert_int_equal(count_of(draws, "\n"), 101);
    program_assert_page(p, "out/report.html", "Interval of the critical height");
    program_assert_page(p, "out/report.html", "foam alone (the draws: parameters and curve)");
    program_assert_page(p, "out/report.html", "with these uncertainties and that of g_eff: 95 % interval");
    program_bytes before = program_read_file(program_path(p, "out/cfh_band.csv"));
    r = program_succeed(p, "cfh", "%s --rig '%s' --posterior posterior --check-drops 2", words,
                        fixture_source("examples/data/penta2018_table2_70mm.csv"));
    assert_non_null(strstr(r.out, "\n0 drops simulated"));
    program_assert_unchanged(program_path(p, "out/cfh_band.csv"), &before);
    r = program_succeed(p, "cfh", "%s --rig '%s'", words,
                        fixture_source("examples/data/penta2018_table2_70mm.csv"));
    assert_null(strstr(r.out, "interval"));
    assert_int_equal(program_shell(p, "test ! -e out/cfh_band.csv && test ! -e out/cfh_draws.csv").code, 0);
    free(json);
    free(band);
    free(draws);
}

/* Draws that state errors of the responses: the interval of the foam alone stays, the whole is wider by the
 * errors, on any number of threads; and the report says what it comes from. */
static void errors_of_the_responses_widen_the_interval(void **state) {
    const program_place *p = *state;
    char words[1200];
    double before[2], after[2];
    snprintf(words, sizeof words,
             "'%s' -o out -t 1 --force --limit-hic 1e6 %s --posterior %%s --check-drops 0",
             fixture_source(EXAMPLE), program_coarse(SPACING));
    program_result r = program_succeed(p, "cfh", words, "posterior");
    char *json = read_text(p, "out/cfh.json");
    before[0] = program_json_number(json, "critical_fall_height", "height_low_m");
    before[1] = program_json_number(json, "critical_fall_height", "height_high_m");
    double foam_low = program_json_number(json, "\"posterior\"", "foam_low_m");
    assert_non_null(strstr(json, "\"response_errors\": false"));
    assert_true(program_json_number(json, "\"shares\"", "response") == 0);
    assert_non_null(strstr(r.err, "warning: The draws have no response_error: "));
    program_assert_page(p, "out/report.html", "and the errors of the responses: not known, not in it");
    free(json);
    program_shell(
        p, "cp -r posterior errors && for k in errors/draw-*.cfg; do printf 'response_error = { a_max = 0.0; "
           "a_max_sd = 0.1; HIC = 0.0; HIC_sd = 0.2; };\n' >> $k; done");
    r = program_succeed(p, "cfh", words, "errors");
    json = read_text(p, "out/cfh.json");
    after[0] = program_json_number(json, "critical_fall_height", "height_low_m");
    after[1] = program_json_number(json, "critical_fall_height", "height_high_m");
    assert_true(program_json_number(json, "\"posterior\"", "foam_low_m") == foam_low);
    assert_non_null(strstr(json, "\"response_errors\": true"));
    assert_true(program_json_number(json, "\"shares\"", "response") > 0.3);
    assert_true(after[1] / after[0] > 1.05 * before[1] / before[0]);
    assert_null(strstr(r.err, "response_error"));
    assert_non_null(strstr(r.out, "With the uncertainty of foam, responses and mesh: "));
    assert_non_null(strstr(r.out, "errors of the responses "));
    program_bytes same = program_read_file(program_path(p, "out/cfh_draws.csv"));
    snprintf(words, sizeof words,
             "'%s' -o out -t 2 --force --limit-hic 1e6 %s --posterior errors --check-drops 0",
             fixture_source(EXAMPLE), program_coarse(SPACING));
    program_succeed(p, "cfh", "%s", words);
    program_assert_unchanged(program_path(p, "out/cfh_draws.csv"), &same);
    char *again = read_text(p, "out/cfh.json");
    assert_true(program_json_number(again, "critical_fall_height", "height_low_m") == after[0]);
    assert_true(program_json_number(again, "critical_fall_height", "height_high_m") == after[1]);
    free(again);
    free(json);
}

/* Each in one sentence, before anything is simulated. */
static void posteriors_that_cannot_be_meant_are_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *spoil, *words, *part;
    } cases[] = {
        {"true", "--posterior none", "--posterior none: there is no draw-001.cfg"},
        {"rm bad/draw-100.cfg", "--posterior bad",
         "--posterior bad: 99 draws for an interval; at least 100 are needed"},
        {"for k in bad/draw-*.csv; do cp bad/draw-001.csv $k.new && mv $k.new $k; done", "--posterior bad",
         "--posterior bad: all 100 draws are the same material"},
        {"true", "--posterior bad --set material.HU=0.5",
         "--set material.HU=0.5: with --posterior the draws are the material"},
        {"rm bad/draw-007.cfg", "--posterior bad", "draw-008.cfg is there, but draw-007.cfg is not"},
        {"rm bad/draw-007.csv", "--posterior bad", "draw-007.csv"},
        {"sed -i 's/^HU.*/HU = 7;/' bad/draw-007.cfg", "--posterior bad", "HU"},
        {"sed -i 's/35 kg/36 kg/' bad/draw-007.cfg", "--posterior bad",
         "the density of bad/draw-007.cfg is 36 kg/m3, that of the case's material 35 kg/m3"},
        {"printf 'law = \"hyperfoam\"; density = \"35 kg/m3\"; term_1 = { mu = \"50 kPa\"; alpha = 8.0; nu = 0.0; };\n' "
         "> bad/draw-007.cfg",
         "--posterior bad",
         "the law of bad/draw-007.cfg is hyperfoam, that of the case's material low_density_foam"},
        {"echo 'response_error = { a_max = 0.0; a_max_sd = 0.1; HIC = 0.0; HIC_sd = 0.2; };' >> bad/draw-001.cfg",
         "--posterior bad", "bad/draw-002.cfg has no response_error, but bad/draw-001.cfg has one"},
        {"echo 'response_error = { HIC = 0.0; HIC_sd = 0.2; };' >> bad/draw-001.cfg", "--posterior bad",
         "response_error of bad/draw-001.cfg has no a_max"},
        {"echo 'response_error = { HIC = 0.0; HIC_sd = -1; };' >> bad/draw-050.cfg", "--posterior bad",
         "HIC_sd: -1 is out of bounds"},
        {"true", "--check-drops 2", "without --posterior"},
        {"true", "--posterior bad --check-drops 10", "expected a whole number from 0 to 9"},
        {"true", "--posterior bad --check-drops two", "expected a whole number from 0 to 9"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        program_shell(p, "rm -rf bad && cp -r posterior bad && %s", cases[k].spoil);
        program_result r =
            program_run(p, "cfh", "'%s' -o new -t 1 %s", fixture_source(EXAMPLE), cases[k].words);
        if (r.code <= 0 || r.code >= 128 || !strstr(r.err, cases[k].part))
            fail_msg("exit code %d, \"%s\" expected in: %s", r.code, cases[k].part, r.err);
        assert_int_equal(count_of(r.err, "\n"), 1);
    }
    program_result r = program_run(p, "cfh", "'%s' -o new -t 1 --posterior posterior",
                                   fixture_source("examples/layers/case.cfg"));
    assert_true(r.code > 0 && r.code < 128);
    assert_non_null(strstr(r.err, "has layers (materials."));
    assert_int_equal(program_shell(p, "test -e new").code, 1); /* none was begun */
}

/* A limit that is not reached up to --max-height is said as a bound, not as a failure. A table that ends
 * early is warned of with the strain. */
static void bounds_and_extrapolation_are_said(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "cfh", "'%s' -o low -t 1 --max-height '50 cm' %s",
                                       fixture_source(EXAMPLE), program_coarse(20));
    assert_non_null(strstr(r.out, "Critical fall height above 0.500 m"));
    char *report = read_text(p, "low/report.html");
    assert_non_null(strstr(report, "greatest height allowed"));
    assert_null(strstr(report, "extrapolated curve"));
    assert_non_null(strstr(report, "m: valid with remarks: ")); /* the mesh of 20 mm is coarse */
    free(report);
    program_shell(p, "sed '/^0.[6-9]/d' '%s' > short.csv", fixture_source("tests/materials/eva35_first.csv"));
    r = program_succeed(p, "cfh",
                        "'%s' -o short -t 1 --max-height '50 cm' %s --set material.curve=\"$PWD/short.csv\"",
                        fixture_source(EXAMPLE), program_coarse(20));
    report = read_text(p, "short/report.html");
    assert_non_null(strstr(report, "the compression table ends at 0.580: extrapolated curve"));
    assert_non_null(strstr(r.err, "softfall-cfh: warning: at 0.500 m: largest local strain 0."));
    free(report);
}

/* A limit that the lowest drop exceeds already is a bound as well. */
static void a_limit_exceeded_from_the_lowest_height_on_is_a_bound(void **state) {
    const program_place *p = *state;
    program_result r = program_succeed(p, "cfh",
                                       "'%s' -o below -t 1 --height '2 cm' --limit-g 0.5 %s "
                                       "--set solver.end_time='100 ms'",
                                       fixture_source(EXAMPLE), program_coarse(20));
    assert_non_null(strstr(r.out, "Critical fall height below 0.010 m of free fall: a_max exceeds 0.5 g"));
    char *json = read_text(p, "below/cfh.json"), *report = read_text(p, "below/report.html");
    assert_non_null(strstr(json, "\"grade\": \"valid"));
    assert_null(strstr(json, "\"grade\": \"do not use\""));
    assert_non_null(strstr(json, "\"verdict\": \"below the lowest point\""));
    assert_non_null(strstr(json, "\"deciding\": \"a_max\""));
    assert_true(isnan(program_json_number(json, "critical_fall_height", "height_m")));
    assert_relative(program_json_number(json, "critical_fall_height", "lowest_simulated_m"), 0.01, 1e-9);
    assert_non_null(strstr(report, "a limit is exceeded down to 1 cm"));
    free(json);
    free(report);
}

/* Drops so fast that the foam fails leave points without figures. With too few others the height is not
 * determined: that is a failure, but the report is written, with what the solver said of each. */
static void too_few_drops_that_succeed_determine_nothing(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *name, *heights, *problem, *verdict, *headline;
        int code, failed;
    } cases[] = {
        {"none", "20 m,22 m,24 m,26 m", "the missile reached the anvil", "below the lowest point",
         "Critical fall height below 2", 0, 4},
        {"some", "1 m,2 m,24 m,26 m", "a_max has 2 points for a crossing; at least 4 are needed",
         "not determined", "Critical fall height not determined", SF_ERR_INPUT, 2},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char path[64];
        program_result r = program_run(p, "cfh", "'%s' -o %s -t 1 --heights '%s' %s", fixture_source(EXAMPLE),
                                       cases[k].name, cases[k].heights, program_coarse(20));
        if (r.code != cases[k].code || !strstr(r.err, cases[k].problem))
            fail_msg("exit code %d, \"%s\" expected in: %s", r.code, cases[k].problem, r.err);
        snprintf(path, sizeof path, "%s/cfh.json", cases[k].name);
        char *json = read_text(p, path);
        assert_non_null(strstr(json, cases[k].verdict));
        assert_non_null(strstr(json, cases[k].problem));
        assert_int_equal(count_of(json, "\"failed\": true"), cases[k].failed);
        assert_int_equal(count_of(json, "the simulation failed: softfall-solve: "), cases[k].failed);
        assert_int_equal(count_of(json, "log.txt)"), cases[k].failed); /* whole sentences */
        snprintf(path, sizeof path, "%s/report.html", cases[k].name);
        char *report = read_text(p, path);
        assert_non_null(strstr(report, cases[k].headline));
        assert_int_equal(count_of(report, "the simulation failed: "), cases[k].failed);
        free(report);
        free(json);
    }
}

static void command_lines_that_cannot_be_meant_are_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *words, *part;
    } lines[] = {
        {"", "output directory"},
        {"--limit-g 0", "--limit-g 0: not a positive number"},
        {"--limit-hic many", "--limit-hic many: not a positive number"},
        {"--height 2", "has no unit"},
        {"--height '2 kg'", "--height"},
        {"--height '0 m'", "outside 1 cm"},
        {"--height '12 m'", "above the greatest height"},
        {"--heights '1 m,2 m,3 m'", "at least 4"},
        {"--heights '1 m,2 m,3 m,200 cm'", "2 m is given twice"},
        {"--heights '1 m,2 m,3 m,4 m' --height '1 m'", "--height does not go with it"},
        {"--heights '1 m,2 m,3 m,4 m' --max-height '9 m'", "--max-height does not go with it"},
        {"--set missile.velocity='3 m/s'", "the drop height decides the speed"},
        {"--set missile.direction='[1.0, 0.0, -1.0]'", "vertical fall"},
        {"--set missile.speed=3", "velocity"}, /* what exists */
        {"--material none.cfg", "none.cfg"},
        {"--rig none.csv", "none.csv"},
        {"--threads 0", "1 to 1024"},
        {"--jobs none", "--jobs"},
    };
    for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++) {
        program_result r =
            k == 0 ? program_run(p, "cfh", "'%s'", fixture_source(EXAMPLE))
                   : program_run(p, "cfh", "'%s' -o new %s", fixture_source(EXAMPLE), lines[k].words);
        if (r.code <= 0 || r.code >= 128 || !strstr(r.err, lines[k].part))
            fail_msg("exit code %d, \"%s\" expected in: %s", r.code, lines[k].part, r.err);
        if (count_of(r.err, "\n") != 1 && !strstr(r.err, "--help"))
            fail_msg("more than a sentence: %s", r.err);
    }
    assert_int_equal(program_shell(p, "test -e new").code, 1); /* none was begun */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_height_found_gives_the_limit_when_it_is_simulated),
        cmocka_unit_test(a_second_run_uses_every_drop_again),
        cmocka_unit_test(drops_side_by_side_have_the_same_bits),
        cmocka_unit_test(draws_of_the_foam_give_the_interval),
        cmocka_unit_test(errors_of_the_responses_widen_the_interval),
        cmocka_unit_test(posteriors_that_cannot_be_meant_are_refused),
        cmocka_unit_test(bounds_and_extrapolation_are_said),
        cmocka_unit_test(a_limit_exceeded_from_the_lowest_height_on_is_a_bound),
        cmocka_unit_test(too_few_drops_that_succeed_determine_nothing),
        cmocka_unit_test(command_lines_that_cannot_be_meant_are_refused),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
