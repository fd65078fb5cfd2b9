/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/motion.h"

#include <math.h>

/* The point at which the piece of `time` begins. */
static int64_t piece_of(const sf_model *m, double time) {
    int64_t low = 0, high = m->motion_count - 1;
    while (high - low > 1) {
        int64_t middle = (low + high) / 2;
        *(m->motion_time[middle] <= time ? &low : &high) = middle;
    }
    return low;
}

static double slope(const sf_model *m, int64_t k) {
    return (m->motion_displacement[k + 1] - m->motion_displacement[k]) /
           (m->motion_time[k + 1] - m->motion_time[k]);
}

double sf_motion_displacement(const sf_model *m, double time) {
    int64_t k = piece_of(m, time);
    return m->motion_displacement[k] + slope(m, k) * (time - m->motion_time[k]);
}

double sf_motion_velocity(const sf_model *m, double time) {
    return slope(m, piece_of(m, time));
}

sf_motion_range sf_motion_measure(const sf_model *m) {
    sf_motion_range range = {.points = m->motion_count};
    for (int64_t k = 0; k < m->motion_count; k++) {
        range.end_time = m->motion_time[k];
        range.displacement = fmax(range.displacement, m->motion_displacement[k]);
        if (k > 0)
            range.speed = fmax(range.speed, fabs(slope(m, k - 1)));
    }
    return range;
}
