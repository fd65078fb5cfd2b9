/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mass dropped flat on a foam column, in one dimension and independent of the solver: without the column's
 * inertia (an ordinary differential equation), and as a wave problem (linear elements, lumped masses). The
 * foam has the curve of formula.h, hysteresis and a Maxwell branch. */
#ifndef SF_VERIFY_COLUMN_H
#define SF_VERIFY_COLUMN_H

#include "material/foam_card.h"
#include "post/figures/signal.h"

typedef struct sf_column {
    double height, area; /* m, m2 */
    double mass, speed;  /* kg, m s-1: of the missile */
    double gravity;      /* m s-2 */
    const sf_foam_card *foam;
} sf_column;

/* Force (N) of the column on the mass over time (s) until it lets go, one point per `dt`; the series is the
 * caller's. */
sf_status sf_column_quasi_static(const sf_column *column, double dt, sf_series *force, sf_error *err);

/* The same with the column's mass, by `elements` elements and steps of `dt`, one point every `stride` steps.
 */
sf_status sf_column_wave(const sf_column *column, int elements, double dt, int stride, sf_series *force,
                         sf_error *err);

#endif
