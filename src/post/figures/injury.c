/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/injury.h"

#include "base/sets.h"

#include <gsl/gsl_statistics_double.h>
#include <math.h>

/* Intervals of the search grid, pairs of the first coarse scan per side, relative gap that ends it. */
enum { GRID_INTERVALS = 4096, SCAN_POINTS = 256, MAX_LEVELS = 40, MAX_SWEEPS = 400 };
#define SEARCH_GAP 1e-9

/* Cells of level l hold 2^l successive grid points; level 0 is the points themselves. */
typedef struct level {
    int64_t count;
    double *least;    /* [count] smallest integral v in the cell */
    double *greatest; /* [count] largest integral v */
    double *peak;     /* [count] largest a */
} level;

typedef struct search {
    int64_t count;  /* grid points */
    double *t;      /* [count] s */
    double *a;      /* [count] g */
    double *v;      /* [count] g s, integral of a from the start */
    double *memory; /* of all levels */
    double window;  /* s */
    int level_count;
    level levels[MAX_LEVELS];
    double best; /* HIC^2 = dv^5 / dt^3 of the best pair so far: saves the powers */
    double t1, t2;
} search;

static double score(double dv, double dt) {
    return dv > 0 && dt > 0 ? dv * dv * dv * dv * dv / (dt * dt * dt) : 0;
}

/* Splits long intervals of the curve (exact, as it is piecewise linear) and integrates it (exact: trapezia).
 */
static sf_status grid_build(search *s, const sf_series *curve, sf_error *err) {
    double longest = (curve->time[curve->count - 1] - curve->time[0]) / GRID_INTERVALS;
    s->count = 1;
    for (int64_t i = 1; i < curve->count; i++)
        s->count += (int64_t)fmax(1, ceil((curve->time[i] - curve->time[i - 1]) / longest - 1e-9));
    s->t = sf_alloc(err, (unsigned long)s->count * 3, sizeof(double), "the HIC grid");
    SF_TRY(err->status);
    s->a = s->t + s->count;
    s->v = s->a + s->count;
    s->t[0] = curve->time[0];
    s->a[0] = curve->value[0];
    int64_t k = 1;
    for (int64_t i = 1; i < curve->count; i++) {
        double dt = curve->time[i] - curve->time[i - 1], da = curve->value[i] - curve->value[i - 1];
        int64_t parts = (int64_t)fmax(1, ceil(dt / longest - 1e-9));
        for (int64_t j = 1; j <= parts; j++, k++) {
            double part = (double)j / (double)parts;
            s->t[k] = j == parts ? curve->time[i] : curve->time[i - 1] + part * dt;
            s->a[k] = curve->value[i - 1] + part * da;
            s->v[k] = s->v[k - 1] + (s->t[k] - s->t[k - 1]) * (s->a[k] + s->a[k - 1]) / 2;
        }
    }
    return SF_OK;
}

static sf_status levels_build(search *s, sf_error *err) {
    int64_t total = 0;
    for (int64_t cells = s->count;; cells = (cells + 1) / 2) {
        s->levels[s->level_count++].count = cells;
        total += cells;
        if (cells == 1)
            break;
    }
    s->memory = sf_alloc(err, (unsigned long)total * 3, sizeof(double), "the HIC search");
    SF_TRY(err->status);
    double *next = s->memory;
    for (int l = 0; l < s->level_count; l++) {
        level *here = &s->levels[l];
        here->least = next;
        here->greatest = next + here->count;
        here->peak = next + 2 * here->count;
        next += 3 * here->count;
        for (int64_t c = 0; c < here->count; c++) {
            if (l == 0) {
                here->least[c] = here->greatest[c] = s->v[c];
                here->peak[c] = s->a[c];
                continue;
            }
            const level *below = here - 1;
            int64_t one = 2 * c, two = 2 * c + 1 < below->count ? 2 * c + 1 : one;
            here->least[c] = fmin(below->least[one], below->least[two]);
            here->greatest[c] = fmax(below->greatest[one], below->greatest[two]);
            here->peak[c] = fmax(below->peak[one], below->peak[two]);
        }
    }
    return SF_OK;
}

static void offer(search *s, double t1, double t2, double dv) {
    double value = score(dv, t2 - t1);
    if (value > s->best) {
        s->best = value;
        s->t1 = t1;
        s->t2 = t2;
    }
}

/* Best score that any t1 in cell p and t2 in cell q >= p of level l could have. */
static double pair_bound(const search *s, int l, int64_t p, int64_t q) {
    const level *here = &s->levels[l];
    int64_t p_last = ((p + 1) << l) - 1, q_last = ((q + 1) << l) - 1;
    if (q_last > s->count - 1)
        q_last = s->count - 1;
    double bound = INFINITY;
    if (p < q) {
        double shortest = s->t[q << l] - s->t[p_last];
        if (shortest > s->window)
            return 0;
        bound = score(here->greatest[q] - here->least[p], shortest);
    }
    if (q - p <= 1) { /* neighbours: the mean is at most the peak of the two */
        double peak = fmax(here->peak[p], here->peak[q]);
        double span = fmin(s->t[q_last] - s->t[p << l], s->window);
        bound = fmin(bound, peak > 0 ? span * span * pow(peak, 5) : 0);
    }
    return bound;
}

static void search_pairs(search *s, int l, int64_t p, int64_t q) {
    if (pair_bound(s, l, p, q) <= s->best * (1 + SEARCH_GAP))
        return;
    if (l == 0) {
        if (s->t[q] - s->t[p] <= s->window)
            offer(s, s->t[p], s->t[q], s->v[q] - s->v[p]);
        return;
    }
    int64_t limit = s->levels[l - 1].count;
    for (int64_t i = 2 * p; i <= 2 * p + 1; i++)
        for (int64_t j = 2 * q; j <= 2 * q + 1; j++)
            if (i <= j && j < limit)
                search_pairs(s, l - 1, i, j);
}

static double a_at(const search *s, double time) {
    int64_t i = sf_interval_find(s->t, s->count, time);
    return s->a[i] + (s->a[i + 1] - s->a[i]) * (time - s->t[i]) / (s->t[i + 1] - s->t[i]);
}

static double v_at(const search *s, double time) {
    int64_t i = sf_interval_find(s->t, s->count, time);
    return s->v[i] + (time - s->t[i]) * (s->a[i] + a_at(s, time)) / 2;
}

/* A first good value: coarse pairs, and all windows of full length that begin or end at a grid point. */
static void search_start(search *s) {
    int64_t stride = s->count / SCAN_POINTS + 1;
    for (int64_t i = 0; i < s->count; i += stride)
        for (int64_t j = i + stride; j < s->count && s->t[j] - s->t[i] <= s->window; j += stride)
            offer(s, s->t[i], s->t[j], s->v[j] - s->v[i]);
    double first = s->t[0], last = s->t[s->count - 1];
    if (s->window >= last - first)
        return;
    for (int64_t i = 0; i < s->count; i++) {
        double end = s->t[i] + s->window, begin = s->t[i] - s->window;
        if (end <= last)
            offer(s, s->t[i], end, v_at(s, end) - s->v[i]);
        if (begin >= first)
            offer(s, begin, s->t[i], s->v[i] - v_at(s, begin));
    }
}

/* Derivative of HIC along (d1, d2), up to a positive factor: d ln HIC / dt2 ~ a(t2) - 3/5 mean, dt1 the
 * opposite. */
static double slope(const search *s, double t1, double t2, int d1, int d2) {
    double mean = (v_at(s, t2) - v_at(s, t1)) / (t2 - t1);
    return d2 * (a_at(s, t2) - 0.6 * mean) - d1 * (a_at(s, t1) - 0.6 * mean);
}

/* Moves the window along (d1, d2), at most `reach`, uphill until the slope changes sign. Returns the distance
 * moved. */
static double climb(search *s, int d1, int d2, double reach) {
    double first = s->t[0], last = s->t[s->count - 1];
    double grow = d2 - d1; /* of t2 - t1 per unit */
    if (d1 < 0)
        reach = fmin(reach, s->t1 - first);
    if (d2 > 0)
        reach = fmin(reach, last - s->t2);
    if (grow > 0)
        reach = fmin(reach, (s->window - (s->t2 - s->t1)) / grow);
    if (grow < 0)
        reach = fmin(reach, 0.5 * (s->t2 - s->t1) / -grow);
    if (!(reach > 0) || !(slope(s, s->t1, s->t2, d1, d2) > 0))
        return 0;
    double low = 0, high = reach;
    if (slope(s, s->t1 + d1 * reach, s->t2 + d2 * reach, d1, d2) > 0)
        low = reach;
    for (int k = 0; k < 60 && low < high; k++) {
        double middle = (low + high) / 2;
        if (slope(s, s->t1 + d1 * middle, s->t2 + d2 * middle, d1, d2) > 0)
            low = middle;
        else
            high = middle;
    }
    double t1 = s->t1 + d1 * low, t2 = s->t2 + d2 * low;
    double value = score(v_at(s, t2) - v_at(s, t1), t2 - t1);
    if (value < s->best * (1 - 1e-14)) /* rounding may hide the last gains, a real loss is refused */
        return 0;
    s->best = fmax(value, s->best);
    s->t1 = t1;
    s->t2 = t2;
    return low;
}

static void refine(search *s) {
    static const int directions[6][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, 1}};
    double reach = 2 * (s->t[s->count - 1] - s->t[0]) / GRID_INTERVALS;
    for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
        double moved = 0;
        for (int k = 0; k < 6; k++)
            moved += climb(s, directions[k][0], directions[k][1], reach);
        if (moved < 1e-9 * reach)
            return;
    }
}

sf_status sf_hic_evaluate(const sf_series *acceleration_g, double window, sf_hic *hic, sf_error *err) {
    *hic = (sf_hic){0, NAN, NAN};
    search s = {.window = window, .t1 = NAN, .t2 = NAN};
    if (!(window > 0))
        return SF_REFUSE(err, "a HIC window of %g s" SF_NOT_ABOVE_0, window);
    SF_TRY(sf_series_check(acceleration_g, "the acceleration curve", err));
    if (grid_build(&s, acceleration_g, err) == SF_OK && levels_build(&s, err) == SF_OK) {
        search_start(&s);
        search_pairs(&s, s.level_count - 1, 0, 0);
    }
    if (s.best > 0) {
        refine(&s);
        *hic = (sf_hic){sqrt(s.best), s.t1, s.t2};
    }
    SF_FREE(s.t, s.memory);
    return err->status;
}

/* Integral of a^2.5 over an interval on which a >= 0 runs linearly from `a1` to `a2`. */
static double gadd_interval(double a1, double a2, double dt) {
    double difference = a2 - a1;
    if (fabs(difference) > 1e-3 * fmax(a1, a2))
        return dt * (pow(a2, 3.5) - pow(a1, 3.5)) / (3.5 * difference);
    /* Nearly constant: the quotient cancels, Simpson's error is below 1e-13. */
    return dt * (pow(a1, 2.5) + 4 * pow((a1 + a2) / 2, 2.5) + pow(a2, 2.5)) / 6;
}

double sf_injury_gadd(const sf_series *curve) {
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

double sf_injury_clip(const sf_series *curve, double duration, int contiguous) {
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
    SF_TRY(sf_hic_evaluate(curve, 15e-3, &injury->hic15, err));
    SF_TRY(sf_hic_evaluate(curve, 36e-3, &injury->hic36, err));
    injury->gadd = sf_injury_gadd(curve);
    injury->clip_contiguous_g = sf_injury_clip(curve, clip_duration, 1);
    injury->clip_cumulative_g = sf_injury_clip(curve, clip_duration, 0);
    return SF_OK;
}
