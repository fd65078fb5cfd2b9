/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The three programs in a row on the example case with a coarse pad, judged by the files that they leave. */
#include "check.h"
#include "extreme.h"
#include "io/h5_data.h"
#include "model_fixture.h"
#include "program_fixture.h"

#include "model/good_run.h"
#include "model/model_io.h"
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

#include "post_check.h"

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";
static const double MASS = 4.6, SPEED = 4.5, GRAVITY = 9.80665; /* of the example */

/* model.h5, results.h5 and out/ of one run, made once for all tests. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    program_succeed(p, "pre", "'%s' -o model.h5 %s --set output.frame_interval='\"4 ms\"'",
                    fixture_source(EXAMPLE), program_coarse(10));
    program_succeed(p, "solve", "model.h5 -o results.h5 --threads 1");
    program_succeed(p, "post", "results.h5 -o out");
    return 0;
}

static double *read_column(const sf_h5 *file, const char *path, int64_t *rows) {
    sf_error err = SF_ERROR_INIT;
    void *data = NULL;
    *rows = -1;
    if (sf_h5_read(file, path, SF_H5_F64, 1, rows, &data, &err) != SF_OK)
        fail_msg("%s", err.text);
    return data;
}

static char *read_text(const sf_h5 *file, const char *path) {
    sf_error err = SF_ERROR_INIT;
    char *text = NULL;
    if (sf_h5_read_text(file, path, &text, &err) != SF_OK)
        fail_msg("%s", err.text);
    return text;
}

/* Columns of /history. */
typedef struct history {
    int64_t rows;
    double *time, *step, *a, *v, *contact, *base, *kinetic, *kinetic_pad, *stored, *hysteresis, *viscous,
        *stabilisation, *lost, *friction, *external, *energy_error, *momentum_error, *residual;
} history;

static const struct {
    const char *path;
    size_t offset;
} columns[] = {
    {"/history/time", offsetof(history, time)},
    {"/history/time_step", offsetof(history, step)},
    {"/history/acceleration", offsetof(history, a)},
    {"/history/velocity", offsetof(history, v)},
    {"/history/contact_force", offsetof(history, contact)},
    {"/history/base_reaction", offsetof(history, base)},
    {"/history/energy_kinetic_missile", offsetof(history, kinetic)},
    {"/history/energy_kinetic_pad", offsetof(history, kinetic_pad)},
    {"/history/energy_stored", offsetof(history, stored)},
    {"/history/energy_hysteresis", offsetof(history, hysteresis)},
    {"/history/energy_viscous", offsetof(history, viscous)},
    {"/history/energy_stabilisation", offsetof(history, stabilisation)},
    {"/history/energy_contact", offsetof(history, lost)},
    {"/history/energy_friction", offsetof(history, friction)},
    {"/history/energy_external", offsetof(history, external)},
    {"/history/energy_error", offsetof(history, energy_error)},
    {"/history/momentum_error", offsetof(history, momentum_error)},
    {"/history/constraint_residual", offsetof(history, residual)},
};

static history read_history(const program_place *p, const char *name) {
    history h = {0};
    sf_h5 *file = program_open_h5(p, name);
    sf_error err = SF_ERROR_INIT;
    for (size_t k = 0; k < sizeof columns / sizeof columns[0]; k++) {
        int64_t rows;
        *(double **)((char *)&h + columns[k].offset) = read_column(file, columns[k].path, &rows);
        if (k == 0)
            h.rows = rows;
        assert_int_equal(rows, h.rows);
    }
    sf_h5_close(&file, &err);
    return h;
}

static void history_free(history *h) {
    for (size_t k = 0; k < sizeof columns / sizeof columns[0]; k++)
        free(*(double **)((char *)h + columns[k].offset));
}

static void every_output_is_there_and_nothing_is_left_over(void **state) {
    const program_place *p = *state;
    program_result list = program_shell(p, "ls -1 . out");
    static const char *const names[] = {"model.h5",    "results.h5",       "summary.json", "history.csv",
                                        "section.csv", "acceleration.csv", "pad.xdmf",     "pad-"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
        if (!strstr(list.out, names[k]))
            fail_msg("%s is missing", names[k]);
    assert_null(strstr(list.out, "partial"));
    assert_null(strstr(list.out, "tmp"));
}

/* The ledger's own error, and the sum of its columns, over every row. */
static void energies_balance_in_every_row(void **state) {
    history h = read_history(*state, "results.h5");
    double initial = 0.5 * MASS * SPEED * SPEED;
    assert_true(h.rows > 500);
    for (int64_t k = 0; k < h.rows; k++) {
        double total = h.kinetic[k] + h.kinetic_pad[k] + h.stored[k] + h.hysteresis[k] + h.viscous[k] +
                       h.stabilisation[k] + h.lost[k] + h.friction[k];
        assert_close((total - h.external[k]) / initial - 1, h.energy_error[k], 1e-12);
        assert_close(h.energy_error[k], 0, 2e-4);
        assert_close(h.residual[k] / SPEED, 0, 1e-10);
    }
    history_free(&h);
}

/* dv = (g - a) dt by the trapezoidal rule is the leap-frog itself; so the columns must agree to rounding. */
static void impulses_balance_momenta(void **state) {
    history h = read_history(*state, "results.h5");
    double contact = 0, base = 0, end = h.time[h.rows - 1], initial = MASS * SPEED;
    for (int64_t k = 0; k + 1 < h.rows; k++) {
        assert_close(h.time[k + 1] - h.time[k], h.step[k], 1e-15);
        contact += 0.5 * h.step[k] * (h.contact[k] + h.contact[k + 1]);
        base += 0.5 * h.step[k] * (h.base[k] + h.base[k + 1]);
        assert_close(h.v[k + 1] - h.v[k], h.step[k] * (GRAVITY - 0.5 * (h.a[k] + h.a[k + 1])), 1e-12 * SPEED);
        assert_close(h.a[k], h.contact[k] / MASS, 1e-9 * GRAVITY);
        assert_close(h.momentum_error[k], 0, 1e-6);
    }
    double change = MASS * (h.v[0] - h.v[h.rows - 1]) + MASS * GRAVITY * end;
    assert_close(contact / initial, change / initial, 1e-10);
    /* The base takes what the pad does not keep: at most the momentum of its kinetic energy. */
    double pad = sqrt(2 * 35 * 0.4 * 0.4 * 0.05 * h.kinetic_pad[h.rows - 1]);
    assert_close(base, contact, pad + 1e-6 * initial);
    assert_true(base > 0.5 * initial);
    history_free(&h);
}

static void history_is_recorded_at_50_kHz_or_more(void **state) {
    history h = read_history(*state, "results.h5");
    for (int64_t k = 0; k + 1 < h.rows; k++)
        assert_true(h.step[k] > 0 && h.step[k] <= 50e-6);
    assert_true(h.v[h.rows - 1] < 0); /* it rebounds */
    history_free(&h);
}

static void raw_and_filtered_peaks_agree(void **state) {
    history h = read_history(*state, "results.h5");
    double peak = 0, filtered = program_file_number(*state, "out/summary.json", "a_max_g");
    for (int64_t k = 0; k < h.rows; k++)
        peak = larger(peak, h.a[k] / GRAVITY);
    assert_relative(program_file_number(*state, "out/summary.json", "a_max_raw_g"), peak, 1e-6);
    assert_relative(filtered, peak, 0.03);
    assert_true(filtered > 50 && program_file_number(*state, "out/summary.json", "hic") > 100);
    history_free(&h);
}

/* The estimate of softfall-pre knows the rate terms of the foam, which shorten the steps. */
static void estimate_of_the_steps_knows_the_rate_terms(void **state) {
    const char *const foam[] = {"material.ED='\"0 Pa\"'", "material.ED='\"40 MPa\"'",
                                "material.eta='\"200 Pa s\"'"};
    for (int k = 0; k < 3; k++) {
        double expected = 0;
        program_result pre = program_succeed(*state, "pre", "'%s' -o cost.h5 --force %s --set %s",
                                             fixture_source(EXAMPLE), program_coarse(25), foam[k]);
        const char *line = strstr(pre.out, "for about ");
        assert_true(line && sscanf(line, "for about %lf steps", &expected) == 1);
        program_result solve = program_succeed(*state, "solve", "cost.h5 -o cost_results.h5 --force -t 1");
        double steps = 0, milliseconds = 0;
        line = strstr(solve.out, "ended: rebound at ");
        assert_true(line &&
                    sscanf(line, "ended: rebound at %lf ms after %lf steps", &milliseconds, &steps) == 2);
        if (!(expected < 2.5 * steps && steps < 2.5 * expected))
            fail_msg("%s: %g steps, expected about %g", foam[k], steps, expected);
    }
}

static void no_local_collapse(void **state) {
    double mean = program_file_number(*state, "out/summary.json", "max_mean_strain"),
           local = program_file_number(*state, "out/summary.json", "max_local_strain");
    assert_true(mean > 0.5 && mean < 0.9);
    assert_close(local - mean, program_file_number(*state, "out/summary.json", "local_strain_excess"), 1e-6);
    assert_true(local - mean < 0.12);
    assert_true(program_file_number(*state, "out/summary.json", "stabilisation_energy_fraction") <
                sf_good_run_limits()->stabilisation);
    assert_true(fabs(program_file_number(*state, "out/summary.json", "contact_energy_fraction")) <
                sf_good_run_limits()->contact);
}

static void files_say_where_they_come_from(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_h5 *model = program_open_h5(p, "model.h5"), *results = program_open_h5(p, "results.h5");
    char *parameters = read_text(model, "/provenance/parameters"),
         *text = read_text(model, "/provenance/case_text");
    char *copied = read_text(results, "/provenance/model/parameters"),
         *status = read_text(results, "/summary/status");
    char *command = read_text(results, "/provenance/command_line");
    assert_non_null(strstr(parameters, "given"));
    assert_non_null(strstr(parameters, "default"));
    assert_non_null(strstr(parameters, "missile.velocity"));
    assert_non_null(strstr(text, "fine_spacing=10.0")); /* the --set is part of the resolved case */
    assert_string_equal(copied, parameters);
    assert_string_equal(status, "rebound");
    assert_non_null(strstr(command, "--threads 1"));
    free(parameters);
    free(text);
    free(copied);
    free(status);
    free(command);
    sf_h5_close(&model, &err);
    sf_h5_close(&results, &err);
}

/* Nothing is written and the old file stays; with --force it is replaced by the same results, whatever the
 * threads. */
static void existing_output_is_replaced_only_with_force(void **state) {
    const program_place *p = *state;
    program_bytes model = program_read_file(program_path(p, "model.h5"));
    program_bytes results = program_read_file(program_path(p, "results.h5"));
    program_bytes summary = program_read_file(program_path(p, "out/summary.json"));
    const program_result refused[] = {
        program_run(p, "pre", "'%s' -o model.h5", fixture_source(EXAMPLE)),
        program_run(p, "solve", "model.h5 -o results.h5"),
        program_run(p, "post", "results.h5 -o out"),
    };
    for (size_t k = 0; k < 3; k++) {
        assert_true(refused[k].code != 0);
        assert_non_null(strstr(refused[k].err, "--force"));
    }
    program_assert_unchanged(program_path(p, "model.h5"), &model);
    program_assert_unchanged(program_path(p, "results.h5"), &results);
    program_assert_unchanged(program_path(p, "out/summary.json"), &summary);

    history before = read_history(p, "results.h5");
    program_succeed(p, "solve", "model.h5 -o results.h5 --threads 2 --force");
    history after = read_history(p, "results.h5");
    assert_int_equal(before.rows, after.rows);
    assert_memory_equal(before.a, after.a, (size_t)before.rows * sizeof *before.a);
    assert_memory_equal(before.base, after.base, (size_t)before.rows * sizeof *before.base);
    history_free(&before);
    history_free(&after);
    program_succeed(p, "post", "results.h5 -o out --force");
}

static void set_overrides_a_key_of_the_case(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_model model;
    program_succeed(p, "pre",
                    "'%s' -o slow.h5 %s --set missile.velocity='3.5 m/s' --set kernel.stabilisation=0.2 "
                    "--set output.fields='[\"displacement\"]'",
                    fixture_source(EXAMPLE), program_coarse(25));
    assert_int_equal(sf_model_read(program_path(p, "slow.h5"), &model, NULL, &err), SF_OK);
    assert_close(model.missile.speed, 3.5, 1e-15);
    assert_close(model.run.stabilisation, 0.2, 1e-15);
    assert_int_equal(model.run.output_fields, SF_FIELD_DISPLACEMENT);
    assert_close(model.missile.mass, MASS, 1e-15);
    sf_model_free(&model);
}

/* Last value of a column. */
static double column_end(const program_place *p, const char *name, const char *path) {
    sf_error err = SF_ERROR_INIT;
    int64_t rows;
    sf_h5 *file = program_open_h5(p, name);
    double *column = read_column(file, path, &rows), value = column[rows - 1];
    free(column);
    sf_h5_close(&file, &err);
    return value;
}

/* The example of a compression test, coarse: it goes on after the release, and is not judged as a drop. */
static void compression_test_runs_to_its_end_and_is_no_drop(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    program_result pre = program_succeed(
        p, "pre",
        "'%s' -o press.h5 --set geometry.parameters.spacing=10 --set output.frame_interval='40 ms' --set material.rate_factor=0",
        fixture_source("examples/compression/case.cfg"));
    assert_non_null(strstr(pre.out, "prescribed motion of 3 points to 160 ms, to 40 mm, at most 0.5 m/s"));
    program_result solve = program_succeed(p, "solve", "press.h5 -o pressed.h5 --threads 1");
    assert_non_null(strstr(solve.out, "the motion's work"));
    assert_null(strstr(solve.err, "warning"));
    sf_h5 *file = program_open_h5(p, "pressed.h5");
    char *status = read_text(file, "/summary/status");
    assert_string_equal(status, "finished");
    free(status);
    sf_h5_close(&file, &err);
    assert_true(column_end(p, "pressed.h5", "/history/contact_nodes") == 0);
    assert_close(column_end(p, "pressed.h5", "/history/displacement"), 0, 2e-5); /* a step */
    assert_close(column_end(p, "pressed.h5", "/history/velocity"), -0.5, 1e-12);
    history h = read_history(p, "pressed.h5");
    for (int64_t k = 0; k < h.rows; k++) {
        double total = h.kinetic_pad[k] + h.stored[k] + h.hysteresis[k] + h.viscous[k] + h.stabilisation[k] +
                       h.lost[k] + h.friction[k];
        assert_true(h.kinetic[k] == 0 && h.a[k] == 0);
        assert_close(h.energy_error[k], 0, 1e-3);
        assert_close(total, h.external[k], 1e-3 * fmax(1, h.external[k])); /* J */
    }
    history_free(&h);

    program_result post = program_succeed(p, "post", "pressed.h5 -o pressed");
    assert_string_equal(post.err, "");
    assert_non_null(strstr(post.out, "Prescribed motion"));
    assert_null(strstr(post.out, "HIC"));
    assert_null(strstr(post.out, "a_max"));
    program_bytes summary = program_read_file(program_path(p, "pressed/summary.json"));
    static const char *const parts[] = {"\"a_max_g\": null",
                                        "\"hic\": null",
                                        "\"v0_m_s\": null",
                                        "\"missile_mass_kg\": null",
                                        "\"prescribed_motion\": true",
                                        "\"section_mm2\": 2500"};
    for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++)
        if (!strstr(summary.data, parts[k]))
            fail_msg("summary.json lacks %s", parts[k]);
    free(summary.data);
    program_result list = program_shell(p, "ls -1 pressed");
    assert_non_null(strstr(list.out, "compression.csv"));
    assert_null(strstr(list.out, "acceleration"));
    /* The largest stress of the table, from the file. */
    program_result peak = program_shell(p, "sort -t, -g -k3 pressed/compression.csv | tail -1");
    double time, strain, stress, force;
    assert_int_equal(sscanf(peak.out, "%lf,%lf,%lf,%lf", &time, &strain, &stress, &force), 4);
    assert_close(time, 80, 0.1);
    assert_close(strain, 0.8, 1e-3);
    assert_close(force / stress, 2.5, 1e-6); /* N over kPa on 2500 mm2 */
    program_result curve =
        program_shell(p,
                      "awk -F, '!/^[#s]/ { if ($1 > 0.8) { print b + (0.8 - a) * ($2 - b) / "
                      "($1 - a); exit } a = $1; b = $2 }' '%s'",
                      fixture_source("examples/materials/eva35.csv"));
    assert_close(stress / strtod(curve.out, NULL), 1, 0.03); /* of the table, but for the Maxwell branch */

    program_shell(p, "printf 'time_ms,acceleration_g\\n0,0\\n1,1\\n' > measured.csv");
    program_result compared = program_run(p, "post", "pressed.h5 -o none --reference measured.csv");
    assert_true(compared.code != 0);
    assert_non_null(strstr(compared.err, "the missile's motion was prescribed"));
    program_result deep = program_run(p, "pre", "'%s' -o deep.h5 --set geometry.parameters.side=40",
                                      fixture_source("examples/compression/case.cfg"));
    assert_true(deep.code != 0);
    assert_non_null(strstr(deep.err, "40 mm deep into a pad that is 40 mm thick"));
}

static void sleep_ms(long ms) {
    nanosleep(&(struct timespec){ms / 1000, ms % 1000 * 1000000}, NULL);
}

/* Starts softfall-solve, waits until it reports its first step, sends the signal; its wait status. */
static int interrupt(const program_place *p, int number) {
    char program[1024];
    snprintf(program, sizeof program, "%s/softfall-solve", getenv("SF_BIN_DIR"));
    program_write_file(program_path(p, "interrupted.log"), "", 0); /* none of an earlier run */
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (chdir(p->folder) != 0 || !freopen("interrupted.log", "w", stdout) ||
            !freopen("interrupted.err", "w", stderr))
            _exit(99);
        execl(program, program, "long.h5", "-o", "interrupted.h5", "--threads", "1", "--force", (char *)NULL);
        _exit(99);
    }
    int status = 0;
    bool started = false;
    for (int wait = 0; wait < 600 && !started && waitpid(child, &status, WNOHANG) == 0; wait++) {
        sleep_ms(50);
        program_bytes log = program_read_file(program_path(p, "interrupted.log"));
        started = strstr(log.data, "step") != NULL; /* the first progress line */
        free(log.data);
    }
    assert_true(started);
    sleep_ms(200);
    kill(child, number);
    assert_int_equal(waitpid(child, &status, 0), child);
    return status;
}

/* Ctrl-C: the run ends after the step, the file is whole and goes through post-processing.
 */
static void interrupted_run_leaves_readable_results(void **state) {
    const program_place *p = *state;
    program_succeed(p, "pre", "'%s' -o long.h5 %s --set solver.step_safety=0.01 --force",
                    fixture_source(EXAMPLE), program_coarse(25));
    int status = interrupt(p, SIGINT);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 130);
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = program_open_h5(p, "interrupted.h5");
    char *text = read_text(file, "/summary/status");
    assert_string_equal(text, "interrupted");
    free(text);
    assert_true(sf_h5_group_size(file, "/frames") >= 2); /* the start, and where it was stopped */
    assert_true(sf_h5_exists(file, "/peak/von_mises"));
    sf_h5_close(&file, &err);
    history h = read_history(p, "interrupted.h5");
    assert_true(h.rows >= 2);
    assert_true(h.time[h.rows - 1] > 0 && h.time[h.rows - 1] < 0.02);
    history_free(&h);
    program_succeed(p, "post", "interrupted.h5 -o interrupted");
}

static void help_and_version_are_there(void **state) {
    const program_place *p = *state;
    static const char *const names[] = {"pre", "solve", "post"};
    for (int k = 0; k < 3; k++) {
        program_result help = program_succeed(p, names[k], "--help"),
                       version = program_succeed(p, names[k], "--version");
        assert_non_null(strstr(help.out, "--output"));
        assert_non_null(strstr(help.out, "--force"));
        assert_non_null(strstr(version.out, "softfall-"));
        assert_string_equal(help.err, "");
    }
}

/* All three XDMF readers load every step and array; the pad's counts are those of the model. */
static void paraview_reads_every_frame(void **state) {
    const program_place *p = *state;
    check_programs("pvpython");
    sf_error err = SF_ERROR_INIT;
    sf_model model;
    assert_int_equal(sf_model_read(program_path(p, "model.h5"), &model, NULL, &err), SF_OK);
    sf_h5 *file = program_open_h5(p, "results.h5");
    program_result result = program_shell(
        p, "pvpython '%s' out/pad.xdmf %lld %lld %lld %lld", fixture_source("tests/check_xdmf.py"),
        (long long)sf_h5_group_size(file, "/frames") + 1, (long long)model.node_count,
        (long long)model.cell_count, (long long)model.surface_triangle_count);
    sf_h5_close(&file, &err);
    sf_model_free(&model);
    if (result.code != 0)
        fail_msg("%s %s", result.out, result.err);
    assert_non_null(strstr(result.out, "cauchy_stress_Pa"));
    assert_non_null(strstr(result.out, "contact_pressure_Pa"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_output_is_there_and_nothing_is_left_over),
        cmocka_unit_test(energies_balance_in_every_row),
        cmocka_unit_test(impulses_balance_momenta),
        cmocka_unit_test(history_is_recorded_at_50_kHz_or_more),
        cmocka_unit_test(raw_and_filtered_peaks_agree),
        cmocka_unit_test(no_local_collapse),
        cmocka_unit_test(files_say_where_they_come_from),
        cmocka_unit_test(existing_output_is_replaced_only_with_force),
        cmocka_unit_test(set_overrides_a_key_of_the_case),
        cmocka_unit_test(interrupted_run_leaves_readable_results),
        cmocka_unit_test(help_and_version_are_there),
        cmocka_unit_test(paraview_reads_every_frame),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(compression_test_runs_to_its_end_and_is_no_drop),
        cmocka_unit_test(estimate_of_the_steps_knows_the_rate_terms),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
