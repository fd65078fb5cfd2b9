/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of two columns (io/table_csv.h). The sentences of its users: test_case_refusals, test_compare,
 * `softfall cfh`; the files of laboratories, which softfall read makes such tables of:
 * tests/python/test_laboratory.py. */
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

static const sf_table_layout thing = {.what = "thing",
                                      .kind = "compression",
                                      .column = {&sf_column_displacement, &sf_column_force},
                                      .check = check};

static void read_text(const program_place *p, const char *text, const sf_table_layout *layout,
                      sf_table *table, sf_error *err) {
    *err = (sf_error)SF_ERROR_INIT;
    sf_table_read(program_write_text(p, "table.csv", text), layout, table, err);
}

static void columns_are_found_by_name_and_scaled(void **state) {
    sf_table table;
    sf_error err;
    read_text(
        *state,
        "\xEF\xBB\xBF# one\n\n \"force_N\" , other,displacement_mm\r\n 3,x,1000\r\n # two\n,,\n\"4\",,2e3,",
        &thing, &table, &err);
    assert_string_equal(err.text, "");
    assert_int_equal(table.count, 2);
    assert_true(table.value[0][0] == 1 && table.value[0][1] == 2);
    assert_true(table.value[1][0] == 3 && table.value[1][1] == 4);
    assert_int_equal(table.line[0], 4);
    assert_int_equal(table.line[1], 7);
    assert_true(table.scale[0] == 1e-3 && table.scale[1] == 1);
    assert_string_equal(table.interpretation, "displacement in mm, force in N");
    sf_table_free(&table);
    assert_null(table.value[0]);
}

static void headings_have_their_units(void **state) {
    static const struct {
        const char *heading;
        double scale[2];
    } cases[] = {
        {"displacement_m,force_kN", {1, 1e3}},
        {"Displacement (mm),Force [N]", {1e-3, 1}},
        {"DISPLACEMENT [in],force (lbf)", {0.0254, 4.4482216152605}},
        {"displacement_um,force_N", {1e-6, 1}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[128];
        sf_table table;
        sf_error err;
        snprintf(text, sizeof text, "%s\n1,1\n", cases[k].heading);
        read_text(*state, text, &thing, &table, &err);
        assert_string_equal(err.text, "");
        for (int c = 0; c < 2; c++)
            assert_true(fabs(table.value[c][0] / cases[k].scale[c] - 1) < 1e-14);
        sf_table_free(&table);
    }
}

static void faults_are_named_with_line_and_cell(void **state) {
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"force_N\n1\n",
         "table.csv:1: the heading has no column of displacement, such as displacement_mm; it has \"force_N\""},
        {"displacement_m,displacement_mm,force_N\n",
         ":1: two displacement columns (\"displacement_m\" and \"displacement_mm\")"},
        {"displacement_m,force_N\n1\n", ":2: 1 values where the heading has 2 columns: softfall read"},
        {"displacement_m,force_N\n1,2,3\n", ":2: 3 values where the heading has 2 columns"},
        {"displacement_m,force_N\n1,2\n#\n1.5.1,2\n", ":4: displacement \"1.5.1\" is not a finite number"},
        {"displacement_m,force_N\n1,\n", ":2: force \"\" is not a finite number"},
        {"displacement_m,force_N\n1,inf\n", ":2: force \"inf\" is not a finite"},
        {"force_N,displacement_mm\n1,2\n1,2\n", ":3: 2 after 2"},
        {"displacement_m;force_N\n1;2\n", "table.csv --kind compression -o clean.csv reads other forms"},
        {"displacement_m\tforce_N\n1\t2\n", "table.csv --kind compression -o clean.csv reads other forms"},
        {"1,2\n3,4\n",
         ":1: the heading has no column of displacement, such as displacement_mm; it has \"1\", \"2\""},
        {"Lateral displacement (mm),Force (N)\n1,2\n", "no column of displacement"},
        {"Displacement,Force\nmm,N\n1,2\n", "no column of displacement"},
        {"Displacement (N),Force (mm)\n1,2\n", "no column of displacement"},
        {"displacement_mm,force_N\n\"1,5\",2\n", ":2: 3 values where the heading has 2 columns"},
        {"# only a comment\n", "table.csv is empty: it needs a heading and rows of numbers"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_table table;
        sf_error err;
        read_text(*state, cases[k].text, &thing, &table, &err);
        if (err.status != SF_ERR_INPUT || !strstr(err.text, cases[k].part))
            fail_msg("%zu: status %d, expected \"%s\": %s", k, err.status, cases[k].part, err.text);
        assert_true(table.count == 0 && !table.value[0] && !table.line);
    }
}

static void rows_of_measured_tables_may_be_short(void **state) {
    sf_table_layout loose = thing;
    sf_table table;
    sf_error err;
    loose.ragged = true;
    read_text(*state, "displacement_m,force_N,c\n1,2\n3,4,5,,\n,,\n", &loose, &table, &err);
    assert_int_equal(err.status, SF_OK);
    assert_int_equal(table.count, 2);
    assert_true(table.value[0][1] == 3 && table.value[1][1] == 4);
    sf_table_free(&table);
    read_text(*state, "displacement_m,force_N\n1\n", &loose, &table, &err);
    assert_non_null(strstr(err.text, ":2: 1 values"));
    read_text(*state, "displacement_m,force_N\n1,5,2,5\n", &loose, &table,
              &err); /* 1.5 and 2.5, not 1 and 5 */
    assert_non_null(strstr(err.text, ":2: 4 values where the heading has 2 columns"));
    read_text(*state, "displacement_m,force_N,c,d\n\"1,5\",2,3\n", &loose, &table, &err);
    assert_non_null(strstr(err.text, ":2: displacement \"\"1\" is not a finite number"));
}

static void a_column_is_chosen_by_its_heading(void **state) {
    static const char text[] = "displacement_m,Force 1 (N),Force 2 (kN),force_3_N\n1,2,3,4\n";
    static const struct {
        const char *chosen;
        double value;
    } cases[] = {{"Force 1", 2}, {"Force 2 (kN)", 3000}, {"force_3", 4}, {"force_3_N", 4}, {"Force 4", 0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_table_layout chosen = thing;
        sf_table table;
        sf_error err;
        chosen.chosen = cases[k].chosen;
        read_text(*state, text, &chosen, &table, &err);
        if (cases[k].value == 0)
            assert_non_null(strstr(err.text, "no column of force called Force 4, such as force_N"));
        else
            assert_true(table.value[1][0] == cases[k].value);
        sf_table_free(&table);
    }
    sf_table_layout layout = thing;
    sf_table table;
    sf_error err;
    layout.choice = "--force";
    read_text(*state, "displacement_m,force_N,force_kN\n1,2,3\n", &layout, &table, &err);
    assert_non_null(
        strstr(err.text, "two force columns (\"force_N\" and \"force_kN\"): name one with --force"));
    read_text(*state, "displacement_m,Cell A (N),Area (mm2),Cell B [kN]\n1,2,3,4\n", &layout, &table, &err);
    assert_non_null(
        strstr(err.text, "no column is called force: name one of \"Cell A\", \"Cell B\" with --force"));
    read_text(*state, "displacement_m,displacement_mm,force_N\n1,2,3\n", &layout, &table, &err);
    assert_non_null(strstr(err.text, "table.csv --kind compression -o clean.csv --column NAME"));
}

/* A comment can give a curve with plain headings another meaning. */
static void a_curve_with_another_title_is_refused(void **state) {
    sf_table_layout layout = {.what = "curve",
                              .kind = "compression",
                              .column = {&sf_column_strain, &sf_column_stress},
                              .means = "nominal stress over nominal strain"};
    static const struct {
        const char *title;
        bool refused;
    } cases[] = {{"True stress over true strain", true},  {"yield stress, plastic strain", true},
                 {"Yield stress: 12 kPa", false},         {"nominal, made of true stress", false},
                 {"foam of the plastics company", false}, {"stress and strain", false}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char text[128];
        sf_table table;
        sf_error err;
        snprintf(text, sizeof text, "# %s\nstrain,stress_kPa\n0,0\n", cases[k].title);
        read_text(*state, text, &layout, &table, &err);
        assert_int_equal(err.status != SF_OK, cases[k].refused);
        assert_true(!cases[k].refused || strstr(err.text, ":1: \""));
        sf_table_free(&table);
    }
}

/* The command that a refusal names can be typed, and writes another file than it reads. */
static void the_remedy_can_be_typed(void **state) {
    const program_place *p = *state;
    sf_table table;
    sf_error err = SF_ERROR_INIT;
    sf_table_read(program_write_text(p, "my test (1).csv", "a;b\n1;2\n"), &thing, &table, &err);
    assert_non_null(strstr(err.text, "softfall read '"));
    assert_non_null(strstr(err.text, "my test (1).csv' --kind compression -o clean.csv"));
    err = (sf_error)SF_ERROR_INIT;
    sf_table_read(program_write_text(p, "clean.csv", "a;b\n1;2\n"), &thing, &table, &err);
    assert_non_null(strstr(err.text, "clean.csv --kind compression -o clean2.csv"));
}

/* What softfall read says of the laboratory's file stays with the table. */
static void what_softfall_read_said_is_told(void **state) {
    sf_table_layout layout = thing;
    sf_table table;
    sf_error err;
    layout.means = "force over displacement";
    read_text(
        *state,
        "# softfall read gap.csv: displacement = 49.9 mm less \"Gap (mm)\"\ndisplacement_mm,force_N\n1,2\n",
        &layout, &table, &err);
    assert_string_equal(table.interpretation,
                        "force over displacement, columns 1 and 2, displacement in mm, force in N "
                        "(softfall read gap.csv: displacement = 49.9 mm less \"Gap (mm)\")");
    sf_table_free(&table);
}

static void the_first_layout_that_fits_is_taken(void **state) {
    const program_place *p = *state;
    const sf_table_layout layouts[] = {
        {.what = "test", .kind = "compression", .column = {&sf_column_strain, &sf_column_stress}}, thing};
    sf_table table;
    int which;
    sf_error err = SF_ERROR_INIT;
    sf_table_read_any(
        program_write_text(p, "table.csv", "strain_percent,displacement_mm,force_N,stress_MPa\n5,1,2,3\n"),
        layouts, 2, &which, &table, &err);
    assert_true(which == 0 && table.value[0][0] == 0.05 && table.value[1][0] == 3e6);
    sf_table_free(&table);
    sf_table_read_any(program_write_text(p, "table.csv", "strain,displacement_mm,force_N\n0.05,1,2\n"),
                      layouts, 2, &which, &table, &err);
    assert_true(which == 1 && table.value[0][0] == 1e-3);
    sf_table_free(&table);
}

static void what_is_no_plain_text_is_refused(void **state) {
    const program_place *p = *state;
    static const char wide[] = "\xFF\xFEt\0_\0s\0";
    sf_table table;
    sf_error err = SF_ERROR_INIT;
    program_write_file(program_path(p, "wide.csv"), wide, sizeof wide - 1);
    assert_int_equal(sf_table_read(program_path(p, "wide.csv"), &thing, &table, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "holds zero bytes: it is not a text in UTF-8: softfall read"));
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_table_read(p->folder, &thing, &table, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "is not a plain file"));
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_table_read("/no/such/table.csv", &thing, &table, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the thing /no/such/table.csv cannot be read: No such file"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_found_by_name_and_scaled),
        cmocka_unit_test(headings_have_their_units),
        cmocka_unit_test(faults_are_named_with_line_and_cell),
        cmocka_unit_test(rows_of_measured_tables_may_be_short),
        cmocka_unit_test(a_column_is_chosen_by_its_heading),
        cmocka_unit_test(a_curve_with_another_title_is_refused),
        cmocka_unit_test(the_remedy_can_be_typed),
        cmocka_unit_test(what_softfall_read_said_is_told),
        cmocka_unit_test(the_first_layout_that_fits_is_taken),
        cmocka_unit_test(what_is_no_plain_text_is_refused),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
