/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/ending.h"

static const double REBOUND_WAIT = 1e-3; /* s, without contact before the run may end */

bool sf_ending_rebounded(const sf_model *m, const sf_state *s) {
    return m->run.stop_after_rebound && sf_missile_is_leaving(m, &s->missile) && s->contact_count == 0 &&
           s->time - s->missile.release_time > REBOUND_WAIT;
}

bool sf_ending_on_anvil(const sf_model *m, const sf_state *s) {
    return m->anvil.depth > 0 && sf_missile_depth(m, &s->missile) >= m->anvil.depth;
}

sf_status sf_ending_fail_on_anvil(const sf_state *s, sf_error *err) {
    return SF_FAIL(
        err, SF_ERR_NUMERIC,
        "the missile reached the anvil at t = %.6g ms with %.4g m/s: an impact of rigid bodies has no "
        "acceleration that could be told, and the run ends there",
        1e3 * s->time, s->missile.velocity_now);
}

bool sf_ending_finished(const sf_model *m, const sf_state *s) {
    return s->time >= m->run.end_time;
}
