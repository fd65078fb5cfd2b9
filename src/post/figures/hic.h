/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Head injury criterion of a piecewise-linear deceleration curve (FMVSS 208; theory, section "Injury
 * figures"):
 *
 *     HIC = max over t1 < t2, t2 - t1 <= window, of (t2 - t1) [ 1/(t2 - t1) int_t1^t2 a dt ]^2.5,   a in g, t
 * in s.
 *
 * t1 and t2 are continuous, not bound to sample points. At an optimum inside the curve and below the window
 * limit a(t1) = a(t2) = 3/5 of the mean. */
#ifndef SF_POST_HIC_H
#define SF_POST_HIC_H

#include "post/figures/signal.h"

typedef struct sf_hic {
    double value; /* g^2.5 s, by custom written without unit; 0 if the curve never decelerates */
    double t1;    /* s, window on the clock of the curve; NaN when value is 0 */
    double t2;    /* s */
} sf_hic;

/* `window` in s, INFINITY for none. The global maximum: a bounded search over the points of the curve
 * (refined to at least 4096 intervals) leaves no pair out, then both ends are moved continuously. */
sf_status sf_hic_evaluate(const sf_series *acceleration_g, double window, sf_hic *hic, sf_error *err);

#endif
