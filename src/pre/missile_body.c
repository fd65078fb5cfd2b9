/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/missile_body.h"

#include "base/sets.h"
#include "pre/mesh/closed_parts.h"
#include "pre/mesh/missile_shape.h"
#include <gsl/gsl_sort.h>

#include "base/mat3.h"

/* Components of a symmetric tensor in the order of base/mat3.h. */
static const int ROW[6] = {0, 1, 2, 0, 1, 0}, COLUMN[6] = {0, 1, 2, 1, 2, 2};

static sf_status refuse_edge(const sf_half_edge *s, int64_t count, const double *position, sf_error *err) {
    const double *a = &position[3 * (int64_t)s->low], *b = &position[3 * (int64_t)s->high];
    static const char *const meeting[][2] = {
        {"it ends", "close its surface, or mesh its volume"},
        {"one triangle faces outwards and the next inwards", "mesh its volume"},
        {"more than two triangles meet", "leave out what is there twice, and walls within the surface"}};
    const char *const *m = meeting[(count < 3 ? count : 3) - 1];
    return SF_FAIL(err, SF_ERR_MODEL,
                   "the surface bounds no solid: %s at the edge from (%.6g, %.6g, %.6g) to (%.6g, %.6g, "
                   "%.6g) mm: %s",
                   m[0], 1e3 * a[0], 1e3 * a[1], 1e3 * a[2], 1e3 * b[0], 1e3 * b[1], 1e3 * b[2], m[1]);
}

static sf_status check_nodes(int64_t node_count, int64_t triangle_count, const int32_t *triangle,
                             sf_error *err) {
    for (int64_t k = 0; k < 3 * triangle_count; k++)
        if (triangle[k] < 0 || triangle[k] >= node_count ||
            triangle[k] == triangle[k % 3 == 2 ? k - 2 : k + 1])
            return SF_FAIL(err, SF_ERR_MODEL, "triangle %lld of the surface has no three nodes",
                           (long long)(k / 3));
    return SF_OK;
}

/* Sets `part` [triangle_count] to the lowest triangle of each triangle's part. */
static sf_status check_closed(const sf_closed_parts *s, int64_t *part, sf_error *err) {
    int64_t count = 3 * s->triangle_count;
    SF_TRY(check_nodes(s->node_count, s->triangle_count, s->triangle, err));
    SF_OWNED sf_half_edge *edge = sf_half_edges(s->triangle_count, s->triangle, err);
    for (int64_t k = 0, end; edge && k < count && err->status == SF_OK; k = end) {
        end = sf_half_edges_end(edge, k, count);
        if (end != k + 2 || edge[k].rises == edge[k + 1].rises)
            refuse_edge(&edge[k], end - k, s->position, err);
        else
            sf_sets_join(part, edge[k].slot / 3, edge[k + 1].slot / 3);
    }
    for (int64_t t = 0; t < s->triangle_count; t++)
        part[t] = sf_sets_find(part, t);
    return err->status;
}

/* Each of several parts must face outwards, or, as the surface of a cavity, inwards. */
static sf_status check_parts(const sf_closed_parts *s, const double *volume, sf_error *err) {
    sf_error overlap = SF_ERROR_INIT;
    SF_OWN(int32_t, depth, s->triangle_count, "parts of a surface", err);
    SF_TRY(sf_closed_parts_nest(s, depth, &overlap, err));
    if (overlap.status != SF_OK)
        return SF_REFUSE(err, "%s", overlap.text);
    for (int64_t t = 0; t < s->triangle_count; t++) {
        const double *x = &s->position[3 * (int64_t)s->triangle[3 * t]];
        if (s->part[t] == t && !(volume[t] * (depth[t] % 2 ? -1 : 1) > 0))
            return SF_REFUSE(err, "the closed part at (%.4g, %.4g, %.4g) mm %s", 1e3 * x[0], 1e3 * x[1],
                             1e3 * x[2],
                             depth[t] % 2 ? "fills what another one fills: cut it out of that (in gmsh "
                                            "BooleanFragments or BooleanDifference)"
                                          : "is flat or turned inwards: turn it over");
    }
    return SF_OK;
}

/* The middle of the box: the sums are taken about it, so that a place far from the origin costs no digits. */
static void find_middle(int64_t count, const double *position, double middle[3]) {
    double low[3], high[3];
    sf_box3(count, position, low, high);
    for (int c = 0; c < 3; c++)
        middle[c] = 0.5 * (low[c] + high[c]);
}

/* Adds the tetrahedron of the triangle x and the origin: for its volume V and the sum s of its corners, the
 * integral of x is V s / 4, that of x x^T is V (sum of the corners' x x^T + s s^T) / 20. */
static void add_tetrahedron(const double x[3][3], double *volume, double first[3], double second[6]) {
    double part = sf_triple3(x[0], x[1], x[2]) / 6, s[3];
    *volume += part;
    for (int c = 0; c < 3; c++) {
        s[c] = x[0][c] + x[1][c] + x[2][c];
        first[c] += part * s[c] / 4;
    }
    for (int k = 0; k < 6; k++) {
        int a = ROW[k], b = COLUMN[k];
        second[k] += part * (x[0][a] * x[0][b] + x[1][a] * x[1][b] + x[2][a] * x[2][b] + s[a] * s[b]) / 20;
    }
}

/* `second`: the integral of x x^T about the same place as the centroid. */
static void set_inertia(double volume, const double centroid[3], double second[6], double inertia[6]) {
    for (int k = 0; k < 6; k++)
        second[k] -= volume * centroid[ROW[k]] * centroid[COLUMN[k]];
    for (int k = 0; k < 3; k++)
        inertia[k] = second[(k + 1) % 3] + second[(k + 2) % 3];
    for (int k = 3; k < 6; k++)
        inertia[k] = -second[k];
}

sf_status sf_solid_measure(int64_t node_count, const double *position, int64_t triangle_count,
                           const int32_t *triangle, sf_solid *solid, sf_error *err) {
    double middle[3], volume = 0, first[3] = {0}, second[6] = {0};
    memset(solid, 0, sizeof *solid);
    if (triangle_count < 4)
        return SF_FAIL(err, SF_ERR_MODEL, "the surface bounds no solid: it has %lld triangles",
                       (long long)triangle_count);
    SF_OWNED int64_t *part = sf_sets_alone(triangle_count, "parts of a surface", err);
    SF_OWN(double, part_volume, triangle_count, "parts of a surface", err);
    const sf_closed_parts parts = {node_count, position, triangle_count, triangle, part};
    SF_TRY(check_closed(&parts, part, err));
    find_middle(node_count, position, middle);
    for (int64_t t = 0; t < triangle_count; t++) {
        double x[3][3], before = volume;
        for (int v = 0; v < 3; v++)
            sf_sub3(&position[3 * (int64_t)triangle[3 * t + v]], middle, x[v]);
        add_tetrahedron(x, &volume, first, second);
        part_volume[part[t]] += volume - before;
    }
    bool single = true;
    for (int64_t t = 0; t < triangle_count; t++)
        single = single && part[t] == 0;
    if (!single)
        SF_TRY(check_parts(&parts, part_volume, err));
    if (!(volume > 0) || !isfinite(volume))
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the surface bounds no solid: its volume is %g m3, so it is flat or turned inwards",
                       volume);
    for (int c = 0; c < 3; c++)
        first[c] /= volume;
    set_inertia(volume, first, second, solid->inertia);
    solid->volume = volume;
    for (int c = 0; c < 3; c++)
        solid->centroid[c] = middle[c] + first[c];
    return SF_OK;
}

/* Volume, and integrals of x and x x^T over it. */
typedef struct moments {
    double volume, first[3], second[6];
} moments;

/* Rule of degree 5 on a triangle (Radon 1948): barycentric coordinates and weights. */
static const double RULE[7][4] = {
    {1. / 3, 1. / 3, 1. / 3, 0.225},
    {0.059715871789769820, 0.470142064105115090, 0.470142064105115090, 0.132394152788506181},
    {0.470142064105115090, 0.059715871789769820, 0.470142064105115090, 0.132394152788506181},
    {0.470142064105115090, 0.470142064105115090, 0.059715871789769820, 0.132394152788506181},
    {0.797426985353087322, 0.101286507323456339, 0.101286507323456339, 0.125939180544827153},
    {0.101286507323456339, 0.797426985353087322, 0.101286507323456339, 0.125939180544827153},
    {0.101286507323456339, 0.101286507323456339, 0.797426985353087322, 0.125939180544827153},
};

/* Adds what lies between a triangle x, seen from the centre of the sphere, and the sphere: in the direction p
 * / |p| from |p| to the radius, the solid angle being p . dA / |p|^3. */
static void add_bulge(const double x[3][3], double radius, moments *sum) {
    double cone = sf_triple3(x[0], x[1], x[2]) / 2; /* p . n times the area */
    for (int k = 0; k < 7; k++) {
        double p[3], r, angle;
        for (int c = 0; c < 3; c++)
            p[c] = RULE[k][0] * x[0][c] + RULE[k][1] * x[1][c] + RULE[k][2] * x[2][c];
        r = sqrt(sf_dot3(p, p));
        angle = RULE[k][3] * cone / (r * r * r);
        sum->volume += angle * (pow(radius, 3) - pow(r, 3)) / 3;
        for (int c = 0; c < 3; c++)
            sum->first[c] += angle * p[c] / r * (pow(radius, 4) - pow(r, 4)) / 4;
        for (int c = 0; c < 6; c++)
            sum->second[c] += angle * p[ROW[c]] * p[COLUMN[c]] / (r * r) * (pow(radius, 5) - pow(r, 5)) / 5;
    }
}

/* The solid's moments about `origin`. */
static moments moments_of(const sf_solid *solid, const double origin[3]) {
    moments m = {.volume = solid->volume};
    double arm[3], trace = 0.5 * (solid->inertia[0] + solid->inertia[1] + solid->inertia[2]);
    for (int c = 0; c < 3; c++) {
        arm[c] = solid->centroid[c] - origin[c];
        m.first[c] = solid->volume * arm[c];
    }
    for (int k = 0; k < 6; k++)
        m.second[k] = (k < 3 ? trace : 0) - solid->inertia[k] + solid->volume * arm[ROW[k]] * arm[COLUMN[k]];
    return m;
}

static void solid_of(const moments *m, const double origin[3], sf_solid *solid) {
    double trace = 0, about[6];
    for (int k = 0; k < 6; k++) {
        about[k] = m->second[k] - m->first[ROW[k]] * m->first[COLUMN[k]] / m->volume;
        trace += k < 3 ? about[k] : 0;
    }
    solid->volume = m->volume;
    for (int c = 0; c < 3; c++)
        solid->centroid[c] = origin[c] + m->first[c] / m->volume;
    for (int k = 0; k < 6; k++)
        solid->inertia[k] = (k < 3 ? trace : 0) - about[k];
}

/* The triangles of the touching surface stand for a sphere. */
static void round_off(const sf_surface *s, const sf_missile_card *card, sf_solid *solid) {
    moments sum = moments_of(solid, card->sphere_centre);
    for (int64_t t = 0; t < s->triangle_count; t++) {
        double x[3][3];
        for (int v = 0; v < 3; v++)
            sf_sub3(&s->position[3 * (int64_t)s->triangle[3 * t + v]], card->sphere_centre, x[v]);
        add_bulge(x, card->sphere_radius, &sum);
    }
    solid_of(&sum, card->sphere_centre, solid);
}

/* Finds the body where the surface is now. The cells of a half or a quarter are not the missile. */
static void find_body(const sf_surface *s, const sf_model *m, sf_missile_body *body) {
    bool cells = s->hull_triangle_count > 0 && m->symmetry_factor == 1;
    *body = (sf_missile_body){.none = SF_ERROR_INIT};
    if (cells)
        sf_solid_measure(s->hull_node_count, s->hull_position, s->hull_triangle_count, s->hull_triangle,
                         &body->solid, &body->none);
    else
        sf_solid_measure(s->node_count, s->position, s->triangle_count, s->triangle, &body->solid,
                         &body->none);
    if (body->none.status != SF_OK)
        return;
    for (int c = 0; c < 3 && cells; c++)
        body->solid.centroid[c] += s->position[c] - s->origin[c];
    if (m->missile.shape == SF_SHAPE_SPHERE)
        round_off(s, &m->missile, &body->solid);
}

static sf_status check_inertia(const double inertia[6], sf_error *err) {
    double p[3];
    if (sf_missile_inertia_is_possible(inertia, p))
        return SF_OK;
    return SF_REFUSE(err,
                     "missile.inertia: no body has the principal moments %.4g, %.4g and %.4g kg m2: they "
                     "must be above 0, and none larger than the sum of the others",
                     p[0], p[1], p[2]);
}

sf_status sf_missile_take_body(const sf_case *c, const sf_surface *s, sf_model *m, sf_missile_body *body,
                               sf_error *err) {
    sf_missile_card *card = &m->missile;
    const sf_solid *solid = &body->solid;
    bool given = c->inertia_count > 0, placed = c->centre_count > 0;
    find_body(s, m, body);
    card->freedom = c->freedom;
    if (card->freedom == SF_MISSILE_GUIDED)
        return SF_OK;
    if (!(given && placed) && body->none.status != SF_OK)
        return SF_REFUSE(err,
                         "missile.freedom: the missile's %s is not given, and its geometry does not tell it: "
                         "%.400s; or give missile.inertia and missile.centre",
                         given ? "centre" : "inertia", body->none.text);
    memcpy(card->angular_velocity, c->angular_velocity, sizeof card->angular_velocity);
    for (int k = 0; k < 3; k++)
        card->centre[k] = placed ? c->centre[k] + s->position[k] - s->origin[k] : solid->centroid[k];
    for (int k = 0; k < 6; k++)
        card->inertia[k] = given ? c->inertia[k] : card->mass * solid->inertia[k] / solid->volume;
    return check_inertia(card->inertia, err);
}

/* ---- impact point ---- */

static const double LEVEL = 1e-6;           /* of the missile's extent: as low as its lowest node */
static const double ON_PLANE = 1e-6;        /* of the thickness */
static const double AT_NODE = 1e-9;         /* of the thickness */
static const double STRAIGHT = M_PI + 1e-6; /* rad */

/* True if the bottom of the card's sphere is a point of its cap. */
static bool has_bottom(const sf_missile_card *card) {
    return card->shape == SF_SHAPE_SPHERE && -card->direction[2] >= card->sphere_cap_cosine;
}

static void find_box(const sf_surface *s, double most, double low[3], double high[3]) {
    sf_box3(0, NULL, low, high);
    for (int64_t k = 0; k < s->node_count; k++)
        if (s->position[3 * k + 2] <= most)
            sf_box3_add(&s->position[3 * k], low, high);
}

/* Area centroid, in x and y, of the triangles that lie at the bottom; false: there is none. */
static bool find_flat(const sf_surface *s, double most, double middle[2]) {
    double sum = 0;
    middle[0] = middle[1] = 0;
    for (int64_t t = 0; t < s->triangle_count; t++) {
        const double *x[3];
        sf_corners(s->position, &s->triangle[3 * t], x);
        if (x[0][2] > most || x[1][2] > most || x[2][2] > most)
            continue;
        double area =
            fabs((x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) - (x[2][0] - x[0][0]) * (x[1][1] - x[0][1]));
        sum += area;
        for (int c = 0; c < 2; c++)
            middle[c] += area * (x[0][c] + x[1][c] + x[2][c]) / 3;
    }
    for (int c = 0; c < 2 && sum > 0; c++)
        middle[c] /= sum;
    return sum > 0;
}

void sf_impact_lowest(const sf_surface *surface, const sf_missile_card *card, double point[3]) {
    double low[3], high[3], extent = 0;
    find_box(surface, INFINITY, low, high);
    for (int c = 0; c < 3; c++)
        extent = fmax(extent, high[c] - low[c]);
    point[2] = low[2];
    if (has_bottom(card)) {
        point[0] = card->sphere_centre[0];
        point[1] = card->sphere_centre[1];
        point[2] = card->sphere_centre[2] - card->sphere_radius;
    } else if (!find_flat(surface, point[2] + LEVEL * extent, point)) {
        find_box(surface, point[2] + LEVEL * extent, low, high);
        for (int c = 0; c < 2; c++)
            point[c] = 0.5 * (low[c] + high[c]);
    }
}

/* ---- is the place on the pad's top? ---- */

/* The largest angle (rad) at the place that holds no node of the whole top: beyond pi the place lies outside
 * its convex outline. 0 at a node. */
static sf_status widest_gap(const sf_model *m, const double at[2], double *gap, sf_error *err) {
    double place[2], sign[2] = {1, 1};
    const bool plane[2] = {sf_symmetry_plane(m, 0, &place[0]), sf_symmetry_plane(m, 1, &place[1])};
    int64_t count = 0;
    bool at_node = false;
    SF_OWN(double, angle, 4 * m->contact_count, "impact point", err);
    for (int image = 0; image < 4; image++) {
        if ((image & 1 && !plane[0]) || (image & 2 && !plane[1]))
            continue;
        for (int c = 0; c < 2; c++)
            sign[c] = image >> c & 1 ? -1 : 1;
        for (int64_t k = 0; k < m->contact_count; k++) {
            const double *x = &m->position[3 * (int64_t)m->contact_node[k]];
            double dx = place[0] + sign[0] * (x[0] - place[0]) - at[0],
                   dy = place[1] + sign[1] * (x[1] - place[1]) - at[1];
            at_node = at_node || hypot(dx, dy) <= AT_NODE * m->thickness;
            angle[count++] = atan2(dy, dx);
        }
    }
    gsl_sort(angle, 1, (size_t)count);
    *gap = angle[0] + 2 * M_PI - angle[count - 1];
    for (int64_t k = 1; k < count; k++)
        *gap = fmax(*gap, angle[k] - angle[k - 1]);
    *gap = at_node ? 0 : *gap;
    return SF_OK;
}

/* ---- placing ---- */

static sf_status check_planes(const sf_model *m, const double at[2], sf_error *err) {
    for (int axis = 0; axis < 2; axis++) {
        double place;
        if (sf_symmetry_plane(m, axis, &place) && !(fabs(at[axis] - place) <= ON_PLANE * m->thickness))
            return SF_REFUSE(err,
                             "missile.position: %c = %g mm lies off the symmetry plane %c = %g mm: an impact "
                             "beside it needs a model without that plane",
                             'x' + axis, 1e3 * at[axis], 'x' + axis, 1e3 * place);
    }
    return SF_OK;
}

/* Over the contact group, or a hole in it. */
static sf_status check_inside(const sf_case *c, const sf_model *m, sf_error *err) {
    const double *at = c->missile_position;
    double gap = 0;
    SF_TRY(widest_gap(m, at, &gap, err));
    if (gap <= STRAIGHT)
        return SF_OK;
    return SF_REFUSE(err, "missile.position: (%g, %g) mm lies outside the pad's top, the group \"%s\"",
                     1e3 * at[0], 1e3 * at[1], c->contact_group);
}

double sf_impact_top(const sf_model *m) {
    double top = -INFINITY;
    for (int64_t i = 0; i < m->node_count; i++)
        top = fmax(top, m->position[3 * i + 2]);
    return top;
}

/* Moves the point along the direction to the height of the pad's top. */
static void follow(const sf_missile_card *card, double top, double point[3]) {
    double travel = (top - point[2]) / card->direction[2];
    for (int axis = 0; axis < 3; axis++)
        point[axis] += travel * card->direction[axis];
}

sf_status sf_impact_place(const sf_case *c, const sf_model *m, sf_surface *surface, sf_missile_card *card,
                          sf_error *err) {
    double point[3], place;
    if (!c->position_given)
        return SF_OK;
    if (check_planes(m, c->missile_position, err) != SF_OK || check_inside(c, m, err) != SF_OK)
        return err->status;
    sf_impact_lowest(surface, card, point);
    follow(card, sf_impact_top(m), point);
    for (int axis = 0; axis < 2; axis++) {
        double shift = c->missile_position[axis] - point[axis];
        if (sf_symmetry_plane(m, axis, &place))
            continue;
        card->sphere_centre[axis] += shift;
        for (int64_t k = 0; k < surface->node_count; k++)
            surface->position[3 * k + axis] += shift;
    }
    return SF_OK;
}

void sf_impact_point(const sf_model *m, double point[3]) {
    const sf_surface missile = sf_surface_of_missile(m);
    double place;
    sf_impact_lowest(&missile, &m->missile, point);
    follow(&m->missile, sf_impact_top(m), point);
    for (int axis = 0; axis < 2; axis++)
        if (sf_symmetry_plane(m, axis, &place))
            point[axis] = place;
}
