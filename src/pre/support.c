/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/support.h"

#include "base/mat3.h"
#include "base/sets.h"
#include "base/text.h"
#include "pre/mesh/missile_shape.h"
#include "pre/missile_body.h"

const sf_node_set *sf_group_need(const sf_mesh *mesh, const char *key, const char *name, sf_error *err) {
    const sf_node_set *set = sf_mesh_find_set(mesh, name);
    if (set)
        return set;
    char known[512] = "";
    for (int k = 0; k < mesh->set_count; k++)
        sf_text_add(known, sizeof known, "%s\"%s\"", k ? ", " : "", mesh->set[k].name);
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
    while (axis < 3 && ((m->axisymmetric && axis == 1) || !sf_group_is_plane(m, set, axis, &place)))
        axis++;
    return axis < 3 ? axis : -1;
}

static const double LOWEST = 1e-9; /* of the thickness: on the plane of the base */

/* Holds the nodes in the components of `mask`. */
static void mark_held(const sf_node_set *set, uint8_t mask, const sf_base_marks *marks) {
    for (int64_t k = 0; k < set->count; k++) {
        marks->mask[set->node[k]] |= mask;
        marks->base[set->node[k]] = 1;
    }
}

static sf_status mark_smooth(const char *key, const sf_node_set *set, const sf_model *m,
                             const sf_base_marks *marks, sf_error *err) {
    int axis = sf_group_plane_axis(m, set);
    if (axis < 0)
        return SF_REFUSE(err, "%s: the group \"%s\" is not a plane normal to x, y or z", key, set->name);
    mark_held(set, (uint8_t)(1 << axis), marks);
    return SF_OK;
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
            mark_held(set, SF_FIX_X | SF_FIX_Y | SF_FIX_Z, marks);
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
    planes |= m->axisymmetric ? SF_FIX_X | SF_FIX_Y : 0;
    if (m->rest_count == 0)
        return SF_OK;
    SF_TRY(SF_ALLOC_ALL(err, "resting nodes", SF_ROOM(m->rest_node, m->rest_count),
                        SF_ROOM(m->rest_load, m->rest_count)));
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

/* ---- rigid supports ---- */

static const double SHARP =
    0.77; /* cosine of the normals of two faces, 40 degrees: their edge is no facet edge */

/* A surface of triangles; borrowed. */
typedef struct triangles {
    int64_t count;
    const double *position;
    const int32_t *node; /* [count][3] */
} triangles;

static const double *corner(const triangles *s, int64_t t, int k) {
    return &s->position[3 * (int64_t)s->node[3 * t + k]];
}

/* Normal of a triangle, of twice its area; to its unit vector with `unit`. */
static void find_normal(const triangles *s, int64_t t, bool unit, double out[3]) {
    sf_face_normal(s->position, &s->node[3 * t], out);
    if (unit)
        sf_unit3(out);
}

/* ---- sharp edges ---- */

/* Corner of the triangle at the lower or the higher node of its edge. */
static int64_t corner_at(const sf_half_edge *e, bool low) {
    if (e->rises == low)
        return e->slot;
    return e->slot % 3 == 2 ? e->slot - 2 : e->slot + 1;
}

/* Joins the corners at the ends of the edges that are not sharp. */
static void join_corners(const triangles *s, const sf_half_edge *edge, int64_t *parent) {
    for (const sf_half_edge *e = edge + 1; e < edge + 3 * s->count; e++) {
        double one[3], other[3];
        if (sf_half_edges_end(e - 1, 0, 2) < 2)
            continue;
        find_normal(s, e->slot / 3, true, one);
        find_normal(s, (e - 1)->slot / 3, true, other);
        for (int low = 0; low < 2 && sf_dot3(one, other) >= SHARP; low++)
            sf_sets_join(parent, corner_at(e, low), corner_at(e - 1, low));
    }
}

/* Appends the triangles to those of the model, as support `part`. Its nodes are the joined corners. */
static sf_status split_edges(const triangles *s, int part, sf_model *m, sf_error *err) {
    int64_t corners = 3 * s->count;
    SF_OWNED sf_half_edge *edge = sf_half_edges(s->count, s->node, err);
    SF_OWNED int64_t *parent = sf_sets_alone(corners, "edges of the support", err);
    if (err->status == SF_OK) {
        int32_t *node = &m->support_triangle[3 * m->support_triangle_count];
        join_corners(s, edge, parent);
        for (int64_t k = 0; k < corners; k++) { /* a leader is the first of its corners */
            int64_t first = sf_sets_find(parent, k);
            node[k] = first < k ? node[first] : (int32_t)m->support_node_count++;
            memcpy(&m->support_position[3 * (int64_t)node[k]], corner(s, k / 3, (int)(k % 3)),
                   3 * sizeof(double));
        }
        memset(&m->support_part[m->support_triangle_count], part, (size_t)s->count);
        m->support_triangle_count += s->count;
    }
    return err->status;
}

/* ---- checks ---- */

static double least_spacing(const sf_model *m) {
    double least = INFINITY;
    for (int64_t i = 0; i < m->node_count; i++)
        least = fmin(least, m->spacing[i]);
    return least;
}

static triangles supports_of(const sf_model *m) {
    return (triangles){m->support_triangle_count, m->support_position, m->support_triangle};
}

/* Depth (m) of x behind the nearest place of the surface; 0 before it, and beside an open one. */
static double depth_behind(const triangles *s, const double x[3]) {
    static const double SAME = 1e-9, STRAIGHT = 0.5; /* of a squared distance; cosine */
    double best = INFINITY, sum[3] = {0}, ray[3] = {0};
    for (int64_t t = 0; t < s->count; t++) {
        double point[3], r[3], normal[3];
        int feature;
        sf_triangle_nearest(corner(s, t, 0), corner(s, t, 1), corner(s, t, 2), x, point, &feature);
        sf_sub3(x, point, r);
        double square = sf_dot3(r, r);
        if (square > best * (1 + SAME))
            continue;
        bool nearer = square < best * (1 - SAME);
        find_normal(s, t, true, normal);
        for (int k = 0; k < 3; k++) {
            sum[k] = normal[k] + (nearer ? 0 : sum[k]);
            ray[k] = r[k];
        }
        best = fmin(best, square);
    }
    sf_unit3(sum);
    double behind = -sf_dot3(ray, sum);
    return behind > STRAIGHT * sqrt(best) ? sqrt(best) : 0;
}

typedef struct box {
    double low[3], high[3];
} box;

static bool is_in_box(const box *b, const double x[3]) {
    bool in = true;
    for (int r = 0; r < 3; r++)
        in = in && x[r] >= b->low[r] && x[r] <= b->high[r];
    return in;
}

/* The point of `count`, within the surface's box, that lies deepest behind it. */
static double deepest_behind(const triangles *s, const box *around, int64_t count, const double *position,
                             double place[3]) {
    double deepest = 0;
    for (int64_t i = 0; i < count; i++) {
        const double *x = &position[3 * i];
        double depth = is_in_box(around, x) ? depth_behind(s, x) : 0;
        if (depth > deepest)
            memcpy(place, x, 3 * sizeof *x);
        deepest = fmax(deepest, depth);
    }
    return deepest;
}

/* A support whose triangles and nodes are the last of the model. */
typedef struct last_support {
    triangles s;
    int64_t first_node;
    bool plane;    /* all that is behind it is inside */
    char label[8]; /* for sentences: its number, "" if it is the only one */
} last_support;

/* Nodes of the pad that lie deeper than SF_CONTACT_ENTRY would never touch. Corners of the support between
 * the nodes of a curved face are deeper where both are meshed. */
static sf_status check_apart(const sf_model *m, const triangles *pad, const last_support *l, sf_error *err) {
    static const double BETWEEN = 0.5; /* of the spacing */
    int64_t nodes = m->support_node_count - l->first_node;
    const double *position = &m->support_position[3 * l->first_node];
    box of_pad, of_support;
    sf_box3(m->node_count, m->position, of_pad.low, of_pad.high);
    sf_box3(nodes, position, of_support.low, of_support.high);
    double x[3],
        spacing = least_spacing(m),
        node = deepest_behind(&l->s, l->plane ? &of_pad : &of_support, m->node_count, m->position, x);
    bool pierced = node <= SF_CONTACT_ENTRY * spacing;
    double depth = pierced ? deepest_behind(pad, &of_pad, nodes, position, x) : node;
    if (depth <= (pierced ? BETWEEN : SF_CONTACT_ENTRY) * spacing)
        return SF_OK;
    return SF_REFUSE(err,
                     "support%s: pad and support overlap at the start: at (%.4g, %.4g, %.4g) mm the %s "
                     "is %.4g mm inside the %s; move the support, or turn its surface outwards (close it)",
                     l->label, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2], pierced ? "support" : "pad", 1e3 * depth,
                     pierced ? "pad" : "support");
}

static double distance_to(const triangles *s, double thickness, const double x[3],
                          const double direction[3]) {
    static const double BEHIND = 0.01; /* of the thickness: facets of curved faces overlap by less */
    double nearest = INFINITY;
    for (int64_t t = 0; t < s->count; t++) {
        double normal[3],
            at = -sf_triangle_travel(corner(s, t, 0), corner(s, t, 1), corner(s, t, 2), direction, x);
        find_normal(s, t, false, normal);
        if (isfinite(at) && sf_dot3(normal, direction) < 0 && at < nearest && at > -BEHIND * thickness)
            nearest = at;
    }
    return nearest;
}

double sf_support_distance(const sf_model *m, const double x[3], const double direction[3]) {
    const triangles s = supports_of(m);
    return distance_to(&s, m->thickness, x, direction);
}

/* Some face of the pad has the support before it. */
static sf_status check_reach(const sf_model *m, const triangles *pad, const last_support *l, sf_error *err) {
    double nearest = INFINITY;
    for (int64_t t = 0; t < pad->count && nearest > m->thickness; t++) {
        double normal[3], middle[3];
        find_normal(pad, t, true, normal);
        for (int r = 0; r < 3; r++)
            middle[r] = (corner(pad, t, 0)[r] + corner(pad, t, 1)[r] + corner(pad, t, 2)[r]) / 3;
        nearest = fmin(nearest, fabs(distance_to(&l->s, m->thickness, middle, normal)));
    }
    if (nearest <= m->thickness)
        return SF_OK;
    return SF_REFUSE(err,
                     "support%s: no face of the pad has the support before it within the pad's thickness "
                     "of %.4g mm%s: check its place and the unit of length",
                     l->label, 1e3 * m->thickness, isfinite(nearest) ? ", the nearest is farther" : "");
}

/* A node of the pad keeps a limited number of facets in reach. */
static sf_status check_size(const sf_model *m, const triangles *s, const char *label, sf_error *err) {
    static const double LEAST = 0.25; /* of the spacing */
    double area = 0, normal[3], spacing = least_spacing(m);
    for (int64_t t = 0; t < s->count; t++) {
        find_normal(s, t, false, normal);
        area += sqrt(sf_dot3(normal, normal));
    }
    double side = sqrt(area / (double)s->count);
    if (side >= LEAST * spacing)
        return SF_OK;
    return SF_REFUSE(err,
                     "support%s: the triangles of the support are %.3g mm wide, the pad's spacing is %.3g "
                     "mm: mesh the support coarser, with at least %.3g mm",
                     label, 1e3 * side, 1e3 * spacing, 1e3 * LEAST * spacing);
}

sf_status sf_support_plane(const sf_case_support *plane, const sf_mesh *mesh, sf_surface *out,
                           sf_error *err) {
    static const double WIDTH = 4; /* half of the square's width over the diagonal of the pad's box */
    static const int32_t triangle[6] = {0, 1, 2, 0, 2, 3};
    const double *n = plane->normal;
    double low[3], high[3], diagonal[3], middle[3], turn[9];
    sf_turn_to_z(n, turn); /* its first rows lie in the plane */
    sf_box3(mesh->node_count, mesh->position, low, high);
    for (int r = 0; r < 3; r++) {
        diagonal[r] = high[r] - low[r];
        middle[r] = 0.5 * (low[r] + high[r]);
    }
    double width = WIDTH * sqrt(sf_dot3(diagonal, diagonal)), height = sf_dot3(middle, n) - plane->place;
    *out = (sf_surface){.position = sf_alloc(err, 12, sizeof *out->position, "support"),
                        .triangle = sf_alloc(err, 6, sizeof *out->triangle, "support")};
    SF_TRY(err->status);
    static const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int k = 0; k < 4; k++)
        for (int r = 0; r < 3; r++)
            out->position[3 * k + r] =
                middle[r] - height * n[r] + width * (corner[k][0] * turn[r] + corner[k][1] * turn[3 + r]);
    memcpy(out->triangle, triangle, sizeof triangle);
    out->node_count = 4;
    out->triangle_count = 2;
    return SF_OK;
}

/* Takes support `k` of the case. `pad`: the triangles of the pad's surface. */
static sf_status take(const sf_case *c, int k, sf_surface *surface, const triangles *pad, sf_model *m,
                      sf_error *err) {
    double against[3];
    for (int r = 0; r < 3; r++)
        against[r] = -c->missile_card.direction[r];
    last_support l = {.first_node = m->support_node_count, .plane = !c->support[k].source.path};
    if (c->support_count > 1)
        snprintf(l.label, sizeof l.label, " %d", k + 1);
    if (!l.plane)
        SF_TRY(sf_surface_turn(surface, against, err));
    const triangles given = {surface->triangle_count, surface->position, surface->triangle};
    l.s = (triangles){given.count, m->support_position, &m->support_triangle[3 * m->support_triangle_count]};
    m->support_friction[k] = c->support[k].friction;
    if (check_size(m, &given, l.label, err) == SF_OK && split_edges(&given, k, m, err) == SF_OK &&
        check_apart(m, pad, &l, err) == SF_OK)
        check_reach(m, pad, &l, err);
    return err->status;
}

sf_status sf_support_take(const sf_case *c, const sf_mesh *mesh, sf_model *m, sf_error *err) {
    triangles pad = {0, m->position, NULL};
    SF_OWNED int32_t *face = NULL;
    unsigned long count = 0;
    m->support_count = mesh->support_count;
    for (int k = 0; k < mesh->support_count; k++)
        count += (unsigned long)mesh->support[k].triangle_count;
    if (count == 0 || sf_skin_triangles(&SF_CELLS_OF(m), &pad.count, &face, NULL, err) != SF_OK)
        return err->status;
    pad.node = face;
    SF_ALLOC_ALL(err, "support", SF_ROOM(m->support_position, 9 * count),
                 SF_ROOM(m->support_triangle, 3 * count), SF_ROOM(m->support_part, count),
                 SF_ROOM(m->support_friction, SF_SUPPORTS));
    for (int k = 0; k < mesh->support_count && err->status == SF_OK; k++)
        take(c, k, &mesh->support[k], &pad, m, err);
    return err->status;
}

/* Compares vertices with triangles, both ways; the missile does not turn. */
sf_status sf_support_find_travel(sf_model *m, sf_error *err) {
    const sf_surface missile = sf_surface_of_missile(m);
    double travel = INFINITY;
    for (int64_t k = 0; k < m->support_node_count; k++)
        travel = fmin(travel, sf_missile_travel(&missile, &m->missile, &m->support_position[3 * k]));
    for (int64_t k = 0; k < m->surface_node_count && m->support_triangle_count > 0; k++)
        travel = fmin(travel, sf_support_distance(m, &m->surface_position[3 * k], m->missile.direction));
    if (travel <= m->missile.gap)
        return SF_REFUSE(err, "support: the missile meets the support %.4g mm before it meets the pad",
                         1e3 * (m->missile.gap - travel));
    m->support_travel = isfinite(travel) ? travel : 0;
    return SF_OK;
}
