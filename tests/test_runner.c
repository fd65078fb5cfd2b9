/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a campaign does with a drop that fails, is interrupted or goes on. The programs are scripts that
 * behave as softfall-pre and softfall-solve do then; test_restart has the programs
 * themselves. */
#include "model_fixture.h"
#include "program_fixture.h"

#include "study/runner.h"
#include "io/process.h"
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";

/* softfall-pre CASE -o MODEL ..., softfall-solve MODEL -o RESULTS ... or --restart RESULTS ... */
#define MAKE_MODEL "touch \"$3\""
#define KEEP_CHECKPOINT "touch \"$3.restart\""

static void write_program(const program_place *p, const char *name, const char *interpreter,
                          const char *body) {
    char text[1024];
    snprintf(text, sizeof text, "#!%s\n%s\n", interpreter, body);
    assert_int_equal(chmod(program_write_text(p, name, text), 0755), 0);
}

static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    return setenv("SF_BIN_DIR", p->folder, 1);
}

/* The drop with the place's programs; the status is that of err. */
static void run_drop(const program_place *p, sf_error *err) {
    char folder[600], source[1024];
    sf_runner_result result;
    snprintf(folder, sizeof folder, "%s/runs", p->folder);
    snprintf(source, sizeof source, "%s", fixture_source(EXAMPLE));
    sf_runner runner = {.folder = folder, .threads = 1};
    const sf_runner_drop drop = {.label = "drop", .case_path = source};
    *err = (sf_error)SF_ERROR_INIT;
    sf_runner_run(&runner, &drop, &result, err);
    assert_int_equal(runner.simulated + runner.reused, 0);
    assert_null(result.path);
}

static bool there_is(const program_place *p, const char *pattern) {
    return program_shell(p, "ls %s", pattern).code == 0;
}

/* The sentence is the program's last one, whole, with its code and its log; the model stays only where the
 * drop can go on. */
static void a_drop_that_fails_is_told_in_the_words_of_its_program(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *pre, *solve;
        sf_status status;
        const char *part, *end;
        bool kept;
    } cases[] = {
        {"exit 7", "", SF_ERR_LIBRARY, "it said nothing (exit code 7; see ", "log.txt)", false},
        {"echo begun; echo 'softfall-pre: no pad' >&2; echo; exit 4", "", SF_ERR_MODEL,
         "softfall-pre: no pad (exit code 4; see ", "log.txt)", false},
        {"printf 'first %0700d last\\n' 0; exit 2", "", SF_ERR_INPUT, "first 000", "log.txt)", false},
        {"printf 'first %0700d last\\n' 0; exit 2", "", SF_ERR_INPUT, "0 last (exit code 2; see ", "log.txt)",
         false},
        {"echo usage; exit 64", "", SF_ERR_LIBRARY, "usage (exit code 64; see ", "log.txt)", false},
        {"kill -KILL $$", "", SF_ERR_LIBRARY, "its process was ended by signal 9 (see ", "log.txt)", false},
        {MAKE_MODEL, "echo begun; kill -KILL $$", SF_ERR_LIBRARY, "its process was ended by signal 9 (see ",
         "log.txt)", true},
        {MAKE_MODEL, "echo 'softfall-solve: collapsed' >&2; exit 5", SF_ERR_NUMERIC,
         "softfall-solve: collapsed (exit code 5; see ", "log.txt)", false},
        {MAKE_MODEL, "exit 0", SF_ERR_IO, "results.h5", "", false}, /* it left no results */
        {MAKE_MODEL, "exit 130", SF_INTERRUPTED, "run the same command again to resume", "", true},
        {MAKE_MODEL, "kill -TERM $$", SF_INTERRUPTED, "run the same command again to resume", "", true},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_error err;
        program_shell(p, "rm -rf runs");
        write_program(p, "softfall-pre", "/bin/sh", cases[k].pre);
        write_program(p, "softfall-solve", "/bin/sh", cases[k].solve);
        run_drop(p, &err);
        size_t length = strlen(err.text), end = strlen(cases[k].end);
        if (err.status != cases[k].status || !strstr(err.text, cases[k].part) || length < end ||
            strcmp(err.text + length - end, cases[k].end) != 0)
            fail_msg("%zu: status %d, expected %d with \"%s\": %s", k, err.status, cases[k].status,
                     cases[k].part, err.text);
        assert_int_equal(there_is(p, "runs/drop-*/model.h5"), cases[k].kept);
    }
}

static void a_program_that_cannot_be_run_is_named(void **state) {
    const program_place *p = *state;
    sf_error err;
    write_program(p, "softfall-solve", "/bin/sh", "");
    write_program(p, "softfall-pre", "/no/such/shell", "");
    run_drop(p, &err);
    assert_int_equal(err.status, SF_ERR_IO);
    assert_non_null(strstr(err.text, "softfall-pre cannot be run: No such file"));
    chmod(program_path(p, "softfall-pre"), 0644);
    run_drop(p, &err);
    assert_int_equal(err.status, SF_ERR_IO);
    assert_non_null(strstr(err.text, "softfall-pre cannot be run: Permission denied"));
}

/* Calls of the programs since the last look, in one line. */
static const char *calls(const program_place *p) {
    static program_result result;
    result = program_shell(p, "cat calls; rm -f calls");
    return result.out;
}

/* `answer` is the exit code of a drop that goes on. */
static sf_status run_again(const program_place *p, const char *answer) {
    sf_error err;
    program_write_text(p, "answer", answer);
    run_drop(p, &err);
    return err.status;
}

static void an_interrupted_drop_goes_on_or_starts_anew(void **state) {
    const program_place *p = *state;
    program_shell(p, "rm -rf runs"); /* of the tests before */
    write_program(p, "softfall-pre", "/bin/sh", "printf 'pre ' >> \"${0%/*}/calls\"; " MAKE_MODEL);
    write_program(p, "softfall-solve", "/bin/sh",
                  "if [ \"$1\" = --restart ]; then printf 'restart ' >> \"${0%/*}/calls\"; "
                  "exit \"$(cat \"${0%/*}/answer\")\"; fi\n"
                  "printf 'run ' >> \"${0%/*}/calls\"; " KEEP_CHECKPOINT "; exit 130");
    assert_int_equal(run_again(p, "0"), SF_INTERRUPTED);
    assert_string_equal(calls(p), "pre run ");
    assert_int_equal(run_again(p, "130"), SF_INTERRUPTED);
    assert_string_equal(calls(p), "restart ");
    assert_int_equal(run_again(p, "3"), SF_INTERRUPTED); /* a damaged checkpoint */
    assert_string_equal(calls(p), "restart pre run ");
    assert_int_equal(run_again(p, "5"), SF_ERR_NUMERIC);
    assert_string_equal(calls(p), "restart ");
    assert_false(there_is(p, "runs/drop-*/model.h5") || there_is(p, "runs/drop-*/results.h5.restart"));
    assert_int_equal(run_again(p, "0"), SF_INTERRUPTED);
    assert_string_equal(calls(p), "pre run ");
    program_shell(p, "rm runs/drop-*/results.h5.restart"); /* killed before it had one: the model is there */
    assert_int_equal(run_again(p, "0"), SF_INTERRUPTED);
    assert_string_equal(calls(p), "run ");
    program_shell(p, "rm -rf runs");
}

/* A campaign of two drops in a process of its own; 0: both were interrupted. */
static pid_t start_campaign(const program_place *p) {
    pid_t child = fork();
    assert_true(child >= 0);
    if (child > 0)
        return child;
    sf_error first, second;
    sf_process_handle_signals();
    bool before = sf_process_stopped();
    run_drop(p, &first);
    run_drop(p, &second);
    _exit(before || !sf_process_stopped() || first.status != SF_INTERRUPTED ||
          second.status != SF_INTERRUPTED);
}

/* The signal goes to the campaign alone, as from `kill`, and no other drop begins. */
static void a_signal_is_passed_on_to_the_drop_that_runs(void **state) {
    const program_place *p = *state;
    static const int numbers[] = {SIGINT, SIGTERM};
    write_program(p, "softfall-pre", "/bin/sh", "printf 'pre ' >> \"${0%/*}/calls\"; " MAKE_MODEL);
    write_program(p, "softfall-solve", "/bin/sh",
                  "trap 'printf \"INT \" >> \"${0%/*}/calls\"; exit 130' INT\n"
                  "trap 'printf \"TERM \" >> \"${0%/*}/calls\"; exit 130' TERM\n"
                  "printf 'run ' >> \"${0%/*}/calls\"; touch \"${0%/*}/started\"\n"
                  "while :; do sleep 0.02; done");
    for (int k = 0; k < 2; k++) {
        int status = -1;
        program_shell(p, "rm -f started calls");
        pid_t child = start_campaign(p);
        while (access(program_path(p, "started"), F_OK) != 0)
            nanosleep(&(struct timespec){0, 5000000}, NULL);
        assert_int_equal(kill(child, numbers[k]), 0);
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_int_equal(status, 0);
        assert_string_equal(calls(p), k == 0 ? "pre run INT " : "run TERM "); /* on with its model */
        assert_true(there_is(p, "runs/drop-*/model.h5"));
    }
}

/* Two drops side by side. */
static void run_batch(const program_place *p, int jobs, FILE *log, sf_error *err) {
    char folder[600], source[1024];
    sf_runner_result result[2];
    snprintf(folder, sizeof folder, "%s/runs", p->folder);
    snprintf(source, sizeof source, "%s", fixture_source(EXAMPLE));
    sf_runner runner = {.folder = folder, .threads = 1, .jobs = jobs, .log = log};
    const sf_runner_drop drop[2] = {
        {.label = "slow", .case_path = source},
        {.label = "fast", .case_path = source, .override_count = 1, .overrides = {"missile.velocity=5 m/s"}}};
    *err = (sf_error)SF_ERROR_INIT;
    sf_runner_run_batch(&runner, 2, drop, result, err);
    for (int k = 0; k < 2; k++)
        sf_runner_result_free(&result[k]);
}

/* The sentence names the drop whose copy was killed and says what to do. */
static void a_killed_copy_is_named(void **state) {
    const program_place *p = *state;
    sf_error err;
    program_shell(p, "rm -rf runs");
    write_program(p, "softfall-pre", "/bin/sh",
                  "case \"$*\" in */fast-*) kill -KILL $PPID;; esac; " MAKE_MODEL);
    write_program(p, "softfall-solve", "/bin/sh", "exit 5");
    run_batch(p, 2, NULL, &err);
    assert_int_equal(err.status, SF_ERR_LIBRARY);
    assert_non_null(strstr(err.text, "/runs/fast-"));
    assert_non_null(strstr(
        err.text, "its process was ended by signal 9; finished drops are kept: run the same command again"));
}

static void a_drop_that_its_case_refuses_leaves_the_others(void **state) {
    const program_place *p = *state;
    char folder[600], source[1024];
    sf_runner_result result[2];
    sf_error failure[2], err = SF_ERROR_INIT;
    program_shell(p, "rm -rf runs");
    write_program(p, "softfall-pre", "/bin/sh", MAKE_MODEL);
    write_program(p, "softfall-solve", "/bin/sh", "exit 5");
    snprintf(folder, sizeof folder, "%s/runs", p->folder);
    snprintf(source, sizeof source, "%s", fixture_source(EXAMPLE));
    sf_runner runner = {.folder = folder, .threads = 1};
    const sf_runner_drop drop[2] = {
        {.label = "bad", .case_path = source, .override_count = 1, .overrides = {"missile.mass=-1 kg"}},
        {.label = "good", .case_path = source}};
    assert_int_equal(sf_runner_run_each(&runner, 2, drop, result, failure, &err), SF_OK);
    assert_int_equal(failure[0].status, SF_ERR_INPUT);
    assert_non_null(strstr(failure[0].text, "missile.mass"));
    assert_int_equal(failure[1].status, SF_ERR_NUMERIC); /* it was run */
}

/* --threads 1 with --jobs 2 uses two processors, which is said. */
static void more_drops_than_threads_are_said(void **state) {
    const program_place *p = *state;
    sf_error err;
    char *words = NULL;
    size_t size = 0;
    write_program(p, "softfall-pre", "/bin/sh", MAKE_MODEL);
    for (int jobs = 0; jobs < 3; jobs++) {
        FILE *log = open_memstream(&words, &size);
        program_shell(p, "rm -rf runs");
        run_batch(p, jobs, log, &err);
        fclose(log);
        assert_int_equal(err.status, SF_ERR_NUMERIC);
        assert_string_equal(words, jobs < 2 ? ""
                                            : "  2 drops side by side, one thread each: more than 1 thread "
                                              "together\n");
        free(words);
    }
}

/* Two geometries of one text in two folders may merge two files: they are not one drop. */
static void one_text_in_two_folders_is_not_one_drop(void **state) {
    const program_place *p = *state;
    char folder[600], path[2][700];
    sf_runner_result result[2];
    sf_error failure[2], err = SF_ERROR_INIT;
    write_program(p, "softfall-pre", "/bin/sh", "echo 'softfall-pre: no pad' >&2; exit 4");
    program_shell(
        p, "for d in one two; do mkdir -p $d/examples && cp -r \"$SF_SOURCE_DIR\"/geo $d && cp -r "
           "\"$SF_SOURCE_DIR\"/examples/eva50-v4.5 \"$SF_SOURCE_DIR\"/examples/materials $d/examples; done");
    snprintf(folder, sizeof folder, "%s/runs", p->folder);
    snprintf(path[0], sizeof path[0], "%s/one/%s", p->folder, EXAMPLE);
    snprintf(path[1], sizeof path[1], "%s/two/%s", p->folder, EXAMPLE);
    sf_runner runner = {.folder = folder, .threads = 1};
    const sf_runner_drop drop[2] = {{.label = "drop", .case_path = path[0]},
                                    {.label = "drop", .case_path = path[1]}};
    sf_runner_run_each(&runner, 2, drop, result, failure, &err);
    assert_non_null(strstr(failure[0].text, "no pad"));
    assert_int_equal(failure[1].status, SF_ERR_INPUT);
    assert_non_null(strstr(failure[1].text, "the same text in different folders"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_drop_that_fails_is_told_in_the_words_of_its_program),
        cmocka_unit_test(a_program_that_cannot_be_run_is_named),
        cmocka_unit_test(an_interrupted_drop_goes_on_or_starts_anew),
        cmocka_unit_test(a_signal_is_passed_on_to_the_drop_that_runs),
        cmocka_unit_test(a_killed_copy_is_named),
        cmocka_unit_test(a_drop_that_its_case_refuses_leaves_the_others),
        cmocka_unit_test(more_drops_than_threads_are_said),
        cmocka_unit_test(one_text_in_two_folders_is_not_one_drop),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
