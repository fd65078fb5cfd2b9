/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/build.h"
#include "pre/mesh/missile_shape.h"

#include <gsl/gsl_sort.h>
#include <math.h>

static const double LEVEL = 1e-6;           /* of the missile's extent: as low as its lowest node */
static const double ON_PLANE = 1e-6;        /* of the thickness */
static const double AT_NODE = 1e-9;         /* of the thickness */
static const double STRAIGHT = M_PI + 1e-6; /* rad */

/* True if the bottom of the card's sphere is a point of its cap. */
static bool has_bottom(const sf_missile_card *card) {
    return card->shape == SF_SHAPE_SPHERE && -card->direction[2] >= card->sphere_cap_cosine;
}

static void find_box(const sf_surface *s, double most, double low[3], double high[3]) {
    for (int c = 0; c < 3; c++) {
        low[c] = INFINITY;
        high[c] = -INFINITY;
    }
    for (int64_t k = 0; k < s->node_count; k++)
        for (int c = 0; c < 3 && s->position[3 * k + 2] <= most; c++) {
            low[c] = fmin(low[c], s->position[3 * k + c]);
            high[c] = fmax(high[c], s->position[3 * k + c]);
        }
}

/* Area centroid, in x and y, of the triangles that lie at the bottom; false: there is none. */
static bool find_flat(const sf_surface *s, double most, double middle[2]) {
    double sum = 0;
    middle[0] = middle[1] = 0;
    for (int64_t t = 0; t < s->triangle_count; t++) {
        const double *x[3];
        for (int v = 0; v < 3; v++)
            x[v] = &s->position[3 * (int64_t)s->triangle[3 * t + v]];
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
    SF_OWNED double *angle =
        sf_alloc(err, 4 * (unsigned long)m->contact_count, sizeof *angle, "impact point");
    SF_TRY(err->status);
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
