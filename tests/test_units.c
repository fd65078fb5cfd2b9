/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/units.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

static int open_units(void **state) {
    sf_error err = SF_ERROR_INIT;
    return sf_units_open((sf_units **)state, &err) != SF_OK;
}

static int close_units(void **state) {
    sf_units_close((sf_units **)state);
    return 0;
}

static void assert_value(const sf_units *units, const char *text, sf_quantity kind, double expected) {
    sf_error err = SF_ERROR_INIT;
    double value = -1.0;
    if (sf_units_parse(units, text, kind, &value, &err) != SF_OK)
        fail_msg("%s", err.text);
    double scale = expected < 0.0 ? -expected : expected;
    if (!(value - expected <= 1e-14 * scale && expected - value <= 1e-14 * scale))
        fail_msg("%s gives %.17g, not %.17g", text, value, expected);
}

static void assert_refused(const sf_units *units, const char *text, sf_quantity kind, const char *part) {
    sf_error err = SF_ERROR_INIT;
    double value = -1.0;
    assert_int_equal(sf_units_parse(units, text, kind, &value, &err), SF_ERR_INPUT);
    if (!strstr(err.text, part))
        fail_msg("\"%s\": the sentence is '%s' and lacks '%s'", text, err.text, part);
}

static void quantities_become_si(void **state) {
    const sf_units *u = *state;
    assert_value(u, "4.5 m/s", SF_SPEED, 4.5);
    assert_value(u, "18 km/h", SF_SPEED, 5.0);
    assert_value(u, "0.4136 MPa", SF_PRESSURE, 413600.0);
    assert_value(u, "3.43e6 Pa", SF_PRESSURE, 3.43e6);
    assert_value(u, "0.5 N/mm2", SF_PRESSURE, 5e5);
    assert_value(u, "160 mm", SF_LENGTH, 0.16);
    assert_value(u, "160mm", SF_LENGTH, 0.16);
    assert_value(u, "  160  mm  ", SF_LENGTH, 0.16);
    assert_value(u, "35 kg/m3", SF_DENSITY, 35.0);
    assert_value(u, "4.29e-3 g/mm3", SF_DENSITY, 4290.0);
    assert_value(u, "5000 1/s", SF_RATE, 5000.0);
    assert_value(u, "5 s-1", SF_RATE, 5.0);
    assert_value(u, "690 Pa s", SF_VISCOSITY, 690.0);
    assert_value(u, "40 ms", SF_TIME, 0.04);
    assert_value(u, "20 us", SF_TIME, 2e-5);
    assert_value(u, "20 \xC2\xB5s", SF_TIME, 2e-5);
    assert_value(u, "9.80665 m/s2", SF_ACCELERATION, 9.80665);
    assert_value(u, "-3 mm", SF_LENGTH, -0.003);
}

static void every_example_is_of_its_kind(void **state) {
    for (int k = 0; k < SF_QUANTITY_COUNT; k++) {
        sf_error err = SF_ERROR_INIT;
        double value = 0.0;
        assert_int_equal(
            sf_units_parse(*state, sf_quantity_example((sf_quantity)k), (sf_quantity)k, &value, &err), SF_OK);
        assert_true(value > 0.0);
        for (int other = 0; other < SF_QUANTITY_COUNT; other++) {
            sf_error refusal = SF_ERROR_INIT;
            sf_status status = sf_units_parse(*state, sf_quantity_example((sf_quantity)k), (sf_quantity)other,
                                              &value, &refusal);
            assert_int_equal(status, other == k ? SF_OK : SF_ERR_INPUT);
        }
    }
}

static void g_is_the_gram(void **state) {
    assert_value(*state, "4600 g", SF_MASS, 4.6);
    assert_refused(*state, "5 g", SF_ACCELERATION, "\"5 g\" is a mass; expected an acceleration");
    assert_refused(*state, "5 g", SF_ACCELERATION, "g is the gram; standard gravity is 9.80665 m/s2");
}

static void wrong_kinds_say_what_was_found(void **state) {
    assert_refused(*state, "4.6 kg", SF_SPEED,
                   "\"4.6 kg\" is a mass; expected a speed, for example \"4.5 m/s\"");
    assert_refused(*state, "5 s", SF_RATE, "is a time; expected a rate");
    assert_refused(*state, "5 Hz", SF_TIME, "is a rate; expected a time");
    assert_refused(*state, "3 A", SF_MASS, "is measured in A; expected a mass");
    assert_refused(*state, "3 radian", SF_LENGTH, "has no dimension; expected a length");
}

static void unreadable_quantities_are_refused(void **state) {
    const sf_units *u = *state;
    assert_refused(u, "4.5", SF_SPEED, "\"4.5\" has no unit; expected a speed");
    assert_refused(u, "", SF_SPEED, "does not begin with a number");
    assert_refused(u, "fast", SF_SPEED, "does not begin with a number");
    assert_refused(u, "4.5 furlongz", SF_SPEED, "\"furlongz\" is not a unit");
    assert_refused(u, "4,5 m/s", SF_SPEED, "is not a unit");
    assert_refused(u, "3 4 m", SF_LENGTH, "\"4 m\" is not a unit");
    assert_refused(u, "3 m @ 5", SF_LENGTH, "is not a unit");
    assert_refused(u, "nan m", SF_LENGTH, "is not finite");
    assert_refused(u, "1e400 m", SF_LENGTH, "is not finite");
    assert_refused(u, "1e308 km", SF_LENGTH, "no finite value");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantities_become_si),
        cmocka_unit_test(every_example_is_of_its_kind),
        cmocka_unit_test(g_is_the_gram),
        cmocka_unit_test(wrong_kinds_say_what_was_found),
        cmocka_unit_test(unreadable_quantities_are_refused),
    };
    return cmocka_run_group_tests(tests, open_units, close_units);
}
