/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/record.h"

#include <gsl/gsl_sort.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"

enum { LEAST_BASE = 5, LEAST_PULSE = 8, LEAST_NOISE = 10 }; /* samples that tell something */
enum { SMOOTH = 40 };           /* part of the pulse over which the medians are averaged: its reciprocal */
static const double FOOT = 0.1; /* of the peak: where the pulse begins and ends */
static const double THIN = 0.1; /* part of the largest sample below which no median of five shows the pulse */

typedef struct record {
    const sf_series *raw, *curve;
    sf_record_facts facts;
    double *median;     /* [count] of five samples; owned */
    double *smooth;     /* [count] mean of the medians over a part of the pulse; owned; NULL: not needed */
    double *work;       /* [count] owned */
    double peak;        /* g, of the medians */
    int64_t begin, end; /* the first and last sample of the pulse */
    bool begins, ends;  /* the record holds both feet of the pulse */
} record;

static double median_of(const double *value, int64_t count, double *work) {
    memcpy(work, value, (size_t)count * sizeof *work);
    gsl_sort(work, 1, (size_t)count);
    return 0.5 * (work[(count - 1) / 2] + work[count / 2]);
}

static void record_free(record *r) {
    SF_CLEAR(r, r->median, r->smooth, r->work);
}

static sf_status record_open(const sf_series *raw, const sf_series *curve, record *r, sf_error *err) {
    int64_t n = raw->count, top = 0;
    *r = (record){.raw = raw, .curve = curve};
    SF_TRY(SF_ALLOC_ALL(err, "medians of the record", SF_ROOM(r->median, n), SF_ROOM(r->work, n)));
    for (int64_t i = 0; i < n; i++) {
        int64_t nearer = i < n - 1 - i ? i : n - 1 - i, half = nearer < 2 ? nearer : 2;
        r->median[i] = median_of(&raw->value[i - half], 2 * half + 1, r->work);
        top = r->median[i] > r->median[top] ? i : top;
    }
    int64_t largest = sf_series_peak(raw);
    if (r->median[top] < THIN * raw->value[largest]) { /* the pulse has one or two samples */
        memcpy(r->median, raw->value, (size_t)n * sizeof *r->median);
        top = largest;
    }
    r->peak = r->median[top];
    for (r->begin = top; r->begin > 0 && r->median[r->begin] > FOOT * r->peak;)
        r->begin--;
    for (r->end = top; r->end < n - 1 && r->median[r->end] > FOOT * r->peak;)
        r->end++;
    r->begins = r->median[r->begin] <= FOOT * r->peak;
    r->ends = r->median[r->end] <= FOOT * r->peak;
    return SF_OK;
}

/* ---- the value of each check; NaN: the record does not tell ---- */

static double spike_value(const record *r) {
    double largest = 0;
    if (r->end - r->begin < LEAST_PULSE)
        return NAN;
    for (int64_t i = 0; i < r->raw->count; i++)
        largest = fmax(largest, fabs(r->raw->value[i] - r->median[i]));
    return largest / r->peak;
}

static double highest(const sf_series *s) {
    return s->value[sf_series_peak(s)];
}

/* ---- saturation ---- */

/* Means of the medians over a part of the pulse, so that noise hides no flat top. */
static sf_status smooth_record(record *r, sf_error *err) {
    int64_t n = r->raw->count, half = (r->end - r->begin) / (2 * SMOOTH);
    SF_TRY(SF_ALLOC_ALL(err, "the record", SF_ROOM(r->smooth, n)));
    for (int64_t i = 0; i < n; i++) {
        int64_t width = half < i ? half : i;
        width = width < n - 1 - i ? width : n - 1 - i;
        for (int64_t k = i - width; k <= i + width; k++)
            r->smooth[i] += r->median[k] / (double)(2 * width + 1);
    }
    return SF_OK;
}

/* The instants at which the smooth curve first and last passes a level of the pulse. */
typedef struct span {
    double first, last; /* s */
} span;

static double crossing(const record *r, int64_t below, int64_t above, double level) {
    double low = r->smooth[below], high = r->smooth[above], *time = r->raw->time;
    return high > low ? time[below] + (level - low) / (high - low) * (time[above] - time[below])
                      : time[above];
}

static span span_above(const record *r, double level) {
    int64_t first = r->begin, last = r->end;
    while (first < r->end && r->smooth[first] < level)
        first++;
    while (last > first && r->smooth[last] < level)
        last--;
    return (span){crossing(r, first > r->begin ? first - 1 : first, first, level),
                  crossing(r, last < r->end ? last + 1 : last, last, level)};
}

static double width_of(span s) {
    return s.last - s.first;
}

/* Slope (g/s) of both flanks between two levels, the harmonic mean. */
static double slope_between(span low, span high, double rise) {
    double width = (high.first - low.first) + (low.last - high.last);
    return width > 0 ? 2 * rise / width : INFINITY;
}

/* True if many samples are exactly the largest one, though the channel resolves far smaller steps. */
static bool ends_at_one_value(const record *r, double interval, double width) {
    static const double FINE = 4e-3, PART = 0.45;
    const double *v = r->raw->value;
    double largest = 0, step = INFINITY;
    int64_t equal = 0;
    for (int64_t i = r->begin; i <= r->end; i++)
        largest = fmax(largest, v[i]);
    for (int64_t i = r->begin; i <= r->end; i++) {
        double next = i < r->end ? fabs(v[i + 1] - v[i]) : 0;
        step = next > 0 ? fmin(step, next) : step;
        equal += v[i] == largest;
    }
    return equal >= 4 && step < FINE * r->peak && (double)equal * interval > PART * width;
}

/* A top that a rail has cut is flat and has corners. Three facts tell it, whatever the shape of the pulse:
 * the width at 98 % of the top over that at 92 % (0.5 of a smooth pulse, 0.35 of a triangle, 0.8 and more
 * where a fifth is cut); the mean height above 95 % over that of a parabola that continues the flanks (0.7
 * and more, under 0.45); and the slope of the flanks at 80 % over that at 90 %, which is 1 at a corner and
 * above 1.75 where a plateau of the foam itself has round shoulders. The bounds come from
 * tests/python/test_pulses.py. */
static double saturation_value(const record *r) {
    static const double FLAT = 0.66, SURELY_FLAT = 0.78, LOW = 0.45, ROUND = 1.75, CORNER = 1.4, CLEAR = 0.9;
    double top = 0, sum = 0, length = r->raw->time[r->end] - r->raw->time[r->begin];
    int64_t samples = r->end - r->begin, inside = 0;
    if (samples < LEAST_PULSE)
        return NAN;
    for (int64_t i = r->begin; i <= r->end; i++)
        top = fmax(top, r->smooth[i]);
    span s98 = span_above(r, 0.98 * top), s95 = span_above(r, 0.95 * top), s92 = span_above(r, 0.92 * top),
         s85 = span_above(r, 0.85 * top), s75 = span_above(r, 0.75 * top);
    double width = width_of(s95), slope = slope_between(s85, s95, 0.1 * top),
           round = slope_between(s75, s85, 0.1 * top) / slope, flat = width_of(s98) / width_of(s92),
           height = slope * width / 4, interval = length / (double)samples, count = width / interval;
    for (int64_t i = r->begin; i <= r->end; i++)
        if (r->raw->time[i] >= s95.first && r->raw->time[i] <= s95.last) {
            sum += r->raw->value[i] - 0.95 * top;
            inside++;
        }
    double part = inside > 0 ? sum / (double)inside / (height * 2 / 3) : NAN;
    bool rail = ends_at_one_value(r, interval, width), cut = rail || (flat >= SURELY_FLAT && count >= 5) ||
                                                             (flat >= FLAT && round < ROUND && count >= 8) ||
                                                             (part < LOW && round < CORNER && count >= 6);
    if (!cut || highest(r->raw) < CLEAR * r->facts.range)
        return 0;
    return fmax(height / top - 0.05, rail ? 0.025 : 0);
}

static double cut_value(const record *r) {
    return fmax(r->begins ? 0 : r->median[0], r->ends ? 0 : r->median[r->raw->count - 1]) / r->peak;
}

/* True if the record begins at contact: what precedes the pulse is shorter than half of it and grows from the
 * first sample on, so that it is the pulse's foot and no rest. */
static bool begins_at_contact(const record *r, const sf_series *series, int64_t count) {
    const double *time = r->raw->time;
    double early = median_of(series->value, count / 2, r->work),
           late = median_of(&series->value[count / 2], count - count / 2, r->work),
           larger = fmax(fabs(early), fabs(late));
    return time[r->begin] - time[0] < 0.5 * (time[r->end] - time[r->begin]) &&
           fabs(late - early) > 0.5 * larger && larger > 2e-3 * r->peak;
}

/* The first half of what precedes the pulse: its foot lies in the other. */
static double base_before(const record *r, const sf_series *series) {
    int64_t count = r->begins ? r->begin / 2 : 0;
    return count < LEAST_BASE || begins_at_contact(r, series, count)
               ? NAN
               : median_of(series->value, count, r->work);
}

static double offset_value(const record *r) {
    return fabs(base_before(r, r->raw)) / r->peak;
}

static double drift_value(const record *r) {
    int64_t after = r->raw->count - r->end, count = r->ends ? after / 4 : 0;
    if (count < LEAST_BASE)
        return NAN;
    return fabs(median_of(&r->raw->value[r->raw->count - count], count, r->work) - base_before(r, r->raw)) /
           r->peak;
}

static double gap_value(const record *r) {
    double longest = 0, length = r->raw->time[r->end] - r->raw->time[r->begin];
    for (int64_t i = r->begin + 1; i <= r->end; i++)
        longest = fmax(longest, r->raw->time[i] - r->raw->time[i - 1]);
    return longest / length;
}

static double noise_value(const record *r) {
    double sum = 0;
    int64_t count = 0;
    for (int64_t i = 0; i < r->raw->count; i++)
        if (i < r->begin || i > r->end) {
            sum += pow(r->raw->value[i] - r->median[i], 2);
            count++;
        }
    return count < LEAST_NOISE ? NAN : sqrt(sum / (double)count) / r->peak;
}

static double ringing_value(const record *r) {
    return fmax(0, highest(r->raw) / highest(r->curve) - 1);
}

/* The highest rise above the lowest value between it and the pulse, before and after. */
static double other_impact_value(const record *r) {
    double most = 0, low = r->smooth[r->begin];
    for (int64_t i = r->begin; i >= 0; i--) {
        low = fmin(low, r->smooth[i]);
        most = fmax(most, r->smooth[i] - low);
    }
    low = r->smooth[r->end];
    for (int64_t i = r->end; i < r->raw->count; i++) {
        low = fmin(low, r->smooth[i]);
        most = fmax(most, r->smooth[i] - low);
    }
    return most / r->peak;
}

/* Compares means near the filtered peak: ringing and noise average out there, what the filter took from the
 * pulse does not. */
static double removed_value(const record *r) {
    static const double HIGH = 0.9;
    int64_t top = sf_series_peak(r->curve), first = top, last = top;
    double level = HIGH * r->curve->value[top], raw = 0, filtered = 0;
    while (first > 0 && r->curve->value[first - 1] >= level)
        first--;
    while (last < r->curve->count - 1 && r->curve->value[last + 1] >= level)
        last++;
    for (int64_t i = first; i <= last; i++) {
        raw += sf_series_at(r->raw, r->curve->time[i]);
        filtered += r->curve->value[i];
    }
    return raw > 0 ? fmax(0, 1 - filtered / raw) : NAN;
}

static double range_value(const record *r) {
    double largest = 0;
    for (int64_t i = 0; i < r->raw->count; i++)
        largest = fmax(largest, fabs(r->raw->value[i]));
    return r->facts.range > 0 ? largest / r->facts.range : NAN;
}

static double pulse_length(const record *r) {
    return r->raw->time[r->end] - r->raw->time[r->begin];
}

static double duration_value(const record *r) {
    static const double SHORTEST = 0.2e-3, LONGEST = 1; /* s */
    return fmax(SHORTEST / pulse_length(r), pulse_length(r) / LONGEST);
}

/* Change of velocity (m/s) of the pulse with its feet, above the zero line. */
static double velocity_change(const record *r) {
    double base = base_before(r, r->raw), sum = 0, foot = 0.25 * pulse_length(r);
    const double *time = r->raw->time, *v = r->raw->value;
    base = isnan(base) ? 0 : base;
    for (int64_t i = 1; i < r->raw->count; i++)
        if (time[i] >= time[r->begin] - foot && time[i] <= time[r->end] + foot)
            sum += (0.5 * (v[i] + v[i - 1]) - base) * (time[i] - time[i - 1]);
    return sum * SF_STANDARD_GRAVITY;
}

static double velocity_value(const record *r) {
    double part = velocity_change(r) / r->facts.speed;
    return r->facts.speed > 0 ? fmax(0, fmax(1 - part, 1.5 * (part - 2))) : NAN;
}

typedef double (*value_of)(const record *r);
#define VALUE(name, ...) name##_value,
static const value_of values[SF_RECORD_CHECKS] = {SF_GOOD_RECORD(VALUE)};
#undef VALUE

/* ---- rows ---- */

#define ROW(name, remark, refuse, heading, how, reason)                                                      \
    {.key = #name, .title = heading, .why = reason, .unit = "1", .bound = remark, .use_bound = refuse},
static const sf_check rules[SF_RECORD_CHECKS] = {SF_GOOD_RECORD(ROW)};
#undef ROW

/* Units that are mistaken for each other, and what the change of velocity then is too small by. */
static const struct {
    double factor;
    const char *mistake;
} mistakes[] = {
    {SF_STANDARD_GRAVITY, "its values are too small by 9.8, as those in g under a heading of m/s2"},
    {1 / SF_STANDARD_GRAVITY, "its values are too large by 9.8, as those in m/s2 under a heading of g"},
    {1e3, "its times are too short by 1000, as seconds under a heading of ms"},
    {1e-3, "its times are too long by 1000, as ms under a heading of s"}};

/* Writes the findings that are not only a value and its bound. */
static void describe(const record *r, sf_check *row) {
    static const double LEAST = 0.9, MOST = 2.1; /* of the known speed */
    bool bad = row->grade != SF_GRADE_VALID;
    double change = velocity_change(r), speed = r->facts.speed, length = pulse_length(r);
    if (isnan(row->value)) {
        snprintf(row->text, sizeof row->text, "%s: the record does not tell", row->title);
    } else if (row->key == rules[SF_RECORD_velocity].key) {
        snprintf(row->text, sizeof row->text,
                 "its velocity changes by %.3g m/s, %.2g times the known speed of %.4g m/s; %g to %g can be",
                 change, change / speed, speed, LEAST, MOST);
        for (size_t k = 0; bad && k < sizeof mistakes / sizeof *mistakes; k++)
            if (change * mistakes[k].factor > LEAST * speed && change * mistakes[k].factor < MOST * speed)
                sf_text_add(row->text, sizeof row->text, ": %s", mistakes[k].mistake);
    } else if (row->key == rules[SF_RECORD_duration].key) {
        snprintf(row->text, sizeof row->text, "the pulse lasts %.3g ms; 0.2 to 1000 ms can be", 1e3 * length);
        if (bad)
            sf_text_add(row->text, sizeof row->text, ": %s", mistakes[length < 1e-3 ? 2 : 3].mistake);
    }
}

sf_status sf_record_judge(const sf_series *raw, const sf_series *curve, const sf_record_facts *facts,
                          sf_record_verdict *verdict, sf_error *err) {
    SF_OWNED_BY(record_free) record r = {0};
    *verdict = (sf_record_verdict){0};
    SF_TRY(record_open(raw, curve, &r, err));
    SF_TRY(smooth_record(&r, err));
    r.facts = *facts;
    for (int k = 0; k < SF_RECORD_CHECKS; k++) {
        sf_check *row = &verdict->rows[k];
        *row = rules[k];
        row->value = r.peak > 0 ? values[k](&r) : NAN;
        row->value = k == SF_RECORD_other_impact ? fmax(row->value, facts->other) : row->value;
        sf_check_judge(row, true);
        describe(&r, row);
        verdict->grade = row->grade > verdict->grade ? row->grade : verdict->grade;
    }
    return SF_OK;
}

sf_status sf_record_offset(const sf_series *raw, const sf_series *axis, double *offset, sf_error *err) {
    SF_OWNED_BY(record_free) record r = {0};
    *offset = NAN;
    SF_TRY(record_open(raw, raw, &r, err));
    *offset = base_before(&r, axis);
    return SF_OK;
}

sf_status sf_record_find_impacts(const sf_series *raw, sf_record_impact impact[SF_RECORD_IMPACTS], int *count,
                                 sf_error *err) {
    static const double HIGH = 0.2;   /* of the highest */
    static const double APART = 5e-3; /* s */
    SF_OWNED_BY(record_free) record r = {0};
    *count = 0;
    SF_TRY(record_open(raw, raw, &r, err));
    bool inside = false;
    double left = raw->time[0], lowest = 0;
    for (int64_t i = 0; i < raw->count; i++)
        lowest = fmin(lowest, r.median[i]);
    if (-lowest > r.peak) /* an inverted channel: its overshoot is no impact */
        return SF_OK;
    for (int64_t i = 0; i < raw->count && r.peak > 0; i++) {
        sf_record_impact *now = &impact[*count - 1];
        bool rises = !inside && r.median[i] > HIGH * r.peak,
             again = *count > 0 && raw->time[i] - left < APART;
        if (rises && again) {
            inside = true;
        } else if (rises) {
            if (*count == SF_RECORD_IMPACTS)
                break;
            now = &impact[(*count)++];
            *now = (sf_record_impact){.begin = *count == 1 ? raw->time[0] : 0.5 * (left + raw->time[i])};
            if (*count > 1)
                now[-1].end = now->begin;
            inside = true;
        }
        if (inside && r.median[i] > now->peak) {
            now->peak = r.median[i];
            now->time = raw->time[i];
        }
        if (inside && r.median[i] < FOOT * r.peak) {
            left = raw->time[i];
            inside = false;
        }
    }
    if (*count > 0)
        impact[*count - 1].end = raw->time[raw->count - 1];
    return SF_OK;
}

void sf_record_line(const sf_record_verdict *verdict, char *text, size_t size) {
    sf_check_line(verdict->grade, SF_RECORD_CHECKS, verdict->rows, SF_RECORD_CHECKS, text, size);
}
