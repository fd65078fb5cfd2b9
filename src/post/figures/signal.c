/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/signal.h"

#include <math.h>
#include <string.h>

#include "base/sets.h"
#include "base/units.h"

static const double MOST_SAMPLES = 1e7; /* of a curve: 100 s at 100 kHz */

sf_status sf_series_create(int64_t count, sf_series *series, sf_error *err) {
    *series = (sf_series){0};
    series->time = sf_alloc(err, count, sizeof(double), "times of a curve");
    series->value = sf_alloc(err, count, sizeof(double), "values of a curve");
    series->count = count;
    if (!series->time || !series->value)
        sf_series_free(series);
    return err->status;
}

void sf_series_free(sf_series *series) {
    SF_CLEAR(series, series->time, series->value);
}

sf_status sf_series_check(const sf_series *series, const char *name, sf_error *err) {
    if (series->count < 2)
        return SF_REFUSE(err, "%s has %lld points" SF_AT_LEAST("2"), name, (long long)series->count);
    for (int64_t i = 0; i < series->count; i++) {
        if (!isfinite(series->time[i]) || !isfinite(series->value[i]))
            return SF_REFUSE(err, "%s: point %lld is not finite", name, (long long)i + 1);
        if (i > 0 && !(series->time[i] > series->time[i - 1]))
            return SF_REFUSE(err, "%s: time %.9g s of point %lld does not follow %.9g s", name,
                             series->time[i], (long long)i + 1, series->time[i - 1]);
    }
    return SF_OK;
}

int64_t sf_series_peak(const sf_series *series) {
    int64_t peak = 0;
    for (int64_t i = 1; i < series->count; i++)
        if (series->value[i] > series->value[peak])
            peak = i;
    return peak;
}

double sf_series_at(const sf_series *series, double time) {
    if (time <= series->time[0])
        return series->value[0];
    if (time >= series->time[series->count - 1])
        return series->value[series->count - 1];
    int64_t k = sf_interval_find(series->time, series->count, time);
    double part = (time - series->time[k]) / (series->time[k + 1] - series->time[k]);
    return series->value[k] + part * (series->value[k + 1] - series->value[k]);
}

double sf_signal_rate(const sf_series *series) {
    const double largest = 20;
    double span = series->time[series->count - 1] - series->time[0];
    double mean_rate = (double)(series->count - 1) / span;
    double factor = ceil(mean_rate / SF_SIGNAL_RATE - 1e-6);
    return SF_SIGNAL_RATE * fmin(fmax(factor, 1), largest);
}

sf_status sf_signal_lead_in(const sf_series *series, double lead, double level, sf_series *out,
                            sf_error *err) {
    double jump = 1e-3 * fmin(lead, series->time[1] - series->time[0]);
    SF_TRY(sf_series_create(series->count + 2, out, err));
    out->time[0] = series->time[0] - lead;
    out->time[1] = series->time[0] - jump;
    out->value[0] = out->value[1] = level;
    memcpy(out->time + 2, series->time, (size_t)series->count * sizeof(double));
    memcpy(out->value + 2, series->value, (size_t)series->count * sizeof(double));
    return SF_OK;
}

static double interpolate(const sf_series *series, int64_t segment, double time) {
    const double *t = &series->time[segment], *v = &series->value[segment];
    return v[0] + fmin((time - t[0]) / (t[1] - t[0]), 1) * (v[1] - v[0]);
}

/* Mean of the curve from `begin` to `end`; `*segment` holds `begin`, and afterwards `end`. */
static double mean_between(const sf_series *series, double begin, double end, int64_t *segment) {
    double sum = 0, from = begin;
    for (;;) {
        bool last = *segment == series->count - 2 || series->time[*segment + 1] >= end;
        double to = last ? end : series->time[*segment + 1];
        sum += (to - from) * 0.5 * (interpolate(series, *segment, from) + interpolate(series, *segment, to));
        if (last)
            return sum / (end - begin);
        from = to;
        ++*segment;
    }
}

sf_status sf_signal_resample(const sf_series *series, double rate, sf_series *uniform, sf_error *err) {
    *uniform = (sf_series){0};
    SF_TRY(sf_series_check(series, "the curve to resample", err));
    double start = series->time[0];
    double span = series->time[series->count - 1] - start;
    double intervals = floor(span * rate * (1 + 1e-12) + 1e-9);
    if (!(intervals >= 1) || intervals > MOST_SAMPLES)
        return SF_REFUSE(err, "a curve of %.3g s cannot be sampled at %.3g Hz: 2 to %g samples are allowed",
                         span, rate, MOST_SAMPLES);
    SF_TRY(sf_series_create((int64_t)intervals + 1, uniform, err));
    int64_t segment = 0, last = uniform->count - 1;
    while (segment < series->count - 2 && series->time[segment + 1] <= start + 0.5 / rate)
        segment++;
    for (int64_t k = 0; k <= last; k++) {
        double time = start + (double)k / rate;
        uniform->time[k] = time;
        uniform->value[k] = k == 0 || k == last
                                ? sf_series_at(series, time)
                                : mean_between(series, time - 0.5 / rate, time + 0.5 / rate, &segment);
    }
    return SF_OK;
}

/* y[i] = a0 x[i] + a1 x[i-1] + a2 x[i-2] + b1 y[i-1] + b2 y[i-2], a1 = 2 a0, a2 = a0 (SAE J211-1, appendix
 * C). */
typedef struct cfc_coefficients {
    double a0, b1, b2;
} cfc_coefficients;

static cfc_coefficients cfc_design(double pole, double step) {
    double wa = tan(pole * step / 2);
    double denominator = 1 + sqrt(2) * wa + wa * wa;
    return (cfc_coefficients){
        .a0 = wa * wa / denominator,
        .b1 = -2 * (wa * wa - 1) / denominator,
        .b2 = (-1 + sqrt(2) * wa - wa * wa) / denominator,
    };
}

/* One pass in place over x[first], x[first + stride], ...: started as if the first value had lasted for ever.
 */
static void cfc_pass(cfc_coefficients c, double *x, int64_t count, int64_t first, int64_t stride) {
    double x1 = x[first], x2 = x1, y1 = x1, y2 = x1;
    for (int64_t k = 0; k < count; k++) {
        double x0 = x[first + k * stride];
        double y0 = c.a0 * (x0 + 2 * x1 + x2) + c.b1 * y1 + c.b2 * y2;
        x[first + k * stride] = y0;
        x2 = x1;
        x1 = x0;
        y2 = y1;
        y1 = y0;
    }
}

/* Sample k of the extended curve, k < 0 or k >= count allowed: reflected through the end point once, then
 * constant. */
static double reflected(const sf_series *series, int64_t k) {
    int64_t last = series->count - 1;
    if (k < 0)
        return 2 * series->value[0] - series->value[-k < last ? -k : last];
    if (k > last)
        return 2 * series->value[last] - series->value[2 * last - k > 0 ? 2 * last - k : 0];
    return series->value[k];
}

static sf_status check_uniform(const sf_series *series, double *step, sf_error *err) {
    *step = (series->time[series->count - 1] - series->time[0]) / (double)(series->count - 1);
    for (int64_t i = 1; i < series->count; i++) {
        double gap = series->time[i] - series->time[i - 1];
        if (fabs(gap - *step) > 1e-4 * *step)
            return SF_REFUSE(
                err, "the CFC filter needs uniform samples: interval %lld is %.9g s, the mean is %.9g s",
                (long long)i, gap, *step);
    }
    return SF_OK;
}

sf_status sf_signal_filter_cfc(const sf_series *uniform, double cfc, sf_series *filtered, sf_error *err) {
    *filtered = (sf_series){0};
    double step = 0;
    SF_OWNED double *work = NULL;
    SF_TRY(sf_series_check(uniform, "the curve to filter", err));
    SF_TRY(check_uniform(uniform, &step, err));
    double pole = 2 * M_PI * cfc * 2.0775;
    if (!(cfc > 0) || pole * step / 2 > 0.45 * M_PI)
        return SF_REFUSE(
            err, "CFC %g cannot be applied to samples at %.6g Hz: the class must be above 0 and at most %.0f",
            cfc, 1 / step, 0.45 / (2.0775 * step));
    /* The impulse response fades as exp(-pole t / sqrt 2): to 1e-9 in 30 / pole. */
    int64_t pad = (int64_t)ceil(30 / (pole * step)) + 2;
    int64_t total = uniform->count + 2 * pad;
    work = sf_alloc(err, total, sizeof *work, "the padded curve");
    SF_TRY(err->status);
    SF_TRY(sf_series_create(uniform->count, filtered, err));
    for (int64_t k = 0; k < total; k++)
        work[k] = reflected(uniform, k - pad);
    cfc_coefficients c = cfc_design(pole, step);
    cfc_pass(c, work, total, 0, 1);
    cfc_pass(c, work, total, total - 1, -1);
    memcpy(filtered->time, uniform->time, (size_t)uniform->count * sizeof(double));
    memcpy(filtered->value, work + pad, (size_t)uniform->count * sizeof(double));
    return SF_OK;
}

/* The samples on their own uniform clock, if written times that are rounded are all that speaks against it.
 */
static bool take_uniform(const sf_series *raw, sf_series *uniform, sf_error *err) {
    static const double OFF = 0.05; /* of a step: a time that is rounded */
    double step = (raw->time[raw->count - 1] - raw->time[0]) / (double)(raw->count - 1);
    for (int64_t i = 0; i < raw->count; i++)
        if (fabs(raw->time[i] - raw->time[0] - (double)i * step) > OFF * step)
            return false;
    if (sf_series_create(raw->count, uniform, err) != SF_OK)
        return true;
    for (int64_t i = 0; i < raw->count; i++)
        uniform->time[i] = raw->time[0] + (double)i * step;
    memcpy(uniform->value, raw->value, (size_t)raw->count * sizeof(double));
    return true;
}

sf_status sf_signal_filter(const sf_series *raw, double cfc, sf_series *filtered, sf_error *err) {
    SF_OWNED_BY(sf_series_free) sf_series uniform = {0};
    if (!take_uniform(raw, &uniform, err))
        sf_signal_resample(raw, sf_signal_rate(raw), &uniform, err);
    if (err->status == SF_OK)
        sf_signal_filter_cfc(&uniform, cfc, filtered, err);
    return err->status;
}

/* ---- accelerometer ---- */

static void pass_mount(const sf_signal_chain *chain, sf_series *s) {
    const double w = 2 * M_PI * chain->mount_frequency, decay = chain->mount_damping * w,
                 damped = w * sqrt(1 - chain->mount_damping * chain->mount_damping);
    double y = s->value[0], rate = 0, a = s->value[0];
    for (int64_t i = 1; i < s->count; i++) {
        double dt = s->time[i] - s->time[i - 1], slope = (s->value[i] - a) / dt,
               lag = 2 * chain->mount_damping * slope / w; /* of y behind a straight line */
        double z = y - (a - lag), v = rate - slope, e = exp(-decay * dt), c = cos(damped * dt),
               d = sin(damped * dt), q = (v + decay * z) / damped;
        a = s->value[i];
        y = e * (z * c + q * d) + a - lag;
        rate = e * (damped * (q * c - z * d) - decay * (z * c + q * d)) + slope;
        s->value[i] = y;
    }
}

static void pass_coupling(double constant, sf_series *s) {
    double y = 0, a = s->value[0];
    s->value[0] = 0;
    for (int64_t i = 1; i < s->count; i++) {
        double dt = s->time[i] - s->time[i - 1], settled = constant * (s->value[i] - a) / dt;
        a = s->value[i];
        y = settled + (y - settled) * exp(-dt / constant);
        s->value[i] = y;
    }
}

void sf_signal_pass(const sf_signal_chain *chain, sf_series *uniform) {
    if (chain->mount_frequency > 0)
        pass_mount(chain, uniform);
    if (chain->coupling > 0)
        pass_coupling(chain->coupling, uniform);
}

sf_status sf_signal_parse_mount(const char *text, sf_signal_chain *chain, sf_error *err) {
    static const double LEAST = 10, MOST = 20e3; /* Hz */
    char unit[4] = "", rest = 0;
    double f = 0, damping = 0;
    int count = sscanf(text, " f = %lf %3[A-Za-z] , damping = %lf %c", &f, unit, &damping, &rest);
    if (strcmp(unit, "kHz") == 0)
        f *= 1e3;
    else if (strcmp(unit, "Hz") != 0)
        f = 0;
    if (count != 3 || !(f >= LEAST && f <= MOST) || !(damping > 0 && damping < 1))
        return SF_REFUSE(err,
                         "\"%s\" is not a mount: write for example \"f = 420 Hz, damping = 0.05\", with a "
                         "frequency of %g Hz to %g kHz and a damping above 0 and below 1",
                         text, LEAST, 1e-3 * MOST);
    chain->mount_frequency = f;
    chain->mount_damping = damping;
    return SF_OK;
}

sf_status sf_signal_parse_coupling(const char *text, sf_signal_chain *chain, sf_error *err) {
    static const double LEAST = 1e-3, MOST = 1e3; /* s */
    SF_TRY(sf_units_read(text, SF_TIME, &chain->coupling, err));
    if (!(chain->coupling >= LEAST && chain->coupling <= MOST))
        return SF_REFUSE(err, "the time constant" SF_OUTSIDE("%s", "1 ms", "1000 s"), text);
    return SF_OK;
}
