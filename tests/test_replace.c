/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are whole at any instant (io/replace.h). Runs that are killed meanwhile: test_restart; full
 * disks: test_disk. */
#include "program_fixture.h"

#include "io/replace.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

static const char *content(const program_place *p, const char *name) {
    static program_result result;
    result = program_shell(p, "cat %s", name);
    return result.out;
}

static void the_new_file_takes_the_place_of_the_old_one(void **state) {
    const program_place *p = *state;
    char path[1024], partial[SF_PATH_SIZE];
    sf_error err = SF_ERROR_INIT;
    program_write_text(p, "file", "old");
    snprintf(path, sizeof path, "%s", program_path(p, "file"));
    assert_int_equal(sf_replace_begin(path, partial, &err), SF_OK);
    assert_string_equal(partial, program_path(p, "file.partial"));
    program_write_text(p, "file.partial", "new");
    assert_string_equal(content(p, "file"), "old");
    assert_int_equal(sf_replace_commit(partial, path, &err), SF_OK);
    assert_string_equal(content(p, "file"), "new");
    assert_int_not_equal(access(partial, F_OK), 0);
}

static void a_file_that_cannot_be_moved_leaves_the_old_one_and_no_rest(void **state) {
    const program_place *p = *state;
    char path[1024], partial[SF_PATH_SIZE];
    sf_error err = SF_ERROR_INIT;
    program_shell(p, "mkdir -p folder/inner");
    snprintf(path, sizeof path, "%s", program_path(p, "folder"));
    assert_int_equal(sf_replace_begin(path, partial, &err), SF_OK);
    program_write_text(p, "folder.partial", "new");
    assert_int_equal(sf_replace_commit(partial, path, &err), SF_ERR_IO);
    assert_non_null(strstr(err.text, "cannot be renamed to"));
    assert_int_equal(program_shell(p, "test -d folder/inner").code, 0);
    assert_int_not_equal(access(partial, F_OK), 0);
}

static void a_file_that_was_not_written_is_an_error(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_replace_commit("/no/such/file.partial", program_path(p, "file"), &err), SF_ERR_IO);
    assert_non_null(strstr(err.text, "cannot be brought to the disk: No such file"));
}

static void a_path_that_is_too_long_is_refused(void **state) {
    (void)state;
    char partial[SF_PATH_SIZE], path[SF_PATH_SIZE];
    sf_error err = SF_ERROR_INIT;
    memset(path, 'a', sizeof path);
    path[sizeof path - 1] = '\0';
    assert_int_equal(sf_replace_begin(path, partial, &err), SF_ERR_IO);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_new_file_takes_the_place_of_the_old_one),
        cmocka_unit_test(a_file_that_cannot_be_moved_leaves_the_old_one_and_no_rest),
        cmocka_unit_test(a_file_that_was_not_written_is_an_error),
        cmocka_unit_test(a_path_that_is_too_long_is_refused),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
