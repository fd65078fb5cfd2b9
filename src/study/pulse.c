/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/pulse.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

enum { LEVELS = 40, CLOSER = 40 };
static const double FOOT = 0.2, LEAST_LEVEL = 0.25, MOST_LEVEL = 0.95; /* of the peak */

typedef struct pulse {
    const sf_series *a;
    int64_t first, peak, last; /* points: from `first` to `last` above the foot */
    double *integral;          /* [count] of the curve, g s */
} pulse;

/* One peak: rises from the foot to it and falls to the foot, with nothing above the foot elsewhere. */
static bool is_single(pulse *p) {
    const double *a = p->a->value;
    int64_t n = p->a->count;
    p->peak = 0;
    for (int64_t k = 1; k < n; k++)
        p->peak = a[k] > a[p->peak] ? k : p->peak;
    for (p->first = p->peak;
         p->first > 0 && a[p->first - 1] <= a[p->first] && a[p->first] > FOOT * a[p->peak];)
        p->first--;
    for (p->last = p->peak;
         p->last < n - 1 && a[p->last + 1] <= a[p->last] && a[p->last] > FOOT * a[p->peak];)
        p->last++;
    if (!(a[p->peak] > 0) || a[p->first] > FOOT * a[p->peak] || a[p->last] > FOOT * a[p->peak])
        return false;
    for (int64_t k = 0; k < n; k++)
        if ((k < p->first || k > p->last) && a[k] > FOOT * a[p->peak])
            return false;
    return true;
}

/* The instant between points `below` and `above`, neighbours in the end, where the curve has this level; and
 * its integral up to there. */
static double cross(const pulse *p, int64_t below, int64_t above, double level, double *integral) {
    const double *a = p->a->value, *t = p->a->time;
    while (llabs(above - below) > 1) {
        int64_t middle = (below + above) / 2;
        if (a[middle] < level)
            below = middle;
        else
            above = middle;
    }
    double part = a[above] > a[below] ? (level - a[below]) / (a[above] - a[below]) : 1,
           time = t[below] + part * (t[above] - t[below]);
    *integral = p->integral[below] + 0.5 * (a[below] + level) * (time - t[below]);
    return time;
}

static double score(const pulse *p, double part, sf_hic *at) {
    double from, to, level = part * p->a->value[p->peak];
    at->t1 = cross(p, p->first, p->peak, level, &from);
    at->t2 = cross(p, p->last, p->peak, level, &to);
    at->value = (at->t2 - at->t1) * pow((to - from) / (at->t2 - at->t1), 2.5);
    return at->value;
}

/* The best level, as a part of the peak: from a scan, then by golden sections. */
static double find_level(const pulse *p) {
    static const double GOLDEN = 0.6180339887498949;
    double step = (MOST_LEVEL - FOOT) / LEVELS, best = FOOT, highest = 0;
    sf_hic at;
    for (int k = 0; k <= LEVELS; k++)
        if (score(p, FOOT + k * step, &at) > highest) {
            highest = at.value;
            best = FOOT + k * step;
        }
    double low = fmax(FOOT, best - step), high = fmin(MOST_LEVEL, best + step);
    for (int k = 0; k < CLOSER; k++) {
        double left = high - GOLDEN * (high - low), right = low + GOLDEN * (high - low);
        sf_hic other;
        if (score(p, left, &at) > score(p, right, &other))
            high = right;
        else
            low = left;
    }
    return (low + high) / 2;
}

sf_status sf_pulse_hic(const sf_series *a, sf_hic *hic, sf_error *err) {
    pulse p = {.a = a};
    if (a->count < 3 || !is_single(&p))
        return sf_hic_evaluate(a, INFINITY, hic, err);
    p.integral = sf_alloc(err, (unsigned long)a->count, sizeof(double), "a pulse");
    if (!p.integral)
        return err->status;
    for (int64_t k = 1; k < a->count; k++)
        p.integral[k] =
            p.integral[k - 1] + 0.5 * (a->value[k] + a->value[k - 1]) * (a->time[k] - a->time[k - 1]);
    double level = find_level(&p);
    score(&p, level, hic);
    free(p.integral);
    return level < LEAST_LEVEL ? sf_hic_evaluate(a, INFINITY, hic, err) : SF_OK;
}
