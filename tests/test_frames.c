/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The files of a run's folder: damaged, foreign, and how many bytes are written for them. Kills:
 * test_restart. */
#include "check.h"
#include "model/model_io.h"
#include "program_fixture.h"
#include "run_fixture.h"

#include "model_fixture.h"

#include "post/results/results.h"
#include "solver/run/run.h"
#include <hdf5.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

/* In place of the C library's: frames are written and not waited for, in this program alone. */
int fsync(int file) {
    (void)file;
    return 0;
}

/* model.h5; full.h5, one run of it; and killed.h5, a run that was killed with a checkpoint behind frame 2. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    const char *const words[] = {"model.h5",          "-o",     "killed.h5", "-t", "1",
                                 "--checkpoint-time", "0.5 ms", NULL};
    program_succeed(p, "pre",
                    "'%s' -o model.h5 %s --set output.frame_interval='\"1 ms\"' "
                    "--set solver.step_safety=0.2 --set solver.end_time='\"14 ms\"'",
                    fixture_source("examples/eva50-v4.5/case.cfg"), program_coarse(20));
    program_succeed(p, "solve", "model.h5 -o full.h5 -t 1");
    int status = 0;
    pid_t child = run_start(p, words);
    while (!run_is_there(p, "killed.h5.run/frame-000005.h5") && waitpid(child, &status, WNOHANG) == 0)
        run_sleep(0.001);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    return run_is_there(p, "killed.h5.run/frame-000005.h5") ? 0 : 1;
}

/* A copy of the killed run as broken.h5 (its links name the folder of its own). */
static void copy_killed(const program_place *p) {
    sf_error err = SF_ERROR_INIT;
    program_shell(
        p, "rm -rf broken; mkdir broken; cp -r killed.h5 killed.h5.run killed.h5.restart model.h5 broken");
    assert_int_equal(sf_seal_check(program_path(p, "broken/killed.h5.run/frame-000001.h5"), &err), SF_OK);
}

/* A bit in the middle of the file, which is that of a value. */
static void flip(const program_place *p, const char *name) {
    program_bytes bytes = program_read_file(program_path(p, name));
    bytes.data[bytes.size / 2] ^= 4;
    program_write_file(program_path(p, name), bytes.data, bytes.size);
    free(bytes.data);
}

static void assert_has(const program_result *r, int code, const char *part) {
    if (r->code != code || !strstr(r->err, part))
        fail_msg("exit code %d, expected %d with \"%s\": %s", r->code, code, part, r->err);
}

/* ---- damage before a restart ---- */

static void damaged_frame_is_computed_again(void **state) {
    static const char *const damage[] = {NULL, "truncate -s -1000", "truncate -s 0", "rm"};
    const program_place *p = *state;
    for (size_t k = 0; k < sizeof damage / sizeof damage[0]; k++) {
        copy_killed(p);
        if (damage[k])
            program_shell(p, "%s broken/killed.h5.run/frame-000001.h5", damage[k]);
        else
            flip(p, "broken/killed.h5.run/frame-000001.h5");
        program_result r = program_succeed(p, "solve", "--restart broken/killed.h5 model.h5 -t 1");
        assert_has(&r, 0, "frame 1 of the run so far");
        assert_has(&r, 0, "the run starts from the beginning");
        run_assert_same(p, "full.h5", "broken/killed.h5");
        assert_false(run_is_there(p, "broken/killed.h5.run"));
    }
    copy_killed(p);
    program_result whole = program_succeed(p, "solve", "--restart broken/killed.h5 model.h5 -t 1");
    assert_null(strstr(whole.err, "beginning"));
    run_assert_same(p, "full.h5", "broken/killed.h5");
}

/* The results of a killed run are read without what is damaged. */
static void damaged_frame_is_left_out_of_the_reading(void **state) {
    const program_place *p = *state;
    copy_killed(p);
    program_succeed(p, "post", "broken/killed.h5 -o before");
    flip(p, "broken/killed.h5.run/frame-000001.h5");
    program_result r = program_succeed(p, "post", "broken/killed.h5 -o after");
    assert_has(&r, 0, "left out: ");
    assert_has(&r, 0, "the file of its run that holds /frames/000001/time is damaged");
    flip(p, "broken/killed.h5.run/base.h5");
    r = program_run(p, "post", "broken/killed.h5 -o neither");
    assert_has(&r, SF_ERR_IO, "the file of its run that holds ");
}

/* A run in progress moves its frames: one that is gone is no frame without fields. */
static void moved_frame_is_told(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_results r;
    sf_frame frame;
    copy_killed(p);
    assert_int_equal(sf_results_open(program_path(p, "broken/killed.h5"), &r, &err), SF_OK);
    assert_true(r.frame_count > 3);
    assert_int_equal(sf_frame_read(&r, &r.frames[1], SF_FIELD_ALL, &frame, &err), SF_OK);
    assert_non_null(frame.field[SF_FRAME_VON_MISES]);
    sf_frame_free(&frame);
    program_shell(p, "rm broken/killed.h5.run/frame-*.h5");
    assert_int_equal(sf_frame_read(&r, &r.frames[2], SF_FIELD_ALL, &frame, &err), SF_ERR_IO);
    assert_non_null(strstr(err.text, "read the results again"));
    assert_null(frame.field[SF_FRAME_DISPLACEMENT]);
    sf_results_close(&r);
}

/* A run that is continued after its end takes its frames from its results, and computes a lost one too. */
static void frame_lost_from_the_results_is_computed_again(void **state) {
    const program_place *p = *state;
    program_succeed(p, "solve", "model.h5 -o ended.h5 -t 1 --end-time '6 ms'");
    hid_t file = H5Fopen(program_path(p, "ended.h5"), H5F_ACC_RDWR, H5P_DEFAULT);
    assert_true(H5Ldelete(file, "/frames/000002", H5P_DEFAULT) >= 0);
    H5Fclose(file);
    program_result r = program_succeed(p, "solve", "--restart ended.h5 -t 1 --end-time '14 ms'");
    assert_has(&r, 0, "of the run so far is missing or damaged: the run starts from the beginning");
    run_assert_same(p, "full.h5", "ended.h5");
}

/* ---- damage during a run ---- */

static void damage_during_a_run_stops_its_end_and_no_restart(void **state) {
    const program_place *p = *state;
    const char *const words[] = {"model.h5", "-o", "hit.h5", "-t", "1", NULL};
    int status = 0;
    pid_t child = run_start(p, words);
    while (!run_is_there(p, "hit.h5.run/frame-000003.h5") && waitpid(child, &status, WNOHANG) == 0)
        run_sleep(0.001);
    assert_int_equal(kill(child, SIGSTOP), 0);
    assert_int_equal(waitpid(child, &status, WUNTRACED), child);
    flip(p, "hit.h5.run/frame-000002.h5");
    kill(child, SIGCONT);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == SF_ERR_IO);
    assert_non_null(strstr(program_shell(p, "cat errors").out, "frame-000002.h5 is damaged"));
    program_succeed(p, "solve", "--restart hit.h5 -t 1");
    run_assert_same(p, "full.h5", "hit.h5");
}

/* ---- foreign files ---- */

/* A frame that leads to another file, with a good seal: nobody reads that file. */
static void frame_that_leads_elsewhere_is_not_read(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    for (int kind = 0; kind < 2; kind++) {
        copy_killed(p);
        program_shell(p, "cp broken/killed.h5.run/frame-000001.h5 secret.h5");
        hid_t file = H5Fcreate(program_path(p, "broken/killed.h5.run/frame-000001.h5"), H5F_ACC_TRUNC,
                               H5P_DEFAULT, H5P_DEFAULT);
        hid_t frames = H5Gcreate2(file, "frames", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        if (kind == 0)
            H5Lcreate_external(program_path(p, "secret.h5"), "/frames/000001", frames, "000001", H5P_DEFAULT,
                               H5P_DEFAULT);
        else
            H5Lcreate_external("killed.h5.run/frame-000002.h5", "/frames/000001", frames, "000001",
                               H5P_DEFAULT, H5P_DEFAULT);
        H5Gclose(frames);
        H5Fclose(file);
        assert_int_equal(sf_seal_add(program_path(p, "broken/killed.h5.run/frame-000001.h5"), &err), SF_OK);
        program_result post = program_succeed(p, "post", "broken/killed.h5 -o led --force");
        assert_has(&post, 0, "link, which is not followed");
        program_result solve = program_run(p, "solve", "--restart broken/killed.h5 model.h5 -t 1");
        assert_has(&solve, SF_ERR_IO, "link, which is not followed");
    }
}

/* A frame is due at its time, not only behind it, and once. */
static void a_frame_is_due_at_its_time(void **state) {
    double at[] = {1e-3, 2e-3};
    const sf_model m = {.run.frame_interval = 1, .frame_time_count = 2, .frame_time = at};
    sf_recorder r = {.next_frame = 1};
    sf_state s = {.time = 0.9e-3};
    (void)state;
    assert_false(sf_recorder_frame_due(&r, &m, &s));
    s.time = at[0];
    assert_true(sf_recorder_frame_due(&r, &m, &s));
    assert_false(sf_recorder_frame_due(&r, &m, &s));
    s.time = at[1];
    assert_true(sf_recorder_frame_due(&r, &m, &s));
    s.time = 1;
    assert_true(sf_recorder_frame_due(&r, &m, &s));
    assert_int_equal(r.frames, 3);
}

/* ---- bytes ---- */

/* Bytes that this process has handed to the system for writing so far. */
static long long bytes_written(void) {
    long long bytes = -1;
    char line[128];
    FILE *file = fopen("/proc/self/io", "r");
    while (file && fgets(line, sizeof line, file))
        sscanf(line, "wchar: %lld", &bytes);
    if (file)
        fclose(file);
    return bytes;
}

/* As softfall-solve does it. */
static void run_in_this_process(const char *model_path, const char *results) {
    const sig_atomic_t go_on = 0;
    const sf_provenance provenance = {.program = "test_frames", .model_path = model_path, .model_hash = ""};
    FILE *log = fopen("/dev/null", "w");
    sf_run run = {.stop = &go_on,
                  .log = log,
                  .threads = 1,
                  .checkpoints = false, /* which follow wall time */
                  .checkpoint_time = INFINITY,
                  .provenance = &provenance};
    sf_error err = SF_ERROR_INIT;
    sf_model model;
    sf_operators operators;
    sf_state state;
    sf_output output;
    sf_h5 *file = NULL;
    assert_non_null(log);
    assert_int_equal(sf_model_read(model_path, &model, &file, &err), SF_OK);
    assert_int_equal(sf_output_name(&output, results, &err), SF_OK);
    assert_int_equal(sf_output_open(&output, &err), SF_OK);
    assert_int_equal(sf_output_base(&output, &model, file, &provenance, &err), SF_OK);
    assert_int_equal(sf_output_start(&output, false, &err), SF_OK);
    assert_int_equal(sf_operators_build(&model, &operators, &err), SF_OK);
    assert_int_equal(sf_state_create(&model, &state, &err), SF_OK);
    if (sf_run_drop(&model, &operators, &state, &run, &output, NULL, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_output_close(&output);
    sf_h5_close(&file, &err);
    sf_state_free(&state);
    sf_operators_free(&operators);
    sf_model_free(&model);
    fclose(log);
}

/* 500 frames, each a small part of the history: what is written grows as the data, not as their square. */
static void bytes_written_are_those_of_the_data(void **state) {
    const program_place *p = *state;
    char model[600], results[600];
    sf_error err = SF_ERROR_INIT;
    struct stat info;
    program_succeed(
        p, "pre",
        "'%s' -o many.h5 %s --set output.frame_interval='\"0.02 ms\"' --set solver.step_safety=0.2 "
        "--set solver.end_time='\"10 ms\"' --set output.fields='[\"velocity\"]'",
        fixture_source("examples/eva50-v4.5/case.cfg"), program_coarse(20));
    snprintf(model, sizeof model, "%s", program_path(p, "many.h5"));
    snprintf(results, sizeof results, "%s", program_path(p, "many_results.h5"));
    long long before = bytes_written();
    if (before < 0)
        check_skip_refused("/proc/self/io cannot be read");
    run_in_this_process(model, results);
    long long written = bytes_written() - before;
    assert_int_equal(stat(results, &info), 0);
    print_message("%lld bytes written for %lld: %.2f\n", written, (long long)info.st_size,
                  (double)written / (double)info.st_size);
    sf_h5 *file = program_open_h5(p, "many_results.h5");
    assert_true(sf_h5_group_size(file, "/frames") >= 500);
    sf_h5_close(&file, &err);
    assert_true((double)written < 3.2 * (double)info.st_size);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(damaged_frame_is_computed_again),
        cmocka_unit_test(damaged_frame_is_left_out_of_the_reading),
        cmocka_unit_test(moved_frame_is_told),
        cmocka_unit_test(frame_lost_from_the_results_is_computed_again),
        cmocka_unit_test(damage_during_a_run_stops_its_end_and_no_restart),
        cmocka_unit_test(frame_that_leads_elsewhere_is_not_read),
        cmocka_unit_test(bytes_written_are_those_of_the_data),
        cmocka_unit_test(a_frame_is_due_at_its_time),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
