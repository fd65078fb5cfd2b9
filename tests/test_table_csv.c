/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of two columns (io/table_csv.h). The sentences of its users: test_case_refusals, test_compare, test_cfh. */
#include "program_fixture.h"

#include "io/table_csv.h"
#include <math.h>
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

static const sf_table_name names[] = {{"a_m", 0, 1, NULL}, {"a_mm", 0, 1e-3, NULL}, {"b", 1, 1, NULL}};
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

static void rows_of_measured_tables_may_be_short(void **state) {
    sf_table_layout loose = strict;
    sf_table table;
    sf_error err;
    loose.ragged = true;
    read_text(*state, "a_m,b,c\n1,2\n3,4,5,,\n,,\n", &loose, &table, &err);
    assert_int_equal(err.status, SF_OK);
    assert_int_equal(table.count, 2);
    assert_true(table.value[0][1] == 3 && table.value[1][1] == 4);
    sf_table_free(&table);
    read_text(*state, "a_m,b\n1\n", &loose, &table, &err);
    assert_non_null(strstr(err.text, ":2: 1 values"));
    read_text(*state, "a_m,b\n1,5,2,5\n", &loose, &table, &err); /* 1.5 and 2.5, not 1 and 5 */
    assert_non_null(strstr(err.text, ":2: 4 values where the header has 2 columns (with decimal commas"));
}

static const sf_table_layout measured = {.what = "thing",
                                         .column = {"time", "force"},
                                         .wanted = {"time_s", "force_N"},
                                         .names = NULL,
                                         .words = {"time|t|*zeit", "force|*kraft"},
                                         .kind = {SF_TIME, SF_FORCE},
                                         .ragged = true};

static void laboratory_tables_are_read_and_told(void **state) {
    static const struct {
        const char *text, *interpretation;
    } cases[] = {
        {"Time (ms);Force (kN)\n1,5;0,25\n", "separator \";\", decimal comma, time in ms, force in kN"},
        {"\xEF\xBB\xBFTime [ms]\tForce [N]\r\n1.5\t250\r\n",
         "separator tab, decimal point, time in ms, force in N"},
        {"t/ms Kraft/kN\n1.5 0.25\n", "separator blanks, decimal point, time in ms, force in kN"},
        {"Messzeit;Standardkraft\nms;N\n1,5;250\n", "decimal comma, time in ms, force in N"},
        {"time_ms,force_kN,x\n1.5,0.25,a\n", "separator \",\", decimal point, time in ms, force in kN"},
        {"Machine 7;;\nDate;1.2.2024;\n\nTime (s);Pos;Force (N)\n0,0015;1;250\n", "heading in line 4"},
        {"Time (ms);Channel 1 (N)\n1,5;250\n", "force in N (\"Channel 1 (N)\")"},
        {"Time in ms;\"Force, N\"\r1,5;250\r", "decimal comma"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_table table;
        sf_error err;
        read_text(*state, cases[k].text, &measured, &table, &err);
        if (err.status != SF_OK || !strstr(table.interpretation, cases[k].interpretation))
            fail_msg("%zu: %s%s", k, err.text, table.interpretation);
        assert_int_equal(table.count, 1);
        assert_true(fabs(table.value[0][0] - 1.5e-3) < 1e-15 && fabs(table.value[1][0] - 250) < 1e-9);
        sf_table_free(&table);
    }
}

/* What could mean two things is not guessed. */
static void ambiguous_tables_are_refused(void **state) {
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"time_s,force_N\n1,\"1,234\"\n", ":2: force \"1,234\" holds a comma, which separates the columns"},
        {"time_s;force_N\n1;1,234\n2;5,678\n",
         ":2: \"1,234\" and every other number with a comma could hold"},
        {"time_s;force_N\n1.5;2\n2;5,67\n",
         ":3: force \"5,67\" has a comma where the file has decimal points"},
        {"time_s;force_N\n1,5;2\n2;5.67\n",
         ":3: force \"5.67\" has a decimal point after numbers with a decimal"},
        {"time_s;force_N\n1;1,234,567\n", "\"1,234,567\" is not a number"},
        {"Time (s);Force\n1;2\n", "\"Force\" names no unit"},
        {"Time (s);Force (N);Force (kN)\n1;2;3\n", "two force columns"},
        {"Time (s);Force (mm)\n1;2\n", "\"Force (mm)\" is in \"mm\", which is not a unit of a force"},
        {"Time;Force\ns;kg\n1;2\n", "is in \"kg\", which is not a unit of a force"},
        {"1;2\nTime (s);Force (N)\n1;2\n", ":1: numbers begin here without a heading"},
        {"Rig 7;a\nSensor;b\nMoment;Wert\ns;?\n1;2\n", ":3: the header has no column"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_table table;
        sf_error err;
        read_text(*state, cases[k].text, &measured, &table, &err);
        if (err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].part))
            fail_msg("%zu: status %d, expected \"%s\": %s", k, err.status, cases[k].part, err.text);
        assert_true(table.count == 0 && !table.value[0]);
    }
}

static void column_can_be_chosen(void **state) {
    sf_table_layout chosen = measured;
    sf_table table;
    sf_error err;
    chosen.chosen[1] = "Force 2";
    read_text(*state, "Time (s);Force 1 (N);Force 2 (kN)\n1;2;3\n", &chosen, &table, &err);
    assert_int_equal(err.status, SF_OK);
    assert_true(table.value[1][0] == 3000);
    sf_table_free(&table);
}

/* Bluehill, data loggers, spreadsheets and ISO-MME. */
static void exports_of_laboratories_are_read(void **state) {
    static const struct {
        const char *text, *interpretation;
        int count;
        double last[2];
    } cases[] = {
        {"Results Table 1\n,Maximum Force\n,(N)\n1,\"1682.35\"\n\nTime,Displacement,Force\n(s),(mm),(N)\n"
         "\"0.0\",\"0.0\",\"0.5\"\n\"2.0\",\"1.0\",\"1,017.76\"\n",
         "heading in line 6",
         2,
         {2, 1017.76}},
        {"Time,Compressive force (Load cell)\n(s),(N)\n\"1.5\",\"1,017\"\n", "force in N", 1, {1.5, 1017}},
        {"Zeit (s);Kraft (N)\n1,5;1.017,76\n", "decimal comma", 1, {1.5, 1017.76}},
        {"Time (s),Force (N)\n1,2\n2,3\n\nPeak,150.0\nHIC,1142.6\n",
         "without what stands from line 5 on",
         2,
         {2, 3}},
        {"Time (s),Force (N)\n1,2\n2,NaN\n3,4\n", "1 lost samples (NaN)", 2, {3, 4}},
        {"Test object number :1\r\nName of the channel :Load, cell\r\nUnit :kN\r\nSampling interval :5.0E-05\r\n"
         "Time of first sample :-1.0E-04\r\nNumber of samples :3\r\n1.0\r\nNOVALUE\r\n3.0E+00\r\n",
         "force in kN (\"Load  cell (kN)\")",
         2,
         {0, 3000}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_table t;
        sf_error err;
        read_text(*state, cases[k].text, &measured, &t, &err);
        if (err.status != SF_OK || !strstr(t.interpretation, cases[k].interpretation))
            fail_msg("%zu: %s, %s", k, err.text, t.interpretation);
        assert_int_equal(t.count, cases[k].count);
        for (int c = 0; c < 2; c++)
            assert_true(fabs(t.value[c][t.count - 1] - cases[k].last[c]) < 1e-12 * (1 + cases[k].last[c]));
        sf_table_free(&t);
    }
}

/* Specimens and cycles: in columns, side by side, one below the other. */
static void parts_are_chosen_and_listed(void **state) {
    static const struct {
        const char *text, *specimen, *cycle, *expected; /* a fault, or NULL: the last point is (3 s, 30 N) */
    } cases[] = {
        {"Specimen;Time (s);Force (N)\n1;1;1\n1;2;2\n2;1;10\n2;3;30\n", "2", NULL, NULL},
        {"Specimen No;Time (s);Force (N)\nA-7;1;1\nB;3;30\n", "B", NULL, NULL},
        {"Specimen;Time (s);Force (N)\n1;1;1\n2;1;10\n", NULL, NULL,
         "holds the specimens 1, 2: choose one with specimen = N"},
        {"Specimen;Time (s);Force (N)\n1;1;1\n2;1;10\n", "3", NULL,
         "\"3\" was asked for; it holds the specimens 1, 2"},
        {"Time (s);Force (N);Cycle count\n1;1;1\n2;2;1\n2.5;5;2\n3;30;2.0\n", NULL, "2", NULL},
        {"Time (s);Force (N);Cycle count\n1;1;1\n2;2;2\n", NULL, NULL,
         "holds the cycles 1, 2: choose one with cycle = N"},
        {"Specimen;Cycle;Time (s);Force (N)\n1;1;1;1\n1;2;2;2\n2;1;3;30\n2;2;4;40\n", "2", "1", NULL},
        {"Specimen;Cycle;Time (s);Force (N)\n1;1;1;1\n1;2;2;2\n2;1;3;30\n", "2", NULL, NULL},
        {"Time (s);Force (N);Time (s);Force (N)\n1;1;3;30\n", "2", NULL, NULL},
        {"Time (s);Force (N);Force (N)\n3;1;30\n", "2", NULL, NULL},
        {"Time (s);Force (N);Time (s);Force (N)\n1;1;3;30\n", "3", NULL, "has columns of 2"},
        {"Time (s);Force (N);Time (s);Force (N)\n1;1;3;30\n", NULL, NULL,
         "choose a specimen with specimen = N"},
        {"Test 1\nTime (s);Force (N)\n1;1\n2;2\nTest 2\nTime;Force\n(s);(N)\n1;10\n3;30\n\nMean;9\n\nTest 3\n"
         "Time (s);Force (N)\n1;5\n",
         "2", NULL, NULL},
        {"Time (s);Force (N)\n1;1\nTime (s);Force (N)\n3;30\n", NULL, NULL,
         ":3: another table begins here, the file holds 2: choose one with specimen = N"},
        {"Time (s);Force (N)\n1;1\nTime (s);Force (N)\n3;30\n", "4", NULL, "holds 2 tables"},
        {"Cycle;Time (s);Force (N)\n1;1;1\n2;2;2\n3;2.1;2\n4;2.2;2\n5;2.3;2\n6;2.4;2\n7;2.5;2\n8;2.6;2\n9;3;30\n",
         NULL, NULL, NULL},
        {"Specimen;Time (s);Force (N)\n1;3;30\nMean;-;\n", NULL, NULL, NULL},
        {"Time (s);Force (N);Specimen height (mm);cycle height (mm)\n1;1;50;3\n3;30;49;4\n", NULL, NULL,
         NULL},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_table t;
        sf_error err;
        sf_table_layout layout = measured;
        layout.part[SF_TABLE_SPECIMEN] = cases[k].specimen;
        layout.part[SF_TABLE_CYCLE] = cases[k].cycle;
        layout.part_option[SF_TABLE_SPECIMEN] = "specimen = N";
        layout.part_option[SF_TABLE_CYCLE] = "cycle = N";
        read_text(*state, cases[k].text, &layout, &t, &err);
        bool fault = cases[k].expected != NULL;
        if (fault ? err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].expected) : err.status != SF_OK)
            fail_msg("%zu: status %d: %s", k, err.status, err.text);
        if (fault)
            continue;
        if (t.value[0][t.count - 1] != 3 || t.value[1][t.count - 1] != 30)
            fail_msg("%zu: (%g, %g)", k, t.value[0][t.count - 1], t.value[1][t.count - 1]);
        assert_true(t.part_taken[SF_TABLE_SPECIMEN] == (cases[k].specimen != NULL));
        assert_true(t.part_taken[SF_TABLE_CYCLE] == (cases[k].cycle != NULL));
        sf_table_free(&t);
    }
}

/* A heading from the user, and samples that are only numbered. */
static void what_a_file_does_not_say_can_be_given(void **state) {
    static const struct {
        const char *text, *heading;
        bool counted;
        const char *expected; /* a fault, or NULL: the last point is (0.003 s, 30 N) */
    } cases[] = {
        {"1,10\n3,30\n", "t (ms), F (N)", false, NULL},
        {"rig 7\n\n1\t10\n3\t30\n", "Time (ms); Force (N)", false, NULL},
        {"1 10 5\n3 30 6\n", "Time (ms);Force (N);other", false, NULL},
        {"1;10;5\n3;30;6\n", "Time (ms);Force (N)", false, ":1: 3 values where"},
        {"Time (s);Force (N)\n1;2\n", "Time (ms);Force (N)", false, ":1: the file has a heading of its own"},
        {"1;2\n", "Time (ms);Mass (kg)", false,
         "--heading \"Time (ms);Mass (kg)\": the header has no column"},
        {"Force (N)\n1\n2\n3\n30\n", NULL, true, NULL},
        {"1\n2\n3,5\n30\n", "Force (N)", true, NULL},
        {"Sample no;Force (N);x\n1;5;1\n3;30;1\n", NULL, true, NULL},
        {"Force (N)\n1\nNaN\n3\n30\nPeak;7\n", NULL, true, NULL},
        {"1\n2\n", NULL, false, ":1: numbers begin here without a heading"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_table t;
        sf_error err;
        sf_table_layout layout = measured;
        layout.heading = cases[k].heading;
        layout.heading_option = "--heading";
        layout.counted = cases[k].counted;
        layout.unit[0] = cases[k].counted ? 1e-3 : 0;
        read_text(*state, cases[k].text, &layout, &t, &err);
        bool fault = cases[k].expected != NULL;
        if (fault ? err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].expected) : err.status != SF_OK)
            fail_msg("%zu: status %d: %s", k, err.status, err.text);
        if (fault)
            continue;
        if (fabs(t.value[0][t.count - 1] - 3e-3) > 1e-15 || t.value[1][t.count - 1] != 30)
            fail_msg("%zu: (%g, %g)", k, t.value[0][t.count - 1], t.value[1][t.count - 1]);
        sf_table_free(&t);
    }
}

/* No remark may hide data. */
static void what_looks_like_a_remark_is_refused_before_data(void **state) {
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"Time (s),Force (N)\n1,2\nPeak,3\n3,4\n", ":3: time \"Peak\" is not a number"},
        {"Time (s),Force (N)\n1,2\n2,x\n", ":3: force \"x\" is not a number"},
        {"Time (s);Force (N)\n1,5;0.123,4\n", ":2: force \"0.123,4\" is not a number"},
        {"Time (s);Force (N)\n1;2\n2;1,017\n", "could hold a decimal comma or a mark of thousands"},
        {"Test object number :1\nUnit :N\nSampling interval :1E-3\nNumber of samples :3\n1\n2\n",
         "3 samples; it holds 2 samples"},
        {"Test object number :1\nSampling interval :1E-3\nNumber of samples :1\n1\n", "the unit \"\""},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_table t;
        sf_error err;
        read_text(*state, cases[k].text, &measured, &t, &err);
        if (err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].part))
            fail_msg("%zu: status %d, expected \"%s\": %s", k, err.status, cases[k].part, err.text);
    }
}

static void text_in_utf16_is_read(void **state) {
    const program_place *p = *state;
    static const char text[] = "Time (s);Force (N)\n1.5;2\n";
    char bytes[2 * sizeof text + 2];
    for (int big = 0; big < 2; big++) {
        sf_table t;
        sf_error err = SF_ERROR_INIT;
        size_t size = 2;
        memcpy(bytes, big ? "\xFE\xFF" : "\xFF\xFE", 2);
        for (const char *c = text; *c; c++) {
            bytes[size + (size_t)big] = *c;
            bytes[size + !big] = 0;
            size += 2;
        }
        program_write_file(program_path(p, "wide.csv"), bytes, size);
        assert_int_equal(sf_table_read(program_path(p, "wide.csv"), &measured, &t, &err), SF_OK);
        assert_true(t.count == 1 && t.value[0][0] == 1.5 && t.value[1][0] == 2);
        sf_table_free(&t);
    }
}

static void broken_utf16_is_refused(void **state) {
    const program_place *p = *state;
    static const char bytes[] = "\xFF\xFEt\0_\0s\0\xD8";
    const char *path = program_path(p, "wide.csv");
    sf_table table;
    sf_error err = SF_ERROR_INIT;
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fwrite(bytes, 1, sizeof bytes - 1, file);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(sf_table_read(path, &strict, &table, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "begins like UTF-16, but is not"));
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
        cmocka_unit_test(rows_of_measured_tables_may_be_short),
        cmocka_unit_test(laboratory_tables_are_read_and_told),
        cmocka_unit_test(ambiguous_tables_are_refused),
        cmocka_unit_test(column_can_be_chosen),
        cmocka_unit_test(exports_of_laboratories_are_read),
        cmocka_unit_test(parts_are_chosen_and_listed),
        cmocka_unit_test(what_a_file_does_not_say_can_be_given),
        cmocka_unit_test(what_looks_like_a_remark_is_refused_before_data),
        cmocka_unit_test(text_in_utf16_is_read),
        cmocka_unit_test(broken_utf16_is_refused),
        cmocka_unit_test(what_is_no_plain_file_is_refused),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
