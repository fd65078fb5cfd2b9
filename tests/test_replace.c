/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are whole at any instant (io/replace.h). Runs that are killed meanwhile: test_restart; full
 * disks: test_disk. */
#include "program_fixture.h"

#include "io/folder.h"
#include "io/plain_file.h"
#include "io/replace.h"
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

static const char *content(const program_place *p, const char *name) {
    static program_result result;
    result = program_shell(p, "cat %s", name);
    return result.out;
}

static void write_partial(const char *partial, const char *text) {
    sf_error err = SF_ERROR_INIT;
    FILE *file = sf_replace_create(partial, &err);
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

/* In place of the C library's: keeps what was brought to the disk last, and whether `watched` had its new
 * content then. */
static struct stat synced;
static const char *watched;
static bool was_new;
int fsync(int file) {
    fstat(file, &synced);
    program_bytes held = watched ? program_read_file(watched) : (program_bytes){0};
    was_new = held.data && strcmp(held.data, "new") == 0;
    free(held.data);
    return (int)syscall(SYS_fsync, file);
}

/* A name that only the memory holds is lost with the power: the folder is synced after the rename. */
static void the_folder_of_a_new_name_is_on_the_disk(void **state) {
    const program_place *p = *state;
    char path[1024], partial[SF_PATH_SIZE];
    sf_error err = SF_ERROR_INIT;
    struct stat folder;
    program_write_text(p, "named", "old");
    snprintf(path, sizeof path, "%s", program_path(p, "named"));
    assert_int_equal(sf_replace_begin(path, partial, &err), SF_OK);
    write_partial(partial, "new");
    watched = path;
    assert_int_equal(sf_replace_commit(partial, path, &err), SF_OK);
    watched = NULL;
    assert_int_equal(stat(p->folder, &folder), 0);
    assert_true(S_ISDIR(synced.st_mode) && synced.st_ino == folder.st_ino && was_new);
}

static void the_new_file_takes_the_place_of_the_old_one(void **state) {
    const program_place *p = *state;
    char path[1024], partial[SF_PATH_SIZE];
    int process = 0;
    sf_error err = SF_ERROR_INIT;
    program_write_text(p, "file", "old");
    snprintf(path, sizeof path, "%s", program_path(p, "file"));
    assert_int_equal(sf_replace_begin(path, partial, &err), SF_OK);
    assert_int_equal(strncmp(partial, program_path(p, "file.partial-"), strlen(path) + 9), 0);
    assert_true(sf_replace_is_partial(strrchr(partial, '/') + 1, "file", &process));
    assert_int_equal(process, getpid());
    write_partial(partial, "new");
    assert_string_equal(content(p, "file"), "old");
    assert_int_equal(sf_replace_commit(partial, path, &err), SF_OK);
    assert_string_equal(content(p, "file"), "new");
    assert_int_not_equal(access(partial, F_OK), 0);
}

static void a_name_that_is_taken_is_neither_followed_nor_overwritten(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    program_write_text(p, "precious", "mine");
    assert_int_equal(symlink(program_path(p, "precious"), program_path(p, "link")), 0);
    assert_null(sf_replace_create(program_path(p, "precious"), &err));
    assert_null(sf_replace_create(program_path(p, "link"), &err));
    assert_int_equal(symlink(program_path(p, "nothing"), program_path(p, "dangling")), 0);
    assert_null(sf_replace_create(program_path(p, "dangling"), &err));
    assert_int_equal(err.status, SF_ERR_IO);
    assert_string_equal(content(p, "precious"), "mine");
    assert_int_not_equal(access(program_path(p, "nothing"), F_OK), 0);
    assert_int_equal(sf_replace_reopen(program_path(p, "link")), -1);
}

/* Nothing but plain files is renamed over. */
static void what_is_no_file_keeps_its_name_and_the_new_file_goes(void **state) {
    const program_place *p = *state;
    program_shell(p, "mkdir -p folder/inner; mkfifo pipe; ln -s /dev/null null");
    static const struct {
        const char *name, *words;
    } rows[] = {{"folder", "it is a folder"}, {"pipe", "it is a pipe"}, {"null", "it is a device"}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        char partial[SF_PATH_SIZE];
        const char *path = program_path(p, rows[k].name);
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(sf_replace_check(path, &err), SF_ERR_INPUT);
        assert_non_null(strstr(err.text, rows[k].words));
        err = (sf_error)SF_ERROR_INIT;
        assert_int_equal(sf_replace_begin(path, partial, &err), SF_OK);
        write_partial(partial, "new");
        assert_int_equal(sf_replace_commit(partial, path, &err), SF_ERR_IO);
        assert_non_null(strstr(err.text, rows[k].words));
        assert_int_not_equal(access(partial, F_OK), 0);
    }
    assert_int_equal(program_shell(p, "test -d folder/inner && test -p pipe && test -L null").code, 0);
}

static void a_file_that_was_not_written_is_an_error(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_replace_commit("/no/such/file.partial", program_path(p, "file"), &err), SF_ERR_IO);
    assert_non_null(strstr(err.text, "cannot be brought to the disk: No such file"));
}

static void names_that_cannot_be_written_are_refused_first(void **state) {
    const program_place *p = *state;
    char path[SF_PATH_SIZE], name[300];
    sf_error err = SF_ERROR_INIT;
    memset(path, 'a', sizeof path);
    path[sizeof path - 1] = '\0';
    assert_int_equal(sf_replace_check(path, &err), SF_ERR_INPUT);
    snprintf(name, sizeof name, "%0245d", 0); /* is possible, but not with what is appended */
    const struct {
        const char *path, *words;
        sf_status status;
    } rows[] = {{"", "is empty", SF_ERR_INPUT},
                {name, "its name is too long", SF_ERR_INPUT},
                {"missing/file", "No such file", SF_ERR_IO},
                {"file/", "it is a folder", SF_ERR_INPUT}};
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        err = (sf_error)SF_ERROR_INIT;
        assert_int_equal(sf_replace_check(*rows[k].path ? program_path(p, rows[k].path) : "", &err),
                         rows[k].status);
        assert_non_null(strstr(err.text, rows[k].words));
    }
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_replace_check(program_path(p, "new"), &err), SF_OK);
    assert_int_equal(sf_replace_check("new", &err), SF_OK);
}

static void what_was_read_is_no_output(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    const char *path = program_write_text(p, "input", "1");
    assert_int_equal(sf_replace_check(path, &err), SF_OK);
    assert_int_equal(sf_plain_check(path, NULL, &err), SF_OK);
    assert_int_equal(link(path, program_path(p, "other-name")), 0);
    assert_int_equal(symlink(path, program_path(p, "input-link")), 0);
    static const char *const names[] = {"input", "other-name", "input-link"};
    for (int k = 0; k < 3; k++) {
        err = (sf_error)SF_ERROR_INIT;
        assert_int_equal(sf_replace_check(program_path(p, names[k]), &err), SF_ERR_INPUT);
        assert_non_null(strstr(err.text, "would replace an input"));
    }
    /* Once the file is gone, another one may have its inode. */
    assert_int_equal(unlink(path), 0);
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_replace_check(program_path(p, "other-name"), &err), SF_OK);
    sf_plain_clear();
}

/* Of processes that have ended, and HDF5 or empty; nothing else. */
static void rests_of_killed_processes_go_and_nothing_else(void **state) {
    const program_place *p = *state;
    static const char signature[] = "\211HDF\r\n\032\nrest";
    char mine[64];
    snprintf(mine, sizeof mine, "m.h5.partial-%d-00000000", (int)getpid());
    static const char *const gone[] = {"m.h5.partial-999999999-0123abcd", "m.h5.partial-999999998-0123abcd"};
    const char *const kept[] = {"m.h5",
                                mine,
                                "m.h5.partial",
                                "m.h5.partial-999999999-0123abcX",
                                "m.h5.partial-999999999-0123abcd.txt",
                                "n.h5.partial-999999999-0123abcd"};
    program_write_file(program_path(p, gone[0]), signature, sizeof signature);
    program_write_text(p, gone[1], "");
    for (size_t k = 0; k < sizeof kept / sizeof kept[0]; k++)
        program_write_file(program_path(p, kept[k]), signature, sizeof signature);
    program_write_text(p, "m.h5.partial-999999997-0123abcd", "somebody's text");
    sf_replace_clean(program_path(p, "m.h5"));
    for (size_t k = 0; k < sizeof gone / sizeof gone[0]; k++)
        assert_int_not_equal(access(program_path(p, gone[k]), F_OK), 0);
    for (size_t k = 0; k < sizeof kept / sizeof kept[0]; k++)
        assert_int_equal(access(program_path(p, kept[k]), F_OK), 0);
    assert_string_equal(content(p, "m.h5.partial-999999997-0123abcd"), "somebody's text");
}

/* The process that wrote a file has ended, but another one has it open: HDF5 locks what it has open. */
static void a_rest_that_is_open_stays(void **state) {
    const program_place *p = *state;
    program_write_text(p, "o.h5.partial-999999999-0123abcd", "");
    int file = open(program_path(p, "o.h5.partial-999999999-0123abcd"), O_RDONLY);
    assert_true(file >= 0);
    assert_int_equal(flock(file, LOCK_SH), 0);
    sf_replace_clean(program_path(p, "o.h5"));
    assert_int_equal(access(program_path(p, "o.h5.partial-999999999-0123abcd"), F_OK), 0);
    close(file);
    sf_replace_clean(program_path(p, "o.h5"));
    assert_int_not_equal(access(program_path(p, "o.h5.partial-999999999-0123abcd"), F_OK), 0);
}

/* ---- folders of our own ---- */

static void a_folder_with_strange_files_is_not_taken(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    program_shell(p, "mkdir strange empty; echo mine > strange/base.h5");
    assert_int_equal(sf_folder_own(program_path(p, "strange"), &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "holds files and was not made by softfall"));
    assert_string_equal(program_shell(p, "ls -A strange").out, "base.h5\n");
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_folder_own(program_path(p, "strange/base.h5"), &err), SF_ERR_INPUT);
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_folder_own(program_path(p, "empty"), &err), SF_OK);
    assert_int_equal(sf_folder_own(program_path(p, "fresh"), &err), SF_OK);
    program_write_text(p, "fresh/base.h5", "mine");
    assert_int_equal(sf_folder_own(program_path(p, "fresh"), &err), SF_OK);
    sf_folder_leave(program_path(p, "fresh"));
    sf_folder_leave(program_path(p, "empty"));
    assert_string_equal(content(p, "fresh/base.h5"), "mine");
    assert_int_not_equal(access(program_path(p, "empty"), F_OK), 0);
}

/* As the jobs of one campaign do: whoever comes second finds the mark of the first. */
static void processes_that_begin_at_once_share_a_folder(void **state) {
    enum { TURNS = 300, PROCESSES = 4 };
    const program_place *p = *state;
    char path[600];
    for (int turn = 0; turn < TURNS; turn++) {
        int gate[2], byte, status, failed = 0;
        snprintf(path, sizeof path, "%s/shared-%d", p->folder, turn);
        assert_int_equal(pipe(gate), 0);
        for (int k = 0; k < PROCESSES; k++)
            if (fork() == 0) {
                sf_error err = SF_ERROR_INIT;
                close(gate[1]);
                bool begun = read(gate[0], &byte, 1) == 0; /* when the gate is closed */
                if (begun && sf_folder_own(path, &err) != SF_OK)
                    print_error("%s\n", err.text);
                _exit(!begun || err.status != SF_OK);
            }
        close(gate[0]);
        close(gate[1]);
        for (int k = 0; k < PROCESSES; k++)
            failed += wait(&status) < 0 || status != 0;
        assert_int_equal(failed, 0);
    }
}

static bool is_known(const char *name) {
    return strcmp(name, "base.h5") == 0;
}

static void files_of_a_known_name_but_strange_content_stay(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_folder_own(program_path(p, "own"), &err), SF_OK);
    program_write_text(p, "own/base.h5", "mine");
    program_write_text(p, "own/other.h5", "");
    int handle = sf_folder_open(program_path(p, "own"));
    assert_int_equal(sf_folder_check(handle, "own", is_known, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "own/base.h5 is not a file of softfall"));
    sf_folder_remove_known(handle, is_known, NULL);
    assert_string_equal(content(p, "own/base.h5"), "mine");
    program_write_text(p, "own/base.h5", "\211HDF\r\n\032\n");
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_folder_check(handle, "own", is_known, &err), SF_OK);
    sf_folder_remove_known(handle, is_known, "base.h5");
    assert_int_equal(access(program_path(p, "own/base.h5"), F_OK), 0);
    sf_folder_remove_known(handle, is_known, NULL);
    close(handle);
    assert_int_not_equal(access(program_path(p, "own/base.h5"), F_OK), 0);
    assert_int_equal(access(program_path(p, "own/other.h5"), F_OK), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_new_file_takes_the_place_of_the_old_one),
        cmocka_unit_test(the_folder_of_a_new_name_is_on_the_disk),
        cmocka_unit_test(a_name_that_is_taken_is_neither_followed_nor_overwritten),
        cmocka_unit_test(what_is_no_file_keeps_its_name_and_the_new_file_goes),
        cmocka_unit_test(a_file_that_was_not_written_is_an_error),
        cmocka_unit_test(names_that_cannot_be_written_are_refused_first),
        cmocka_unit_test(what_was_read_is_no_output),
        cmocka_unit_test(rests_of_killed_processes_go_and_nothing_else),
        cmocka_unit_test(a_rest_that_is_open_stays),
        cmocka_unit_test(a_folder_with_strange_files_is_not_taken),
        cmocka_unit_test(processes_that_begin_at_once_share_a_folder),
        cmocka_unit_test(files_of_a_known_name_but_strange_content_stay),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
