/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-post as a user runs it, on synthetic results with a closed-form history. */
#include "check.h"
#include "base/units.h"
#include "post/view/axis.h"
#include "post_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#include "post_check.h"
#include "program_fixture.h"

typedef struct place {
    program_place made;
    char results[600];
    char output[600];
} place;

typedef struct outcome {
    int code;
    char text[16384]; /* stdout and stderr */
} outcome;

static outcome run_shell(const char *format, ...) {
    outcome result = {.code = -1};
    char command[4096];
    va_list args;
    va_start(args, format);
    vsnprintf(command, sizeof command - 8, format, args);
    va_end(args);
    strcat(command, " 2>&1");
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    size_t length = fread(result.text, 1, sizeof result.text - 1, pipe);
    result.text[length] = '\0';
    while (fgetc(pipe) != EOF) /* lets the program finish */
        ;
    int status = pclose(pipe);
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    return result;
}

static outcome run_post(const place *p, const char *arguments) {
    const char *programs = getenv("SF_BIN_DIR");
    if (!programs)
        fail_msg("SF_BIN_DIR is not set: it names the directory of softfall-post");
    return run_shell("'%s/softfall-post' '%s' -o '%s' %s", programs, p->results, p->output, arguments);
}

static void assert_says(const outcome *result, const char *text) {
    if (!strstr(result->text, text))
        fail_msg("\"%s\" is missing in: %s", text, result->text);
}

static int set_up(void **state) {
    place *p = calloc(1, sizeof *p);
    assert_non_null(p);
    *state = p;
    program_set_up(&p->made);
    snprintf(p->results, sizeof p->results, "%s/results.h5", p->made.folder);
    snprintf(p->output, sizeof p->output, "%s/out", p->made.folder);
    return 0;
}

static int tear_down(void **state) {
    place *p = *state;
    program_tear_down(&p->made);
    free(p);
    return 0;
}

static void write_fixture(const place *p, fixture_options options) {
    sf_error err = SF_ERROR_INIT;
    if (fixture_write(p->results, &options, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* A value of summary.json as Python prints it; strict: NaN and Infinity are refused. */
static outcome summary_value(const place *p, const char *expression) {
    return run_shell("python3 -c \"import json\n"
                     "def refuse(text): raise SystemExit('not JSON: ' + text)\n"
                     "s = json.load(open('%s/summary.json'), parse_constant=refuse)\n"
                     "print(%s)\"",
                     p->output, expression);
}

static double summary_number(const place *p, const char *key) {
    char path[800];
    snprintf(path, sizeof path, "%s/summary.json", p->output);
    program_bytes text = program_read_file(path);
    double value = program_json_number(text.data, NULL, key);
    free(text.data);
    return value;
}

static bool output_exists(const place *p, const char *name) {
    char path[800];
    snprintf(path, sizeof path, "%s/%s", p->output, name);
    return access(path, F_OK) == 0;
}

static void half_sine_drop_gives_closed_form_figures(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    outcome result = run_post(p, "");
    assert_int_equal(result.code, 0);
    assert_says(&result, "indicative, not a certification");
    assert_says(&result, "summary.json");
    const char *files[] = {"summary.json", "history.csv", "section.csv", "pad.xdmf", "acceleration.csv"};
    for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
        assert_true(output_exists(p, files[k]));
    assert_relative(summary_number(p, "hic"), 1658.58, 1e-5);
    assert_relative(summary_number(p, "hic_raw"), 1658.58, 1e-5);
    assert_relative(summary_number(p, "hic15"), 1295.868, 1e-5);
    assert_relative(summary_number(p, "a_max_g"), 100, 1e-5);
    assert_relative(summary_number(p, "hic_t2_ms") - summary_number(p, "hic_t1_ms"), 0.6702296636 * 40, 1e-4);
    assert_relative(summary_number(p, "clip_3ms_g"), 100 * cos(M_PI * 1.5 / 40), 1e-4);
    double change = FIXTURE_PEAK_G * SF_STANDARD_GRAVITY * FIXTURE_DURATION * 2 / M_PI;
    assert_relative(summary_number(p, "v_rebound_m_s"), change - FIXTURE_SPEED, 1e-6);
    outcome free_again =
        run_shell(/* the first row without contact behind the last one with it */
                  "python3 -c \"import csv; r = [x for x in csv.DictReader(open('%s/history.csv'))]\n"
                  "k = max(i for i, x in enumerate(r) if float(x['contact_nodes_1']) > 0); print(r[k + 1]['time_ms'])\"",
                  p->output);
    assert_relative(summary_number(p, "rebound_time_ms"), atof(free_again.text), 1e-8);
    assert_close(summary_number(p, "v0_m_s"), FIXTURE_SPEED, 1e-9);
    assert_relative(summary_number(p, "absorbed_energy_per_volume_kJ_m3"),
                    1e-3 * summary_number(p, "absorbed_energy_J") /
                        (FIXTURE_CONTACT_AREA * 1e-3 * summary_number(p, "thickness_mm")),
                    1e-6);
    assert_relative(summary_number(p, "max_indentation_mm"), 30, 1e-6);
    assert_relative(summary_number(p, "max_local_strain"), 0.7, 1e-6);
    assert_relative(summary_number(p, "energy_error"), 0.002, 1e-6);
    assert_relative(summary_number(p, "stabilisation_energy_fraction"), 0.8 / 96.8, 1e-9);
    assert_relative(summary_number(p, "contact_energy_fraction"), 0.5 / 96.8, 1e-9);
    assert_close(summary_number(p, "nodes"), FIXTURE_NODES, 0);
    assert_close(summary_number(p, "steps"), 4199, 0);
    assert_close(summary_number(p, "threads"), 2, 0);
    assert_relative(summary_number(p, "wall_s"), 12.5, 1e-9);
}

static void history_csv_names_units_and_holds_every_row(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    assert_int_equal(run_post(p, "--filter 600").code, 0);
    outcome result = run_shell(
        "python3 -c \"import csv, math\n"
        "rows = list(csv.DictReader(open('%s/history.csv')))\n"
        "assert len(rows) == 4200, len(rows)\n"
        "for r in rows:\n"
        "    t = float(r['time_ms'])\n"
        "    a = 100 * math.sin(math.pi * t / 40) if t < 40 else 0\n"
        "    assert abs(float(r['acceleration_raw_g']) - a) < 1e-5, r\n"
        "    assert abs(float(r['acceleration_cfc600_g']) - a) < 1.5, r\n"
        "    assert abs(float(r['indentation_mm']) - 30 * math.sin(math.pi * min(t, 40) / 40)) < 1e-5, r\n\"",
        p->output);
    if (result.code != 0)
        fail_msg("%s", result.text);
}

/* The displacement of the fixture is linear in depth: so must be the profile under the axis. */
static void section_follows_the_plane_and_the_axis(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    assert_int_equal(run_post(p, "").code, 0);
    outcome result = run_shell(
        "python3 -c \"import csv\n"
        "rows = list(csv.DictReader(open('%s/section.csv')))\n"
        "plane = [r for r in rows if r['set'] == 'section']\n"
        "axis = [r for r in rows if r['set'] == 'axis']\n"
        "assert len(plane) == 9 and len(axis) == 41, (len(plane), len(axis))\n"
        "assert all(float(r['y_mm']) == 0 for r in plane)\n"
        "for r in plane:\n"
        "    assert abs(float(r['von_mises_kPa']) - 2 - int(r['node']) / 100) < 1e-9, r\n"
        "for k, r in enumerate(axis):\n"
        "    assert abs(float(r['depth_mm']) - 1.25 * k) < 1e-9, r\n"
        "    assert abs(float(r['displacement_z_mm']) + 10 * (50 - 1.25 * k) / 50) < 1e-9, r\n"
        "    assert abs(float(r['von_mises_kPa']) - 2.04 - 0.18 * (50 - 1.25 * k) / 50) < 1e-9, r\n\"",
        p->output);
    if (result.code != 0)
        fail_msg("%s", result.text);
}

/* The peak, where no frame was due, is a frame in its place; the missile's arrays are those of the history.
 */
static void xdmf_loads_in_all_three_paraview_readers(void **state) {
    place *p = *state;
    check_programs("pvpython");
    write_fixture(p, (fixture_options){.peak_time = 0.015, .sphere_radius = 0.2});
    for (int full = 0; full < 2; full++) {
        assert_int_equal(run_post(p, full ? "--force --full" : "").code, 0);
        outcome result = run_shell(
            "pvpython '%s/tests/check_xdmf.py' '%s/pad.xdmf' %d %d %d %d %s --times 0 0.01 0.015 0.02 0.03 "
            "--bounds 0 -0.1 0.15 -0.1 0.1 -0.05 0.08 --bounds 4 -0.1 0.15 -0.1 0.1 -0.05 0.065 "
            "--range von_mises_Pa 4 3000 3280 --range displacement_m 4 0 0 "
            "--range cauchy_stress_Pa 1 1000 1280 --range contact_pressure_Pa 2 2000 2280 --range 'cell material' 1 0 0 "
            "--range 'missile acceleration_g' 1 70.6681951667 70.6681951667 "
            "--range 'missile sphere_centre_m' 1 0 0 --range 'missile contact_force_N' 1 0 0",
            getenv("SF_SOURCE_DIR"), p->output, FIXTURE_FRAMES + 1, FIXTURE_NODES, FIXTURE_CELLS,
            FIXTURE_TRIANGLES, full ? "--full" : "");
        if (result.code != 0)
            fail_msg("%s", result.text);
        assert_says(&result, "XDMFReader");
        assert_says(&result, "Xdmf3ReaderS");
        assert_says(&result, "Xdmf3ReaderT");
        assert_says(&result, "missile speed_m_s");
    }
}

/* A frame of the very step of the peak is not shown twice, and a file without /peak has no such frame. */
static void peak_is_a_frame_once(void **state) {
    place *p = *state;
    for (int peak = 0; peak < 2; peak++) {
        write_fixture(p, (fixture_options){.no_peak = !peak});
        assert_int_equal(run_post(p, "--force").code, 0);
        outcome count = run_shell("grep -c 'Name=\"pad\" GridType=\"Uniform' '%s/pad.xdmf'", p->output);
        assert_int_equal(atoi(count.text), FIXTURE_FRAMES);
    }
}

static void reference_adds_fits_and_the_shift(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    char path[800];
    snprintf(path, sizeof path, "%s/measured.csv", p->made.folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("time_ms,acceleration_g\n", file);
    for (int i = 0; i <= 600; i++) {
        double x = (i * 0.1 - 10) / 40;
        fprintf(file, "%.1f,%.6f\n", i * 0.1, x > 0 && x < 1 ? 100 * sin(M_PI * x) : 0);
    }
    fclose(file);
    char arguments[1000];
    snprintf(arguments, sizeof arguments, "--reference '%s' --regions 10-20,20-30", path);
    outcome result = run_post(p, arguments);
    assert_int_equal(result.code, 0);
    assert_says(&result, "model time = measured time ");
    assert_true(output_exists(p, "reference.csv"));
    outcome shift =
        summary_value(p, "abs(s['reference']['shift_ms'] + 10) < 0.02, s['reference']['record']['grade']");
    assert_string_equal(shift.text, "True valid\n");
    outcome fits = summary_value(p, "min(f['r2'] for f in s['reference']['fits']) > 0.9999, "
                                    "max(f['rmse_g'] for f in s['reference']['fits']) < 0.1, "
                                    "[f['interval_ms'] for f in s['reference']['fits']]");
    assert_string_equal(fits.text, "True True [0.25, 0.5, 0.25, 0.5, 0.25, 0.5]\n");
    snprintf(arguments, sizeof arguments, "--force --reference '%s' --shift -12 --window 15,45", path);
    assert_int_equal(run_post(p, arguments).code, 0);
    fits = summary_value(p, "s['reference']['shift_ms'], s['reference']['fits'][0]['t1_ms'], "
                            "0.5 < s['reference']['fits'][0]['r2'] < 0.95, len(s['reference']['fits'])");
    assert_string_equal(fits.text, "-12 15 True 2\n");
    assert_int_equal(run_post(p, "--force").code,
                     0); /* the curve of the earlier comparison must not stay behind */
    assert_false(output_exists(p, "reference.csv"));
    result = run_post(p, "--force --regions 0-10");
    assert_int_equal(result.code, SF_ERR_INPUT);
    assert_says(&result, "need --reference");
}

/* A laboratory's file as it comes, and what it must not be taken for. */
static void measurements_are_read_filtered_and_not_cut(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    char path[800], arguments[1100];
    snprintf(path, sizeof path, "%s/lab.csv", p->made.folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(
        "\xEF\xBB\xBF# rig 4\r\nTime (ms),acceleration (m/s\xC2\xB2),Acc X (m/s\xC2\xB2),a (m/s\xC2\xB2)\r\n",
        file);
    for (int i = 0; i <= 1200; i++) { /* 20 kHz, with 30 g at 5 kHz */
        double t = i * 0.05, x = (t - 10) / 40, noise = 30 * sin(M_PI / 2 * i);
        double a = SF_STANDARD_GRAVITY * (noise + (x > 0 && x < 1 ? 100 * sin(M_PI * x) : 0));
        fprintf(file, "%d.%02d,%d,%d,%d\r\n", i / 20, i % 20 * 5, (int)round(a), (int)round(a),
                -(int)round(a));
    }
    fclose(file);
    snprintf(arguments, sizeof arguments, "--reference '%s'", path);
    outcome result = run_post(p, arguments);
    assert_int_equal(result.code, SF_ERR_INPUT);
    assert_says(&result, "two acceleration columns");
    assert_says(&result, "--reference-column");

    snprintf(arguments, sizeof arguments, "--reference '%s' --reference-column 'Acc X' --shift -10", path);
    result = run_post(p, arguments);
    assert_int_equal(result.code, 0);
    assert_says(&result, "lab.csv: time in ms, acceleration in m/s\xC2\xB2");
    assert_says(&result, "1201 samples at 20 kHz, 0 to 60 ms, filtered with CFC 1000");
    outcome values = summary_value(p, "abs(s['reference']['a_max_g'] - 100) < 1.2, s['reference']['cfc'], "
                                      "'20 kHz' in s['reference']['understood'], s['reference']['inverted'], "
                                      "s['reference']['fits'][0]['rmse_g'] < 1");
    assert_string_equal(values.text, "True 1000 True False True\n");

    snprintf(arguments, sizeof arguments,
             "--force --reference '%s' --reference-column 'Acc X' --shift -10 --reference-filter none", path);
    assert_int_equal(run_post(p, arguments).code, 0);
    values = summary_value(p, "s['reference']['a_max_g'] > 120, s['reference']['cfc'], "
                              "s['reference']['fits'][0]['rmse_g'] > 10");
    assert_string_equal(values.text, "True None True\n");

    snprintf(arguments, sizeof arguments, "--force --reference '%s' --reference-column 'a'", path);
    result = run_post(p, arguments);
    assert_int_equal(result.code, SF_ERR_INPUT);
    assert_says(&result, "the channel looks inverted");
    strcat(arguments, " --shift -10 --reference-invert");
    assert_int_equal(run_post(p, arguments).code, 0);

    const struct {
        const char *more, *expected;
    } bad[] = {
        {"--shift -10 --window 20,70",
         "the region 20 to 70 ms does not lie within the measured curve (0 to 60 ms)"},
        {"--shift -10 --regions 20-30,55-61", "does not lie within the measured curve"},
        {"--shift 30 --window 20,30", "lies outside the model's curve"},
        {"--shift -10 --reference-filter 500", "60, 180, 600 and 1000"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        snprintf(arguments, sizeof arguments, "--force --reference '%s' --reference-column 'Acc X' %s", path,
                 bad[k].more);
        result = run_post(p, arguments);
        assert_int_equal(result.code, SF_ERR_INPUT);
        assert_says(&result, bad[k].expected);
    }
}

/* A page or a picture that was made of earlier figures does not stay beside others. */
static void what_was_made_of_earlier_figures_goes(void **state) {
    static const char *const made[] = {"report.html", "acceleration.png", "acceleration.gp"};
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    assert_int_equal(run_post(p, "").code, 0);
    for (size_t k = 0; k < sizeof made / sizeof made[0]; k++) {
        assert_false(output_exists(p, made[k]));
        run_shell("echo 'of softfall' > '%s/%s'", p->output, made[k]);
    }
    assert_int_equal(run_post(p, "--force").code, 0);
    for (size_t k = 0; k < sizeof made / sizeof made[0]; k++)
        assert_false(output_exists(p, made[k]));
}

static void existing_output_is_replaced_only_by_force(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    assert_int_equal(run_shell("mkdir '%s' && touch '%s/notes.txt'", p->output, p->output).code, 0);
    assert_int_equal(run_post(p, "").code, 0); /* a directory with other files is fine */
    outcome result = run_post(p, "--filter 60");
    assert_int_equal(result.code, SF_ERR_INPUT);
    assert_says(&result, "--force");
    assert_close(summary_number(p, "cfc"), 1000, 0);
    assert_int_equal(run_post(p, "--filter 60 --force").code, 0);
    assert_close(summary_number(p, "cfc"), 60, 0);
    assert_true(output_exists(p, "notes.txt"));
}

static void failing_run_leaves_earlier_files_whole(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    assert_int_equal(run_post(p, "").code, 0);
    outcome before = run_shell("cd '%s' && ls -A && sha256sum *", p->output);
    write_fixture(p, (fixture_options){.bad_frame = true}); /* noticed when half of the output is written */
    outcome result = run_post(p, "--force");
    assert_int_equal(result.code, SF_ERR_IO);
    assert_says(&result, "/frames/000003/von_mises: value 7 is not finite");
    outcome after = run_shell("cd '%s' && ls -A && sha256sum *", p->output);
    assert_string_equal(before.text, after.text);
    assert_int_equal(run_shell("rm -r '%s'", p->output).code, 0);
    assert_int_equal(run_post(p, "").code, SF_ERR_IO);
    assert_int_not_equal(access(p->output, F_OK), 0); /* nor is an empty directory left */
}

static void killed_run_is_read_as_far_as_it_goes(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){.no_summary = true,
                                       .no_peak = true,
                                       .headless_frame = true,
                                       .lost_rows = 100,
                                       .end_time = 0.025});
    outcome result = run_post(p, "");
    assert_int_equal(result.code, 0);
    assert_says(&result, "no /summary");
    assert_says(&result, "first 2400 rows");
    assert_says(&result, "/frames/000003/time");
    assert_says(&result, "ended in contact");
    outcome values =
        summary_value(p, "s['status'], s['v_rebound_m_s'], s['wall_s'], s['threads'], s['frames'], "
                         "s['rebounded'], s['a_max_g'] > 99");
    assert_string_equal(values.text, "None None None None 3 False True\n");
    assert_true(output_exists(p, "section.csv"));
}

static void failed_run_is_cut_before_its_first_bad_row(void **state) {
    place *p = *state;
    write_fixture(
        p, (fixture_options){.status = "the domain of node 3 collapsed", .nan_row = 3000, .bad_frame = true});
    outcome result = run_post(p, "");
    assert_int_equal(result.code, 0);
    assert_says(&result, "the domain of node 3 collapsed");
    assert_says(&result, "row 3000 is not finite");
    assert_says(&result, "frames from 0.03 s on are left out");
    assert_close(summary_number(p, "end_time_ms"), 30, 0.02);
}

static void untouched_pad_gives_nulls_and_a_warning(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){.untouched = true, .status = "finished"});
    outcome result = run_post(p, "");
    assert_int_equal(result.code, 0);
    assert_says(&result, "never touched");
    outcome values = summary_value(p, "[s[k] for k in ('a_max_g', 'hic', 'hic_t1_ms', 'gadd', 'clip_3ms_g', "
                                      "'v_rebound_m_s', 'max_local_strain', 'contact_energy_fraction', "
                                      "'contact_time_ms')], s['touched']");
    assert_string_equal(values.text, "[None, None, None, None, None, None, None, None, None] False\n");
}

static void missing_stress_leaves_only_the_section_out(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){.no_stress = true});
    outcome result = run_post(p, "");
    assert_int_equal(result.code, 0);
    assert_says(&result, "no section.csv");
    assert_false(output_exists(p, "section.csv"));
    assert_true(output_exists(p, "pad.xdmf"));
}

static void bad_input_is_refused_with_its_cause(void **state) {
    place *p = *state;
    const struct {
        fixture_options options;
        const char *expected;
    } bad[] = {
        {{.format = "softfall-model"}, "is a softfall-model file"},
        {{.lost_rows = 5}, "/history/velocity has 4195 rows"},
        {{.nan_row = 17}, "/history/acceleration: row 17 is not finite"},
        {{.bad_cell = true}, "/model/cell_node: entry 72 is 29, outside 0 to 28"},
        {{.headless_frame = true}, "/frames/000003/time"},
    };
    outcome result = run_post(p, "");
    assert_int_equal(result.code, SF_ERR_IO);
    assert_says(&result, "results.h5 cannot be read: No such file");
    assert_int_equal(run_shell("echo text > '%s'", p->results).code, 0);
    result = run_post(p, "");
    assert_int_equal(result.code, SF_ERR_IO);
    assert_says(&result, "not an HDF5 file");
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        write_fixture(p, bad[k].options);
        result = run_post(p, "");
        assert_int_equal(result.code, SF_ERR_IO);
        assert_says(&result, bad[k].expected);
        assert_int_not_equal(access(p->output, F_OK), 0);
    }
}

/* Any prefix of a sound file is refused or read, but never crashes the program. */
static void truncated_files_end_with_a_message(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    outcome size = run_shell("stat -c %%s '%s'", p->results);
    long bytes = strtol(size.text, NULL, 10);
    assert_true(bytes > 100000);
    for (int k = 1; k < 10; k++) {
        write_fixture(p, (fixture_options){0});
        assert_int_equal(truncate(p->results, bytes * k / 10), 0);
        outcome result = run_post(p, "");
        assert_int_equal(result.code, SF_ERR_IO);
        assert_says(&result, "softfall-post: ");
    }
}

static void bad_command_lines_are_refused(void **state) {
    place *p = *state;
    write_fixture(p, (fixture_options){0});
    const struct {
        const char *arguments, *expected;
    } bad[] = {
        {"--filter 500", "60, 180, 600 and 1000"},
        {"--reference x.csv --window 5", "\"5\" is not a window"},
        {"--reference x.csv --regions 5-1", "not a list of regions"},
        {"--reference x.csv --shift soon", "expected a time in ms"},
        {"--reference /nonexistent/x.csv", "the reference /nonexistent/x.csv cannot be read"},
        {"second.h5", "one results file"},
        {"--unknown", "unrecognized option"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        outcome result = run_post(p, bad[k].arguments);
        assert_int_not_equal(result.code, 0);
        assert_says(&result, bad[k].expected);
        assert_int_not_equal(access(p->output, F_OK), 0);
    }
    outcome result = run_post(p, "--help");
    assert_int_equal(result.code, 0);
    assert_says(&result, "--regions");
    result = run_post(p, "--version");
    assert_int_equal(result.code, 0);
    assert_says(&result, "softfall-post ");
}

/* Where the file has planes, in them; else where a missile modelled in part ends with the pad; of a full
 * model in the middle of the missile: there need be no node at the pole. */
static void axis_lies_in_the_symmetry_planes(void **state) {
    (void)state;
    double surface[4][3] = {{0, 0, 0}, {0.08, 0, 0.08}, {0, 0.08, 0.08}, {0.05, 0.05, 0.05}},
           pad[2][3] = {{0, 0, -0.05}, {0.2, 0.2, 0}}, axis[2];
    sf_results results = {.surface_node_count = 4,
                          .surface_position = surface[0],
                          .node_count = 2,
                          .position = pad[0],
                          .thickness = 0.05,
                          .symmetry_factor = 4,
                          .symmetry_place = {0.01, 0.02},
                          .missile_direction = {0, 0, -1}};
    sf_axis_find(&results, axis);
    assert_close(axis[0], 0.01, 1e-15);
    assert_close(axis[1], 0.02, 1e-15);
    results.symmetry_place[0] = results.symmetry_place[1] = NAN;
    sf_axis_find(&results, axis);
    assert_close(axis[0], 0, 1e-15);
    assert_close(axis[1], 0, 1e-15);
    results.symmetry_factor = 1;
    sf_axis_find(&results, axis);
    assert_close(axis[0], 0.04, 1e-15);
}

int main(void) {
#define IN_PLACE(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        IN_PLACE(half_sine_drop_gives_closed_form_figures),
        IN_PLACE(history_csv_names_units_and_holds_every_row),
        IN_PLACE(section_follows_the_plane_and_the_axis),
        IN_PLACE(xdmf_loads_in_all_three_paraview_readers),
        IN_PLACE(peak_is_a_frame_once),
        IN_PLACE(reference_adds_fits_and_the_shift),
        IN_PLACE(measurements_are_read_filtered_and_not_cut),
        IN_PLACE(what_was_made_of_earlier_figures_goes),
        IN_PLACE(existing_output_is_replaced_only_by_force),
        IN_PLACE(failing_run_leaves_earlier_files_whole),
        IN_PLACE(killed_run_is_read_as_far_as_it_goes),
        IN_PLACE(failed_run_is_cut_before_its_first_bad_row),
        IN_PLACE(untouched_pad_gives_nulls_and_a_warning),
        IN_PLACE(missing_stress_leaves_only_the_section_out),
        IN_PLACE(bad_input_is_refused_with_its_cause),
        IN_PLACE(truncated_files_end_with_a_message),
        IN_PLACE(bad_command_lines_are_refused),
        cmocka_unit_test(axis_lies_in_the_symmetry_planes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
