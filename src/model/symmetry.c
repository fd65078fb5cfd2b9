/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/symmetry.h"

/* The nodes of such a plane are held along its normal, but not as part of the base. */
bool sf_symmetry_plane(const sf_model *m, int axis, double *place) {
    for (int64_t k = 0; k < m->fixed_count; k++)
        if (!m->fixed_base[k] && m->fixed_mask[k] & (1 << axis)) {
            *place = m->position[3 * (int64_t)m->fixed_node[k] + axis];
            return true;
        }
    *place = 0;
    return false;
}
