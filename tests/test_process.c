/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Programs that are run (io/process.h). Signals and softfall's own programs: test_runner. */
#include "program_fixture.h"

#include "io/process.h"
#include <errno.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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
    assert_int_equal(sf_process_pool(3, 2, end_by_signal, NULL, result, &err), SF_OK);
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
        cmocka_unit_test(children_are_waited_for_whatever_was_inherited),
        cmocka_unit_test(our_programs_are_looked_for_in_SF_BIN_DIR),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
