/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/injury.h"

#include "base/sets.h"

#include <gsl/gsl_statistics_double.h>
#include <math.h>

/* Intervals of the grid that is searched: as many as the curve has, within these bounds. */
enum { LEAST_INTERVALS = 512, MOST_INTERVALS = 4096, COARSE = 16, POLISHES = 40 };
static const double CLOSEST = 1e-5; /* of an interval: the smallest move of an end */

typedef struct search {
    const sf_series *curve;
    double first, last, longest; /* s, of the curve, and the window's limit */
    double score, t1, t2;        /* of the best window: HIC^2 = dv^5 / dt^3, which saves the powers; s */
} search;

static void offer(search *s, double t1, double t2, double dv) {
    double dt = t2 - t1, score = dv > 0 && dt > 0 ? dv * dv * dv * dv * dv / (dt * dt * dt) : 0;
    if (score > s->score) {
        s->score = score;
        s->t1 = t1;
        s->t2 = t2;
    }
}

/* Returns the integral of the curve up to `time`; that up to its points is given. */
static double integral_at(const sf_series *c, const double *integral, double time) {
    int64_t i = sf_interval_find(c->time, c->count, time);
    double dt = time - c->time[i], slope = (c->value[i + 1] - c->value[i]) / (c->time[i + 1] - c->time[i]);
    return integral[i] + dt * (c->value[i] + 0.5 * dt * slope);
}

/* Offers the pairs of the grid's instants, `stride` apart, that may be better than the best one: the mean of
 * a window is at most the peak, its integral at most the greatest one less that before the window, and at
 * least what makes a window of this length as good as the best one at the begin of the scan (`least`, [n + 1]
 * of work). */
static void scan(search *s, int64_t n, const double *v, double step, int64_t stride, double *least) {
    for (int64_t k = 0; k <= n; k += stride)
        least[k] = pow(s->score * pow((double)k * step, 3), 0.2) * (1 - 1e-12);
    double peak = s->curve->value[sf_series_peak(s->curve)], greatest = gsl_stats_max(v, 1, (size_t)n + 1);
    for (int64_t i = 0; i < n && v[i] < greatest; i += stride) {
        double shortest = fmax((double)stride, sqrt(s->score / pow(peak, 5)) / step);
        double longest = fmin(s->longest, cbrt(pow(greatest - v[i], 5) / s->score)) / step;
        int64_t last = i + (int64_t)fmin(longest * (1 + 1e-12), (double)(n - i));
        for (int64_t j = i + (int64_t)shortest; j <= last; j += stride)
            if (v[j] - v[i] >= least[j - i])
                offer(s, s->first + (double)i * step, s->first + (double)j * step, v[j] - v[i]);
    }
}

/* Moves the ends of the best window, by less and less, until no move makes it better. */
static void refine(search *s, const double *integral, double step) {
    for (double move = step; move > CLOSEST * step;) {
        const search centre = *s;
        for (int k = 0; k < 9; k++) {
            double t1 = fmax(s->first, centre.t1 + (k / 3 - 1) * move);
            double t2 = fmin(fmin(s->last, centre.t2 + (k % 3 - 1) * move), t1 + s->longest);
            offer(s, t1, t2, integral_at(s->curve, integral, t2) - integral_at(s->curve, integral, t1));
        }
        if (!(s->score > centre.score))
            move /= 2;
    }
}

static double slope_at(const sf_series *c, double time) {
    int64_t i = sf_interval_find(c->time, c->count, time);
    return (c->value[i + 1] - c->value[i]) / (c->time[i + 1] - c->time[i]);
}

/* Solves for the ends: a(t1) = a(t2) where the window is as long as it may be, else both are 3/5 of the mean.
 * The score alone is flat to its rounding over 1e-8 of the window. */
static void polish(search *s, const double *integral) {
    bool limited = s->t2 - s->t1 > s->longest * (1 - 1e-9);
    bool moves_first = s->t1 > s->first, moves_last = s->t2 < s->last;
    double t1 = s->t1, t2 = s->t2, dv = 0;
    if (limited && !(moves_first && moves_last))
        return;
    for (int k = 0; k < POLISHES; k++) {
        double a1 = sf_series_at(s->curve, t1), slope1 = slope_at(s->curve, t1);
        double a2 = sf_series_at(s->curve, t2), slope2 = slope_at(s->curve, t2);
        dv = integral_at(s->curve, integral, t2) - integral_at(s->curve, integral, t1);
        double level = 0.6 * dv / (t2 - t1), shift = (a2 - a1) / (slope1 - slope2);
        if (moves_first)
            t1 += limited ? shift : (level - a1) / slope1;
        if (moves_last)
            t2 += limited ? shift : (level - a2) / slope2;
    }
    double score = pow(dv, 5) / pow(t2 - t1, 3);
    if (t1 >= s->first && t2 <= s->last && score > s->score * (1 - 1e-13)) {
        s->score = score;
        s->t1 = t1;
        s->t2 = t2;
    }
}

sf_status sf_hic_evaluate(const sf_series *curve, double window, sf_hic *hic, sf_error *err) {
    *hic = (sf_hic){0, NAN, NAN};
    if (!(window > 0))
        return SF_REFUSE(err, "a HIC window of %g s" SF_NOT_ABOVE_0, window);
    SF_TRY(sf_series_check(curve, "the acceleration curve", err));
    int64_t count = curve->count;
    int64_t n = count < LEAST_INTERVALS ? LEAST_INTERVALS : count - 1;
    if (n > MOST_INTERVALS)
        n = MOST_INTERVALS;
    SF_OWNED double *integral = sf_alloc(err, (size_t)(count + 2 * (n + 1)), sizeof *integral, "the HIC search");
    SF_TRY(err->status);
    for (int64_t i = 1; i < count; i++)
        integral[i] = integral[i - 1] +
                      (curve->time[i] - curve->time[i - 1]) * (curve->value[i] + curve->value[i - 1]) / 2;

    search s = {.curve = curve, .first = curve->time[0], .last = curve->time[count - 1], .longest = window};
    double step = (s.last - s.first) / (double)n, *v = integral + count;
    for (int64_t i = 0; i <= n; i++)
        v[i] = integral_at(curve, integral, s.first + (double)i * step);
    scan(&s, n, v, step, COARSE, v + n + 1);
    scan(&s, n, v, step, 1, v + n + 1);
    for (int64_t i = 0; i <= n && s.first + (double)i * step + window <= s.last; i++) {
        double t1 = s.first + (double)i * step;
        offer(&s, t1, t1 + window, integral_at(curve, integral, t1 + window) - v[i]);
    }
    if (s.score > 0) {
        refine(&s, integral, step);
        polish(&s, integral);
        *hic = (sf_hic){sqrt(s.score), s.t1, s.t2};
    }
    return SF_OK;
}

/* Integral of a^2.5 over an interval on which a >= 0 runs linearly from `a1` to `a2`. */
static double gadd_interval(double a1, double a2, double dt) {
    double difference = a2 - a1;
    if (fabs(difference) > 1e-3 * fmax(a1, a2))
        return dt * (pow(a2, 3.5) - pow(a1, 3.5)) / (3.5 * difference);
    /* Nearly constant: the quotient cancels, Simpson's error is below 1e-13. */
    return dt * (pow(a1, 2.5) + 4 * pow((a1 + a2) / 2, 2.5) + pow(a2, 2.5)) / 6;
}

static double gadd_index(const sf_series *curve) {
    double sum = 0;
    for (int64_t i = 1; i < curve->count; i++) {
        double a1 = curve->value[i - 1], a2 = curve->value[i], dt = curve->time[i] - curve->time[i - 1];
        if (a1 <= 0 && a2 <= 0)
            continue;
        if (a1 < 0) {
            dt *= a2 / (a2 - a1);
            a1 = 0;
        } else if (a2 < 0) {
            dt *= a1 / (a1 - a2);
            a2 = 0;
        }
        sum += gadd_interval(a1, a2, dt);
    }
    return sum;
}

/* Time for which the curve is at or above `limit`: the longest stretch, or the sum. */
static double time_above(const sf_series *curve, double limit, int contiguous) {
    double longest = 0, run = 0, sum = 0;
    for (int64_t i = 1; i < curve->count; i++) {
        double a1 = curve->value[i - 1], a2 = curve->value[i], dt = curve->time[i] - curve->time[i - 1];
        double part = 0;
        if (a1 >= limit && a2 >= limit) {
            part = dt;
            run += part;
        } else if (a1 >= limit) {
            part = dt * (a1 - limit) / (a1 - a2);
            run += part;
        } else if (a2 >= limit) {
            part = dt * (a2 - limit) / (a2 - a1);
            run = part;
        }
        sum += part;
        longest = fmax(longest, run);
        if (a2 < limit)
            run = 0;
    }
    return contiguous ? longest : sum;
}

/* Returns the largest level that the curve reaches or exceeds for `duration` (s), at a stretch or summed over
 * all stretches; NaN if the whole curve is shorter. */
static double clip_level(const sf_series *curve, double duration, int contiguous) {
    double low, high;
    gsl_stats_minmax(&low, &high, curve->value, 1, (size_t)curve->count);
    double slack = duration * 1e-12; /* rounding of summed intervals */
    if (time_above(curve, low, contiguous) < duration - slack)
        return NAN;
    for (double middle; (middle = low + (high - low) / 2) > low && middle < high;) {
        if (time_above(curve, middle, contiguous) >= duration - slack)
            low = middle;
        else
            high = middle;
    }
    return low;
}

sf_status sf_injury_evaluate_peak(const sf_series *curve, sf_injury *injury, sf_error *err) {
    int64_t peak = sf_series_peak(curve);
    *injury = (sf_injury){.a_max_g = curve->value[peak], .a_max_time = curve->time[peak]};
    return sf_hic_evaluate(curve, INFINITY, &injury->hic, err);
}

sf_status sf_injury_evaluate(const sf_series *curve, sf_injury *injury, sf_error *err) {
    const double clip_duration = 3e-3;
    SF_TRY(sf_injury_evaluate_peak(curve, injury, err));
    injury->hic15 = injury->hic36 = injury->hic;
    double window = injury->hic.t2 - injury->hic.t1; /* the best of all is the best of those up to a limit */
    if (!(window <= 15e-3))
        SF_TRY(sf_hic_evaluate(curve, 15e-3, &injury->hic15, err));
    if (!(window <= 36e-3))
        SF_TRY(sf_hic_evaluate(curve, 36e-3, &injury->hic36, err));
    injury->gadd = gadd_index(curve);
    injury->clip_contiguous_g = clip_level(curve, clip_duration, 1);
    injury->clip_cumulative_g = clip_level(curve, clip_duration, 0);
    return SF_OK;
}
