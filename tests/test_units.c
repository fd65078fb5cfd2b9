/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/units.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
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
    assert_value(u, "2.2 pcf", SF_DENSITY, 2.2 * 0.45359237 / (0.3048 * 0.3048 * 0.3048));
    assert_value(u, "10 mph", SF_SPEED, 4.4704);
    assert_value(u, "16 oz", SF_MASS, 0.45359237);
    assert_value(u, "1 lbm", SF_MASS, 0.45359237);
    assert_value(u, "500 mil", SF_LENGTH, 0.0127);
    assert_value(u, "144 psf", SF_PRESSURE, 4.4482216152605 / (0.0254 * 0.0254));
    assert_refused(u, "16 oz", SF_FORCE, "is a mass");
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
            /* a radian is 1 */
            bool same = other == k || (k == SF_RATE && other == SF_ANGULAR_VELOCITY) ||
                        (k == SF_ANGULAR_VELOCITY && other == SF_RATE);
            assert_int_equal(status, same ? SF_OK : SF_ERR_INPUT);
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
    assert_refused(*state, "5 1/s", SF_TIME, "is a rate; expected a time");
    assert_refused(*state, "3 kg m", SF_MASS, "is measured in m.kg; expected a mass");
    assert_refused(*state, "3 mm/m", SF_LENGTH, "has no dimension; expected a length");
}

static void every_spelling_of_a_unit_is_read(void **state) {
    const sf_units *u = *state;
    assert_value(u, "35 kg/m^3", SF_DENSITY, 35.0);
    assert_value(u, "35 kg/m\xC2\xB3", SF_DENSITY, 35.0);
    assert_value(u, "35 kg m-3", SF_DENSITY, 35.0);
    assert_value(u, "35 kg.m^-3", SF_DENSITY, 35.0);
    assert_value(u, "35 kg \xC2\xB7 m\xE2\x81\xBB\xC2\xB3", SF_DENSITY, 35.0);
    assert_value(u, "2 kg/(m s)", SF_VISCOSITY, 2.0);
    assert_value(u, "2 kg / ( m * s )", SF_VISCOSITY, 2.0);
    assert_value(u, "9 1/(s)", SF_RATE, 9.0);
    assert_value(u, "9 (s/m)-2/(m2/s)", SF_RATE, 9.0); /* m2 s-2, by s m-2 */
    assert_value(u, "20 \xCE\xBCs", SF_TIME, 2e-5);
    assert_value(u, "+4.5E0m/s", SF_SPEED, 4.5);
    assert_value(u, ".5 in", SF_LENGTH, 0.0127);
    assert_value(u, "60 mm/min", SF_SPEED, 0.001);
}

static void one_number_and_one_unit_and_nothing_else(void **state) {
    static const struct {
        const char *text;
        sf_quantity kind;
        const char *part;
    } texts[] = {
        {"4.5 m/s 2", SF_SPEED, "a second number \"2\" follows"},
        {"4.5 m 3/s", SF_SPEED, "a second number \"3/s\" follows"},
        {"4.5 m/3 s", SF_SPEED, "a second number \"3 s\" follows"},
        {"4.5 m*2/s", SF_SPEED, "a second number \"2/s\" follows"},
        {"4.6 kg 1000", SF_MASS, "a second number \"1000\" follows"},
        {"4.6 kg.2", SF_MASS, "a second number \"2\" follows"},
        {"4.6 kg 1", SF_MASS, "a second number \"1\" follows"},
        {"4.6 kg (2)", SF_MASS, "a second number \"2)\" follows"},
        {"4.5 m/s)", SF_SPEED, "\")\" follows it"},
        {"4.5 (m/s", SF_SPEED, "a bracket is not closed"},
        {"4.5 ()m/s", SF_SPEED, "a unit's name is missing"},
        {"4.5 m//s", SF_SPEED, "a unit's name is missing"},
        {"4.5 m/s/", SF_SPEED, "a unit's name is missing"},
        {"4.5 m/s,", SF_SPEED, "\",\" follows it"},
        {"4.5 m/s;", SF_SPEED, "is not a unit"},
        {"4.5 m/s # fast", SF_SPEED, "is not a unit"},
        {"4.5 m/s\n", SF_SPEED, "is not a unit"},
        {"1 Hz", SF_RATE, "unknown unit \"Hz\" (softfall-pre"},
        {"1 Bq", SF_RATE, "unknown unit \"Bq\" (softfall-pre"},
        {"1 rpm", SF_RATE, "unknown unit \"rpm\" (softfall-pre"},
        {"5 Mm", SF_LENGTH, "unknown unit \"Mm\" (softfall-pre"},
        {"5 mPa", SF_PRESSURE, "unknown unit \"mPa\" (softfall-pre"},
        {"1 m s-1e0", SF_SPEED, "is not a unit"},
        {"1 m-11 m12", SF_LENGTH, "is not a power"},
        {"1 m9 m-8", SF_LENGTH, "is not a power"},
        {"1 m^", SF_LENGTH, "is not a power"},
        {"1 m0", SF_LENGTH, "is not a power"},
        {"1 ((((((m))))))", SF_LENGTH, "nested too deep"},
        {"1 m m m m m m m m m m", SF_LENGTH, "too many factors"},
        {"1 ((m4)4)4", SF_LENGTH, "the power of \"m\" is too large"},
        {"0x10 m", SF_LENGTH, "does not begin with a number"},
        {"- 5 m", SF_LENGTH, "does not begin with a number"},
        {". m", SF_LENGTH, "does not begin with a number"},
        {"1 m\xC2", SF_LENGTH, "is not a unit"},
    };
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
        assert_refused(*state, texts[k].text, texts[k].kind, texts[k].part);
}

/* Every name of the table is one that the database has, and a unit of its kind. */
static void every_name_of_the_table_is_a_unit(void **state) {
    static const struct {
        const char *kind;
        sf_quantity quantity;
    } kinds[] = {{"length", SF_LENGTH},       {"mass", SF_MASS},           {"time", SF_TIME},
                 {"force", SF_FORCE},         {"pressure", SF_PRESSURE},   {"density", SF_DENSITY},
                 {"speed", SF_SPEED},         {"voltage", SF_VOLTAGE},     {"temperature", SF_TEMPERATURE},
                 {"energy", SF_MOLAR_ENERGY}, {"amount", SF_MOLAR_ENERGY}, {"angle", SF_ANGULAR_VELOCITY}};
    char *table = NULL, *rest, kind[16] = "";
    size_t size = 0;
    int names = 0;
    FILE *file = open_memstream(&table, &size);
    sf_unit_text_print(file);
    fclose(file);
    rest = table;
    for (char *line = strsep(&rest, "\n"); line; line = strsep(&rest, "\n"))
        for (char *name = strchr(line, '`'); name && sscanf(line, "| %15s", kind) == 1;
             name = strchr(name + strcspn(name + 1, "`") + 2, '`')) {
            char text[64];
            size_t k = 0;
            double value = 0;
            sf_error err = SF_ERROR_INIT;
            while (k + 1 < sizeof kinds / sizeof *kinds && strcmp(kinds[k].kind, kind) != 0)
                k++;
            bool amount = strcmp(kinds[k].kind, "amount") == 0;
            snprintf(text, sizeof text, "1 %s%.*s%s", amount ? "J/" : "", (int)strcspn(name + 1, "`"),
                     name + 1,
                     kinds[k].quantity == SF_ANGULAR_VELOCITY          ? "/s"
                     : kinds[k].quantity == SF_MOLAR_ENERGY && !amount ? "/mol"
                                                                       : "");
            if (sf_units_parse(*state, text, kinds[k].quantity, &value, &err) != SF_OK || !(value > 0))
                fail_msg("%s: %s", text, err.text);
            names++;
        }
    assert_true(names > 50);
    free(table);
}

static void unreadable_quantities_are_refused(void **state) {
    const sf_units *u = *state;
    assert_refused(u, "4.5", SF_SPEED, "\"4.5\" has no unit; expected a speed");
    assert_refused(u, "", SF_SPEED, "does not begin with a number");
    assert_refused(u, "fast", SF_SPEED, "does not begin with a number");
    assert_refused(u, "4.5 furlongz", SF_SPEED, "\"furlongz\" is not a unit");
    assert_refused(u, "4,5 m/s", SF_SPEED, "has a decimal comma; write a decimal point");
    assert_refused(u, "3 4 m", SF_LENGTH, "\"4 m\" is not a unit: a second number");
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
        cmocka_unit_test(every_spelling_of_a_unit_is_read),
        cmocka_unit_test(one_number_and_one_unit_and_nothing_else),
        cmocka_unit_test(every_name_of_the_table_is_a_unit),
        cmocka_unit_test(unreadable_quantities_are_refused),
    };
    return cmocka_run_group_tests(tests, open_units, close_units);
}
