/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Programs that are run (io/process.h). Signals and softfall's own programs: test_runner. */
#include "program_fixture.h"

#include "io/folder.h"
#include "io/process.h"
#include <errno.h>
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

static int shell(const char *command, const char *folder, const char *log) {
    const char *const arguments[] = {"sh", "-c", command, NULL};
    const sf_process process = {.arguments = arguments, .folder = folder, .log = log};
    int code = -1;
    assert_int_equal(sf_process_run(&process, &code), 0);
    return code;
}

static void the_exit_code_or_the_signal_comes_back(void **state) {
    (void)state;
    assert_int_equal(shell("exit 0", NULL, NULL), 0);
    assert_int_equal(shell("exit 7", NULL, NULL), 7);
    assert_int_equal(shell("kill -KILL $$", NULL, NULL), 128 + SIGKILL);
}

static void what_it_prints_is_appended_to_the_log_and_it_reads_nothing(void **state) {
    const program_place *p = *state;
    char log[1024];
    snprintf(log, sizeof log, "%s", program_path(p, "log"));
    assert_int_equal(shell("echo out; echo err >&2", NULL, log), 0);
    assert_int_equal(shell("cat; echo again", NULL, log), 0);
    assert_string_equal(program_shell(p, "cat log").out, "out\nerr\nagain\n");
}

static void it_runs_in_its_folder(void **state) {
    const program_place *p = *state;
    assert_int_equal(shell("echo 1 > here", p->folder, NULL), 0);
    assert_int_equal(program_shell(p, "test -f here").code, 0);
}

static void a_program_or_folder_that_is_not_there_has_its_reason(void **state) {
    (void)state;
    const char *const none[] = {"softfall-no-such-program", NULL}, *const sh[] = {"sh", "-c", "exit 0", NULL};
    const sf_process no_program = {.arguments = none},
                     no_folder = {.arguments = sh, .folder = "/no/such/folder"};
    int code = -1;
    assert_int_equal(sf_process_run(&no_program, &code), ENOENT);
    assert_int_equal(sf_process_run(&no_folder, &code), ENOENT);
    assert_int_equal(code, -1);
    assert_false(sf_process_stopped());
}

/* Waits for the file; false after a minute. */
static bool wait_for(const char *path) {
    const struct timespec pause = {0, 20000000};
    for (int k = 0; k < 3000 && access(path, F_OK) != 0; k++)
        nanosleep(&pause, NULL);
    return access(path, F_OK) == 0;
}

/* A child that locks the folder and has a shell run there, apart and with the lock. */
static pid_t run_apart(const program_place *p, const char *command) {
    pid_t child = fork();
    if (child != 0)
        return child;
    const char *const arguments[] = {"sh", "-c", command, NULL};
    sf_error err = SF_ERROR_INIT;
    int lock = -1, code = 9;
    const sf_process process = {
        .arguments = arguments, .folder = p->folder, .stoppable = true, .apart = true, .held = &lock};
    sf_process_handle_signals();
    if (sf_folder_lock(p->folder, &lock, &err) == SF_OK)
        sf_process_run(&process, &code);
    _exit(sf_process_stopped() ? 100 + code : code);
}

/* The sentence is that of a second campaign. */
static void a_program_that_holds_a_lock_keeps_it_when_its_parent_is_killed(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT, none = SF_ERROR_INIT;
    int lock = -1, status;
    pid_t child = run_apart(p, "touch held; until test -e go; do sleep 0.05; done; touch gone");
    assert_true(child > 0 && wait_for(program_path(p, "held")));
    kill(child, SIGKILL);
    assert_true(waitpid(child, &status, 0) == child);
    assert_int_equal(sf_folder_lock(p->folder, &lock, &err), SF_ERR_INPUT);
    assert_int_equal(lock, -1);
    program_shell(p, "touch go");
    assert_true(wait_for(program_path(p, "gone")));
    assert_int_equal(sf_folder_lock(p->folder, &lock, &none), SF_OK);
    close(lock);
}

static void a_signal_interrupts_a_program_that_is_apart_with_its_group(void **state) {
    const program_place *p = *state;
    int status;
    pid_t child =
        run_apart(p, "trap 'touch outer; exit 3' INT; trap '' TERM; "
                     "sh -c 'trap \"touch inner; exit\" INT; touch ready; while :; do sleep 0.05; done'");
    assert_true(child > 0 && wait_for(program_path(p, "ready")));
    kill(child, SIGTERM);
    assert_true(waitpid(child, &status, 0) == child);
    assert_int_equal(status, 103 << 8);
    assert_int_equal(program_shell(p, "test -e inner && test -e outer").code, 0);
}

static sf_status end_by_signal(void *context, int index, sf_error *err) {
    (void)context;
    if (index == 1)
        raise(SIGKILL);
    return index == 2 ? SF_FAIL(err, SF_ERR_MODEL, "no good") : SF_OK;
}

/* Also where who started us ignores the end of children, which goes over to us. */
static void children_are_waited_for_whatever_was_inherited(void **state) {
    (void)state;
    sf_error result[3], err = SF_ERROR_INIT;
    signal(SIGCHLD, SIG_IGN);
    assert_int_equal(shell("exit 7", NULL, NULL), 7);
    signal(SIGCHLD, SIG_IGN);
    assert_int_equal(sf_process_pool(3, 2, end_by_signal, NULL, NULL, result, &err), SF_OK);
    assert_int_equal(result[0].status, SF_OK);
    assert_int_equal(result[1].status, SF_ERR_LIBRARY);
    assert_string_equal(result[1].text, SF_PROCESS_KILLED " 9");
    assert_int_equal(result[2].status, SF_ERR_MODEL);
    assert_string_equal(result[2].text, "no good");
}

static void our_programs_are_looked_for_in_SF_BIN_DIR(void **state) {
    const program_place *p = *state;
    char path[1024], before[1024];
    sf_error err = SF_ERROR_INIT;
    const char *given = getenv("SF_BIN_DIR");
    snprintf(before, sizeof before, "%s", given ? given : "");
    setenv("SF_BIN_DIR", p->folder, 1);
    assert_int_equal(sf_process_find("softfall-pre", path, sizeof path, &err), SF_ERR_IO);
    assert_non_null(strstr(err.text, "softfall-pre cannot be run: No such file"));
    program_shell(p, "touch softfall-pre; chmod +x softfall-pre");
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_process_find("softfall-pre", path, sizeof path, &err), SF_OK);
    assert_string_equal(path, program_path(p, "softfall-pre"));
    setenv("SF_BIN_DIR", before, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_exit_code_or_the_signal_comes_back),
        cmocka_unit_test(what_it_prints_is_appended_to_the_log_and_it_reads_nothing),
        cmocka_unit_test(it_runs_in_its_folder),
        cmocka_unit_test(a_program_or_folder_that_is_not_there_has_its_reason),
        cmocka_unit_test(a_program_that_holds_a_lock_keeps_it_when_its_parent_is_killed),
        cmocka_unit_test(a_signal_interrupts_a_program_that_is_apart_with_its_group),
        cmocka_unit_test(children_are_waited_for_whatever_was_inherited),
        cmocka_unit_test(our_programs_are_looked_for_in_SF_BIN_DIR),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
