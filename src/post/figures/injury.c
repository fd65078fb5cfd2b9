/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/injury.h"

#include <math.h>

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
    double low = INFINITY, high = -INFINITY;
    for (int64_t i = 0; i < curve->count; i++) {
        low = fmin(low, curve->value[i]);
        high = fmax(high, curve->value[i]);
    }
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
    *injury = (sf_injury){.a_max_g = curve->value[0], .a_max_time = curve->time[0]};
    for (int64_t i = 1; i < curve->count; i++) {
        if (curve->value[i] > injury->a_max_g) {
            injury->a_max_g = curve->value[i];
            injury->a_max_time = curve->time[i];
        }
    }
    return sf_hic_evaluate(curve, INFINITY, &injury->hic, err);
}

sf_status sf_injury_evaluate(const sf_series *curve, sf_injury *injury, sf_error *err) {
    const double clip_duration = 3e-3;
    if (sf_injury_evaluate_peak(curve, injury, err) != SF_OK ||
        sf_hic_evaluate(curve, 15e-3, &injury->hic15, err) != SF_OK ||
        sf_hic_evaluate(curve, 36e-3, &injury->hic36, err) != SF_OK)
        return err->status;
    injury->gadd = sf_injury_gadd(curve);
    injury->clip_contiguous_g = sf_injury_clip(curve, clip_duration, 1);
    injury->clip_cumulative_g = sf_injury_clip(curve, clip_duration, 0);
    return SF_OK;
}
