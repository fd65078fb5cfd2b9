/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/kinds.h"

#include <math.h>

void sf_drop_values_scale(const sf_columns_figures *v, double y[SF_FIT_SAMPLES]) {
    y[SF_FIT_A_MAX] = log(v->a_max_g);
    y[SF_FIT_HIC] = log(v->hic);
    y[SF_FIT_WINDOW] = log(1e3 * v->hic_window);
    y[SF_FIT_REBOUND] = log(v->v_rebound);
    y[SF_FIT_CONTACT] = log(1e3 * v->contact_time);
}
