/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gate for files that are read (io/plain_file.h): what passes, what is refused without waiting, and its
 * register. That every program goes through it: test_hostile_files, tools/gate.py. */
#include "program_fixture.h"

#include "base/hash.h"
#include "io/plain_file.h"
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

static sf_status read_at_most(const char *path, uint64_t largest, char **text, sf_error *err) {
    *err = (sf_error)SF_ERROR_INIT;
    return sf_plain_read(path, "curve", largest, text, NULL, err);
}

static void assert_refused(const char *path, const char *words) {
    char *text = NULL;
    sf_error err;
    int handle = 0;
    alarm(2);
    assert_int_equal(read_at_most(path, 1000, &text, &err), SF_ERR_INPUT);
    assert_null(text);
    assert_non_null(strstr(err.text, words));
    assert_non_null(strstr(err.text, path));
    err = (sf_error)SF_ERROR_INIT;
    assert_int_not_equal(sf_plain_open(path, NULL, &handle, NULL, &err), SF_OK);
    assert_int_equal(handle, -1);
    assert_int_equal(strncmp(err.text, path, strlen(path)), 0);
    alarm(0);
}

static void content_comes_whole_and_is_registered(void **state) {
    const char *path = program_write_text(*state, "curve.csv", "a,b\n1,2\n");
    char *text = NULL;
    size_t size = 0, before = sf_plain_count();
    sf_error err = SF_ERROR_INIT;
    uint64_t hash = 0;
    struct stat info;
    assert_int_equal(sf_plain_read(path, "curve", 8, &text, &size, &err), SF_OK);
    assert_string_equal(text, "a,b\n1,2\n");
    assert_int_equal(size, 8);
    free(text);
    assert_int_equal(sf_plain_hash(path, NULL, 8, &hash, &err), SF_OK);
    assert_int_equal(sf_plain_check(path, NULL, &err), SF_OK);
    assert_int_equal(sf_plain_count(), before + 3);
    assert_int_equal(stat(path, &info), 0);
    for (size_t k = 0; k < 3; k++) {
        sf_plain_record r = sf_plain_get(before + k);
        assert_string_equal(r.path, path);
        assert_true(r.device == info.st_dev && r.inode == info.st_ino);
    }
    assert_true(hash == sf_hash_bytes(SF_HASH_START, "a,b\n1,2\n", 8));
    assert_string_equal(sf_plain_name(info.st_dev, info.st_ino), path);
    sf_plain_clear();
    assert_int_equal(sf_plain_count(), 0);
    assert_null(sf_plain_name(info.st_dev, info.st_ino));
}

/* Read once, unless it has changed or was written a moment before. */
static void a_hash_is_kept_while_the_file_stays(void **state) {
    const char *path = program_write_text(*state, "kept.csv", "a,b\n1,2\n");
    sf_error err = SF_ERROR_INIT;
    uint64_t first = 0, again = 0, other = 0;
    size_t before = sf_plain_count();
    assert_int_equal(sf_plain_hash_kept(path, &first, &err), SF_OK);
    assert_int_equal(sf_plain_hash_kept(path, &first, &err), SF_OK);
    assert_int_equal(sf_plain_count(), before + 2);
    usleep(2200000);
    for (int k = 0; k < 3; k++)
        assert_int_equal(sf_plain_hash_kept(path, &again, &err), SF_OK);
    assert_int_equal(sf_plain_count(), before + 3);
    assert_true(first == again && again == sf_hash_bytes(SF_HASH_START, "a,b\n1,2\n", 8));
    path = program_write_text(*state, "kept.csv", "a,b\n1,3\n"); /* of the same length */
    assert_int_equal(sf_plain_hash_kept(path, &other, &err), SF_OK);
    assert_true(other == sf_hash_bytes(SF_HASH_START, "a,b\n1,3\n", 8));
    unlink(path);
    assert_int_equal(sf_plain_hash_kept(path, &other, &err), SF_ERR_INPUT);
}

static void a_large_content_is_the_same_in_one_piece_and_in_blocks(void **state) {
    enum { SIZE = 300001 };
    char *data = malloc(SIZE), *text = NULL;
    size_t size = 0;
    uint64_t hash = 0;
    sf_error err = SF_ERROR_INIT;
    for (int k = 0; k < SIZE; k++)
        data[k] = (char)(k * 7 + k / 256);
    const char *path = program_path(*state, "large");
    program_write_file(path, data, SIZE);
    assert_int_equal(sf_plain_read(path, NULL, SF_PLAIN_ANY, &text, &size, &err), SF_OK);
    assert_int_equal(size, SIZE);
    assert_memory_equal(text, data, SIZE);
    assert_int_equal(sf_plain_hash(path, NULL, SF_PLAIN_ANY, &hash, &err), SF_OK);
    assert_true(hash == sf_hash_bytes(SF_HASH_START, data, SIZE));
    free(text);
    free(data);
}

static void an_empty_file_is_an_empty_text(void **state) {
    char *text = NULL;
    sf_error err;
    assert_int_equal(read_at_most(program_write_text(*state, "empty", ""), 0, &text, &err), SF_OK);
    assert_string_equal(text, "");
    free(text);
}

static void what_is_no_plain_file_is_refused_at_once(void **state) {
    const program_place *p = *state;
    assert_int_equal(mkfifo(program_path(p, "pipe"), 0666), 0);
    assert_int_equal(symlink("/dev/zero", program_path(p, "link")), 0);
    program_shell(p, "python3 -c 'import socket; socket.socket(socket.AF_UNIX).bind(\"socket\")'");
    assert_refused(program_path(p, "pipe"), "is not a plain file: it is a pipe");
    assert_refused(program_path(p, "link"), "is not a plain file: it is a device");
    assert_refused(program_path(p, "socket"), "is not a plain file: it is a socket");
    assert_refused(p->folder, "is not a plain file: it is a folder");
    assert_refused("/dev/zero", "it is a device");
    assert_refused("/proc/self/status", "the system makes it up");
    if (access("/sys/kernel/notes", F_OK) == 0) /* not every container has sysfs */
        assert_refused("/sys/kernel/notes", "the system makes it up");
    if (geteuid() == 0 && access("/proc/kmsg", F_OK) == 0) /* waits for the next message of the kernel */
        assert_refused("/proc/kmsg", "the system makes it up");
    assert_refused(program_path(p, "missing"), "cannot be read: No such file");
}

static void a_file_that_is_too_large_is_refused_unread(void **state) {
    const program_place *p = *state;
    char *text = NULL;
    sf_error err;
    assert_int_equal(truncate(program_write_text(p, "sparse", ""), (off_t)1 << 40), 0);
    size_t before = sf_plain_count();
    alarm(2);
    assert_int_equal(read_at_most(program_path(p, "sparse"), 1000, &text, &err), SF_ERR_INPUT);
    alarm(0);
    assert_non_null(strstr(err.text, "is larger than 0.001 MB"));
    assert_int_equal(sf_plain_count(), before);
    assert_int_equal(read_at_most(program_write_text(p, "nine", "123456789"), 8, &text, &err), SF_ERR_INPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(content_comes_whole_and_is_registered),
        cmocka_unit_test(a_hash_is_kept_while_the_file_stays),
        cmocka_unit_test(a_large_content_is_the_same_in_one_piece_and_in_blocks),
        cmocka_unit_test(an_empty_file_is_an_empty_text),
        cmocka_unit_test(what_is_no_plain_file_is_refused_at_once),
        cmocka_unit_test(a_file_that_is_too_large_is_refused_unread),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
