/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves over time, uniform resampling and the channel frequency class (CFC) filter of crash testing.
 *
 * sf_series is a piecewise-linear curve: `value[i]` at `time[i]` (s), times strictly ascending. The unit of
 * the values is the user's (here: multiples of g). Arrays come from sf_alloc and belong to the series;
 * sf_series_free releases them. A failing function leaves its output series zeroed. */
#pragma once
#include "base/error.h"
#include <stdint.h>

#define SF_SIGNAL_RATE 100e3 /* Hz, least sampling rate of a resampled curve */

typedef struct sf_series {
    int64_t count;
    double *time;  /* [count] s */
    double *value; /* [count] */
} sf_series;

sf_status sf_series_create(int64_t count, sf_series *series, sf_error *err);
void sf_series_free(sf_series *series);

/* SF_ERR_INPUT, naming `name` and the point, unless there are two points or more, all finite, times
 * ascending. */
sf_status sf_series_check(const sf_series *series, const char *name, sf_error *err);

/* Returns the index of the largest value, the first of equal ones. */
int64_t sf_series_peak(const sf_series *series);

/* Linear interpolation at `time` (s); the end values outside the curve. */
double sf_series_at(const sf_series *series, double time);

/* The curve with `lead` (s) of the value `level` before its first point, where it jumps. */
sf_status sf_signal_lead_in(const sf_series *series, double lead, double level, sf_series *out,
                            sf_error *err);

/* A sampling rate (Hz) that keeps every detail of the curve: SF_SIGNAL_RATE, or the next multiple of it above
 * the mean rate of the points, so that resampling a finely stepped history does not alias it. At most 20
 * times as much. */
double sf_signal_rate(const sf_series *series);

/* Uniform samples from the first instant on, `rate` (Hz) apart. A sample is the mean of the curve over its
 * interval, half a step on either side, so that the integral of the curve, an impulse, survives however short
 * its peaks are; the first and the last sample are the curve's own values. */
sf_status sf_signal_resample(const sf_series *series, double rate, sf_series *uniform, sf_error *err);

/* The chain between the missile and its record: the accelerometer's mount, a second-order system that moves
 * with y'' + 2 zeta w y' + w^2 y = w^2 a, and the high pass y' + y / tau = a' of a piezo chain. */
typedef struct sf_signal_chain {
    double mount_frequency; /* Hz, w / 2 pi; 0: the mount is rigid */
    double mount_damping;   /* -, zeta, above 0 and below 1 */
    double coupling;        /* s, tau; 0: the chain passes constants */
} sf_signal_chain;
enum { SF_SIGNAL_CHAIN = sizeof(sf_signal_chain) / sizeof(double) }; /* its numbers, in this order */

/* Passes uniform samples through it in place: exact for straight lines between them. It has been at rest with
 * the first sample. */
void sf_signal_pass(const sf_signal_chain *chain, sf_series *uniform);

/* "f = 420 Hz, damping = 0.05" and "0.2 s". SF_ERR_INPUT names the text. */
sf_status sf_signal_parse_mount(const char *text, sf_signal_chain *chain, sf_error *err);
sf_status sf_signal_parse_coupling(const char *text, sf_signal_chain *chain, sf_error *err);

/* Two-pole Butterworth filter of SAE J211-1, run forward and backward (four poles, no phase shift), on
 * uniformly sampled data. Both ends are extended by point reflection, as ISO 6487 does, until the filter's
 * memory has faded, so that the first and the last sample are not bent. SF_ERR_INPUT if the samples are not
 * uniform or too far apart for `cfc`. */
sf_status sf_signal_filter_cfc(const sf_series *uniform, double cfc, sf_series *filtered, sf_error *err);

/* The same filter of any curve: at its own rate if its times are uniform but for their rounding, because
 * interpolation between samples would be a filter of its own; else the curve is resampled. */
sf_status sf_signal_filter(const sf_series *raw, double cfc, sf_series *filtered, sf_error *err);
