/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A measured record is judged before it is compared with: what laboratories' records suffer from. */
#include "extreme.h"
#include "post/figures/reference.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

enum { COUNT = 1200 };
static const double STEP = 5e-5, BEGIN = 0.02, LENGTH = 0.012, PEAK = 150;

/* A half sine of 150 g and 12 ms between rest and rest, at 20 kHz. */
static void pulse(double time[COUNT], double value[COUNT]) {
    for (int i = 0; i < COUNT; i++) {
        double x = (i * STEP - BEGIN) / LENGTH;
        time[i] = i * STEP;
        value[i] = x > 0 && x < 1 ? PEAK * sin(M_PI * x) : 0;
    }
}

static sf_record_verdict judge(double *time, double *value, int count) {
    const sf_series raw = {.count = count, .time = time, .value = value};
    sf_series curve;
    sf_record_verdict v;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_signal_filter_cfc(&raw, 1000, &curve, &err), SF_OK);
    assert_int_equal(sf_record_judge(&raw, &curve, &(sf_record_facts){0}, &v, &err), SF_OK);
    sf_series_free(&curve);
    return v;
}

static void a_clean_record_is_valid(void **state) {
    (void)state;
    double time[COUNT], value[COUNT];
    pulse(time, value);
    sf_record_verdict v = judge(time, value, COUNT);
    char line[SF_VERDICT_LINE_SIZE];
    sf_record_line(&v, line, sizeof line);
    assert_string_equal(line, "valid");
    for (int k = 0; k < SF_RECORD_CHECKS; k++)
        assert_true(isnan(v.rows[k].value) || v.rows[k].value <= 0.02);
}

/* Quantised in steps of 0.5 g: several equal samples at the top are no rail. */
static void a_coarse_converter_is_no_rail(void **state) {
    (void)state;
    double time[COUNT], value[COUNT];
    pulse(time, value);
    for (int i = 0; i < COUNT; i++)
        value[i] = 0.5 * floor(value[i] / 0.5);
    assert_int_equal(judge(time, value, COUNT).grade, SF_GRADE_VALID);
}

static void each_fault_is_found(void **state) {
    (void)state;
    double time[COUNT], value[COUNT];
    sf_record_verdict v;

    pulse(time, value);
    value[100] = 900;
    assert_int_equal(judge(time, value, COUNT).rows[SF_RECORD_spike].grade, SF_GRADE_DO_NOT_USE);
    pulse(time, value);
    value[520] = 70; /* a dropped sample in the pulse */
    assert_int_equal(judge(time, value, COUNT).rows[SF_RECORD_spike].grade, SF_GRADE_DO_NOT_USE);

    for (double rail = 0.6; rail < 0.95; rail += 0.1) {
        pulse(time, value);
        for (int i = 0; i < COUNT; i++)
            value[i] = smaller(value[i], rail * PEAK);
        v = judge(time, value, COUNT);
        assert_true(v.rows[SF_RECORD_saturation].grade > SF_GRADE_VALID);
        assert_close(v.rows[SF_RECORD_saturation].value, 1 / rail - 1,
                     0.25 * (1 / rail - 1)); /* of the true peak */
    }

    pulse(time, value);
    v = judge(time, value, 500); /* after 5 of 12 ms */
    assert_int_equal(v.rows[SF_RECORD_cut].grade, SF_GRADE_DO_NOT_USE);
    v = judge(time + 480, value + 480, COUNT - 480);
    assert_int_equal(v.rows[SF_RECORD_cut].grade, SF_GRADE_DO_NOT_USE);

    pulse(time, value);
    for (int i = 0; i < COUNT; i++)
        value[i] += 3;
    v = judge(time, value, COUNT);
    assert_int_equal(v.rows[SF_RECORD_offset].grade, SF_GRADE_REMARKS);
    assert_close(v.rows[SF_RECORD_offset].value, 3 / (PEAK + 3), 1e-4);

    pulse(time, value);
    for (int i = 0; i < COUNT; i++)
        value[i] += 10 * time[i] / time[COUNT - 1];
    assert_int_equal(judge(time, value, COUNT).rows[SF_RECORD_drift].grade, SF_GRADE_REMARKS);

    pulse(time, value);
    srand(1);
    for (int i = 0; i < COUNT; i++)
        value[i] += 20 * (rand() / (double)RAND_MAX - 0.5);
    assert_true(judge(time, value, COUNT).rows[SF_RECORD_noise].grade > SF_GRADE_VALID);

    pulse(time, value);
    for (int i = 400; i < 640; i++)
        value[i] += 60 * sin(2 * M_PI * 4000 * time[i]) * (value[i] > 0);
    assert_true(judge(time, value, COUNT).rows[SF_RECORD_ringing].grade > SF_GRADE_VALID);

    pulse(time, value);
    for (int i = 800; i < 1000; i++)
        value[i] = 60 * sin(M_PI * (i - 800) / 200.0);
    v = judge(time, value, COUNT);
    assert_int_equal(v.rows[SF_RECORD_other_impact].grade, SF_GRADE_REMARKS);
    assert_close(v.rows[SF_RECORD_other_impact].value, 0.4, 1e-3);
}

/* A record that begins at contact, as softfall's own history.csv does, has no rest before it: its first
 * samples are the foot of the pulse and tell no offset. With a rest of 2 ms they do. */
static void a_record_that_begins_at_contact_tells_no_offset(void **state) {
    (void)state;
    double time[COUNT], value[COUNT], offset;
    sf_error err = SF_ERROR_INIT;
    for (int rest = 0; rest < 2; rest++) {
        for (int i = 0; i < COUNT; i++) { /* half a sine squared: slow at first */
            double x = larger(0, (i * STEP - 2e-3 * rest) / (2 * LENGTH));
            time[i] = i * STEP;
            value[i] = 3 * rest + (x < 1 ? PEAK * pow(sin(M_PI * x), 2) : 0);
        }
        const sf_series raw = {.count = COUNT, .time = time, .value = value};
        assert_int_equal(sf_record_offset(&raw, &raw, &offset, &err), SF_OK);
        if (rest)
            assert_close(offset, 3, 1e-2);
        else
            assert_true(isnan(offset));
        assert_true(rest || isnan(judge(time, value, COUNT).rows[SF_RECORD_offset].value));
    }
}

static void a_gap_in_the_pulse_is_found(void **state) {
    (void)state;
    double time[COUNT], value[COUNT];
    int count = 0;
    pulse(time, value);
    for (int i = 0; i < COUNT; i++)
        if (i < 490 || i > 550) {
            time[count] = time[i];
            value[count++] = value[i];
        }
    const sf_series raw = {.count = count, .time = time, .value = value};
    sf_record_verdict v;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_record_judge(&raw, &raw, &(sf_record_facts){0}, &v, &err), SF_OK);
    assert_int_equal(v.rows[SF_RECORD_gap].grade, SF_GRADE_DO_NOT_USE);
}

/* ---- files ---- */

static sf_reference read_file(const char *path, sf_reference_options o, sf_status expected, sf_error *err) {
    sf_reference r = {0};
    o.path = path;
    assert_int_equal(sf_reference_read(&o, &r, err), expected);
    return r;
}

static const char *write_record(const program_place *p, double origin, double offset, int impacts) {
    FILE *f = fopen(program_path(p, "record.csv"), "w");
    assert_non_null(f);
    fputs("time_s,acceleration_g\n", f);
    for (int i = 0; i < COUNT * impacts; i++) {
        double x = (i % COUNT * STEP - BEGIN) / LENGTH, peak = PEAK / (1 + i / COUNT);
        fprintf(f, "%.6f,%.6f\n", origin + i * STEP, offset + (x > 0 && x < 1 ? peak * sin(M_PI * x) : 0));
    }
    fclose(f);
    return program_path(p, "record.csv");
}

static void clock_zero_line_and_impact_are_chosen(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_reference r =
        read_file(write_record(p, 1.7e9, 0, 1), (sf_reference_options){.cfc = 1000}, SF_OK, &err);
    assert_close(r.raw.time[0], 0, 1e-12);
    assert_close(r.origin, 1.7e9, 1);
    sf_reference_free(&r);

    r = read_file(write_record(p, 0, 3, 1), (sf_reference_options){.cfc = 1000, .zero = true}, SF_OK, &err);
    assert_close(r.offset, 3, 1e-9);
    assert_close(r.raw.value[0], 0, 1e-9);
    sf_reference_free(&r);

    const char *path = write_record(p, 0, 0, 3);
    for (int impact = 0; impact <= 3; impact++) {
        double top = 0;
        r = read_file(path, (sf_reference_options){.cfc = 1000, .impact = impact}, SF_OK, &err);
        for (int64_t i = 0; i < r.raw.count; i++)
            top = larger(top, r.raw.value[i]);
        assert_close(top, PEAK / (impact ? impact : 1), 0.01);
        assert_close(r.record.rows[SF_RECORD_other_impact].value, impact ? 0 : 0.5, 1e-3);
        if (!strstr(r.interpretation, "3 at 145.9 ms (50 g)"))
            fail_msg("%s", r.interpretation);
        sf_reference_free(&r);
    }
    read_file(path, (sf_reference_options){.cfc = 1000, .impact = 4}, SF_ERR_INPUT, &err);
    assert_non_null(strstr(err.text, "impact 4 was asked for; it has 3"));
    err = (sf_error)SF_ERROR_INIT;
    read_file(path, (sf_reference_options){.cfc = 1000, .invert = true, .invert_option = "--turn"},
              SF_ERR_INPUT, &err);
    assert_non_null(strstr(err.text, "largest magnitude is negative")); /* and no impact of its overshoot */
    err = (sf_error)SF_ERROR_INIT;
    r = read_file(path, (sf_reference_options){.cfc = 1000, .from = 0.06, .to = 0.12}, SF_OK, &err);
    assert_close(r.raw.time[0], 0.06, 1e-9);
    sf_reference_free(&r);
}

/* A ringing of 1.5 kHz sampled at 10 kHz comes out of CFC 1000 with the closed form of the class's filter,
 * run twice: interpolation before the filter took 1.6 % of the peak. */
static void the_filter_works_at_the_records_own_rate(void **state) {
    const program_place *p = *state;
    static const double rate = 1e4, frequency[] = {300, 700, 1500};
    for (int k = 0; k < 3; k++) {
        double f = frequency[k], wa = tan(M_PI * 1000 * 2.0775 / rate), x = tan(M_PI * f / rate) / wa,
               top = 0, expected = 1 / (1 + pow(x, 4));
        FILE *file = fopen(program_path(p, "ring.csv"), "w");
        sf_error err = SF_ERROR_INIT;
        assert_non_null(file);
        fputs("time_ms,acceleration_g\n", file);
        for (int i = 0; i < 2000; i++)
            fprintf(file, "%.4f,%.9f\n", 1e3 * i / rate, 100 * sin(2 * M_PI * f * i / rate + 0.3));
        fclose(file);
        sf_reference r =
            read_file(program_path(p, "ring.csv"), (sf_reference_options){.cfc = 1000}, SF_OK, &err);
        double c = 0, s = 0; /* the amplitude at that frequency, from the middle, over whole periods */
        for (int64_t i = 500; i < 1500; i++) {
            c += r.curve.value[i] * cos(2 * M_PI * f * (double)i / rate);
            s += r.curve.value[i] * sin(2 * M_PI * f * (double)i / rate);
        }
        top = hypot(c, s) / 500;
        assert_close(top / (100 * expected), 1, 1e-3);
        sf_reference_free(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_clean_record_is_valid),
        cmocka_unit_test(a_coarse_converter_is_no_rail),
        cmocka_unit_test(each_fault_is_found),
        cmocka_unit_test(a_record_that_begins_at_contact_tells_no_offset),
        cmocka_unit_test(a_gap_in_the_pulse_is_found),
        cmocka_unit_test(clock_zero_line_and_impact_are_chosen),
        cmocka_unit_test(the_filter_works_at_the_records_own_rate),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
