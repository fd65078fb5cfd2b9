/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/signal.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

#include "extreme.h"
#include "post_check.h"

static sf_series uniform_curve(int64_t count, double rate) {
    sf_error err = SF_ERROR_INIT;
    sf_series series;
    assert_int_equal(sf_series_create(count, &series, &err), SF_OK);
    for (int64_t k = 0; k < count; k++)
        series.time[k] = (double)k / rate;
    return series;
}

typedef struct response {
    double gain;
    double phase; /* rad */
} response;

/* Amplitude and phase of the filtered sine of `frequency`, by projection over whole periods in the middle. */
static response filter_response(double cfc, double rate, double frequency) {
    sf_error err = SF_ERROR_INIT;
    sf_series filtered, sine = uniform_curve(80001, rate);
    for (int64_t k = 0; k < sine.count; k++)
        sine.value[k] = sin(2 * M_PI * frequency * sine.time[k]);
    assert_int_equal(sf_signal_filter_cfc(&sine, cfc, &filtered, &err), SF_OK);
    double in_phase = 0, quadrature = 0, weight = 0;
    for (int64_t k = 20000; k < 60000; k++) {
        double window = 1 - cos(2 * M_PI * (double)(k - 20000) / 40000); /* whole periods need not fit */
        in_phase += window * filtered.value[k] * sin(2 * M_PI * frequency * sine.time[k]);
        quadrature += window * filtered.value[k] * cos(2 * M_PI * frequency * sine.time[k]);
        weight += window / 2;
    }
    sf_series_free(&sine);
    sf_series_free(&filtered);
    return (response){hypot(in_phase, quadrature) / weight, atan2(quadrature, in_phase)};
}

/* The forward-backward gain of the digital two-pole Butterworth filter is 1 / (1 + (tan(w T/2) / wa)^4). */
static void cfc_minus_3_db_points_at_20_khz(void **state) {
    (void)state;
    const double cfc[4] = {60, 180, 600, 1000}, corner[4] = {99.9, 299.8, 1003.6, 1686};
    for (int k = 0; k < 4; k++) {
        double low = 0.5 * corner[k], high = 2 * corner[k];
        for (int step = 0; step < 14; step++) {
            double middle = (low + high) / 2;
            if (filter_response(cfc[k], 20e3, middle).gain > pow(10, -3.0 / 20))
                low = middle;
            else
                high = middle;
        }
        assert_relative(low, corner[k], 6e-4); /* half a unit of the last digit tabulated */
    }
}

static void cfc_gain_matches_bilinear_butterworth(void **state) {
    (void)state;
    const double rate = 100e3, frequency[3] = {200, 1650, 5000};
    double wa = tan(M_PI * 1000 * 2.0775 / rate);
    for (int k = 0; k < 3; k++) {
        double ratio = tan(M_PI * frequency[k] / rate) / wa;
        assert_close(filter_response(1000, rate, frequency[k]).gain, 1 / (1 + pow(ratio, 4)), 1e-7);
    }
}

static void cfc_has_no_phase_shift(void **state) {
    (void)state;
    assert_close(filter_response(1000, 20e3, 800).phase, 0, 1e-8);
    assert_close(filter_response(60, 20e3, 100).phase, 0, 1e-8);
}

static void cfc_leaves_constants_and_ramps_alone(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_series filtered, curve = uniform_curve(1000, 100e3);
    for (int64_t k = 0; k < curve.count; k++)
        curve.value[k] = 7.5;
    assert_int_equal(sf_signal_filter_cfc(&curve, 1000, &filtered, &err), SF_OK);
    for (int64_t k = 0; k < curve.count; k++)
        assert_close(filtered.value[k], 7.5, 1e-10);
    sf_series_free(&filtered);
    for (int64_t k = 0; k < curve.count; k++)
        curve.value[k] = (double)k;
    assert_int_equal(sf_signal_filter_cfc(&curve, 1000, &filtered, &err), SF_OK);
    for (int64_t k = 0; k < curve.count; k++) /* both ends included: that is what the padding is for */
        assert_close(filtered.value[k], (double)k, 1e-4);
    sf_series_free(&filtered);
    sf_series_free(&curve);
}

static void filtered_pulse_mirrors_like_the_pulse(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_series filtered, curve = uniform_curve(2001, 100e3);
    for (int64_t k = 0; k < curve.count; k++)
        curve.value[k] = k > 600 && k < 1400 ? 100 : 0;
    assert_int_equal(sf_signal_filter_cfc(&curve, 1000, &filtered, &err), SF_OK);
    for (int64_t k = 0; k < 1000; k++)
        assert_close(filtered.value[k], filtered.value[2000 - k], 1e-6);
    assert_true(filtered.value[600] > 30 && filtered.value[600] < 70); /* the step really is smoothed */
    sf_series_free(&filtered);
    sf_series_free(&curve);
}

static void resampling_interpolates_a_non_uniform_history(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    double time[5] = {0.001, 0.00101, 0.00104, 0.0012, 0.002}, value[5];
    for (int i = 0; i < 5; i++)
        value[i] = 3 + 2000 * time[i];
    sf_series uniform, history = {5, time, value};
    assert_int_equal(sf_signal_resample(&history, 100e3, &uniform, &err), SF_OK);
    assert_int_equal(uniform.count, 101);
    for (int64_t k = 0; k < uniform.count; k++) {
        assert_close(uniform.time[k], 0.001 + (double)k * 1e-5, 1e-15);
        assert_close(uniform.value[k], 3 + 2000 * uniform.time[k], 1e-12);
    }
    sf_series_free(&uniform);
    assert_close(sf_series_at(&history, 0.0011), 5.2, 1e-12);
    assert_close(sf_series_at(&history, 0), value[0], 0);
    assert_close(sf_series_at(&history, 1), value[4], 0);
}

static void sampling_rate_follows_the_steps_of_the_history(void **state) {
    (void)state;
    sf_series coarse = uniform_curve(100, 50e3), fine = uniform_curve(1000, 730e3);
    assert_close(sf_signal_rate(&coarse), 100e3, 1e-6);
    assert_close(sf_signal_rate(&fine), 800e3, 1e-6);
    sf_series_free(&coarse);
    sf_series_free(&fine);
}

enum { CHAIN_SAMPLES = 40000 }; /* 0.4 s at 100 kHz */

static sf_series sine(double frequency) {
    sf_series s;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_series_create(CHAIN_SAMPLES, &s, &err), SF_OK);
    for (int i = 0; i < CHAIN_SAMPLES; i++) {
        s.time[i] = i * 1e-5;
        s.value[i] = sin(2 * M_PI * frequency * s.time[i]);
    }
    return s;
}

/* Largest value of the last tenth, where the beginning has faded. */
static double last_peak(const sf_series *s) {
    double peak = 0;
    for (int64_t i = s->count - s->count / 10; i < s->count; i++)
        peak = larger(peak, s->value[i]);
    return peak;
}

/* Steady vibration: 1 / sqrt((1 - r^2)^2 + (2 zeta r)^2), and w tau / sqrt(1 + (w tau)^2) of the high pass.
 */
static void mount_and_coupling_have_their_gain(void **state) {
    (void)state;
    const sf_signal_chain mount = {.mount_frequency = 420, .mount_damping = 0.05},
                          couple = {.coupling = 0.01};
    static const double frequency[] = {40, 200, 420, 700, 2000};
    for (size_t k = 0; k < sizeof frequency / sizeof *frequency; k++) {
        double r = frequency[k] / 420, w = 2 * M_PI * frequency[k] * couple.coupling;
        sf_series s = sine(frequency[k]);
        sf_signal_pass(&mount, &s);
        assert_relative(last_peak(&s), 1 / sqrt((1 - r * r) * (1 - r * r) + 0.01 * r * r), 5e-3);
        sf_series_free(&s);
        s = sine(frequency[k]);
        sf_signal_pass(&couple, &s);
        assert_relative(last_peak(&s), w / sqrt(1 + w * w), 5e-3);
        sf_series_free(&s);
    }
}

/* A ramp that begins from rest, by its closed form. */
static void mount_and_coupling_follow_a_ramp(void **state) {
    (void)state;
    const double f = 300, zeta = 0.2, w = 2 * M_PI * f, d = w * sqrt(1 - zeta * zeta), slope = 50, tau = 0.05;
    const sf_signal_chain mount = {.mount_frequency = f, .mount_damping = zeta}, couple = {.coupling = tau};
    for (int kind = 0; kind < 2; kind++) {
        sf_series s = sine(0);
        for (int i = 0; i < CHAIN_SAMPLES; i++)
            s.value[i] = 3 + slope * s.time[i];
        sf_signal_pass(kind ? &couple : &mount, &s);
        for (int i = 0; i < CHAIN_SAMPLES; i += 37) {
            double t = s.time[i], e = exp(-zeta * w * t), lag = 2 * zeta / w;
            double expected =
                kind ? slope * tau * -expm1(-t / tau)
                     : 3 + slope * (t - lag + e * (lag * cos(d * t) + (zeta * w * lag - 1) / d * sin(d * t)));
            assert_close(s.value[i], expected, 1e-9);
        }
        sf_series_free(&s);
    }
}

static void mounts_and_couplings_are_read(void **state) {
    (void)state;
    sf_signal_chain c = {0};
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_signal_parse_mount("f = 0.42 kHz, damping = 0.05", &c, &err), SF_OK);
    assert_close(c.mount_frequency, 420, 1e-9);
    assert_close(c.mount_damping, 0.05, 0);
    assert_int_equal(sf_signal_parse_coupling("0.2 s", &c, &err), SF_OK);
    assert_close(c.coupling, 0.2, 0);
    static const char *const bad[] = {"",
                                      "420 Hz",
                                      "f = 420, damping = 0.1",
                                      "f = 420 Hz, damping = 1.5",
                                      "f = -1 Hz, damping = 0.1",
                                      "f = 420 Hz, damping = 0.1 x",
                                      "f = 1 Hz, damping = 0.1"};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        err = (sf_error)SF_ERROR_INIT;
        assert_int_equal(sf_signal_parse_mount(bad[k], &c, &err), SF_ERR_INPUT);
        err = (sf_error)SF_ERROR_INIT;
        assert_int_equal(sf_signal_parse_coupling(bad[k], &c, &err), SF_ERR_INPUT);
    }
}

static void bad_curves_are_refused(void **state) {
    (void)state;
    sf_series out;
    double time[3] = {0, 1e-3, 1e-3}, value[3] = {0, 1, 2};
    sf_series curve = {3, time, value};
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_signal_resample(&curve, 100e3, &out, &err), SF_ERR_INPUT); /* time stands still */
    time[2] = 3e-3;
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_signal_filter_cfc(&curve, 60, &out, &err), SF_ERR_INPUT); /* not uniform */
    time[2] = 2e-3;
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_signal_filter_cfc(&curve, 1000, &out, &err), SF_ERR_INPUT); /* 1 kHz is too coarse */
    value[1] = NAN;
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_signal_filter_cfc(&curve, 60, &out, &err), SF_ERR_INPUT);
    assert_null(out.time);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cfc_minus_3_db_points_at_20_khz),
        cmocka_unit_test(cfc_gain_matches_bilinear_butterworth),
        cmocka_unit_test(cfc_has_no_phase_shift),
        cmocka_unit_test(cfc_leaves_constants_and_ramps_alone),
        cmocka_unit_test(filtered_pulse_mirrors_like_the_pulse),
        cmocka_unit_test(resampling_interpolates_a_non_uniform_history),
        cmocka_unit_test(sampling_rate_follows_the_steps_of_the_history),
        cmocka_unit_test(mount_and_coupling_have_their_gain),
        cmocka_unit_test(mount_and_coupling_follow_a_ramp),
        cmocka_unit_test(mounts_and_couplings_are_read),
        cmocka_unit_test(bad_curves_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
