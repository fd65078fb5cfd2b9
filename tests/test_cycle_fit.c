/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory identified from records of cycles: a law that is known, LEAP, and records that say too little. */
#include "model_fixture.h"
#include "point_fixture.h"
#include "program_fixture.h"
#include "extreme.h"

#include "material/low_density_foam.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const double S0 = 5e4, E = 9e5, P0 = 101e3, PHI = 0.06; /* of gas_solid, without B */

static void make_foam(point_card *card) {
    double strain[400], stress[400];
    point_card_init(card);
    for (int i = 0; i < 400; i++) {
        double e = strain[i] = 0.85 * i / 399;
        stress[i] = S0 * (1 - exp(-(E - P0 / (1 - PHI)) * e / S0)) + P0 * e / (1 - e - PHI);
    }
    point_card_add(card, 0, 400, strain, stress);
    card->card.modulus = E;
    card->card.hysteresis_hu = 0.02;
    card->card.hysteresis_shape = 0.3;
    card->card.hysteresis_alpha = 0.6;
    card->card.memory = (sf_memory){.reload = 0.35, .drift = 0.25, .recovery = 0.12, .start = 1};
}

/* Cycles to 60 %, with pauses of 100 s and 3000 s before the fourth and the fifth, if `pauses`. Those after
 * the first begin with a `set`, a part of the largest strain that takes up no stress. */
static void write_record_with(const program_place *p, const char *name, int cycles, bool pauses, double set) {
    point_card card;
    sf_error err = SF_ERROR_INIT;
    sf_material_law law;
    sf_uniaxial point = {0};
    double rows[SF_LAW_HISTORY][SF_LANES] = {{0}}, time = 0;
    FILE *out = fopen(program_path(p, name), "w");
    make_foam(&card);
    const sf_material material = sf_foam_material(&card.card);
    assert_int_equal(sf_material_law_build(&material, &law, &err), SF_OK);
    fputs("time_s,strain,stress_kPa\n", out);
    for (int i = 0; i <= 100 * cycles; i++, time += 0.05) {
        double x = 0.01 * (i % 100), strain = 0.6 * (x < 0.5 ? 2 * x : 2 - 2 * x),
               own = i < 100 ? strain : larger(0, (strain - 0.6 * set) / (1 - set));
        double pause = pauses && i == 301 ? 100 : pauses && i == 401 ? 3000 : 0;
        for (int k = 0; pause > 0 && k < SF_LAW_HISTORY; k++)
            rows[k][0] = point.history[k];
        if (pause > 0)
            law.law->rest(law.numbers, pause, rows);
        for (int k = 0; pause > 0 && k < SF_LAW_HISTORY; k++)
            point.history[k] = rows[k][0];
        time += pause;
        fprintf(out, "%.6f,%.8f,%.8f\n", time, strain,
                1e-3 * law.law->uniaxial(law.numbers, 0.05, own, &point));
    }
    fclose(out);
    sf_material_law_free(&law);
}

static void write_record(const program_place *p, const char *name, int cycles, bool pauses) {
    write_record_with(p, name, cycles, pauses, 0);
}

/* `cycles`: the value of that key; the tests are the first cycles of one file or two (NULL: one). */
static program_result fit_all(const program_place *p, const char *name, const char *cycles, const char *file,
                              const char *second) {
    char text[4096], config[64], more[1200] = "";
    if (second)
        snprintf(more, sizeof more, ", { file = \"%s\"; rate = \"15 1/min\"; }", second);
    snprintf(
        text, sizeof text,
        "density = \"100 kg/m3\"; curve_form = \"gas_solid\"; unknown = ( \"E\", \"s0\", \"solid_fraction\" );\n"
        "start = { B = \"1 Pa\"; };\ntests = ( { file = \"%s\"; rate = \"0.25 1/s\"; }%s );\ncycles = %s;\n",
        file, more, cycles);
    snprintf(config, sizeof config, "%s.cfg", name);
    program_write_text(p, config, text);
    return program_run(p, "fit", "compression %s -o %s --force", config, name);
}

static program_result fit(const program_place *p, const char *name, const char *file, const char *cycles) {
    char value[1200];
    snprintf(value, sizeof value, "{ file = \"%s\"; %s }", file, cycles);
    return fit_all(p, name, value, file, NULL);
}

static void assert_number(const program_place *p, const char *key, double expected, double tolerance) {
    double value = program_file_number(p, "known/fit.json", key);
    if (!(fabs(value / expected - 1) < tolerance))
        fail_msg("%s is %.5g, not %.5g", key, value, expected);
}

static void a_known_memory_is_found(void **state) {
    const program_place *p = *state;
    write_record(p, "known.csv", 5, true);
    program_result r = fit(p, "known", "known.csv", "");
    if (r.code != 0)
        fail_msg("%s", r.err);
    assert_number(p, "reload", 0.35, 0.02);
    assert_number(p, "drift", 0.25, 0.05);
    assert_number(p, "recovery", 0.12, 0.03);
    assert_true(program_file_number(p, "known/fit.json", "pauses") == 2);
    assert_true(program_file_number(p, "known/fit.json", "reload_half_width") < 0.05);
    program_bytes material = program_read_file(program_path(p, "known/material.cfg"));
    assert_non_null(strstr(material.data, "memory"));
    free(material.data);
}

/* The set is told by the reloads, and not written into the material. */
static void a_set_is_measured(void **state) {
    const program_place *p = *state;
    for (int k = 0; k < 2; k++) {
        double set = 0.04 * k;
        write_record_with(p, "set.csv", 4, false, set);
        program_result r = fit(p, "known", "set.csv", "");
        if (r.code != 0)
            fail_msg("%s", r.err);
        double found = program_file_number(p, "known/fit.json", "set");
        print_message("set %g: %.4f\n", set, found);
        assert_true(fabs(found - set) < 0.012);
        assert_non_null(strstr(r.out, "set, not written: reloads take up stress"));
    }
    program_bytes material = program_read_file(program_path(p, "known/material.cfg"));
    assert_null(strstr(material.data, "set ="));
    free(material.data);
}

/* What a record does not tell is left out, and said. */
static void little_is_told_by_little(void **state) {
    const program_place *p = *state;
    write_record(p, "two.csv", 2, false);
    program_result r = fit(p, "two", "two.csv", "");
    if (r.code != 0)
        fail_msg("%s", r.err);
    assert_non_null(strstr(r.out, "drift 0 (at its bound, or no record tells it)"));
    assert_non_null(strstr(r.out, "recovery 0 (at its bound, or no record tells it)"));
    write_record(p, "one.csv", 1, false);
    r = fit(p, "one", "one.csv", "");
    assert_true(r.code != 0 && strstr(r.err, "memory is in the cycles after the first"));
    r = fit(p, "one", "two.csv", "fitted = 1;");
    assert_true(r.code != 0 && strstr(r.err, "fitted"));
    program_shell(p, "awk -F, 'NR==1 || $2 > 0.3' known.csv > high.csv");
    r = fit(p, "one", "high.csv", "");
    assert_true(r.code != 0);
    program_shell(p, "awk -F, 'NR==120 {sub(/^[^,]*/, \"0.01\")} {print}' two.csv > back.csv");
    r = fit(p, "one", "back.csv", "");
    assert_true(r.code != 0 && strstr(r.err, "time must rise"));
}

/* The worst number of an array of fit.json. */
static double worst(const program_place *p, const char *name, const char *key, int first, int last) {
    char path[64];
    snprintf(path, sizeof path, "%s/fit.json", name);
    program_bytes json = program_read_file(program_path(p, path));
    char *at = strstr(strstr(json.data, "\"memory\""), key);
    assert_non_null(at);
    double most = 0;
    at = strchr(at, '[') + 1;
    for (int k = 0; k < last; k++) {
        double value = strtod(at, &at);
        most = k >= first ? fmax(most, value) : most;
        at += strcspn(at, ",]") + 1;
    }
    free(json.data);
    return most;
}

/* Two records of one law, of which only the first has pauses, are fitted at once: what both tell is told
 * better. A record of a foam whose stress is 10 % above shows in the misfit of each. */
static void specimens_are_fitted_together(void **state) {
    const program_place *p = *state;
    write_record(p, "plain.csv", 4, false);
    program_shell(
        p,
        "awk -F, 'NR==1 {print; next} {printf \"%%s,%%s,%%.8f\\n\", $1, $2, 1.1 * $3}' plain.csv > stiff.csv");
    program_result r =
        fit_all(p, "known", "( { file = \"known.csv\"; }, { file = \"plain.csv\"; fitted = 3; } )",
                "known.csv", NULL);
    if (r.code != 0)
        fail_msg("%s", r.err);
    assert_number(p, "reload", 0.35, 0.02);
    assert_number(p, "drift", 0.25, 0.05);
    assert_number(p, "recovery", 0.12, 0.03);
    assert_true(worst(p, "known", "plain.csv", 0, 4) < 0.002);
    r = fit_all(p, "pair", "( { file = \"plain.csv\"; }, { file = \"stiff.csv\"; } )", "plain.csv",
                "stiff.csv");
    if (r.code != 0)
        fail_msg("%s", r.err);
    double low = worst(p, "pair", "plain.csv\",", 0, 4), high = worst(p, "pair", "stiff.csv\",", 0, 4);
    print_message("misfit of the pair: %.4f, %.4f\n", low, high);
    assert_true(low > 0.005 && high > 0.005 && low < 0.05 && high < 0.05);
    r = fit_all(p, "same", "( { file = \"plain.csv\"; }, { file = \"plain.csv\"; } )", "plain.csv",
                "stiff.csv");
    assert_true(r.code == 2 && strstr(r.err, "is given twice"));
    r = fit_all(p, "same", "( )", "plain.csv", "stiff.csv");
    assert_true(r.code == 2 && strstr(r.err, "cycles must be a list"));
    r = fit_all(p, "same", "( { file = \"plain.csv\"; } ); rate_model = \"factor\"", "plain.csv",
                "stiff.csv");
    assert_true(r.code == 2 && strstr(r.err, "there is one rate"));
    r = fit_all(p, "same", "{ file = \"plain.csv\"; }", "plain.csv", "plain.csv");
    assert_true(r.code == 2 && strstr(r.err, "give the same data once"));
}

/* Six cycles of two specimens, all fitted, and the last three predicted from the first three. */
static void leap_is_described(void **state) {
    const program_place *p = *state;
    static const char *const files[] = {"examples/data/leap_cycles_a.csv", "examples/data/leap_cycles_b.csv"};
    for (int k = 0; k < 2; k++) {
        char path[1024];
        snprintf(path, sizeof path, "%s", fixture_source(files[k]));
        assert_int_equal(fit(p, "leap", path, "").code, 0);
        assert_true(worst(p, "leap", "\"loading_rms\"", 0, 6) < 0.02);
        assert_true(worst(p, "leap", "\"unloading_rms\"", 0, 6) < 0.03);
        assert_int_equal(fit(p, "three", path, "fitted = 3;").code, 0);
        assert_true(worst(p, "three", "\"loading_rms\"", 3, 6) < 0.025);
        assert_true(worst(p, "three", "\"unloading_rms\"", 3, 6) < 0.025);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_known_memory_is_found),  cmocka_unit_test(a_set_is_measured),
        cmocka_unit_test(little_is_told_by_little), cmocka_unit_test(specimens_are_fitted_together),
        cmocka_unit_test(leap_is_described),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
