/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/edge.h"

#include <math.h>

/* Secants of the force, by the speed where they begin and end over that at contact. */
static const double secants[][2] = {{0.5, 0.25}, {0.35, 0.2}, {0.25, 0.12}, {0.2, 0.08}, {0.15, 0.04}};
static const double LAG = 1.24; /* of e over that of the steepest */
static const double PERCENT = 0.01;
static const double LATER = 0.005; /* of the lock-up strain */
static const double SHARPER = 0.8; /* of the mean's change over the peak's, as the top grows sharper */
static const double ROUND = 0.5;   /* q over p: the middle of a pad is compressed more evenly than columns */

/* The first row from `first` on in which the missile has slowed down to this speed; -1: none. */
static int64_t row_of_speed(const sf_history *h, int64_t first, double speed) {
    for (int64_t i = first; i < h->rows; i++)
        if (h->velocity[i] <= speed)
            return i;
    return -1;
}

static int64_t row_of_indentation(const sf_history *h, int64_t first, double indentation) {
    for (int64_t i = first; i < h->rows; i++)
        if (h->indentation[i] >= indentation)
            return i;
    return -1;
}

/* The steepest secant: (dF/dd) / F, m-1; NaN: there is none. */
static double steepest(const sf_history *h, int64_t first) {
    double growth = NAN;
    for (size_t k = 0; k < sizeof secants / sizeof *secants; k++) {
        int64_t from = row_of_speed(h, first, secants[k][0] * h->velocity[first]),
                to = row_of_speed(h, first, secants[k][1] * h->velocity[first]);
        if (from < 0 || to <= from || !(h->contact_force[from] > 0) ||
            !(h->indentation[to] > h->indentation[from]))
            continue;
        growth = fmax(growth, log(h->contact_force[to] / h->contact_force[from]) /
                                  (h->indentation[to] - h->indentation[from]));
    }
    return growth;
}

/* Part of the peak's change that HIC has: by the duration of the force above that of row `from`, over the
 * window of HIC. */
static double share_of_hic(const sf_history *h, int64_t from, double largest, double window) {
    double begin = h->contact_force[from], duration = 0, impulse = 0;
    for (int64_t i = from + 1; i < h->rows && h->contact_force[i] > begin; i++) {
        duration += h->time[i] - h->time[i - 1];
        impulse += h->contact_force[i] * (h->time[i] - h->time[i - 1]);
    }
    double mean = impulse / duration;
    return duration > 0
               ? 1.5 * SHARPER * duration / window * (mean - begin) / (largest - begin) * largest / mean
               : 0;
}

/* The changes by a later lock-up: `slope` (m-1) is (dF/dd) / F at the turn, `q` as in edge.h. */
static void estimate_lock_up(const sf_results *r, int64_t first, int64_t deepest, double slope, double q,
                             double window, sf_edge *edge) {
    const sf_history *h = &r->history;
    double room = r->lock_up - r->lock_begin, shift = LATER * r->thickness, bend = 0, energy = 0, w = 0,
           largest = h->contact_force[sf_history_row_of_largest(h, h->contact_force)];
    int64_t begin = row_of_indentation(h, first, r->lock_begin * r->thickness);
    edge->a_max_by_lock_up = edge->hic_by_lock_up = isfinite(room) ? 0 : NAN;
    if (begin < 0 || !(room > 0))
        return;
    for (int64_t i = begin + 1; i <= deepest; i++) {
        double x = fmin(1, (h->indentation[i] / r->thickness - r->lock_begin) / room),
               gain = fmax(0, h->contact_force[i] - h->contact_force[i - 1]);
        w = x * x;
        bend += x < 1 ? gain * 2 * x / (room * r->thickness) : 0; /* of the integral of F' dw */
        energy -= shift * (w * gain - q * bend * (h->indentation[i] - h->indentation[i - 1]));
    }
    edge->a_max_by_lock_up = -shift * (w * slope - q * bend / largest) - slope * energy / largest;
    edge->hic_by_lock_up = edge->a_max_by_lock_up * share_of_hic(h, begin, largest, window);
}

void sf_edge_estimate(const sf_results *r, double window, sf_edge *edge) {
    const sf_history *h = &r->history;
    *edge = (sf_edge){NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN};
    if (r->driven || r->turns)
        return;
    int64_t first = 0;
    while (first + 1 < h->rows && !(h->contact_nodes[first + 1] > 0))
        first++;
    int64_t deepest = sf_history_row_of_largest(h, h->indentation),
            half = row_of_indentation(h, first, 0.5 * h->indentation[deepest]);
    double growth = steepest(h, first);
    if (half < 0 || isnan(growth) || !(h->contact_area[half] > 0))
        return;
    double force = h->contact_force[sf_history_row_of_largest(h, h->contact_force)],
           e = LAG * growth * h->energy_kinetic_missile[first] / force,
           p = fmin(1, fmax(0, log(h->contact_area[deepest] / h->contact_area[half]) / log(2)));
    edge->a_max_by_speed = PERCENT * 2 * e;
    edge->a_max_by_thickness = PERCENT * (p - (1 + p) * e);
    edge->a_max_by_stress = PERCENT * (1 - e);
    edge->hic_by_speed = 1.5 * edge->a_max_by_speed + PERCENT;
    edge->hic_by_thickness = 1.5 * edge->a_max_by_thickness;
    edge->hic_by_stress = 1.5 * edge->a_max_by_stress;
    estimate_lock_up(r, first, deepest, LAG * growth, ROUND * p, window, edge);
    double speed = r->speed_scatter / PERCENT, thickness = r->thickness_tolerance / r->thickness / PERCENT;
    edge->a_max_scatter = hypot(edge->a_max_by_speed * speed, edge->a_max_by_thickness * thickness);
    edge->hic_scatter = hypot(edge->hic_by_speed * speed, edge->hic_by_thickness * thickness);
}
