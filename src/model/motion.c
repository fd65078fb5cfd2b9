/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/motion.h"

#include "base/sets.h"

static double slope(const sf_model *m, int64_t k) {
    return (m->motion_displacement[k + 1] - m->motion_displacement[k]) /
           (m->motion_time[k + 1] - m->motion_time[k]);
}

double sf_motion_displacement(const sf_model *m, double time) {
    int64_t k = sf_interval_find(m->motion_time, m->motion_count, time);
    return m->motion_displacement[k] + slope(m, k) * (time - m->motion_time[k]);
}

double sf_motion_velocity(const sf_model *m, double time) {
    return slope(m, sf_interval_find(m->motion_time, m->motion_count, time));
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
