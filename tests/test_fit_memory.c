/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a fit remembers: found by a later run, by its key and length only; never from a record that was cut or
 * has changed; one run at a time. */
#include "study/fit/drop/drop_fit.h"
#include "program_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

enum { RECORDS = 5, VALUES = 3, RECORD = 8 * (3 + VALUES) };

static double value_of(int record, int k) {
    return 1.0 / (1 + record) + k;
}

/* Opens the memory and adds the records that it does not find; how many it has found. */
static int find_or_add(const char *path) {
    sf_fit_memory m;
    int found = 0;
    sf_fit_memory_open(path, &m);
    assert_true(m.file >= 0);
    for (int r = 0; r < RECORDS; r++) {
        double value[VALUES];
        if (sf_fit_memory_find(&m, (uint64_t)r, VALUES, value)) {
            found++;
            for (int k = 0; k < VALUES; k++)
                assert_true(value[k] == value_of(r, k));
            continue;
        }
        for (int k = 0; k < VALUES; k++)
            value[k] = value_of(r, k);
        sf_fit_memory_add(&m, (uint64_t)r, VALUES, value);
    }
    sf_fit_memory_close(&m);
    return found;
}

static void records_are_found_by_key_and_length(void **state) {
    const char *path = program_path(*state, "memory.bin");
    double value[VALUES + 1];
    sf_fit_memory m, other;
    assert_int_equal(find_or_add(path), 0);
    assert_int_equal(find_or_add(path), RECORDS);
    sf_fit_memory_open(path, &m);
    assert_true(sf_fit_memory_find(&m, 3, VALUES, value));
    assert_true(sf_fit_memory_find(&m, 1, VALUES, value));
    assert_false(sf_fit_memory_find(&m, 1, VALUES - 1, value));
    assert_false(sf_fit_memory_find(&m, RECORDS, VALUES, value));
    assert_false(sf_fit_memory_find(NULL, 1, VALUES, value));
    sf_fit_memory_open(path, &other);
    assert_false(sf_fit_memory_find(&other, 1, VALUES, value)); /* the first has it */
    sf_fit_memory_add(&other, 7, VALUES, value);
    sf_fit_memory_close(&other);
    sf_fit_memory_close(&m);
    assert_int_equal(find_or_add(path), RECORDS);
}

static void damaged_records_are_made_again(void **state) {
    const char *path = program_path(*state, "memory.bin");
    find_or_add(path);
    program_bytes good = program_read_file(path);
    assert_int_equal(good.size, RECORDS * RECORD);
    for (size_t k = 0; k < good.size; k += 7) { /* a changed bit, a cut, and garbage behind a cut */
        good.data[k] ^= 16;
        program_write_file(path, good.data, good.size);
        good.data[k] ^= 16;
        assert_int_equal(find_or_add(path), (int)(k / RECORD));
        assert_int_equal(find_or_add(path), RECORDS);
        program_write_file(path, good.data, k);
        assert_int_equal(find_or_add(path), (int)(k / RECORD));
        assert_int_equal(find_or_add(path), RECORDS);
    }
    program_assert_unchanged(path, &good);
}

static void folder_or_link_in_its_place_is_left_alone(void **state) {
    const char *path = program_path(*state, "memory.bin");
    double value[VALUES] = {0};
    for (int link = 0; link < 2; link++) {
        sf_fit_memory m;
        program_shell(*state, link ? "echo text > other; ln -s other memory.bin" : "mkdir memory.bin");
        sf_fit_memory_open(path, &m);
        sf_fit_memory_add(&m, 1, VALUES, value);
        assert_false(sf_fit_memory_find(&m, 1, VALUES, value));
        sf_fit_memory_close(&m);
        program_shell(*state, "rm -r memory.bin");
    }
    assert_int_equal(program_shell(*state, "test \"$(cat other)\" = text").code, 0);
}

static int clean(void **state) {
    program_shell(*state, "rm -rf memory.bin");
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(records_are_found_by_key_and_length, clean),
        cmocka_unit_test_setup(damaged_records_are_made_again, clean),
        cmocka_unit_test_setup(folder_or_link_in_its_place_is_left_alone, clean),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
