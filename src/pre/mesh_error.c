/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh_error.h"

#include "pre/mesh/missile_shape.h"
#include "model/symmetry.h"
#include <math.h>

static const double DEPTH = 0.5; /* of the thickness: where the zone is measured */

/* Sums over the zone's contact points, weighted with their areas. */
typedef struct zone_sums {
    double area, first[2], second[2][2];
} zone_sums;

static void add_point(zone_sums *s, const double x[3], const double origin[2], double area, double spacing) {
    s->area += area;
    for (int a = 0; a < 2; a++) {
        s->first[a] += area * (x[a] - origin[a]);
        for (int b = 0; b < 2; b++)
            s->second[a][b] += area * ((x[a] - origin[a]) * (x[b] - origin[b]) +
                                       (a == b ? spacing * spacing / 12 : 0)); /* of the node's own square */
    }
}

/* Moments about the planes, or else about the centroid, to the radii along the zone's principal axes: those
 * of the ellipse with the same moments. */
static void find_radii(zone_sums *s, const bool plane[2], double centre[2], double *narrow, double *wide) {
    double shift[2];
    for (int a = 0; a < 2; a++) {
        shift[a] = plane[a] ? 0 : s->first[a] / s->area;
        centre[a] += shift[a];
    }
    double xx = s->second[0][0] / s->area - shift[0] * shift[0],
           yy = s->second[1][1] / s->area - shift[1] * shift[1],
           xy = plane[0] || plane[1] ? 0 : s->second[0][1] / s->area - shift[0] * shift[1];
    double mean = (xx + yy) / 2, difference = hypot((xx - yy) / 2, xy);
    *narrow = 2 * sqrt(fmax(mean - difference, 0));
    *wide = 2 * sqrt(mean + difference);
}

/* Root mean square of the spacing, by volume, of the nodes within `radius` of the vertical through the
 * centre. */
static double mean_spacing(const sf_model *m, const double centre[2], double radius) {
    double sum = 0, volume = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        const double *x = &m->position[3 * i];
        if (hypot(x[0] - centre[0], x[1] - centre[1]) > radius)
            continue;
        sum += m->volume[i] * m->spacing[i] * m->spacing[i];
        volume += m->volume[i];
    }
    return volume > 0 ? sqrt(sum / volume) : 0;
}

void sf_contact_zone_measure(const sf_model *m, sf_contact_zone *zone) {
    const sf_surface missile = {.node_count = m->surface_node_count,
                                .position = m->surface_position,
                                .triangle_count = m->surface_triangle_count,
                                .triangle = m->surface_triangle};
    double centre[2], wide, deepest = m->missile.gap - DEPTH * m->thickness / m->missile.direction[2];
    const bool plane[2] = {sf_symmetry_plane(m, 0, &centre[0]), sf_symmetry_plane(m, 1, &centre[1])};
    zone_sums sums = {0};
    for (int64_t k = 0; k < m->contact_count; k++) {
        int64_t i = m->contact_node[k];
        if (sf_missile_travel(&missile, &m->missile, &m->position[3 * i]) <= deepest)
            add_point(&sums, &m->position[3 * i], centre, m->contact_area[k], m->spacing[i]);
    }
    *zone = (sf_contact_zone){.area = sf_model_whole(m) * sums.area};
    if (!(sums.area > 0))
        return;
    find_radii(&sums, plane, centre, &zone->half_width, &wide);
    zone->spacing = mean_spacing(m, centre, wide);
}

double sf_mesh_error_expect(const sf_model *m, const sf_contact_zone *zone) {
    if (sf_missile_is_driven(m) || !(zone->half_width > 0))
        return 0;
    double thickness = zone->spacing / m->thickness, width = zone->spacing / zone->half_width;
    return SF_MESH_ERROR_THICKNESS * thickness * thickness + SF_MESH_ERROR_WIDTH * width * width;
}
