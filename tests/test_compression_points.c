/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What softfall-fit takes from the points of a compression test (study/fit/compression/compression_test.c):
 * one cycle, without rests, from the zero of strain on. The points follow a law that is known. */
#include "extreme.h"
#include "program_fixture.h"
#include "post_check.h"

#include "study/fit/compression/compression_test.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

enum { TEXT = 65536 };

typedef struct sheet {
    char text[TEXT];
    size_t used;
} sheet;

/* kPa */
static double law(double strain) {
    return 100 * (1 - exp(-strain / 0.03)) + 400 * pow(strain, 6);
}

static void put(sheet *s, double strain, double stress) {
    s->used += (size_t)snprintf(s->text + s->used, TEXT - s->used, "%.6f,%.6f\n", strain, stress);
}

static void begin(sheet *s) {
    s->used = (size_t)snprintf(s->text, TEXT, "strain,stress_kPa\n");
}

/* From one strain to another in steps of 0.005, the first left out. */
static void load(sheet *s, double from, double to) {
    int steps = (int)lround(fabs(to - from) / 0.005);
    for (int k = 1; k <= steps; k++) {
        double strain = from + (to - from) * k / steps;
        put(s, strain, (to > from ? 1 : 0.5) * law(strain));
    }
}

static void read_sheet(const program_place *p, const sheet *s, sf_compression_source source,
                       sf_compression_test *test, sf_error *err) {
    *err = (sf_error)SF_ERROR_INIT;
    source.path = program_write_text(p, "test.csv", s->text);
    source.rate = 0.1;
    sf_compression_test_read(&source, test, err);
}

static void read_good(const program_place *p, const sheet *s, sf_compression_source source,
                      sf_compression_test *test) {
    sf_error err;
    read_sheet(p, s, source, test, &err);
    if (err.status != SF_OK)
        fail_msg("%s", err.text);
}

/* Largest distance of the loading from the law, over the law. */
static double off_law(const sf_compression_test *t) {
    double off = 0;
    for (int i = 1; i < t->loading; i++)
        off = larger(off, fabs(1e-3 * t->stress[i] / law(t->strain[i]) - 1));
    return off;
}

static void one_cycle_is_taken(void **state) {
    sheet s;
    sf_compression_test t;
    sf_error err;
    begin(&s);
    load(&s, 0, 0.4);
    load(&s, 0.4, 0.05);
    load(&s, 0.05, 0.6);
    load(&s, 0.6, 0.0);
    read_good(*state, &s, (sf_compression_source){0}, &t);
    assert_true(t.cycle == 1 && t.cycles == 2 && t.loading == 80);
    assert_close(t.largest_strain, 0.4, 1e-9);
    assert_close(off_law(&t), 0, 1e-3);
    assert_non_null(strstr(t.interpretation, "cycle 1 of 2"));
    sf_compression_test_free(&t);
    read_good(*state, &s, (sf_compression_source){.cycle = "2"}, &t);
    assert_close(t.largest_strain, 0.6, 1e-9);
    assert_close(t.strain[t.count - 1], 0, 1e-9);
    assert_non_null(strstr(t.interpretation, "cycle 2 of 2"));
    sf_compression_test_free(&t);
    read_sheet(*state, &s, (sf_compression_source){.cycle = "3"}, &t, &err);
    assert_non_null(strstr(err.text, "cycle 3 was asked for; the strain has 2"));
}

/* At 30 % and at the turn the machine stops: the stress relaxes by a tenth, and comes back over 2 % strain.
 */
static void rests_are_left_out(void **state) {
    sheet s;
    sf_compression_test t;
    begin(&s);
    load(&s, 0, 0.3);
    for (int k = 1; k <= 20; k++)
        put(&s, 0.3, law(0.3) * (1 - 0.1 * k / 20));
    for (int k = 1; k <= 10; k++)
        put(&s, 0.3 + 0.002 * k, law(0.3 + 0.002 * k) * (0.9 + 0.01 * (k - 0.5)));
    load(&s, 0.32, 0.6);
    for (int k = 1; k <= 20; k++)
        put(&s, 0.6, law(0.6) * (1 - 0.1 * k / 20));
    load(&s, 0.6, 0);
    read_good(*state, &s, (sf_compression_source){0}, &t);
    assert_close(off_law(&t), 0, 1e-3);
    assert_int_equal(t.loading, 60 + 56);
    assert_int_equal(t.count - t.loading, 120);
    assert_non_null(strstr(t.interpretation, "of a rest under strain"));
    sf_compression_test_free(&t);
}

/* The machine counts from a load that stands for 0.4 % strain. */
static void preload_is_told_and_taken_away(void **state) {
    sheet s;
    sf_compression_test t;
    begin(&s);
    for (int k = 0; k <= 300; k++)
        put(&s, 0.002 * k, law(0.004 + 0.002 * k));
    read_good(*state, &s, (sf_compression_source){0}, &t);
    assert_true(t.preload > 0.0035 && t.preload < 0.0055);
    assert_close(t.strain[0], 0, 0);
    assert_non_null(strstr(t.interpretation, "begins under a load"));
    sf_compression_test_free(&t);
    read_good(*state, &s, (sf_compression_source){.toe = true}, &t);
    assert_true(t.strain[0] > 0.0035 && t.strain[0] < 0.0055);
    assert_non_null(strstr(t.interpretation, "added that a preload had hidden"));
    sf_compression_test_free(&t);
    begin(&s); /* the same foam without a preload */
    load(&s, 0, 0.6);
    read_good(*state, &s, (sf_compression_source){0}, &t);
    assert_close(t.preload, 0, 0);
    sf_compression_test_free(&t);
}

/* A crosshead that comes down from 120 mm on a specimen of 50 mm and 25 cm2. */
static void crosshead_counts_from_a_contact_force(void **state) {
    sheet s;
    sf_compression_test t;
    sf_error err;
    const double thickness = 50, area = 25e-4;
    sf_compression_source source = {.area = area, .thickness = 0.05, .invert = SF_INVERT_STRAIN};
    s.used = (size_t)snprintf(s.text, TEXT, "displacement_mm,force_N\n");
    for (double strain = -1.4; strain < 0.6; strain += 0.005)
        put(&s, 50 - thickness * strain, strain > 0 ? 1e3 * area * law(strain) : 0.01);
    for (double strain = 0.6; strain > -1; strain -= 0.005)
        put(&s, 50 - thickness * strain, strain > 0 ? 5e2 * area * law(strain) : 0);
    read_sheet(*state, &s, source, &t, &err);
    assert_int_equal(err.status, SF_ERR_INPUT);
    source.contact_force = 0.5;
    read_good(*state, &s, source, &t);
    assert_close(t.largest_strain, 0.6, 0.006);
    assert_true(off_law(&t) < 0.01 && t.strain[0] < 0.006);
    assert_true(t.strain[t.count - 1] < 0.01 && t.count - t.loading > 100);
    assert_non_null(strstr(t.interpretation, "zero at a force of 0.5 N"));
    sf_compression_test_free(&t);
    source.contact_force = 1e6;
    read_sheet(*state, &s, source, &t, &err);
    assert_non_null(strstr(err.text, "the force does not rise to 1e+06 N"));
}

/* A turn that stands twice, and a specimen that sticks to the platen. */
static void ends_of_branches_are_read_as_they_come(void **state) {
    sheet s;
    sf_compression_test t;
    sf_error err;
    begin(&s);
    load(&s, 0, 0.6);
    put(&s, 0.6, 0.7 * law(0.6));
    load(&s, 0.6, 0.05);
    put(&s, 0.04, -0.03 * law(0.6));
    read_good(*state, &s, (sf_compression_source){0}, &t);
    assert_int_equal(t.loading, 120);
    assert_int_equal(t.count - t.loading, 112);
    assert_int_equal(t.tension, 1);
    assert_true(t.stress[t.count - 1] > -0.011 * t.largest_stress);
    sf_compression_test_free(&t);
    put(&s, 0.03, -0.2 * law(0.6));
    read_sheet(*state, &s, (sf_compression_source){0}, &t, &err);
    assert_non_null(strstr(err.text, "is negative, beyond the scatter about zero"));
}

/* LEAP's confined third cycle would have an ALPHA below 0.1, which no material has: the fit ends at that
 * bound, and writes its material. */
static void an_unloading_at_the_bound_of_ALPHA_is_fitted(void **state) {
    const program_place *p = *state;
    program_shell(p, "cp \"$SF_SOURCE_DIR\"/examples/data/leap_confined_cycle3.csv .");
    program_write_text(p, "fit.cfg",
                       "name = \"foam\"; density = \"105 kg/m3\"; E_range = 0.1;\n"
                       "tests = ( { file = \"leap_confined_cycle3.csv\"; rate = \"0.01 1/s\"; } );\n");
    program_succeed(p, "fit", "compression fit.cfg -o out");
    assert_true(program_file_number(p, "out/fit.json", "unloading_rms_of_largest") < 0.015);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_cycle_is_taken),
        cmocka_unit_test(rests_are_left_out),
        cmocka_unit_test(preload_is_told_and_taken_away),
        cmocka_unit_test(crosshead_counts_from_a_contact_force),
        cmocka_unit_test(ends_of_branches_are_read_as_they_come),
        cmocka_unit_test(an_unloading_at_the_bound_of_ALPHA_is_fitted),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
