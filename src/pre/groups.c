/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/groups.h"

#include <math.h>
#include <stdio.h>

const sf_node_set *sf_group_need(const sf_mesh *mesh, const char *key, const char *name, sf_error *err) {
    const sf_node_set *set = sf_mesh_find_set(mesh, name);
    if (set)
        return set;
    char known[512] = "";
    size_t used = 0;
    for (int k = 0; k < mesh->set_count && used < sizeof known; k++)
        used +=
            (size_t)snprintf(known + used, sizeof known - used, "%s\"%s\"", k ? ", " : "", mesh->set[k].name);
    SF_FAIL(err, SF_ERR_INPUT, "%s names the surface group \"%s\", which the pad does not have; it has %s",
            key, name, mesh->set_count ? known : "none");
    return NULL;
}

int sf_group_plane_axis(const sf_model *m, const sf_node_set *set) {
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t k = 0; k < set->count; k++) {
            low = fmin(low, m->position[3 * (int64_t)set->node[k] + axis]);
            high = fmax(high, m->position[3 * (int64_t)set->node[k] + axis]);
        }
        if (high - low <= 1e-9 * m->thickness)
            return axis;
    }
    return -1;
}
