/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of two columns (io/table_csv.h). The sentences of its users: test_case, test_compare, test_cfh. */
#include "program_fixture.h"

#include "io/table_csv.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static sf_status check(const sf_table_point *p, sf_error *err) {
    if (p->index > 0 && !(p->value[0] > p->before[0]))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s after %g", p->path, p->line, p->text[0], p->last[0]);
    return SF_OK;
}

static const sf_table_name names[] = {{"a_m", 0, 1}, {"a_mm", 0, 1e-3}, {"b", 1, 1}};
static const sf_table_layout strict = {.what = "thing",
                                       .column = {"place", "value"},
                                       .wanted = {"a_m or a_mm", "b"},
                                       .names = names,
                                       .name_count = 3,
                                       .check = check};

static void read_text(const program_place *p, const char *text, const sf_table_layout *layout,
                      sf_table *table, sf_error *err) {
    *err = (sf_error)SF_ERROR_INIT;
    sf_table_read(program_write_text(p, "table.csv", text), layout, table, err);
}

static void columns_are_found_by_name_and_scaled(void **state) {
    sf_table table;
    sf_error err;
    read_text(*state, "\xEF\xBB\xBF# one\n\n \"b\" , other,a_mm\r\n 3,x,1000\r\n # two\n\"4\",,2e3", &strict,
              &table, &err);
    assert_int_equal(err.status, SF_OK);
    assert_int_equal(table.count, 2);
    assert_true(table.value[0][0] == 1 && table.value[0][1] == 2);
    assert_true(table.value[1][0] == 3 && table.value[1][1] == 4);
    assert_int_equal(table.line[0], 4);
    assert_int_equal(table.line[1], 6);
    assert_true(table.scale[0] == 1e-3 && table.scale[1] == 1);
    sf_table_free(&table);
    assert_null(table.value[0]);
}

static void faults_are_named_with_line_and_cell(void **state) {
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"b\n1\n", "table.csv:1: the header has no column a_m or a_mm"},
        {"a_m,a_mm,b\n", ":1: two place columns (\"a_m\" and \"a_mm\")"},
        {"a_m,b\n1\n", ":2: 1 values where the header has 2 columns"},
        {"a_m,b\n1,2,3\n", ":2: 3 values where the header has 2 columns"},
        {"a_m,b\n1,2\n#\n1.5.1,2\n", ":4: place \"1.5.1\" is not a number"},
        {"a_m,b\n1,\n", ":2: value \"\" is not a number"},
        {"a_m,b\n1,inf\n", ":2: value \"inf\" is not finite"},
        {"b,a_mm\n1,2\n1,2\n", ":3: 2 after 2"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_table table;
        sf_error err;
        read_text(*state, cases[k].text, &strict, &table, &err);
        if (err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].part))
            fail_msg("%zu: status %d, expected \"%s\": %s", k, err.status, cases[k].part, err.text);
        assert_true(table.count == 0 && !table.value[0] && !table.line);
    }
}

static void measured_tables_may_be_ragged_and_repeat_a_column(void **state) {
    sf_table_layout loose = strict;
    sf_table table;
    sf_error err;
    loose.first = loose.ragged = true;
    read_text(*state, "a_m,b,a_mm\n1,2\n3,4,5,6\n", &loose, &table, &err);
    assert_int_equal(err.status, SF_OK);
    assert_int_equal(table.count, 2);
    assert_true(table.value[0][1] == 3 && table.value[1][1] == 4);
    sf_table_free(&table);
    read_text(*state, "a_m,b\n1\n", &loose, &table, &err);
    assert_non_null(strstr(err.text, ":2: 1 values"));
}

static void what_is_no_plain_file_is_refused(void **state) {
    const program_place *p = *state;
    sf_table table;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_table_read(p->folder, &strict, &table, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "is not a plain file"));
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_table_read("/no/such/table.csv", &strict, &table, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the thing /no/such/table.csv cannot be read: No such file"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_found_by_name_and_scaled),
        cmocka_unit_test(faults_are_named_with_line_and_cell),
        cmocka_unit_test(measured_tables_may_be_ragged_and_repeat_a_column),
        cmocka_unit_test(what_is_no_plain_file_is_refused),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
