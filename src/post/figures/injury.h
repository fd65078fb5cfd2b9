/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Injury figures of a deceleration curve in g, above all the head injury criterion. All are exact for the
 * piecewise-linear curve through the points. They are indicative: nothing here is a certification. */
#pragma once
#include "post/figures/signal.h"

/* Head injury criterion of a piecewise-linear deceleration curve (FMVSS 208; theory, section "Reported
 * figures"):
 *
 *     HIC = max over t1 < t2, t2 - t1 <= window, of (t2 - t1) [ 1/(t2 - t1) int_t1^t2 a dt ]^2.5,   a in g, t
 * in s.
 *
 * t1 and t2 are continuous, not bound to sample points. At an optimum inside the curve and below the window
 * limit a(t1) = a(t2) = 3/5 of the mean. */

typedef struct sf_hic {
    double value; /* g^2.5 s, by custom written without unit; 0 if the curve never decelerates */
    double t1;    /* s, window on the clock of the curve; NaN when value is 0 */
    double t2;    /* s */
} sf_hic;

/* Finds the global maximum: from all pairs of 513 to 4097 instants of the curve, as many as it has points,
 * the ends of the best window are moved between them. `window` in s; INFINITY: no limit. */
sf_status sf_hic_evaluate(const sf_series *acceleration_g, double window, sf_hic *hic, sf_error *err);

typedef struct sf_injury {
    double a_max_g;           /* g */
    double a_max_time;        /* s */
    sf_hic hic;               /* no window limit */
    sf_hic hic15;             /* window <= 15 ms */
    sf_hic hic36;             /* window <= 36 ms */
    double gadd;              /* g^2.5 s, Gadd severity index: integral of a^2.5 where a > 0 */
    double clip_contiguous_g; /* g, exceeded for 3 ms without a break; NaN if the curve is shorter */
    double clip_cumulative_g; /* g, exceeded for 3 ms in all; NaN if the curve is shorter */
} sf_injury;

/* The peak, its time and HIC without a limit alone; the others are 0. */
sf_status sf_injury_evaluate_peak(const sf_series *acceleration_g, sf_injury *injury, sf_error *err);
sf_status sf_injury_evaluate(const sf_series *acceleration_g, sf_injury *injury, sf_error *err);
