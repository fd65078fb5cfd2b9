/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Several models of one fit file, of which one fails, and predicted drops, of which one fails: both are
 * marked with their sentences, and the others go on. */
#include "fit_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* A coarse 70 mm drop; `between.cfg` is slower, `cut.cfg` ends before its peak. */
static void put_cases(const program_place *place) {
    fit_fixture_put_case(place);
    program_shell(place, "sed 's/4.5 m/4.2 m/' case.cfg > between.cfg && "
                         "sed 's/\"40 ms\"/\"4 ms\"/' case.cfg > cut.cfg");
}

#define MATERIAL "material = \"start.cfg\";\n"
#define MEASURED "drops = ( { name = \"slow\"; case = \"case.cfg\"; a_max_g = 50.0; HIC = 180.0; } );\n"
#define PREDICTED                                                                                            \
    "predict = ( { name = \"cut\"; case = \"cut.cfg\"; }, { name = \"between\"; case = \"between.cfg\"; } "  \
    ");\n"
/* Far too soft: the missile goes through the pad. */
#define SOFT                                                                                                 \
    "{ curve = \"gas\"; start: { s0 = \"0.2 kPa\"; p0 = \"0.3 kPa\"; B = \"0.1 kPa\"; }; unknown = ( { "     \
    "name = \"p0\"; prior_sd = 0.01; } ); }"
#define GOOD "{ curve = \"gas\"; unknown = ( { name = \"p0\"; }, { name = \"B\"; } ); }"

static void failures_are_marked_and_the_rest_goes_on(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    put_cases(&place);
    program_write_text(&place, "fit.cfg", MATERIAL MEASURED PREDICTED "forms = ( " SOFT ", " GOOD " );\n");
    program_result run = program_run(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_int_equal(run.code, 0);
    assert_non_null(strstr(run.out, "model 1 of 2 FAILED"));
    assert_non_null(strstr(run.err, "has no weight: "));
    program_bytes json = program_read_file(program_path(&place, "out/fit.json"));
    const char *failure = strstr(json.data, "\"failure\": \"deceleration");
    failure =
        failure ? failure : strstr(json.data, "\"failure\": \"do not use: deceleration left at the end");
    assert_non_null(failure); /* of the drop that was cut */
    const char *failed = strstr(json.data, "\"failed_predictions\":");
    assert_true(failed && strstr(failed, "\"drop\": \"cut\""));
    assert_non_null(strstr(json.data, "\"weight\": 0,"));
    /* No figure of its simulation, but one by the columns; the other drop has both. */
    const char *cut = strstr(json.data, "\"name\": \"cut\""),
               *between = strstr(json.data, "\"name\": \"between\"");
    assert_true(cut && between && cut < between);
    const char *figure = strstr(cut, "\"a_max_g\": ");
    double value = NAN;
    assert_true(figure && strncmp(figure, "\"a_max_g\": null", 15) == 0);
    figure = strstr(between, "\"a_max_g\": ");
    assert_true(figure && sscanf(figure, "\"a_max_g\": %lf", &value) == 1 && value > 30 && value < 60);
    const char *median = strstr(strstr(json.data, "\"predictions\":"), "\"median\": ");
    assert_true(median && sscanf(median, "\"median\": %lf", &value) == 1 && fabs(value / 50 - 1) < 0.1);
    assert_non_null(strstr(json.data, "\"share_of_draws_without_value\": 0"));
    program_assert_page(&place, "out/report.html", "a predicted drop failed");
    program_assert_page(&place, "out/report.html", "a model failed");
    free(json.data);
    program_tear_down(&place);
}

static void failure_of_all_models_is_one_of_the_command(void **state) {
    (void)state;
    program_place place;
    program_set_up(&place);
    put_cases(&place);
    program_write_text(&place, "fit.cfg", MATERIAL MEASURED "forms = ( " SOFT ", " SOFT " );\n");
    program_result run = program_run(&place, "fit", "drop fit.cfg -o out -t 1");
    assert_int_equal(run.code, 5);
    assert_non_null(strstr(run.err, "none of the 2 models was fitted; the first: "));
    program_tear_down(&place);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(failures_are_marked_and_the_rest_goes_on),
        cmocka_unit_test(failure_of_all_models_is_one_of_the_command),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
