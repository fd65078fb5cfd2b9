/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of a report: what each writer makes of a value of every type, and of one that is not defined. */
#include "report/row.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <cmocka.h>

typedef struct drop {
    double peak;     /* m/s2 */
    double fraction; /* of 1 */
    int64_t rows;
    int layers;
    bool free;
    char status[24];
    const char *file;
} drop;

static sf_value doubled(const void *record) {
    return sf_value_real(2 * ((const drop *)record)->peak);
}

static const sf_row declared[] = {
    {.key = "peak_g",
     .name = "peak",
     .unit = "g",
     .format = "%.1f",
     .factor = 0.1,
     SF_ROW_OF(NUMBER, drop, peak)},
    {.key = "fraction", .name = "share", .unit = "%", .shown = 100, SF_ROW_OF(NUMBER, drop, fraction)},
    {.key = "rows", .name = "rows", SF_ROW_OF(COUNT, drop, rows)},
    {.key = "layers", SF_ROW_OF(INTEGER, drop, layers)},
    {.key = "free", .name = "free", SF_ROW_OF(FLAG, drop, free)},
    {.key = "status", .name = "status", SF_ROW_OF(TEXT, drop, status)},
    {.key = "file", SF_ROW_OF(STRING, drop, file)},
    {.key = "double_peak", .value = doubled},
    {.name = "shown <only>", .meaning = "a hint", SF_ROW_OF(NUMBER, drop, peak)},
};

static const drop defined = {1234.5, 0.25, 7, 2, true, "a,\"b\"", "x.csv"};
static const drop undefined = {NAN, INFINITY, -1, -1, false, "", NULL};

/* Collects what a writer puts into a stream. */
typedef struct page {
    char *text;
    size_t size;
    FILE *out;
} page;

static FILE *open_page(page *p) {
    *p = (page){0};
    p->out = open_memstream(&p->text, &p->size);
    assert_non_null(p->out);
    return p->out;
}

static void assert_page(page *p, const char *expected) {
    fclose(p->out);
    assert_string_equal(p->text, expected);
    free(p->text);
}

static void json_has_every_key_and_null_where_undefined(void **state) {
    (void)state;
    page p;
    sf_json json = {.file = open_page(&p)};
    const drop both[] = {defined, undefined};
    sf_json_open(&json, NULL, '{');
    sf_rows_json_array(&json, "drops", SF_ROWS(declared), (sf_records){both, sizeof both[0], 2});
    sf_json_close(&json);
    assert_page(&p, "{\n  \"drops\": [\n    {\n      \"peak_g\": 123.45,\n      \"fraction\": 0.25,\n"
                    "      \"rows\": 7,\n      \"layers\": 2,\n      \"free\": true,\n"
                    "      \"status\": \"a,\\\"b\\\"\",\n      \"file\": \"x.csv\",\n"
                    "      \"double_peak\": 2469\n    },\n    {\n      \"peak_g\": null,\n"
                    "      \"fraction\": null,\n      \"rows\": null,\n      \"layers\": null,\n"
                    "      \"free\": false,\n      \"status\": null,\n      \"file\": null,\n"
                    "      \"double_peak\": null\n    }\n  ]\n}\n");
}

static void text_lines_have_units_of_defined_values_only(void **state) {
    (void)state;
    page p;
    FILE *out = open_page(&p);
    for (int k = 0; k < 3; k++)
        sf_row_text(out, &declared[k], &defined);
    for (int k = 0; k < 2; k++)
        sf_row_text(out, &declared[k], &undefined);
    assert_page(&p, "  peak                            123.5 g\n  share                              25 %\n"
                    "  rows                                7\n  peak                                -\n"
                    "  share                               -\n");
}

static void text_tables_align_by_characters(void **state) {
    (void)state;
    page p;
    static const sf_row rows[] = {{.name = "status", SF_ROW_OF(TEXT, drop, status)},
                                  {.name = "area", .unit = "cm²", SF_ROW_OF(NUMBER, drop, peak)}};
    const drop both[] = {defined, undefined};
    sf_rows_text_table(open_page(&p), SF_ROWS(rows), (sf_records){both, sizeof both[0], 2});
    assert_page(&p, "  status  area (cm²)\n  a,\"b\"         1234\n  -                -\n");
}

static void numbers_are_those_of_the_key(void **state) {
    (void)state;
    assert_float_equal(sf_row_number(&declared[0], &defined), 123.45, 1e-12);
    assert_float_equal(sf_row_number(&declared[1], &defined), 0.25, 0);
    assert_float_equal(sf_row_number(&declared[4], &defined), 1, 0);
    assert_true(isnan(sf_row_number(&declared[5], &defined)));
    assert_true(isnan(sf_row_number(&declared[2], &undefined)));
    assert_true(sf_row_is_defined(&declared[4], &undefined));
    assert_false(sf_row_is_defined(&declared[6], &undefined));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_has_every_key_and_null_where_undefined),
        cmocka_unit_test(text_lines_have_units_of_defined_values_only),
        cmocka_unit_test(text_tables_align_by_characters),
        cmocka_unit_test(numbers_are_those_of_the_key),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
