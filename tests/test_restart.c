/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interrupted, killed, failed and prolonged runs of softfall-solve: the file always opens, nothing is lost,
 * and the bits are those of one run. Under SF_SLOW=1 one run is killed sixty times. */
#include "check.h"
#include "io/h5_data.h"
#include "solver/contact/shape.h"
#include "model_fixture.h"
#include "program_fixture.h"
#include "run_fixture.h"

#include "io/replace.h"
#include "model/model_io.h"
#include "post/results/results.h"
#include <hdf5.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";

static int kill_count(void) {
    return check_slow() ? 60 : 6;
}

/* s of the processor, in this build: of a run before its first steps, and of the rest of a run without
 * interruption. */
static double start_time, run_time;

/* Processor time of the children that have ended. */
static double time_of_children(void) {
    struct rusage used;
    assert_int_equal(getrusage(RUSAGE_CHILDREN, &used), 0);
    return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
           1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

/* Processor time of a child that runs: no wall time, so that other work on the machine does not matter. */
static double time_of(pid_t child) {
    clockid_t clock;
    struct timespec used = {0};
    if (clock_getcpuclockid(child, &clock) == 0)
        clock_gettime(clock, &used);
    return (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
}

/* model.h5 and what one run makes of it, full.h5; steps are small, so that there is time to kill. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    program_succeed(
        p, "pre",
        "'%s' -o model.h5 %s --set output.frame_interval='\"1 ms\"' --set solver.step_safety=%.3f "
        "--set solver.end_time='\"20 ms\"'",
        fixture_source(EXAMPLE), program_coarse(20), 2.0 / kill_count());
    double start = time_of_children();
    program_succeed(p, "solve", "model.h5 -o start.h5 --threads 1 --no-checkpoint --end-time '0.05 ms'");
    start_time = time_of_children() - start;
    program_succeed(p, "solve", "model.h5 -o full.h5 --threads 1");
    run_time = time_of_children() - start - 2 * start_time;
    return 0;
}

/* ---- one run in parts ---- */

static void finished_run_goes_on_to_a_later_end(void **state) {
    const program_place *p = *state;
    uint64_t seed = 1;
    double end = 0;
    int parts = 0;
    program_succeed(p, "solve", "model.h5 -o parts.h5 --end-time '0.01 ms' --threads 1");
    for (end = 1 + fixture_random(&seed); end < 20; end += 2 * (1.2 + fixture_random(&seed))) {
        program_succeed(p, "solve", "--restart parts.h5 --end-time '%.17g ms' --threads %d", end,
                        1 + parts % 2);
        assert_false(run_is_there(p, "parts.h5.run"));
        parts++;
    }
    program_succeed(p, "solve", "--restart parts.h5 --end-time '20 ms' --threads 2");
    assert_true(parts >= 5);
    assert_int_equal(run_restarts(p, "parts.h5"), parts + 1);
    run_assert_same(p, "full.h5", "parts.h5");
    program_succeed(p, "solve",
                    "--restart parts.h5 --threads 1"); /* nothing is left to do, nothing changes */
    run_assert_same(p, "full.h5", "parts.h5");
}

/* The same of the hyperfoam with all that its points remember. */
static void hyperfoam_goes_on_with_the_same_bits(void **state) {
    const program_place *p = *state;
    program_succeed(p, "pre",
                    "'%s' -o hyper.h5 %s --set material=@'%s' --set material.ED='\"1 MPa\"' --set "
                    "material.BETA1='\"4000 1/s\"' --set material.rate_factor=0.2 --set "
                    "material.rate_reference='\"0.01 1/s\"' --set material.ALPHA=0.6 --set "
                    "solver.end_time='\"6 ms\"'",
                    fixture_source(EXAMPLE), program_coarse(20),
                    fixture_source("examples/materials/vn600_slow.cfg"));
    program_succeed(p, "solve", "hyper.h5 -o hyper_full.h5 --threads 1");
    program_succeed(p, "solve", "hyper.h5 -o hyper_parts.h5 --end-time '2.3 ms' --threads 2");
    program_succeed(p, "solve", "--restart hyper_parts.h5 --end-time '6 ms' --threads 2");
    run_assert_same(p, "hyper_full.h5", "hyper_parts.h5");
}

/* And of the low-density foam with a rate factor: the filtered rate is part of a checkpoint. */
static void rate_factor_goes_on_with_the_same_bits(void **state) {
    const program_place *p = *state;
    program_succeed(p, "pre",
                    "'%s' -o rate.h5 %s --set 'material.ED=0 Pa' --set material.rate_factor=0.2 --set "
                    "material.rate_reference='\"1 1/s\"' --set solver.end_time='\"6 ms\"'",
                    fixture_source(EXAMPLE), program_coarse(20));
    program_succeed(p, "solve", "rate.h5 -o rate_full.h5 --threads 1");
    program_succeed(p, "solve", "rate.h5 -o rate_parts.h5 --end-time '2.3 ms' --threads 2");
    program_succeed(p, "solve", "--restart rate_parts.h5 --end-time '6 ms' --threads 2");
    run_assert_same(p, "rate_full.h5", "rate_parts.h5");
}

/* Runs to the end with a signal after a random time, again and again, at least `least` times; `after_steps`:
 * not before it has a checkpoint of its own steps. The file opens after each; post-processing reads it. A run
 * that comes to its end earlier, as run_time was measured on a slower machine, begins anew with shorter
 * waits. */
static void run_with_signals(const program_place *p, const char *results, const int *numbers, int count,
                             int least, bool after_steps) {
    char checkpoint[64];
    uint64_t seed = 7;
    double pace = 1; /* of the waits, to those by the times that were measured */
    int killed = 0, opened = 0;
    snprintf(checkpoint, sizeof checkpoint, "%s.restart", results);
    for (int turn = 0; turn < 100 * least; turn++) {
        const char *anew[] = {"model.h5", "-o", results, "--force", "--checkpoint-every", "0.02 s", NULL};
        const char *again[] = {"--restart", results, "--checkpoint-every", "0.02 s", NULL};
        struct timespec before = run_written_at(p->folder, checkpoint);
        pid_t child = run_start(p, before.tv_sec ? again : anew);
        int status = 0, number = numbers[turn % count];
        double part = 0.4 * run_time / least * (1 + fixture_random(&seed)),
               wait = killed < least ? pace * (start_time + part) : 1e3 * run_time;
        while ((time_of(child) < wait ||
                (after_steps && !run_is_other(before, run_written_at(p->folder, checkpoint)))) &&
               waitpid(child, &status, WNOHANG) == 0)
            run_sleep(0.002);
        if (kill(child, number) == 0 && waitpid(child, &status, 0) == child)
            killed += !WIFEXITED(status) || WEXITSTATUS(status) != 0;
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
            if (killed >= least)
                break;
            pace /= 2;
            killed = opened = 0;
            assert_true(pace > 0.05);
            assert_int_equal(remove(program_path(p, checkpoint)) + remove(program_path(p, results)), 0);
            continue;
        }
        if (WIFSIGNALED(status) ? WTERMSIG(status) != number : WEXITSTATUS(status) != SF_INTERRUPTED)
            fail_msg("wait status %d after %d signals: %s", status, killed,
                     program_shell(p, "cat errors").out);
        if (run_is_there(p, results)) {
            sf_error err = SF_ERROR_INIT;
            sf_results r;
            sf_status code = sf_results_open(program_path(p, results), &r, &err);
            if (code != SF_OK && !strstr(err.text, "usable rows"))
                fail_msg("after %d signals: %s", killed, err.text);
            opened += code == SF_OK;
            sf_results_close(&r);
        }
    }
    print_message("%d signals, %d times the results were read\n", killed, opened);
    assert_true(killed >= least);
    assert_true(opened >= least / 2);
    run_assert_same(p, "full.h5", results);
}

static void interrupted_run_goes_on(void **state) {
    static const int numbers[] = {SIGINT, SIGTERM};
    run_with_signals(*state, "interrupted.h5", numbers, 2, 4, true);
    assert_true(run_restarts(*state, "interrupted.h5") >= 3);
}

static void killed_run_loses_nothing(void **state) {
    static const int numbers[] = {SIGKILL};
    run_with_signals(*state, "killed.h5", numbers, 1, kill_count(), false);
    assert_false(run_is_there(*state, "killed.h5.run"));
}

/* The signal comes before the first step. */
static void interruption_at_once_leaves_a_checkpoint(void **state) {
    const program_place *p = *state;
    program_result first =
        program_shell(p,
                      "timeout -s TERM 0.001 true; '%s/softfall-solve' model.h5 -o early.h5 -t 1 & s=$!; "
                      "while [ ! -e early.h5 ]; do sleep 0.005; done; kill $s; wait $s; exit $?",
                      getenv("SF_BIN_DIR"));
    assert_int_equal(first.code, SF_INTERRUPTED);
    assert_non_null(strstr(first.err, "--restart resumes the run"));
    assert_true(run_is_there(p, "early.h5.restart") && !run_is_there(p, "early.h5.run"));
    program_succeed(p, "solve", "--restart early.h5 --threads 2");
    run_assert_same(p, "full.h5", "early.h5");
}

static void checkpoints_by_simulated_time_can_be_left_out(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "model.h5 -o none.h5 --end-time '2 ms' --no-checkpoint");
    assert_false(run_is_there(p, "none.h5.restart"));
    program_result result = program_run(p, "solve", "--restart none.h5");
    assert_int_equal(result.code, SF_ERR_IO);
    assert_non_null(strstr(result.err, "no checkpoint none.h5.restart"));

    const char *const words[] = {"model.h5", "-o", "timed.h5", "--checkpoint-time", "0.5 ms", NULL};
    pid_t child = run_start(p, words);
    while (!run_is_there(p, "timed.h5.restart")) /* well before the 60 s of wall time */
        run_sleep(0.002);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    program_succeed(p, "solve", "--restart timed.h5 --checkpoint-time '3 ms'");
    run_assert_same(p, "full.h5", "timed.h5");
}

/* ---- the fields at the peak ---- */

/* A number of a file that may not be there yet: then NAN. */
static double number_of(const program_place *p, const char *name, const char *path) {
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = NULL;
    double value = NAN;
    if (run_is_there(p, name) && sf_h5_open(program_path(p, name), &file, &err) == SF_OK)
        sf_h5_read_scalar(file, path, &value, &err);
    sf_h5_close(&file, &err);
    return value;
}

static void assert_same_peak(const program_place *p, const char *first, const char *second) {
    sf_error err = SF_ERROR_INIT;
    sf_h5 *a = program_open_h5(p, first), *b = program_open_h5(p, second);
    assert_int_equal(sf_h5_group_size(a, "/peak"),
                     SF_FRAME_FIELDS - 1 + 5); /* all fields but that of later drops */
    run_assert_same_group(a, b, "/peak");
    sf_h5_close(&a, &err);
    sf_h5_close(&b, &err);
}

/* Does the run's folder hold a later peak than its checkpoint, which holds one, too? */
static bool is_before_the_peak(const program_place *p) {
    double kept = number_of(p, "late.h5.restart", "/peak/time");
    return kept > 0 && number_of(p, "late.h5.run/peak.h5", "/peak/time") > kept;
}

/* A run is killed when its folder holds a later peak than its checkpoint. What goes on from there has the
 * peak of the checkpoint, and then that of one run. */
static void restart_takes_the_peak_of_its_checkpoint(void **state) {
    const program_place *p = *state;
    const char *const words[] = {"model.h5", "-o", "late.h5", "--checkpoint-time", "2 ms", NULL};
    int status = 0;
    pid_t child = run_start(p, words);
    while (waitpid(child, &status, WNOHANG) == 0 && !is_before_the_peak(p))
        run_sleep(0.001);
    assert_int_equal(kill(child, SIGKILL), 0);
    waitpid(child, &status, 0);
    assert_true(number_of(p, "late.h5.restart", "/peak/time") > 0);

    double end = number_of(p, "late.h5.restart", "/time_before") + 1e-9; /* the step that it holds */
    program_shell(p, "cp late.h5.restart killed.restart");
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = program_open_h5(p, "killed.restart");
    int64_t rows = -1;
    void *time = NULL;
    assert_int_equal(sf_h5_read(file, "/history/time", SF_H5_F64, 1, &rows, &time, &err), SF_OK);
    assert_true(rows > 2 && fabs(end - 1e-9 - ((double *)time)[rows - 2]) < 1e-15);
    free(time);
    sf_h5_close(&file, &err);
    program_succeed(p, "solve", "model.h5 -o short.h5 --end-time '%.17g s' --threads 1", end);
    program_succeed(p, "solve", "--restart late.h5 --end-time '%.17g s' --threads 1", end);
    assert_same_peak(p, "killed.restart", "late.h5.restart");
    run_assert_same(p, "short.h5", "late.h5");
    program_succeed(p, "solve", "--restart late.h5 --end-time '20 ms' --threads 1");
    run_assert_same(p, "full.h5", "late.h5");
}

/* A fast drop with a strict limit fails after some 80 steps, before the missile reaches the anvil. */
#define FAILING "--set missile.velocity='\"25 m/s\"' --set solver.energy_limit=1e-4"

/* The results of a failed run have its last peak; its checkpoint has that of the step before, whether the
 * steps were repeated from the beginning or from a checkpoint. */
static void failed_run_keeps_two_peaks(void **state) {
    static const char *const options[] = {"--no-checkpoint", "", "--checkpoint-time '1.5 ms'"};
    const program_place *p = *state;
    program_succeed(p, "pre", "'%s' -o rising.h5 %s " FAILING " --set output.fields='[\"velocity\"]'",
                    fixture_source(EXAMPLE), program_coarse(20));
    for (int k = 0; k < 3; k++) {
        program_result result = program_run(p, "solve", "rising.h5 -o rising_%d.h5 -t 1 %s", k, options[k]);
        assert_int_equal(result.code, SF_ERR_NUMERIC);
    }
    program_succeed(p, "solve", "rising.h5 -o held.h5 -t 1 --end-time '%.17g s'",
                    number_of(p, "rising_1.h5.restart", "/time_before") + 1e-9);
    assert_true(number_of(p, "rising_0.h5", "/peak/time") > number_of(p, "held.h5.restart", "/peak/time"));
    assert_same_peak(p, "rising_0.h5", "rising_1.h5");
    assert_same_peak(p, "rising_0.h5", "rising_2.h5");
    assert_same_peak(p, "held.h5.restart", "rising_1.h5.restart");
    assert_same_peak(p, "held.h5.restart", "rising_2.h5.restart");
}

/* With a stable step below the least that is allowed: results without history, with the frame of the failure,
 * which stands for the peak, and no checkpoint. */
static void failure_in_the_first_step_has_results(void **state) {
    const program_place *p = *state;
    program_succeed(p, "pre",
                    "'%s' -o stiff.h5 %s --set material.E='\"20 GPa\"' --set output.frame_interval='\"1 s\"'",
                    fixture_source(EXAMPLE), program_coarse(20));
    program_result result = program_run(p, "solve", "stiff.h5 -o stiff_results.h5 -t 1 --end-time '1000 s'");
    assert_int_equal(result.code, SF_ERR_NUMERIC);
    assert_non_null(strstr(result.err, "at t = 0 s the stable time step fell to"));
    assert_false(run_is_there(p, "stiff_results.h5.restart") || run_is_there(p, "stiff_results.h5.run"));
    assert_true(number_of(p, "stiff_results.h5", "/peak/time") == 0);
    sf_error err = SF_ERROR_INIT;
    sf_h5 *file = program_open_h5(p, "stiff_results.h5");
    assert_int_equal(sf_h5_group_size(file, "/frames"), 1);
    sf_h5_close(&file, &err);
}

/* ---- what cannot go on ---- */

/* One sentence that has `part`, the exit code, and files as they were. */
static void assert_refused(const program_place *p, int code, const char *part, const char *words) {
    program_bytes results = program_read_file(program_path(p, "part.h5")),
                  checkpoint = program_read_file(program_path(p, "part.h5.restart"));
    program_result result = program_run(p, "solve", "--restart part.h5 %s", words);
    if (result.code != code || !strstr(result.err, part) ||
        strchr(result.err, '\n') != result.err + strlen(result.err) - 1)
        fail_msg("exit code %d, expected %d with \"%s\": %s", result.code, code, part, result.err);
    program_assert_unchanged(program_path(p, "part.h5"), &results);
    program_assert_unchanged(program_path(p, "part.h5.restart"), &checkpoint);
    assert_false(run_is_there(p, "part.h5.run"));
}

static void set_version(const program_place *p, int64_t version) {
    hid_t file = H5Fopen(program_path(p, "part.h5.restart"), H5F_ACC_RDWR, H5P_DEFAULT);
    hid_t attribute = H5Aopen(file, "format_version", H5P_DEFAULT);
    assert_true(H5Awrite(attribute, H5T_NATIVE_INT64, &version) >= 0);
    H5Aclose(attribute);
    H5Fclose(file);
}

static void damaged_or_foreign_checkpoint_is_refused(void **state) {
    const program_place *p = *state;
    char text[64];
    sf_error err = SF_ERROR_INIT;
    uint64_t seed = 3;
    program_succeed(p, "solve", "model.h5 -o part.h5 --end-time '4 ms' --threads 1");
    const char *path = program_path(p, "part.h5.restart");
    program_bytes good = program_read_file(path);
    for (int k = 0; k < 24; k++) { /* a bit anywhere */
        size_t at = (size_t)((double)(good.size - 1) * 0.5 * (1 + fixture_random(&seed)));
        good.data[at] ^= (char)(1 << k % 8);
        program_write_file(program_path(p, "part.h5.restart"), good.data, good.size);
        good.data[at] ^= (char)(1 << k % 8);
        assert_refused(p, SF_ERR_IO, "part.h5.restart is ", "");
    }
    static const double lengths[] = {0, 0.001, 0.3, 0.9};
    for (int k = 0; k < 4; k++) {
        program_write_file(program_path(p, "part.h5.restart"), good.data,
                           (size_t)(lengths[k] * (double)good.size));
        assert_refused(p, SF_ERR_IO, "does not end with its checksum", "");
    }
    program_write_file(program_path(p, "part.h5.restart"), good.data, good.size - 24); /* without its seal */
    set_version(p, 99);
    assert_int_equal(sf_seal_add(program_path(p, "part.h5.restart"), &err), SF_OK);
    assert_refused(p, SF_ERR_IO, "has format version 99; this program reads version", "");
    program_shell(p, "cp model.h5 part.h5.restart");
    assert_int_equal(sf_seal_add(program_path(p, "part.h5.restart"), &err), SF_OK);
    assert_refused(p, SF_ERR_IO, "is a softfall-model file, expected a softfall-checkpoint file", "");
    program_write_file(program_path(p, "part.h5.restart"), good.data,
                       good.size - 24); /* as of an older version */
    hid_t file = H5Fopen(program_path(p, "part.h5.restart"), H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(H5Ldelete(file, "/state/kick", H5P_DEFAULT) >= 0);
    H5Fclose(file);
    assert_int_equal(sf_seal_add(program_path(p, "part.h5.restart"), &err), SF_OK);
    program_result older = program_run(p, "solve", "--restart part.h5");
    assert_true(older.code == SF_ERR_IO && !strstr(older.out, "ended:"));
    assert_non_null(strstr(older.err, "cannot be resumed: start a new run with --force"));
    program_shell(p, "rm -r part.h5.run");
    program_write_file(program_path(p, "part.h5.restart"), good.data, good.size);

    program_succeed(p, "pre", "'%s' -o other.h5 %s --set missile.mass='\"4.7 kg\"' --force",
                    fixture_source(EXAMPLE), program_coarse(20));
    assert_refused(p, SF_ERR_INPUT, "other.h5 is not the model of part.h5.restart: its hash is ", "other.h5");
    assert_refused(p, SF_ERR_INPUT, "beyond the end time 0.002 s", "--end-time '2 ms'");
    assert_refused(p, SF_ERR_INPUT, "--end-time: ", "--end-time '2 kg' 2>&1 | head -1 >&2; exit 2");
    program_shell(p, "mv model.h5 moved.h5");
    assert_refused(p, SF_ERR_IO, "(--restart RESULTS MODEL says where the model is now)", "");
    snprintf(text, sizeof text, "%s", "--restart part.h5 moved.h5 --end-time '20 ms'");
    program_succeed(p, "solve", "%s", text);
    program_shell(p, "mv moved.h5 model.h5");
    run_assert_same(p, "full.h5", "part.h5");
    free(good.data);
}

/* A checkpoint is no less worth than results; and two runs do not write the same file. */
static void nothing_is_replaced_without_force(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "model.h5 -o kept.h5 --end-time '1 ms'");
    program_result results = program_run(p, "solve", "model.h5 -o kept.h5");
    assert_int_equal(results.code, SF_ERR_INPUT);
    assert_non_null(strstr(results.err, "--restart resumes it"));
    program_shell(p, "rm kept.h5");
    program_result checkpoint = program_run(p, "solve", "model.h5 -o kept.h5");
    assert_int_equal(checkpoint.code, SF_ERR_INPUT);
    assert_non_null(strstr(checkpoint.err, "kept.h5.restart exists"));
    program_result lost = program_succeed(p, "solve", "--restart kept.h5"); /* its frames are gone */
    assert_non_null(strstr(
        lost.err, "frame 0 of the run so far is missing or damaged: the run starts from the beginning"));
    assert_true(run_is_there(p, "kept.h5") && run_is_there(p, "kept.h5.restart"));

    assert_int_equal(mkdir(program_path(p, "busy.h5.run"), 0777), 0);
    FILE *folder = fopen(program_path(p, "busy.h5.run"), "r");
    assert_non_null(folder);
    assert_int_equal(flock(fileno(folder), LOCK_EX), 0);
    program_result busy = program_run(p, "solve", "model.h5 -o busy.h5");
    fclose(folder);
    assert_int_equal(busy.code, SF_ERR_INPUT);
    assert_non_null(strstr(busy.err, "another softfall-solve is writing busy.h5"));
}

/* A whole pad has no symmetry plane that a point of its skin could touch. */
static void partner_that_is_not_there_is_refused(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    program_succeed(p, "pre",
                    "'%s' -o whole.h5 %s --set geometry.parameters.quarter=0 --set "
                    "geometry.missile_parameters.quarter=0 --set pad.self_contact='\"on\"'",
                    fixture_source(EXAMPLE), program_coarse(25));
    program_succeed(p, "solve", "whole.h5 -o whole_part.h5 --end-time '1 ms' --threads 1");
    const char *path = program_path(p, "whole_part.h5.restart");
    program_bytes good = program_read_file(path);
    program_write_file(path, good.data, good.size - 24); /* without its seal */
    free(good.data);
    hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT),
          data = H5Dopen(file, "/state/skin.partner", H5P_DEFAULT);
    hid_t space = H5Dget_space(data);
    hssize_t count = H5Sget_simple_extent_npoints(space);
    int32_t *partner = calloc((size_t)count, sizeof *partner);
    assert_true(count > 0 && partner);
    partner[0] = SF_FIRST_BODY - SF_BODY_SYMMETRY_X;
    assert_true(H5Dwrite(data, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, partner) >= 0);
    free(partner);
    H5Sclose(space);
    H5Dclose(data);
    H5Fclose(file);
    assert_int_equal(sf_seal_add(path, &err), SF_OK);
    program_result r = program_run(p, "solve", "--restart whole_part.h5 --end-time '2 ms'");
    assert_int_equal(r.code, SF_ERR_IO);
    assert_non_null(strstr(r.err, "touches facet or body -3, which is not there"));
}

/* ---- the model during a run ---- */

/* A run of `model`, as its own copy during.h5, that stands still after its third frame. */
static pid_t start_and_stop(const program_place *p, const char *model, const char *results) {
    char frame[64];
    const char *const words[] = {"during.h5",         "-o",     results, "--threads", "1",
                                 "--checkpoint-time", "0.5 ms", NULL};
    int status = 0;
    snprintf(frame, sizeof frame, "%s.run/frame-000002.h5", results);
    program_shell(p, "cp %s during.h5", model);
    pid_t child = run_start(p, words);
    while (!run_is_there(p, frame) && waitpid(child, &status, WNOHANG) == 0)
        run_sleep(0.001);
    assert_int_equal(kill(child, SIGSTOP), 0);
    assert_int_equal(waitpid(child, &status, WUNTRACED), child);
    assert_true(WIFSTOPPED(status));
    return child;
}

static int exit_code(pid_t child) {
    int status = 0;
    kill(child, SIGCONT);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/* The model is in memory from before the first frame on: what becomes of its file is nothing to the run. */
static void model_may_change_during_a_run(void **state) {
    static const char *const change[] = {"mv during.h5 moved_away.h5; cp model.h5 during.h5",
                                         "truncate -s 1000 during.h5", "cat model.h5 > during.h5"};
    const program_place *p = *state;
    program_succeed(p, "pre", "'%s' -o finer.h5 %s --set output.frame_interval='\"1 ms\"'",
                    fixture_source(EXAMPLE), program_coarse(14));
    program_succeed(p, "solve", "finer.h5 -o undisturbed.h5 --threads 1");
    for (size_t k = 0; k < sizeof change / sizeof change[0]; k++) {
        program_shell(p, "rm -rf changed.h5*");
        pid_t child = start_and_stop(p, "finer.h5", "changed.h5");
        program_shell(p, "%s", change[k]);
        assert_int_equal(exit_code(child), 0);
        run_assert_same(p, "undisturbed.h5", "changed.h5");
    }
}

/* A model that passes its checks, and whose constraints cannot be built: held nodes without shape
 * functions. A run of it leaves nothing, and what an earlier run has left as it was. */
static void model_that_cannot_be_built_costs_nothing(void **state) {
    const program_place *p = *state;
    const sf_provenance provenance = {.program = "test_restart"};
    const char *const words[] = {"model.h5", "-o", "earlier.h5", "--checkpoint-time", "0.5 ms", NULL};
    sf_error err = SF_ERROR_INIT;
    sf_model m;
    assert_int_equal(sf_model_read(program_path(p, "model.h5"), &m, NULL, &err), SF_OK);
    memset(m.phi_value, 0, (size_t)m.phi_nnz * sizeof *m.phi_value);
    assert_int_equal(sf_model_write(program_path(p, "void.h5"), &m, &provenance, &err), SF_OK);
    sf_model_free(&m);
    assert_int_equal(program_run(p, "solve", "void.h5 -o nothing.h5").code, SF_ERR_MODEL);
    assert_false(run_is_there(p, "nothing.h5") || run_is_there(p, "nothing.h5.run"));

    pid_t child = run_start(p, words);
    while (!run_is_there(p, "earlier.h5.restart"))
        run_sleep(0.002);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    program_shell(p, "rm -f earlier.h5.run/*.partial-* earlier.h5*.partial-*; "
                     "find earlier.h5* -type f | sort | xargs sha256sum > before");
    assert_int_equal(program_run(p, "solve", "void.h5 -o earlier.h5 --force").code, SF_ERR_MODEL);
    program_result same = program_shell(
        p, "grep -q earlier.h5.run/base.h5 before && find earlier.h5* -type f | sort | xargs sha256sum | "
           "cmp before -");
    if (same.code != 0)
        fail_msg("the earlier run has changed: %s%s", same.out, same.err);
    program_succeed(p, "solve", "--restart earlier.h5");
    run_assert_same(p, "full.h5", "earlier.h5");
}

/* ---- numerical failure ---- */

/* The frames' last time. */
static double last_frame(const program_place *p, const char *name, sf_results *r) {
    sf_error err = SF_ERROR_INIT;
    if (sf_results_open(program_path(p, name), r, &err) != SF_OK)
        fail_msg("%s", err.text);
    return r->frames[r->frame_count - 1].time;
}

/* A numerical failure: exit code, sentence, a frame of the failure, and the step before as a checkpoint. */
static void failed_run_leaves_its_state(void **state) {
    const program_place *p = *state;
    sf_results r;
    long long node, step, held;
    double time, held_time;
    program_succeed(p, "pre", "'%s' -o fast.h5 %s " FAILING, fixture_source(EXAMPLE), program_coarse(20));
    program_result first = program_run(p, "solve", "fast.h5 -o fast_results.h5 -t 1");
    assert_int_equal(first.code, SF_ERR_NUMERIC);
    const char *sentence = strstr(first.err, "softfall-solve: at t = "), *at = strstr(first.err, "node "),
               *kept = strstr(first.err, "fast_results.h5.restart is step ");
    assert_true(sentence && at && kept);
    assert_int_equal(sscanf(sentence, "softfall-solve: at t = %lg s (step %lld)", &time, &step), 2);
    assert_int_equal(sscanf(at, "node %lld", &node), 1);
    assert_int_equal(sscanf(kept, "fast_results.h5.restart is step %lld, t = %lg", &held, &held_time), 2);
    assert_int_equal(held, step - 1);
    assert_true(held_time < time);
    assert_true(fabs(last_frame(p, "fast_results.h5", &r) / time - 1) < 1e-5);
    assert_int_equal(r.history.rows, step); /* all that held */
    assert_true(strncmp(r.status, sentence + 16, 100) == 0);
    sf_results_close(&r);

    program_result again = program_run(p, "solve", "--restart fast_results.h5 -t 2");
    assert_int_equal(again.code, SF_ERR_NUMERIC);
    assert_string_equal(strstr(again.err, "softfall-solve: at t = "), sentence);
    program_result held_run =
        program_succeed(p, "solve", "--restart fast_results.h5 --end-time '%.17g s'", held_time * (1 - 1e-5));
    assert_non_null(strstr(held_run.out, "finished"));
    assert_true(fabs(last_frame(p, "fast_results.h5", &r) / held_time - 1) < 1e-5);
    sf_results_close(&r);

    program_result removed = program_run(p, "solve", "fast.h5 -o gone.h5 --on-failure remove");
    assert_int_equal(removed.code, SF_ERR_NUMERIC);
    assert_false(run_is_there(p, "gone.h5") || run_is_there(p, "gone.h5.restart") ||
                 run_is_there(p, "gone.h5.run"));
    assert_int_equal(program_run(p, "solve", "fast.h5 -o gone.h5 --on-failure ask").code, 64);
}

/* A foam whose curve ends in absurd stresses, which no case can name: forces overflow in one step. The
 * results end with the last valid state, and softfall-post reads them. */
static void overflow_leaves_the_last_finite_state(void **state) {
    const program_place *p = *state;
    const sf_provenance provenance = {.program = "test_restart"};
    sf_error err = SF_ERROR_INIT;
    sf_model m;
    sf_results r;
    sf_frame frame;
    program_succeed(p, "pre", "'%s' -o absurd.h5 %s", fixture_source(EXAMPLE), program_coarse(20));
    assert_int_equal(sf_model_read(program_path(p, "absurd.h5"), &m, NULL, &err), SF_OK);
    sf_foam_card *card = m.material[0].card;
    for (int64_t i = 0; i < card->curves.curve_points; i++)
        if (card->curves.curve_strain[i] > 0.5)
            card->curves.curve_stress[i] = 1e300 * card->curves.curve_strain[i];
    assert_int_equal(sf_model_write(program_path(p, "absurd.h5"), &m, &provenance, &err), SF_OK);
    sf_model_free(&m);
    for (int kept = 0; kept < 2; kept++) {
        program_result run = program_run(p, "solve", "absurd.h5 -o over.h5 --force -t 1 %s",
                                         kept ? "--checkpoint-time '1 ms'" : "--no-checkpoint");
        if (run.code != SF_ERR_NUMERIC || !strstr(run.err, "ends with the last frame that is finite"))
            fail_msg("exit code %d: %s", run.code, run.err);
        assert_true(last_frame(p, "over.h5", &r) > 0);
        assert_true(r.has_peak && r.frame_count > (kept ? 1 : 0));
        assert_int_equal(sf_frame_read(&r, &r.frames[r.frame_count - 1], SF_FIELD_ALL, &frame, &err), SF_OK);
        sf_frame_free(&frame);
        assert_int_equal(sf_frame_read(&r, &r.peak, SF_FIELD_ALL, &frame, &err), SF_OK);
        sf_frame_free(&frame);
        if (kept)
            assert_true(r.frames[r.frame_count - 1].time == r.history.time[r.history.rows - 1]);
        sf_results_close(&r);
        program_succeed(p, "post", "over.h5 -o over --force");
    }
}

/* ---- resuming after the rebound ---- */

static void rebounded_run_goes_on_when_an_end_time_is_given(void **state) {
    const program_place *p = *state;
    sf_results r;
    program_succeed(p, "pre", "'%s' -o bounce.h5 %s", fixture_source(EXAMPLE), program_coarse(20));
    program_succeed(p, "solve", "bounce.h5 -o bounced.h5 -t 1");
    double rebound = last_frame(p, "bounced.h5", &r);
    assert_string_equal(r.status, "rebound");
    sf_results_close(&r);
    program_result same = program_succeed(p, "solve", "--restart bounced.h5 -t 1");
    assert_non_null(strstr(same.out, "the run had ended by rebound at"));
    assert_true(last_frame(p, "bounced.h5", &r) == rebound);
    sf_results_close(&r);
    program_succeed(p, "solve", "--restart bounced.h5 -t 1 --end-time '%.15g s'", rebound + 2e-3);
    assert_true(last_frame(p, "bounced.h5", &r) > rebound + 2e-3 - 1e-12);
    assert_string_equal(r.status, "finished");
    sf_results_close(&r);
    program_succeed(p, "solve", "--restart bounced.h5 -t 1 --end-time '%.15g s'", rebound + 3e-3);
    assert_true(last_frame(p, "bounced.h5", &r) > rebound + 3e-3 - 1e-12);
    sf_results_close(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finished_run_goes_on_to_a_later_end),
        cmocka_unit_test(interrupted_run_goes_on),
        cmocka_unit_test(killed_run_loses_nothing),
        cmocka_unit_test(interruption_at_once_leaves_a_checkpoint),
        cmocka_unit_test(checkpoints_by_simulated_time_can_be_left_out),
        cmocka_unit_test(restart_takes_the_peak_of_its_checkpoint),
        cmocka_unit_test(damaged_or_foreign_checkpoint_is_refused),
        cmocka_unit_test(partner_that_is_not_there_is_refused),
        cmocka_unit_test(nothing_is_replaced_without_force),
        cmocka_unit_test(model_that_cannot_be_built_costs_nothing),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(overflow_leaves_the_last_finite_state),
        cmocka_unit_test(failed_run_leaves_its_state),
        cmocka_unit_test(rate_factor_goes_on_with_the_same_bits),
        cmocka_unit_test(killed_run_loses_nothing),
        cmocka_unit_test(model_may_change_during_a_run),
        cmocka_unit_test(failure_in_the_first_step_has_results),
        cmocka_unit_test(failed_run_keeps_two_peaks),
        cmocka_unit_test(rebounded_run_goes_on_when_an_end_time_is_given),
        cmocka_unit_test(hyperfoam_goes_on_with_the_same_bits),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, program_group_tear_down)
                        : cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
