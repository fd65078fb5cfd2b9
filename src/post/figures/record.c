/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/record.h"

#include <gsl/gsl_sort.h>
#include <string.h>

enum { LEAST_BASE = 5, LEAST_PULSE = 8, LEAST_NOISE = 10 }; /* samples that tell something */
static const double FOOT = 0.1;                             /* of the peak: where the pulse begins and ends */

typedef struct record {
    const sf_series *raw, *curve;
    double *median;     /* [count] of five samples; owned */
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
    SF_CLEAR(r, r->median, r->work);
}

static sf_status record_open(const sf_series *raw, const sf_series *curve, record *r, sf_error *err) {
    int64_t n = raw->count, top = 0;
    *r = (record){.raw = raw, .curve = curve};
    SF_TRY(SF_ALLOC_ALL(err, "medians of the record", SF_ROOM(r->median, n), SF_ROOM(r->work, n)));
    for (int64_t i = 0; i < n; i++) {
        int64_t half = i < 2 ? i : n - 1 - i < 2 ? n - 1 - i : 2;
        r->median[i] = median_of(&raw->value[i - half], 2 * half + 1, r->work);
        top = r->median[i] > r->median[top] ? i : top;
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

/* The vertex of the parabola by least squares through (x, v) [count], above `top`; 0 if it has none. */
static double vertex_above(const double *x, const double *v, int count, double top) {
    double s[5] = {0}, t[3] = {0};
    for (int i = 0; i < count; i++)
        for (int p = 0; p < 5; p++) {
            s[p] += pow(x[i], p);
            t[p % 3] += p < 3 ? pow(x[i], p) * v[i] : 0;
        }
    double d = s[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (s[1] * s[4] - s[3] * s[2]) +
               s[2] * (s[1] * s[3] - s[2] * s[2]);
    double a = (t[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (t[1] * s[4] - s[3] * t[2]) +
                s[2] * (t[1] * s[3] - s[2] * t[2])) /
               d,
           b = (s[0] * (t[1] * s[4] - t[2] * s[3]) - t[0] * (s[1] * s[4] - s[3] * s[2]) +
                s[2] * (s[1] * t[2] - t[1] * s[2])) /
               d,
           c = (s[0] * (s[2] * t[2] - s[3] * t[1]) - s[1] * (s[1] * t[2] - t[1] * s[2]) +
                t[0] * (s[1] * s[3] - s[2] * s[2])) /
               d;
    return c < 0 ? fmax(0, a - b * b / (4 * c) - top) : 0;
}

static double saturation_value(const record *r) {
    enum { FLANK = 3 };
    const double *v = r->raw->value, *time = r->raw->time;
    double x[2 * FLANK], y[2 * FLANK], worst = 0;
    for (int64_t i = r->begin; i <= r->end;) {
        int64_t last = i;
        while (last < r->end && fabs(v[last + 1] - v[i]) <= 1e-4 * r->peak)
            last++;
        if (last > i && v[i] > 0.5 * r->peak && i >= FLANK && last + FLANK < r->raw->count &&
            v[i - 1] < v[i] && v[last + 1] < v[last]) {
            double middle = 0.5 * (time[i] + time[last]), half = time[last + FLANK] - middle;
            for (int k = 0; k < FLANK; k++) {
                x[k] = (time[i - FLANK + k] - middle) / half;
                y[k] = v[i - FLANK + k];
                x[FLANK + k] = (time[last + 1 + k] - middle) / half;
                y[FLANK + k] = v[last + 1 + k];
            }
            worst = fmax(worst, vertex_above(x, y, 2 * FLANK, v[i]));
        }
        i = last + 1;
    }
    return worst / r->peak;
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

static double highest(const sf_series *s) {
    return s->value[sf_series_peak(s)];
}

static double ringing_value(const record *r) {
    return fmax(0, highest(r->raw) / highest(r->curve) - 1);
}

/* The medians beyond the feet of the pulse, from where they turn. */
static double other_impact_value(const record *r) {
    double most = 0;
    int64_t i = r->begin, k = r->end;
    while (i > 0 && r->median[i - 1] <= r->median[i])
        i--;
    while (k < r->raw->count - 1 && r->median[k + 1] <= r->median[k])
        k++;
    for (int64_t j = 0; j < r->raw->count; j++)
        if (j < i || j > k)
            most = fmax(most, r->median[j]);
    return most / r->peak;
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

sf_status sf_record_judge(const sf_series *raw, const sf_series *curve, double other,
                          sf_record_verdict *verdict, sf_error *err) {
    SF_OWNED_BY(record_free) record r = {0};
    *verdict = (sf_record_verdict){0};
    SF_TRY(record_open(raw, curve, &r, err));
    for (int k = 0; k < SF_RECORD_CHECKS; k++) {
        sf_check *row = &verdict->rows[k];
        *row = rules[k];
        row->value = r.peak > 0 ? values[k](&r) : NAN;
        row->value = k == SF_RECORD_other_impact ? fmax(row->value, other) : row->value;
        sf_check_judge(row, true);
        if (isnan(row->value))
            snprintf(row->text, sizeof row->text, "%s: the record does not tell", row->title);
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
