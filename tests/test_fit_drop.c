/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Identification from drops: whole fits on a coarse mesh. The input: test_fit_input. */
#include "extreme.h"
#include "study/fit/drop/drop_fit.h"
#include "study/fit/form/form.h"
#include "foam_fixture.h"
#include "io/folder.h"
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

/* A fit that begins at the least SHAPE that a case allows beside its ALPHA goes no further, nor do its draws.
 */
static void no_foam_is_one_that_a_case_refuses(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    fit_fixture_put_case(&place);
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

/* No foam of this thickness has 15 g: the peak is least, 62 g, at some stress, where the columns still expect
 * less. */
static void what_no_foam_has_does_not_converge(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    fit_fixture_put_case(&place);
    program_write_text(&place, "fit.cfg",
                       "material = \"start.cfg\"; curve_form = \"table\"; posterior = false;\n"
                       "unknown = ( { name = \"stress_scale\"; prior_sd = 2.0; } );\n"
                       "drops = ( { name = \"a\"; case = \"case.cfg\"; a_max_g = 15.0; } );\n");
    program_result fit = program_run(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_int_equal(fit.code, 5);
    assert_true(strstr(fit.err, "the data are missed by ten times their standard deviations") ||
                strstr(fit.err, "no proposed step lowers the objective")); /* by the mesh */
    assert_non_null(strstr(fit.err, "1 of 1 fits did not converge: the files are written"));
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    assert_non_null(strstr(json.data, "\"converged\": false"));
    free(json.data);
    program_bytes material = program_read_file(program_path(&place, "out/material.cfg"));
    assert_non_null(strstr(material.data, "NOT CONVERGED: "));
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

/* The figures of a drop, as softfall-post writes them. */
typedef struct drop_figures {
    double a_max, hic, window, rebound, contact_time; /* g, -, ms, m/s, ms */
} drop_figures;

static drop_figures simulate_hidden(const program_place *p, const char *speed) {
    drop_figures f;
    program_succeed(p, "pre",
                    "case.cfg --set material=@hidden.cfg --set missile.velocity='%s' -o m.h5 --force", speed);
    program_succeed(p, "solve", "m.h5 -o r.h5 --force");
    program_figures(p, "r.h5 -o post --force");
    program_bytes json = program_read_file(program_path(p, "post/summary.json"));
    assert_int_equal(sscanf(strstr(json.data, "\"a_max_g\":"), "\"a_max_g\": %lf", &f.a_max), 1);
    assert_int_equal(sscanf(strstr(json.data, "\"hic\":"), "\"hic\": %lf", &f.hic), 1);
    f.window =
        program_json_number(json.data, NULL, "hic_t2_ms") - program_json_number(json.data, NULL, "hic_t1_ms");
    f.contact_time = program_json_number(json.data, NULL, "rebound_time_ms") -
                     program_json_number(json.data, NULL, "contact_time_ms");
    f.rebound = program_json_number(json.data, NULL, "v_rebound_m_s");
    free(json.data);
    return f;
}

static void put_hidden(const program_place *p) {
    program_write_text(
        p, "hidden.cfg",
        "density = \"35 kg/m3\"; E = \"0.4136 MPa\"; curve = \"hidden.csv\"; HU = 0.01; ED = \"3 MPa\"; "
        "BETA1 = \"5000 1/s\";\n");
    FILE *curve = fopen(program_path(p, "hidden.csv"), "w");
    assert_non_null(curve);
    fputs("strain,stress_Pa\n", curve);
    for (int k = 0; k <= 95; k++)
        fprintf(curve, "%g,%.9g\n", 0.01 * k, sf_gas_curve_stress(&eva, 0.01 * k));
    fclose(curve);
}

/* Two drops, within a fifth of a standard deviation of what was measured. */
static void assert_drops_are_met(const char *json, const drop_figures *f) {
    const char *at = json;
    for (int k = 0; k < 2; k++) {
        double a, h;
        at = strstr(at, "\"a_max_g\":");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "\"a_max_g\": %lf", &a), 1);
        at = strstr(at, "\"hic\":");
        assert_int_equal(sscanf(at, "\"hic\": %lf", &h), 1);
        assert_true(fabs(a / f[k].a_max - 1) < 0.004 && fabs(h / f[k].hic - 1) < 0.008);
    }
    assert_true(fabs(program_json_number(json, NULL, "hic_window_measured_sd") - 0.5 / sqrt(6) / f->window) <
                1e-6);
    assert_true(fabs(program_json_number(json, NULL, "hic_window_ms") / f->window - 1) < 0.01);
    assert_true(fabs(program_json_number(json, NULL, "v_rebound_m_s") / f->rebound - 1) < 0.015);
    assert_true(fabs(program_json_number(json, NULL, "contact_time_ms") / f->contact_time - 1) < 0.01);
    assert_true(program_json_number(json, NULL, "hic_window_from_others_ms") > 0);
}

static void assert_foam_is_met(const char *json) {
    const double hidden[3] = {134e3, 23e3, 3e6}; /* p0, B, ED */
    const char *at = strstr(json, "\"parameters\":");
    for (int k = 0; k < 3; k++) {
        double low, high;
        at = strstr(at, "\"low95_SI\":");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "\"low95_SI\": %lf, \"high95_SI\": %lf", &low, &high), 2);
        assert_true(low < hidden[k] && hidden[k] < high && high < 10 * low);
        at++;
    }
    assert_non_null(strstr(json, "\"converged\": true"));
    assert_non_null(strstr(json, "\"criteria_reached\": true"));
}

/* The posterior is whole, and comes again with more threads. */
static void assert_posterior_is_repeated(const program_place *p) {
    assert_int_equal(program_shell(p, "test \"$(ls out/posterior/*.cfg | wc -l)\" = 200 && test \"$(wc -l < "
                                      "out/posterior.csv)\" = 201 && cp -r out first")
                         .code,
                     0);
    program_succeed(p, "pre", "case.cfg --set material=@out/posterior/draw-100.cfg -o m.h5 --force");
    assert_response_errors(p);
    program_result again = program_run(p, "fit", "drop fit.cfg -o out -t 1");
    assert_true(again.code == 2 && strstr(again.err, "--force"));
    again = program_succeed(p, "fit", "drop fit.cfg -o out -t 2 --force");
    assert_non_null(strstr(again.out, "\n0 drops simulated"));
    assert_int_equal(program_shell(p, "cmp first/posterior.csv out/posterior.csv && cmp "
                                      "first/posterior/draw-007.csv out/posterior/draw-007.csv")
                         .code,
                     0);
}

/* Coarse drops with a hidden foam are identified: the responses are met, the second run simulates nothing. */
static void hidden_foam_is_found(void **state) {
    (void)state;
    program_place place;
    char text[1536];
    program_set_up(&place);
    fit_fixture_put_case(&place);
    put_hidden(&place);
    const drop_figures f[2] = {simulate_hidden(&place, "4.5 m/s"), simulate_hidden(&place, "6.2 m/s")};
    program_shell(&place, "sed 's/4.5 m/6.2 m/' case.cfg > fast.cfg");
    snprintf(
        text, sizeof text,
        "material = \"start.cfg\";\nunknown = ( { name = \"p0\"; }, { name = \"B\"; }, { name = \"ED\"; "
        "} );\n"
        "start: { m = 2.8; s0 = \"7.4 kPa\"; };\n"
        "drops = ( { name = \"slow\"; case = \"case.cfg\"; a_max_g = %.9g; HIC = %.9g; HIC_window_ms = %.9g; "
        "HIC_window_resolution_ms = 0.5; v_rebound_m_s = %.9g; contact_time_ms = %.9g; },\n"
        "{ name = \"fast\"; case = \"fast.cfg\"; a_max_g = %.9g; HIC = %.9g; } );\n",
        f[0].a_max, f[0].hic, f[0].window, f[0].rebound, f[0].contact_time, f[1].a_max, f[1].hic);
    program_write_text(&place, "fit.cfg", text);
    program_succeed(&place, "fit", "drop fit.cfg -o out -t 1");
    program_assert_page(&place, "out/report.html", "softfall-fit drop fit.cfg -o out -t 1");
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    assert_drops_are_met(json.data, f);
    assert_foam_is_met(json.data);
    free(json.data);
    assert_posterior_is_repeated(&place);
    program_succeed(&place, "pre", "case.cfg --set material=@out/material.cfg -o m.h5 --force");
    /* The strains that the drops inform are data of the material, and each drop has its grade. */
    assert_int_equal(program_shell(&place, "grep -q '^informed_strain = 0\\.[2-9]' out/material.cfg").code,
                     0);
    assert_int_equal(program_shell(&place, "test \"$(grep -c '\"grade\": \"valid' out/fit.json)\" = 2").code,
                     0);
    program_tear_down(&place);
}

/* What was measured must be in the simulation; a drop that ends before its peak is no measure. */
static void drops_that_end_too_early_are_refused(void **state) {
    (void)state;
    static const struct {
        const char *end, *sentence;
    } cases[] = {{"24 ms", "v_rebound_m_s of the drop slow was measured, but its simulation ends without "
                           "rebound within its time: raise solver.end_time"},
                 {"4 ms", "the drop slow: do not use: deceleration left at the end"}};
    program_place place;
    program_set_up(&place);
    fit_fixture_put_case(&place);
    program_write_text(&place, "fit.cfg",
                       "material = \"start.cfg\"; unknown = ( { name = \"p0\"; } );\n"
                       "drops = ( { name = \"slow\"; case = \"early.cfg\"; a_max_g = 60.0; HIC = 150.0; "
                       "v_rebound_m_s = 2.0; contact_time_ms = 22.0; } );\n");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char command[128];
        snprintf(command, sizeof command,
                 "sed 's/end_time = \"[^\"]*\"/end_time = \"%s\"/' case.cfg > early.cfg", cases[k].end);
        program_shell(&place, "%s", command);
        program_result r = program_run(&place, "fit", "drop fit.cfg -o out -t 1");
        assert_int_equal(r.code, SF_ERR_NUMERIC);
        assert_non_null(strstr(r.err, cases[k].sentence));
    }
    program_tear_down(&place);
}

/* A prediction is of a single pad and drop: speed and thickness of its case scatter. */
static void a_predicted_drop_scatters(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    fit_fixture_put_case(&place);
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

/* A drop was 1 % faster than its case says: the fit finds the speed, simulates with it, and its figures at
 * the given speed are those of the case. */
static void an_unknown_speed_is_found_and_simulated(void **state) {
    (void)state;
    program_place place;
    char text[768];
    program_set_up(&place);
    fit_fixture_put_case(&place);
    program_shell(&place, "cp start.cfg hidden.cfg");
    const drop_figures given = simulate_hidden(&place, "4.5 m/s"),
                       real = simulate_hidden(&place, "4.545 m/s");
    snprintf(
        text, sizeof text,
        "material = \"start.cfg\"; curve_form = \"table\"; posterior = false;\n"
        "unknown = ( { name = \"stress_scale\"; prior_sd = 0.01; } );\n"
        "drops = ( { name = \"a\"; case = \"case.cfg\"; speed_sd = 0.02; a_max_g = %.9g; a_max_sd = 0.001; "
        "HIC = %.9g; HIC_sd = 0.002; v_rebound_m_s = %.9g; v_rebound_sd = 0.002; } );\n",
        real.a_max, real.hic, real.rebound);
    program_write_text(&place, "fit.cfg", text);
    program_result fit = program_succeed(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_non_null(strstr(fit.out, "the drops are told at the given speeds"));
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    assert_close(program_json_number(json.data, NULL, "speed_fitted_m_s"), 4.545, 0.012);
    assert_close(program_json_number(json.data, NULL, "a_max_at_fitted_speed_g"), real.a_max,
                 0.002 * real.a_max);
    assert_close(program_json_number(json.data, NULL, "hic_at_fitted_speed"), real.hic, 0.004 * real.hic);
    assert_close(program_json_number(json.data, NULL, "a_max_g"), given.a_max, 0.004 * given.a_max);
    assert_close(program_json_number(json.data, NULL, "hic"), given.hic, 0.008 * given.hic);
    assert_true(real.hic > 1.015 * given.hic);
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
    fit_fixture_put_case(&place);
    program_succeed(&place, "pre", "case.cfg -o m.h5");
    program_succeed(&place, "solve", "m.h5 -o r.h5");
    program_figures(&place, "r.h5 -o post --mount 'f = 100 Hz, damping = 0.4'");
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

/* The numbers of a drop jump with the frequency of a mount that rings: from a prior on the other side of the
 * jumps the search finds it none the less. */
static void a_mount_that_rings_is_found_from_afar(void **state) {
    (void)state;
    program_place place;
    char text[1024];
    program_set_up(&place);
    fit_fixture_put_case(&place);
    program_succeed(&place, "pre", "case.cfg -o m.h5");
    program_succeed(&place, "solve", "m.h5 -o r.h5");
    program_figures(&place, "r.h5 -o post --mount 'f = 240 Hz, damping = 0.05'");
    snprintf(text, sizeof text,
             "material = \"start.cfg\"; curve_form = \"table\"; posterior = false;\n"
             "unknown = ( { name = \"stress_scale\"; } );\n"
             "mount = \"f = 160 Hz, damping = 0.05\"; mount_frequency_sd = 0.3;\n"
             "drops = ( { name = \"a\"; case = \"case.cfg\"; curve = \"post/history.csv\"; "
             "curve_column = \"acceleration_cfc1000_g\"; curve_sd = 0.005; } );\n");
    program_write_text(&place, "fit.cfg", text);
    program_result r = program_succeed(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_non_null(strstr(r.out, "from a mount of "));
    const char *told = strstr(r.out, "\nConverged");
    assert_non_null(told);
    assert_relative(number_after(told, "accelerometer's mount: frequency "), 240, 0.01);
    assert_relative(number_after(told, "stress_scale"), 1, 0.01);
    program_tear_down(&place);
}

/* Damping and coupling are found as well, alone and all three at once, from priors beside them. */
static void damping_and_coupling_of_the_accelerometer_are_found(void **state) {
    (void)state;
    static const struct {
        const char *chain, *after[2];
        double expected[2];
    } rows[] = {
        {"mount = \"f = 100 Hz, damping = 0.6\"; mount_damping_sd = 0.5; coupling = \"0.2 s\";\n",
         {"damping "},
         {0.4}},
        {"mount = \"f = 100 Hz, damping = 0.4\"; coupling = \"0.35 s\"; coupling_sd = 0.5;\n",
         {"time constant "},
         {0.2}},
        {"mount = \"f = 110 Hz, damping = 0.6\"; mount_frequency_sd = 0.3; mount_damping_sd = 0.5;\n"
         "coupling = \"0.3 s\"; coupling_sd = 0.5;\n",
         {"damping ", "time constant "},
         {0.4, 0.2}},
    };
    program_place place;
    program_set_up(&place);
    fit_fixture_put_case(&place);
    program_succeed(&place, "pre", "case.cfg -o m.h5");
    program_succeed(&place, "solve", "m.h5 -o r.h5");
    program_figures(&place, "r.h5 -o post --mount 'f = 100 Hz, damping = 0.4' --coupling '0.2 s'");
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "material = \"start.cfg\"; curve_form = \"table\"; posterior = false;\n"
                 "unknown = ( { name = \"stress_scale\"; } );\n%s"
                 "drops = ( { name = \"a\"; case = \"case.cfg\"; curve = \"post/history.csv\"; "
                 "curve_column = \"acceleration_cfc1000_g\"; curve_sd = 0.005; } );\n",
                 rows[k].chain);
        program_write_text(&place, "fit.cfg", text);
        program_result r = program_succeed(&place, "fit", "drop fit.cfg -o out%zu -t 1", k);
        const char *told = strstr(r.out, "\nConverged");
        assert_non_null(told);
        for (int n = 0; n < 2 && rows[k].after[n]; n++) {
            const char *at = strstr(told, rows[k].after[n]);
            double expected = rows[k].expected[n], low = number_after(at, "linearised: ");
            assert_relative(number_after(at, rows[k].after[n]), expected, 0.01);
            assert_true(low < expected && number_after(strstr(at, "linearised: "), " to ") > expected);
        }
    }
    program_tear_down(&place);
}

static void a_second_fit_in_the_folder_is_refused(void **state) {
    (void)state;
    program_place place;
    sf_error err = SF_ERROR_INIT;
    int lock = -1;
    program_set_up(&place);
    fit_fixture_put_case(&place);
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
        cmocka_unit_test(no_foam_is_one_that_a_case_refuses),
        cmocka_unit_test(what_no_foam_has_does_not_converge),
        cmocka_unit_test(a_fit_ends_at_the_bound_of_a_parameter),
        cmocka_unit_test(hidden_foam_is_found),
        cmocka_unit_test(drops_that_end_too_early_are_refused),
        cmocka_unit_test(a_predicted_drop_scatters),
        cmocka_unit_test(an_unknown_speed_is_found_and_simulated),
        cmocka_unit_test(the_mount_of_the_accelerometer_is_found),
        cmocka_unit_test(a_mount_that_rings_is_found_from_afar),
        cmocka_unit_test(damping_and_coupling_of_the_accelerometer_are_found),
        cmocka_unit_test(a_second_fit_in_the_folder_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
