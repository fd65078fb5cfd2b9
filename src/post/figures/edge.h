/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge on which a figure may stand: how a_max and HIC change with the speed, the pad's thickness and the
 * foam's stress, estimated from the run's own force over indentation (docs/theory.md, section 12).
 *
 * Near the turn F = C h^(p - n) d^n, with the thickness h, the indentation d, the contact area ~ d^p and the
 * energy E = F d / (n + 1), so that with e = (dF/dd) E / F^2 = n / (n + 1)
 *
 *     d ln a_max = 2 e d ln v,  (p - (1 + p) e) d ln h,  (1 - e) d ln C;
 *     d ln HIC = 1.5 d ln a_max, and d ln v in addition.
 *
 * A lock-up strain eps_D later by 0.005 shifts the locked part of the stress, from eps_s on, by that times
 * w = ((eps - eps_s) / (eps_D - eps_s))^2 (which is the law's own change for the exponent 1). With eps = d /
 * h the force loses h 0.005 (w F' - q int F' dw), where q is 0 below a flat missile; then d ln a_max = dF / F
 * - (dF/dd) dE / F^2 with the energy dE that the force no longer takes. The impulse of the locked part is
 * that of the speed with which it begins, so that only its duration changes, and HIC with it.
 *
 * The slope is that of the steepest of five secants before the turn, the first where the missile slows down
 * from a half to a quarter of its speed: later ones are bent by the rate of a smooth foam, but see a lock-up.
 * It lags behind the slope at the turn: e is 1.24 times that of the secant, calibrated to seven drops. While
 * a foam locks up the estimate is an upper one: up to three times the change beyond the lock-up, where the
 * force no longer grows as steeply (tests/test_edge.c).
 */
#ifndef SF_POST_FIGURES_EDGE_H
#define SF_POST_FIGURES_EDGE_H

#include "post/results/results.h"

/* Relative changes for 1 % of each. */
typedef struct sf_edge {
    double a_max_by_speed, a_max_by_thickness, a_max_by_stress;
    double hic_by_speed, hic_by_thickness, hic_by_stress;
    double a_max_by_lock_up, hic_by_lock_up; /* for a lock-up strain later by 0.005; NaN: there is none */
    /* relative standard deviations by the scatter of the case's speed and the tolerance of its thickness */
    double a_max_scatter, hic_scatter;
} sf_edge;

/* `window` (s) is that of HIC. All NaN of a driven or free missile, and where the force tells nothing. The
 * run has rebounded. */
void sf_edge_estimate(const sf_results *results, double window, sf_edge *edge);

#endif
