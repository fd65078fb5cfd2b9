/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/missile_body.h"

#include "base/mat3.h"
#include "pre/solid.h"
#include <string.h>

static const int ROW[6] = {0, 1, 2, 0, 1, 0}, COLUMN[6] = {0, 1, 2, 1, 2, 2};

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
            for (int c = 0; c < 3; c++)
                x[v][c] = s->position[3 * (int64_t)s->triangle[3 * t + v] + c] - card->sphere_centre[c];
        add_bulge(x, card->sphere_radius, &sum);
    }
    solid_of(&sum, card->sphere_centre, solid);
}

/* The solid, where the surface is now; `reason`: why there is none. */
static bool find_solid(const sf_surface *s, const sf_missile_card *card, sf_solid *solid, sf_error *reason) {
    sf_status status =
        s->hull_triangle_count > 0
            ? sf_solid_measure(s->hull_node_count, s->hull_position, s->hull_triangle_count, s->hull_triangle,
                               solid, reason)
            : sf_solid_measure(s->node_count, s->position, s->triangle_count, s->triangle, solid, reason);
    if (status != SF_OK)
        return false;
    for (int c = 0; c < 3 && s->hull_triangle_count > 0; c++)
        solid->centroid[c] += s->position[c] - s->origin[c];
    if (card->shape == SF_SHAPE_SPHERE)
        round_off(s, card, solid);
    return true;
}

static sf_status check_inertia(const double inertia[6], sf_error *err) {
    double p[3];
    if (sf_missile_inertia_is_possible(inertia, p))
        return SF_OK;
    return SF_FAIL(
        err, SF_ERR_INPUT,
        "missile.inertia: no body has the principal moments %.4g, %.4g and %.4g kg m2: they must be "
        "positive, and none larger than the sum of the others",
        p[0], p[1], p[2]);
}

sf_status sf_missile_take_body(const sf_case *c, const sf_surface *s, sf_missile_card *card, sf_error *err) {
    sf_error reason = SF_ERROR_INIT;
    sf_solid solid = {0};
    bool given = c->inertia_count > 0, placed = c->centre_count > 0;
    card->freedom = c->freedom;
    if (card->freedom == SF_MISSILE_GUIDED)
        return SF_OK;
    if (!(given && placed) && !find_solid(s, card, &solid, &reason))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "missile.freedom: the missile's %s is not given, and its geometry is no solid that tells it "
            "(%.300s): close its surface, mesh its volume, or give missile.inertia and missile.centre",
            given ? "centre" : "inertia", reason.text);
    memcpy(card->angular_velocity, c->angular_velocity, sizeof card->angular_velocity);
    for (int k = 0; k < 3; k++)
        card->centre[k] = placed ? c->centre[k] + s->position[k] - s->origin[k] : solid.centroid[k];
    for (int k = 0; k < 6; k++)
        card->inertia[k] = given ? c->inertia[k] : card->mass * solid.inertia[k] / solid.volume;
    return check_inertia(card->inertia, err);
}
