/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "post/figures/compare.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "post_check.h"

/* Half-sine of `peak` g and `duration` from `start` on, zero before and after, every 0.05 ms from 0 to 40 ms.
 */
static sf_series half_sine(double peak, double start, double duration) {
    sf_error err = SF_ERROR_INIT;
    sf_series curve;
    assert_int_equal(sf_series_create(801, &curve, &err), SF_OK);
    for (int64_t i = 0; i < curve.count; i++) {
        double time = (double)i * 5e-5, x = (time - start) / duration;
        curve.time[i] = time;
        curve.value[i] = x > 0 && x < 1 ? peak * sin(M_PI * x) : 0;
    }
    return curve;
}

static void write_text(char *path, const char *text) {
    const char *root = getenv("TMPDIR");
    snprintf(path, 256, "%s/softfall-compare-XXXXXX", root ? root : "/tmp");
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    FILE *file = fdopen(descriptor, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static sf_status read_text(const char *text, sf_series *curve, sf_error *err) {
    char path[256];
    write_text(path, text);
    *err = (sf_error)SF_ERROR_INIT;
    sf_reference reference;
    const sf_reference_options options = {.path = path,
                                          .column_option = "--reference-column",
                                          .filter_option = "--reference-filter ",
                                          .invert_option = "--reference-invert",
                                          .zero_option = "--reference-zero"};
    sf_status status = sf_reference_read(&options, &reference, err);
    *curve = reference.curve;
    reference.curve = (sf_series){0};
    sf_reference_free(&reference);
    unlink(path);
    return status;
}

static void identical_curves_fit_perfectly(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_fit fit;
    sf_series curve = half_sine(60, 0.01, 0.015);
    assert_int_equal(
        sf_compare_fit(&curve, &curve, &(sf_fit_of){{0.01, 0.025}, 0.25e-3, 0, true, 0}, &fit, &err), SF_OK);
    assert_int_equal(fit.count, 61);
    assert_close(fit.r2, 1, 1e-15);
    assert_close(fit.rmse_g, 0, 1e-15);
    sf_series_free(&curve);
}

/* measured = A sin, model = k A sin over whole half periods with n even intervals:
 * sum sin^2 = n/2, so RMSE^2 (n+1) = (1-k)^2 A^2 n/2, and sum sin = cot(pi/2n). */
static void r2_and_rmse_of_a_scaled_half_sine(void **state) {
    (void)state;
    const double peak = 60, scale = 0.9;
    sf_series measured = half_sine(peak, 0.01, 0.015), model = half_sine(scale * peak, 0.01, 0.015);
    for (int k = 0; k < 2; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_fit fit;
        double interval = k ? 0.5e-3 : 0.25e-3, n = k ? 30 : 60;
        assert_int_equal(
            sf_compare_fit(&measured, &model, &(sf_fit_of){{0.01, 0.025}, interval, 0, true, 0}, &fit, &err),
            SF_OK);
        double residual = (1 - scale) * (1 - scale) * peak * peak * n / 2;
        double sum = peak / tan(M_PI / (2 * n));
        double total = peak * peak * n / 2 - sum * sum / (n + 1);
        assert_int_equal(fit.count, (int64_t)n + 1);
        assert_relative(fit.rmse_g, sqrt(residual / (n + 1)), 1e-9);
        assert_close(fit.r2, 1 - residual / total, 1e-9);
    }
    sf_series_free(&measured);
    sf_series_free(&model);
}

static void contact_of_a_ramp_is_where_it_leaves_zero(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    double time[4] = {0, 0.0101, 0.0201, 0.03}, value[4] = {0, 0, 50, 0}, instant = 0;
    sf_series curve = {4, time, value};
    assert_int_equal(sf_contact_instant(&curve, "ramp", 0, &instant, &err), SF_OK);
    assert_close(instant, 0.0101, 1e-12);
    for (int i = 0; i < 4; i++)
        value[i] += 3; /* an offset of the channel */
    assert_int_equal(sf_contact_instant(&curve, "shifted ramp", 3, &instant, &err), SF_OK);
    assert_close(instant, 0.0101, 1e-12);
    for (int i = 0; i < 4; i++)
        value[i] -= 3;
    sf_series cut = {3, time + 1, value + 1}; /* cut at 4 % of its peak it still shows where it came from */
    time[1] = 0.0101 + 0.0004;
    value[1] = 2;
    assert_int_equal(sf_contact_instant(&cut, "cut ramp", 0, &instant, &err), SF_OK);
    assert_close(instant, 0.0101, 1e-12);
    value[1] = 20;
    assert_int_equal(sf_contact_instant(&cut, "late ramp", 0, &instant, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "--shift"));
}

static void alignment_undoes_a_shifted_clock(void **state) {
    (void)state;
    char path[256];
    char text[65536] = "# drop 7\nsample,time_ms,acceleration_g\n";
    for (int i = 0; i <= 800; i++) {
        double x = (i * 0.05 - 10.5) / 15;
        char row[80];
        snprintf(row, sizeof row, "%d,%.2f,%.9f\n", i, i * 0.05, x > 0 && x < 1 ? 60 * sin(M_PI * x) : 0);
        strcat(text, row);
    }
    write_text(path, text);
    sf_error err = SF_ERROR_INIT;
    sf_series model = half_sine(60, 0.002, 0.015);
    sf_region regions[2] = {{0.0, 0.012}, {0.012, 0.030}};
    sf_compare_options options = {.reference = {.path = path},
                                  .shift = NAN,
                                  .window = {NAN, NAN},
                                  .regions = regions,
                                  .region_count = 2,
                                  .left = true};
    sf_comparison c;
    assert_int_equal(sf_compare_run(&options, &model, &c, &err), SF_OK);
    assert_close(c.shift, -0.0085, 1e-6);
    assert_int_equal(c.shift_given, 0);
    assert_int_equal(c.fit_count, 6);
    for (int64_t k = 0; k < c.fit_count; k++) {
        assert_true(c.fits[k].r2 > 0.999999);
        assert_close(c.fits[k].interval, k % 2 ? 0.5e-3 : 0.25e-3, 1e-12);
    }
    /* the window is the measured HIC window: 0.6702296636 of the half-sine, in its middle */
    assert_close(c.fits[0].region.begin, 0.018 - 0.6702296636 * 0.0075, 1e-5);
    assert_close(c.fits[0].region.end, 0.018 + 0.6702296636 * 0.0075, 1e-5);
    assert_relative(c.injury.a_max_g, 60, 1e-6);
    sf_comparison_free(&c);

    options.shift = -0.0075; /* a wrong shift that the user insists on */
    options.window = (sf_region){0.011, 0.025};
    options.region_count = 0;
    assert_int_equal(sf_compare_run(&options, &model, &c, &err), SF_OK);
    assert_close(c.shift, -0.0075, 0);
    assert_int_equal(c.fit_count, 2);
    assert_close(c.fits[0].region.begin, 0.011, 0);
    assert_true(c.fits[0].r2 < 0.97);
    sf_comparison_free(&c);
    sf_series_free(&model);
    unlink(path);
}

/* The model's curve is never cut or made longer silently: after a rebound it is free flight, which the fit
 * counts; in contact the region is refused. */
static void region_beyond_the_model_is_refused_or_counted(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_fit fit;
    sf_series measured = half_sine(60, 0.01, 0.015), model = half_sine(60, 0.01, 0.015);
    model.count = 351; /* stops at 17.5 ms, at the peak */
    assert_int_equal(
        sf_compare_fit(&measured, &model, &(sf_fit_of){{0.01, 0.025}, 0.25e-3, 0, false, 0}, &fit, &err),
        SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "ends in contact at 17.5 ms"));
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(
        sf_compare_fit(&measured, &model, &(sf_fit_of){{0.01, 0.0175}, 0.25e-3, 0, false, 0}, &fit, &err),
        SF_OK);
    assert_int_equal(fit.flight, 0);
    model.count = 501; /* stops with the pulse: free flight after it */
    assert_int_equal(
        sf_compare_fit(&measured, &model, &(sf_fit_of){{0.01, 0.035}, 0.25e-3, 0, true, 0}, &fit, &err),
        SF_OK);
    assert_close(fit.r2, 1, 1e-12);
    assert_int_equal(fit.flight, 40);
    /* of the kinematic acceleration -1 g: 40 of 101 samples are 1 g off */
    assert_int_equal(
        sf_compare_fit(&measured, &model, &(sf_fit_of){{0.01, 0.035}, 0.25e-3, 0, true, -1}, &fit, &err),
        SF_OK);
    assert_int_equal(fit.count, 101);
    assert_close(fit.rmse_g, sqrt(40 / 101.0), 1e-9);
    assert_int_equal(
        sf_compare_fit(&measured, &model, &(sf_fit_of){{0.026, 0.035}, 0.25e-3, 0, true, 0}, &fit, &err),
        SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "lies outside the model's curve"));
    sf_series_free(&measured);
    sf_series_free(&model);
}

static void still_measurement_has_rmse_but_no_r2(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_fit fit;
    sf_series measured = half_sine(60, 0.01, 0.015), model = half_sine(60, 0.01, 0.015);
    for (int64_t i = 0; i < model.count; i++)
        model.value[i] += 2;
    assert_int_equal(
        sf_compare_fit(&measured, &model, &(sf_fit_of){{0, 0.008}, 0.25e-3, 0, true, 0}, &fit, &err), SF_OK);
    assert_true(isnan(fit.r2));
    assert_close(fit.rmse_g, 2, 1e-12);
    sf_series_free(&measured);
    sf_series_free(&model);
}

static void region_outside_the_measurement_is_refused(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_fit fit;
    sf_series curve = half_sine(60, 0.01, 0.015);
    assert_int_equal(
        sf_compare_fit(&curve, &curve, &(sf_fit_of){{0.05, 0.06}, 0.25e-3, 0, true, 0}, &fit, &err),
        SF_ERR_INPUT);
    err = (sf_error)SF_ERROR_INIT; /* nor is the part that was measured taken for the whole */
    assert_int_equal(
        sf_compare_fit(&curve, &curve, &(sf_fit_of){{0.03, 0.06}, 0.25e-3, 0, true, 0}, &fit, &err),
        SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "30 to 60 ms does not lie within the measured curve (0 to 40 ms)"));
    sf_series_free(&curve);
}

/* A last time of 2e12 ms once meant 8e12 samples. */
static void samples_are_bounded_whatever_the_times(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_fit fit;
    sf_series measured = half_sine(60, 0.01, 0.015), model = half_sine(60, 0.01, 0.015);
    measured.time[measured.count - 1] = 2e9;
    assert_int_equal(
        sf_compare_fit(&measured, &model, &(sf_fit_of){{0, 1e9}, 0.25e-3, 0, true, 0}, &fit, &err),
        SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "the region 0 to 1e+12 ms would be sampled 4e+12 times"));
    sf_series_free(&measured);
    sf_series_free(&model);
}

static void regions_are_bounded(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_region *regions = NULL;
    int64_t count = 0;
    char text[101 * 8] = "";
    for (int k = 0; k < 101; k++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s%d-%d", k ? "," : "", k, k + 1);
    assert_int_equal(sf_regions_parse(text, &regions, &count, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "101 regions; at most 100"));
    assert_null(regions);
}

static void regions_are_parsed_in_ms(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_region *regions = NULL, window;
    int64_t count = 0;
    assert_int_equal(sf_regions_parse("0-10,10-16,16-30", &regions, &count, &err), SF_OK);
    assert_int_equal(count, 3);
    assert_close(regions[1].begin, 0.010, 1e-15);
    assert_close(regions[2].end, 0.030, 1e-15);
    free(regions);
    assert_int_equal(sf_region_parse("10.5,25", &window, &err), SF_OK);
    assert_close(window.begin, 0.0105, 1e-15);
    const char *bad[] = {"", "5", "5-", "10-5", "0-10,", "0-10;10-16", "a-b", "0-nan", "0-10,10", "0x0-0xA"};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        err = (sf_error)SF_ERROR_INIT;
        assert_int_equal(sf_regions_parse(bad[k], &regions, &count, &err), SF_ERR_INPUT);
        assert_null(regions);
    }
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_region_parse("25,10.5", &window, &err), SF_ERR_INPUT);
}

static void reference_units_are_taken_from_the_heading(void **state) {
    (void)state;
    sf_error err;
    sf_series curve;
    assert_int_equal(read_text("\xef\xbb\xbftime_s,acceleration_m_s2\r\n0,0\r\n0.001,98.0665\r\n0.002,0\r\n",
                               &curve, &err),
                     SF_OK);
    assert_int_equal(curve.count, 3);
    assert_close(curve.time[1], 0.001, 1e-15);
    assert_close(curve.value[1], 10, 1e-12);
    sf_series_free(&curve);
    assert_int_equal(
        read_text("# c\n\nacceleration_g , x, time_us\n1,9,1000\n\n2,9,2000\n3,9,3000", &curve, &err), SF_OK);
    assert_close(curve.time[2], 0.003, 1e-15);
    assert_close(curve.value[2], 3, 0);
    sf_series_free(&curve);
}

/* Half-sine of 40 g over 15 ms with a disturbance of 10 g at 4 kHz, every `step` ms. */
static void write_noisy(char *path, double step, double sign) {
    static char text[400000];
    size_t used = (size_t)sprintf(text, "time_ms,acceleration_g\n");
    for (int i = 0; i * step <= 30; i++) {
        double t = i * step, x = (t - 5) / 15;
        used += (size_t)sprintf(text + used, "%.4f,%.9f\n", t,
                                sign * ((x > 0 && x < 1 ? 40 * sin(M_PI * x) : 0) + 10 * sin(8 * M_PI * t)));
    }
    write_text(path, text);
}

/* A measurement is filtered like the model: otherwise its noise would stand against a smooth model. At 4 kHz
 * the four poles of CFC 1000 (corner 2077.5 Hz) leave 1 / (1 + (4 / 2.0775)^4) = 0.068 of it. */
static void measurement_is_filtered_with_the_class(void **state) {
    (void)state;
    char path[256];
    sf_error err = SF_ERROR_INIT;
    write_noisy(path, 0.02, 1);
    const double classes[] = {0, 1000, 180}, excess[] = {9, 0.7, 0.02};
    for (int k = 0; k < 3; k++) {
        const sf_reference_options options = {.path = path, .cfc = classes[k]};
        sf_reference reference;
        double away = 0, raw = 0;
        assert_int_equal(sf_reference_read(&options, &reference, &err), SF_OK);
        assert_int_equal(reference.curve.count, 1501); /* at its own rate */
        for (double t = 0.008; t < 0.017; t += 1e-5) { /* where the pulse itself passes the filter */
            double pulse = 40 * sin(M_PI * (t - 0.005) / 0.015);
            away = larger(away, fabs(sf_series_at(&reference.curve, t) - pulse));
            raw = larger(raw, fabs(sf_series_at(&reference.raw, t) - pulse));
        }
        assert_true(raw > 9);
        if (k == 0)
            assert_true(away > excess[0]);
        else if (!(away < excess[k]))
            fail_msg("CFC %g: %g g away", classes[k], away);
        sf_reference_free(&reference);
    }
    unlink(path);
}

static void coarse_or_inverted_measurement_is_refused(void **state) {
    (void)state;
    char path[256];
    sf_error err = SF_ERROR_INIT;
    sf_reference reference;
    write_noisy(path, 0.2, 1);
    sf_reference_options options = {.path = path,
                                    .cfc = 1000,
                                    .filter_option = "--filter ",
                                    .invert_option = "--turn",
                                    .zero_option = "--zero"};
    assert_int_equal(sf_reference_read(&options, &reference, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, ": sample 2: samples 0.2 ms apart are too coarse for CFC 1000"));
    assert_non_null(strstr(err.text, "give --filter 180, or --filter none if"));
    assert_null(reference.raw.time);
    err = (sf_error)SF_ERROR_INIT;
    options.cfc = 180;
    assert_int_equal(sf_reference_read(&options, &reference, &err), SF_OK);
    sf_reference_free(&reference);
    options.cfc = 1000;
    unlink(path);
    write_noisy(path, 0.02, -1);
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_reference_read(&options, &reference, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "looks inverted"));
    assert_non_null(strstr(err.text, "--turn"));
    err = (sf_error)SF_ERROR_INIT;
    options.invert = true;
    assert_int_equal(sf_reference_read(&options, &reference, &err), SF_OK);
    assert_close(sf_series_at(&reference.curve, 0.0125), 40, 1);
    assert_non_null(strstr(reference.interpretation, "inverted"));
    sf_reference_free(&reference);
    unlink(path);
    write_noisy(path, 0.02, 1); /* already the right way round */
    assert_int_equal(sf_reference_read(&options, &reference, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "leave --turn out"));
    unlink(path);
}

enum { AXIS_SAMPLES = 1000 };

/* A half sine of 80 g and 14 ms after 10 ms at rest, at 20 kHz. */
static double axis_pulse(int i) {
    double x = (i / 20e3 - 0.01) / 0.014;
    return x > 0 && x < 1 ? 80 * sin(M_PI * x) : 0;
}

static const double axis_direction[3] = {0.6, -0.64, 0.48};
static const double axis_offset[3] = {2, 0, -1.5}; /* g */

static char *write_axes(void) {
    static char text[AXIS_SAMPLES * 80];
    size_t used = (size_t)snprintf(text, sizeof text, "Time (ms),ax (g),ay_g,az (m/s2)\n");
    for (int i = 0; i < AXIS_SAMPLES; i++) {
        double p = axis_pulse(i), a[3];
        for (int k = 0; k < 3; k++)
            a[k] = axis_direction[k] * p + axis_offset[k];
        used += (size_t)snprintf(text + used, sizeof text - used, "%.2f,%.6f,%.6f,%.6f\n", 0.05 * i, a[0],
                                 a[1], 9.80665 * a[2]);
    }
    return text;
}

/* Axes with offsets are the pulse; so are samples that were read already. */
static void axes_with_offsets_are_the_pulse(void **state) {
    (void)state;
    char path[256];
    sf_error err = SF_ERROR_INIT;
    sf_reference r;
    double time[AXIS_SAMPLES], value[3][AXIS_SAMPLES];
    for (int i = 0; i < AXIS_SAMPLES; i++) {
        time[i] = i / 20e3;
        for (int k = 0; k < 3; k++)
            value[k][i] = axis_direction[k] * axis_pulse(i) + axis_offset[k];
    }
    const sf_reference_samples samples = {AXIS_SAMPLES, time, 3, {value[0], value[1], value[2]}, "of memory"};
    write_text(path, write_axes());
    for (int k = 0; k < 2; k++) {
        const sf_reference_options o = {.path = path,
                                        .samples = k ? &samples : NULL,
                                        .columns = k ? NULL : "ax, ay,az",
                                        .zero = true,
                                        .cfc = 1000};
        double away = 0;
        if (sf_reference_read(&o, &r, &err) != SF_OK ||
            !strstr(r.interpretation, k ? "of memory, 1000 samples at 20 kHz" : "resultant of the columns"))
            fail_msg("%s%s", err.text, r.interpretation);
        for (int i = 0; i < AXIS_SAMPLES; i++)
            away = larger(away, fabs(r.raw.value[i] - axis_pulse(i)));
        assert_true(r.raw.count == AXIS_SAMPLES && away < 1e-5);
        assert_close(sf_series_at(&r.curve, 0.017), 80, 0.08);
        assert_close(r.offset, 2.5, 1e-5);
        sf_reference_free(&r);
    }
    unlink(path);
}

static void contradicting_options_of_a_record_are_refused(void **state) {
    (void)state;
    static const struct {
        sf_reference_options options;
        const char *expected;
    } cases[] = {
        {{.columns = "ax"}, "not a list of two or three columns"},
        {{.columns = "ax,,az"}, "not a list of two or three columns"},
        {{.columns = "ax,ay,aq"}, "no column of acceleration called aq"},
        {{.columns = "ax,ay", .invert = true}, "leave --reference-invert out"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char path[256];
        sf_error err = SF_ERROR_INIT;
        sf_reference r;
        sf_reference_options o = cases[k].options;
        o.path = path;
        o.invert_option = "--reference-invert";
        o.column_option = "--reference-column";
        write_text(path, write_axes());
        if (sf_reference_read(&o, &r, &err) != SF_ERR_INPUT || !strstr(err.text, cases[k].expected))
            fail_msg("%zu: %s", k, err.text);
        unlink(path);
    }
    double range;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_reference_parse_range("200 g", &range, &err), SF_OK);
    assert_close(range, 200, 0);
    assert_int_equal(sf_reference_parse_range("1961.33 m/s2", &range, &err), SF_OK);
    assert_close(range, 200, 1e-9);
    static const char *const bad[] = {"200", "200 mm", "-10 g", ""};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        err = (sf_error)SF_ERROR_INIT;
        assert_int_equal(sf_reference_parse_range(bad[k], &range, &err), SF_ERR_INPUT);
    }
}

static void bad_references_name_file_and_line(void **state) {
    (void)state;
    const struct {
        const char *text, *expected;
    } bad[] = {
        {"", "is empty"},
        {"time,acceleration_g\n0,1\n", ":1: the heading has no column of time, such as time_ms"},
        {"# x\ntime_ms,a\n0,1\n", ":2: the heading has no column of acceleration, such as acceleration_g"},
        {"time_ms,acceleration_g\n0,1\n1,two\n", ":3: acceleration \"two\" is not a finite number"},
        {"time_ms,acceleration_g\n0,1\n1\n", ":3: 1 values where the heading has 2 columns"},
        {"time_ms,acceleration_g\n0,1\n1,nan\n", ":3: acceleration \"nan\" is not"},
        {"time_ms,acceleration_g\n0,1\n1,2\n1,3\n", ":4: time 1 ms does not follow 1 ms"},
        {"time_ms,acceleration_g\n0,1\n1,2\n", "2 points"},
        {"time_ms,acceleration_g,acceleration_m_s2\n0,1,2\n",
         ":1: two acceleration columns (\"acceleration_g\" and \"acceleration_m_s2\"): name one with "
         "--reference-column"},
        {"Time (ms);Acc (g)\n0;1\n", "-o clean.csv reads other forms"},
        {"0,1\n1,2\n2,3\n", ":1: the heading has no column of time"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        sf_error err;
        sf_series curve;
        assert_int_equal(read_text(bad[k].text, &curve, &err), SF_ERR_INPUT);
        assert_non_null(strstr(err.text, bad[k].expected));
        assert_null(curve.time);
    }
    sf_error err = SF_ERROR_INIT;
    sf_reference reference;
    const sf_reference_options none = {.path = "/nonexistent/measured.csv"};
    assert_int_equal(sf_reference_read(&none, &reference, &err), SF_ERR_INPUT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identical_curves_fit_perfectly),
        cmocka_unit_test(r2_and_rmse_of_a_scaled_half_sine),
        cmocka_unit_test(contact_of_a_ramp_is_where_it_leaves_zero),
        cmocka_unit_test(alignment_undoes_a_shifted_clock),
        cmocka_unit_test(region_beyond_the_model_is_refused_or_counted),
        cmocka_unit_test(still_measurement_has_rmse_but_no_r2),
        cmocka_unit_test(region_outside_the_measurement_is_refused),
        cmocka_unit_test(samples_are_bounded_whatever_the_times),
        cmocka_unit_test(regions_are_bounded),
        cmocka_unit_test(regions_are_parsed_in_ms),
        cmocka_unit_test(reference_units_are_taken_from_the_heading),
        cmocka_unit_test(measurement_is_filtered_with_the_class),
        cmocka_unit_test(coarse_or_inverted_measurement_is_refused),
        cmocka_unit_test(axes_with_offsets_are_the_pulse),
        cmocka_unit_test(contradicting_options_of_a_record_are_refused),
        cmocka_unit_test(bad_references_name_file_and_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
