/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/reference.h"

#include "base/units.h"
#include "io/table_csv.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FEWEST_POINTS = 3 };
static const double SAMPLES_PER_CLASS = 10; /* least sampling rate over the class (SAE J211) */
static const double ROUNDING = 1.05;        /* of written times: 0.105 ms counts as 0.1 ms */
static const double UNEVEN = 1.5; /* largest over mean distance of samples that are told as uneven */

static const sf_table_name names[] = {
    {"time_s", 0, 1, "s"},
    {"time_ms", 0, 1e-3, "ms"},
    {"time_us", 0, 1e-6, "us"},
    {"acceleration_g", 1, 1, "g"},
    {"acceleration_m_s2", 1, 1 / SF_STANDARD_GRAVITY, "m/s2"},
    {"acceleration_km_s2", 1, 1e3 / SF_STANDARD_GRAVITY, "km/s2"},
};

static sf_status check_point(const sf_table_point *p, sf_error *err) {
    if (p->index > 0 && !(p->value[0] > p->before[0]))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: time %g ms does not follow %g ms of the row before",
                       p->path, p->line, p->value[0] * 1e3, p->before[0] * 1e3);
    return SF_OK;
}

static sf_table_layout layout_of(const sf_reference_options *o) {
    return (sf_table_layout){
        .what = "reference",
        .column = {"time", "acceleration"},
        .wanted = {"time_s, time_ms or time_us (or \"Time (ms)\")",
                   "acceleration_g, acceleration_m_s2 or acceleration_km_s2 (or \"Acceleration (g)\")"},
        .names = names,
        .name_count = sizeof names / sizeof *names,
        .words = {"time|t|*zeit|temps|tiempo|tempo",
                  "acceleration|deceleration|accel|acc|a|*beschleunigung|accélération|aceleración|"
                  "accelerazione"},
        .kind = {SF_TIME, SF_ACCELERATION},
        .unit = {1, SF_STANDARD_GRAVITY},
        .chosen = {NULL, o->column},
        .choice = o->column_option,
        .ragged = true,
        .check = check_point,
    };
}

static double gap_before(const sf_series *s, int64_t i) {
    return s->time[i] - s->time[i - 1];
}

static double largest_gap(const sf_series *s) {
    double gap = 0;
    for (int64_t i = 1; i < s->count; i++)
        gap = fmax(gap, gap_before(s, i));
    return gap;
}

static sf_status check_sampling(const sf_reference_options *o, const sf_table *table, const sf_series *raw,
                                sf_error *err) {
    double most = 1 / (SAMPLES_PER_CLASS * o->cfc);
    for (int64_t i = 1; o->cfc > 0 && i < raw->count; i++)
        if (gap_before(raw, i) > ROUNDING * most)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s:%d: samples %.4g ms apart are too coarse for CFC %g, which needs %.4g ms (%g kHz) or "
                "less: choose a lower class, or %s if the curve is filtered already",
                o->path, table->line[i], gap_before(raw, i) * 1e3, o->cfc, most * 1e3,
                SAMPLES_PER_CLASS * o->cfc * 1e-3, o->unfiltered_option);
    return SF_OK;
}

static sf_status filter(const sf_reference_options *o, sf_reference *r, sf_error *err) {
    sf_series uniform = {0};
    if (o->cfc > 0) {
        if (sf_signal_resample(&r->raw, sf_signal_rate(&r->raw), &uniform, err) == SF_OK)
            sf_signal_filter_cfc(&uniform, o->cfc, &r->curve, err);
        sf_series_free(&uniform);
    } else if (sf_series_create(r->raw.count, &r->curve, err) == SF_OK) {
        memcpy(r->curve.time, r->raw.time, (size_t)r->raw.count * sizeof(double));
        memcpy(r->curve.value, r->raw.value, (size_t)r->raw.count * sizeof(double));
    }
    return err->status;
}

/* A braked missile's largest magnitude is positive. */
static sf_status check_sign(const sf_reference_options *o, const sf_series *curve, sf_error *err) {
    double high = 0, low = 0;
    for (int64_t i = 0; i < curve->count; i++) {
        high = fmax(high, curve->value[i]);
        low = fmin(low, curve->value[i]);
    }
    if (high >= -low)
        return SF_OK;
    if (o->invert)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: inverted, the channel's largest magnitude is negative (%.4g g, against %.4g g): the "
            "file has the right sign, leave %s out",
            o->path, low, high, o->invert_option);
    return SF_FAIL(
        err, SF_ERR_INPUT,
        "%s: the channel looks inverted: its largest magnitude is negative (%.4g g, against %.4g g), but "
        "a missile that is slowed down has a positive acceleration; if so, give %s",
        o->path, low, high, o->invert_option);
}

static void describe(const sf_reference_options *o, const sf_table *table, sf_reference *r) {
    const sf_series *s = &r->raw;
    double span = s->time[s->count - 1] - s->time[0], mean = span / (double)(s->count - 1);
    char spacing[64], class[32] = "not filtered";
    if (largest_gap(s) > UNEVEN * mean)
        snprintf(spacing, sizeof spacing, "unevenly, up to %.4g ms apart", largest_gap(s) * 1e3);
    else
        snprintf(spacing, sizeof spacing, "at %.4g kHz", 1e-3 / mean);
    if (o->cfc > 0)
        snprintf(class, sizeof class, "filtered with CFC %g", o->cfc);
    snprintf(r->understood, sizeof r->understood, "%.383s, %lld samples %s, %.6g to %.6g ms, %s%s",
             table->understood, (long long)s->count, spacing, s->time[0] * 1e3, s->time[s->count - 1] * 1e3,
             class, o->invert ? ", inverted as asked for" : "");
}

static sf_status take_table(const sf_reference_options *o, sf_table *table, sf_reference *r, sf_error *err) {
    if (table->count < FEWEST_POINTS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s has %lld points, at least %d are needed", o->path,
                       (long long)table->count, FEWEST_POINTS);
    r->raw = (sf_series){.count = table->count, .time = table->value[0], .value = table->value[1]};
    table->value[0] = table->value[1] = NULL;
    for (int64_t i = 0; o->invert && i < r->raw.count; i++)
        r->raw.value[i] = 0 - r->raw.value[i];
    SF_TRY(check_sampling(o, table, &r->raw, err));
    SF_TRY(filter(o, r, err));
    SF_TRY(check_sign(o, &r->curve, err));
    describe(o, table, r);
    return SF_OK;
}

sf_status sf_reference_read(const sf_reference_options *options, sf_reference *reference, sf_error *err) {
    const sf_table_layout layout = layout_of(options);
    sf_table table;
    *reference = (sf_reference){0};
    if (sf_table_read(options->path, &layout, &table, err) != SF_OK)
        return err->status;
    take_table(options, &table, reference, err);
    sf_table_free(&table);
    if (err->status != SF_OK)
        sf_reference_free(reference);
    return err->status;
}

void sf_reference_free(sf_reference *reference) {
    sf_series_free(&reference->raw);
    sf_series_free(&reference->curve);
    *reference = (sf_reference){0};
}
