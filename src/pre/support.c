/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/steps.h"

#include "base/mat3.h"

const sf_node_set *sf_group_need(const sf_mesh *mesh, const char *key, const char *name, sf_error *err) {
    const sf_node_set *set = sf_mesh_find_set(mesh, name);
    if (set)
        return set;
    char known[512] = "";
    size_t used = 0;
    for (int k = 0; k < mesh->set_count && used < sizeof known; k++)
        used +=
            (size_t)snprintf(known + used, sizeof known - used, "%s\"%s\"", k ? ", " : "", mesh->set[k].name);
    SF_REFUSE(err, "%s names the surface group \"%s\", which the pad does not have; it has %s", key, name,
              mesh->set_count ? known : "none");
    return NULL;
}

bool sf_group_is_plane(const sf_model *m, const sf_node_set *set, int axis, double *place) {
    double low = INFINITY, high = -INFINITY;
    for (int64_t k = 0; k < set->count; k++) {
        low = fmin(low, m->position[3 * (int64_t)set->node[k] + axis]);
        high = fmax(high, m->position[3 * (int64_t)set->node[k] + axis]);
    }
    *place = low;
    return high - low <= 1e-9 * m->thickness;
}

int sf_group_plane_axis(const sf_model *m, const sf_node_set *set) {
    double place;
    int axis = 0;
    while (axis < 3 && !sf_group_is_plane(m, set, axis, &place))
        axis++;
    return axis < 3 ? axis : -1;
}

static const double LOWEST = 1e-9; /* of the thickness: on the plane of the base */

static sf_status mark_smooth(const char *key, const sf_node_set *set, const sf_model *m,
                             const sf_base_marks *marks, sf_error *err) {
    int axis = sf_group_plane_axis(m, set);
    if (axis < 0)
        return SF_REFUSE(err, "%s: the group \"%s\" is not a plane normal to x, y or z", key, set->name);
    for (int64_t k = 0; k < set->count; k++) {
        marks->mask[set->node[k]] |= (uint8_t)(1 << axis);
        marks->base[set->node[k]] = 1;
    }
    return SF_OK;
}

static void mark_glued(const sf_node_set *set, const sf_base_marks *marks) {
    for (int64_t k = 0; k < set->count; k++) {
        marks->mask[set->node[k]] = SF_FIX_X | SF_FIX_Y | SF_FIX_Z;
        marks->base[set->node[k]] = 1;
    }
}

static double lowest_node(const sf_model *m) {
    double low[3], high[3];
    sf_box3(m->node_count, m->position, low, high);
    return low[2];
}

/* The anvil is a plane below the whole pad. */
static sf_status mark_resting(const sf_node_set *set, const sf_model *m, const sf_base_marks *marks,
                              sf_error *err) {
    double low = lowest_node(m);
    for (int64_t k = 0; k < set->count; k++) {
        const double *x = &m->position[3 * (int64_t)set->node[k]];
        if (x[2] > low + LOWEST * m->thickness)
            return SF_REFUSE(err,
                             "pad.fixed: the group \"%s\" cannot rest on the anvil (pad.base = \"resting\"): "
                             "it must lie in the plane of the pad's lowest nodes, z = %.6g mm, and has a "
                             "node at (%.4g, %.4g, %.4g) mm",
                             set->name, 1e3 * low, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
        marks->rest[set->node[k]] = 1;
    }
    return SF_OK;
}

/* The anvil presses the nodes of the base only: others in its plane would pass through it. */
static sf_status check_whole_base(const sf_model *m, const sf_base_marks *marks, sf_error *err) {
    double low = lowest_node(m);
    int64_t count = 0, first = -1;
    for (int64_t i = 0; i < m->node_count; i++)
        if (!marks->rest[i] && m->position[3 * i + 2] <= low + LOWEST * m->thickness) {
            first = count == 0 ? i : first;
            count++;
        }
    if (count == 0)
        return SF_OK;
    return SF_REFUSE(err,
                     "pad.fixed: %lld nodes in the plane of the anvil, the first at (%.4g, %.4g, %.4g) mm, "
                     "are in none of its groups: a resting pad (pad.base = \"resting\") would pass through "
                     "the anvil there; name its whole underside",
                     (long long)count, 1e3 * m->position[3 * first], 1e3 * m->position[3 * first + 1],
                     1e3 * m->position[3 * first + 2]);
}

/* A resting node is free to rise. */
static sf_status check_resting(const sf_model *m, const sf_base_marks *marks, sf_error *err) {
    for (int64_t i = 0; i < m->node_count; i++)
        if (marks->rest[i] && (marks->mask[i] & SF_FIX_Z))
            return SF_REFUSE(err,
                             "pad.base: the pad cannot rest on the anvil at (%.4g, %.4g, %.4g) mm, where "
                             "pad.sliding holds it along z",
                             1e3 * m->position[3 * i], 1e3 * m->position[3 * i + 1],
                             1e3 * m->position[3 * i + 2]);
    return SF_OK;
}

sf_status sf_base_mark(const sf_case *c, const sf_mesh *mesh, const sf_model *m, const sf_base_marks *marks,
                       sf_error *err) {
    for (int g = 0; g < c->fixed_count; g++) {
        const sf_node_set *set = sf_group_need(mesh, "pad.fixed", c->fixed_group[g], err);
        SF_TRY(err->status);
        if (c->base_rule == SF_BASE_GLUED)
            mark_glued(set, marks);
        else if (c->base_rule == SF_BASE_SMOOTH)
            mark_smooth("pad.fixed", set, m, marks, err);
        else
            mark_resting(set, m, marks, err);
        SF_TRY(err->status);
    }
    for (int g = 0; g < c->sliding_count; g++) {
        const sf_node_set *set = sf_group_need(mesh, "pad.sliding", c->sliding_group[g], err);
        if (!set || mark_smooth("pad.sliding", set, m, marks, err) != SF_OK)
            return err->status;
    }
    if (c->base_rule == SF_BASE_RESTING && check_whole_base(m, marks, err) != SF_OK)
        return err->status;
    return check_resting(m, marks, err);
}

/* ---- the weight of a resting pad ---- */

/* Sums of w, w r and w r r over nodes of weight w at r, in plan. */
typedef struct moments {
    double sum, first[2], second[2][2];
} moments;

static void add_moments(moments *s, double w, const double r[2]) {
    s->sum += w;
    for (int a = 0; a < 2; a++) {
        s->first[a] += w * r[a];
        for (int b = 0; b < 2; b++)
            s->second[a][b] += w * r[a] * r[b];
    }
}

/* The resting nodes' volumes stand for their shares of the surface. */
static moments base_moments(const sf_model *m, const double centre[2]) {
    moments s = {0};
    for (int64_t k = 0; k < m->rest_count; k++) {
        const double *x = &m->position[3 * (int64_t)m->rest_node[k]],
                     r[2] = {x[0] - centre[0], x[1] - centre[1]};
        add_moments(&s, m->volume[m->rest_node[k]], r);
    }
    return s;
}

/* Slope of the pressure over the middle of the base, per metre, so that its resultant passes below the pad's
 * centre of mass at `offset` from that middle; a symmetry plane (bit of `planes`) carries the moment about
 * it. */
static void solve_slope(const moments *s, const double offset[2], int planes, double slope[2]) {
    double a = s->second[0][0] / s->sum, b = s->second[0][1] / s->sum, d = s->second[1][1] / s->sum;
    slope[0] = slope[1] = 0;
    if (planes == 0) {
        double det = a * d - b * b;
        slope[0] = (d * offset[0] - b * offset[1]) / det;
        slope[1] = (a * offset[1] - b * offset[0]) / det;
    } else if (planes == 1 << 0) {
        slope[1] = offset[1] / d;
    } else if (planes == 1 << 1) {
        slope[0] = offset[0] / a;
    }
}

/* The loads q0 of a pressure that is linear over the base, with the weight's resultant. A base on a line has
 * no slope (NaN) and is refused by hold.h. */
static sf_status set_loads(sf_model *m, double gravity, int planes, sf_error *err) {
    moments mass = {0}, base = base_moments(m, (const double[2]){0, 0});
    for (int64_t i = 0; i < m->node_count; i++)
        add_moments(&mass, m->mass[i], &m->position[3 * i]);
    double centre[2], offset[2], slope[2];
    for (int a = 0; a < 2; a++) {
        centre[a] = base.first[a] / base.sum;
        offset[a] = mass.first[a] / mass.sum - centre[a];
    }
    base = base_moments(m, centre);
    solve_slope(&base, offset, planes, slope);
    for (int64_t k = 0; k < m->rest_count; k++) {
        int64_t i = m->rest_node[k];
        double share = m->volume[i] / base.sum *
                       (1 + slope[0] * (m->position[3 * i] - centre[0]) +
                        slope[1] * (m->position[3 * i + 1] - centre[1]));
        if (share < 0)
            return SF_REFUSE(err,
                             "pad.base: the pad does not rest on the whole of its base: its centre of mass "
                             "is above (%.4g, %.4g) mm, the middle of the base at (%.4g, %.4g) mm, and it "
                             "would lift off at (%.4g, %.4g) mm",
                             1e3 * (centre[0] + offset[0]), 1e3 * (centre[1] + offset[1]), 1e3 * centre[0],
                             1e3 * centre[1], 1e3 * m->position[3 * i], 1e3 * m->position[3 * i + 1]);
        m->rest_load[k] = isnan(share) ? 0 : gravity * mass.sum * share;
    }
    return SF_OK;
}

sf_status sf_base_rest(const sf_case *c, const sf_base_marks *marks, sf_model *m, sf_error *err) {
    int planes = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        m->rest_count += marks->rest[i];
        planes |= marks->base[i] ? 0 : marks->mask[i] & (SF_FIX_X | SF_FIX_Y);
    }
    if (m->rest_count == 0)
        return SF_OK;
    m->rest_node = sf_alloc(err, m->rest_count, sizeof *m->rest_node, "resting nodes");
    m->rest_load = sf_alloc(err, m->rest_count, sizeof *m->rest_load, "resting nodes");
    SF_TRY(err->status);
    int64_t used = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        if (marks->rest[i])
            m->rest_node[used++] = (int32_t)i;
    m->anvil.friction = c->anvil_card.friction;
    return set_loads(m, c->pad_gravity, planes, err);
}

void sf_base_place_anvil(const sf_case *c, const sf_hold *hold, sf_model *m) {
    bool there = c->base_rule == SF_BASE_RESTING || hold->underside >= SF_HOLD_MOST;
    m->anvil.depth = there ? sf_impact_top(m) - hold->underside_low : 0;
}
