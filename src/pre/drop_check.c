/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/drop_check.h"

#include "base/mat3.h"
#include "base/sets.h"
#include "model/flight.h"
#include "model/good_run.h"
#include "pre/mesh/missile_shape.h"
#include "pre/missile_body.h"
#include "pre/support.h"

static const double DEPTH = SF_CONTACT_ZONE_DEPTH;
static const double EARLY = 0.1; /* steps of depth before that */
static const double LEADS =
    0.7; /* of its width: narrower than that is a part of its own, not a coarse mesh */

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

/* The zone when the missile stands `part` of the thickness deep, by fine x fine points a contact node. */
static void measure_at(const sf_model *m, double part, int fine, sf_contact_zone *zone) {
    const sf_surface missile = sf_surface_of_missile(m);
    double centre[2], wide, deepest = m->missile.gap - part * m->thickness / m->missile.direction[2];
    const bool plane[2] = {sf_symmetry_plane(m, 0, &centre[0]), sf_symmetry_plane(m, 1, &centre[1])};
    zone_sums sums = {0};
    for (int64_t k = 0; k < m->contact_count * fine * fine; k++) {
        int64_t node = k / (fine * fine), i = m->contact_node[node], at = k % (fine * fine);
        double width =
            m->axisymmetric ? 0 : sqrt(m->contact_area[node]); /* of a ring the node stands for it */
        double step = width / fine, x[3];
        memcpy(x, &m->position[3 * i], sizeof x);
        x[0] += step * ((double)(at / fine) - 0.5 * (fine - 1));
        x[1] += step * ((double)(at % fine) - 0.5 * (fine - 1));
        if (sf_missile_travel(&missile, &m->missile, x) <= deepest)
            add_point(&sums, x, centre, m->contact_area[node] / (fine * fine), m->spacing[i] / fine);
    }
    *zone = (sf_contact_zone){.area = sf_model_whole(m) * sums.area};
    if (!(sums.area > 0))
        return;
    if (m->axisymmetric) { /* a disc */
        zone->half_width = sqrt(sums.area / M_PI);
        zone->spacing = mean_spacing(m, (const double[2]){0}, zone->half_width);
        return;
    }
    find_radii(&sums, plane, centre, &zone->half_width, &wide);
    zone->spacing = mean_spacing(m, centre, wide);
}

/* Under a sphere the width grows with the root of the depth. A part that leads, such as a stud, stays narrow
 * for longer, and its own width counts. */
void sf_contact_zone_measure(const sf_model *m, sf_contact_zone *zone) {
    enum { FINE = 2 };
    measure_at(m, DEPTH, 1, zone);
    if (m->missile.shape == SF_SHAPE_SPHERE)
        return;
    for (double part = EARLY; part < DEPTH && zone->half_width > 0; part += EARLY) {
        sf_contact_zone early;
        measure_at(m, part, FINE, &early);
        double width = early.half_width * sqrt(DEPTH / part);
        if (width > 0 && width < LEADS * zone->half_width)
            zone->half_width = width;
    }
}

double sf_mesh_error_expect(const sf_model *m, const sf_contact_zone *zone) {
    if (sf_missile_is_driven(m) || !(zone->half_width > 0))
        return 0;
    double thickness = zone->spacing / m->thickness, width = zone->spacing / zone->half_width;
    return SF_MESH_ERROR_THICKNESS * thickness * thickness + SF_MESH_ERROR_WIDTH * width * width;
}

static const double AT_PLANE = 1e-3;  /* of the missile's extent: on the plane */
static const double SYMMETRIC = 1e-2; /* of the missile's extent: as far on one side as on the other */

/* ---- sizes ---- */

static const double THINNEST = 5e-4, THICKEST = 5; /* m, of a pad */
static const double SMALLEST = 1e-3, LARGEST = 10; /* m, of a missile */
static const double MOST_PADS = 100;               /* longest sides of the pad that a missile is wide */
static const double DENSEST = 23e3, LIGHTEST = 5;  /* kg m-3, of a metal and of a box around a missile */

/* Fills the extents (m) of the whole body, of whose points the model may have one side of a symmetry plane.
 */
static void find_size(const sf_model *m, int64_t count, const double *position, double size[3]) {
    double low[3], high[3], place;
    sf_box3(count, position, low, high);
    for (int c = 0; c < 3; c++) {
        size[c] = high[c] - low[c];
        if (c < 2 && (m->axisymmetric ? (place = 0, true) : sf_symmetry_plane(m, c, &place)))
            size[c] = 2 * fmax(fabs(low[c] - place), fabs(high[c] - place));
    }
}

/* The unit that the case gives to a geometry, and its key. */
static void name_unit(const sf_case *c, bool of_missile, char text[64]) {
    bool own = of_missile && c->missile.unit != c->length_unit;
    snprintf(text, 64, "geometry.%s is %g m", own ? "missile_length_unit" : "length_unit",
             own ? c->missile.unit : c->length_unit);
}

/* A geometry in another unit is a thousand times too large or too small. */
static sf_status check_sizes(const sf_case *c, const sf_model *m, sf_error *err) {
    char unit[64];
    double pad[3], missile[3];
    find_size(m, m->node_count, m->position, pad);
    find_size(m, m->surface_node_count, m->surface_position, missile);
    double narrow = fmin(missile[0], missile[1]), wide = fmax(fmax(missile[0], missile[1]), missile[2]);
    name_unit(c, false, unit);
    if (!(m->thickness >= THINNEST && m->thickness <= THICKEST))
        return SF_REFUSE(err,
                         "the pad is %g mm thick, outside %g to %g mm: %s; is that the unit of its geometry?",
                         1e3 * m->thickness, 1e3 * THINNEST, 1e3 * THICKEST, unit);
    name_unit(c, true, unit);
    if (!(wide >= SMALLEST && wide <= LARGEST && narrow <= MOST_PADS * fmax(fmax(pad[0], pad[1]), pad[2])))
        return SF_REFUSE(
            err,
            "the sizes cannot belong together: the missile is %.4g x %.4g x %.4g mm, the pad %.4g x "
            "%.4g x %.4g mm; %s: if the missile was drawn in another unit than the pad, %s",
            1e3 * missile[0], 1e3 * missile[1], 1e3 * missile[2], 1e3 * pad[0], 1e3 * pad[1], 1e3 * pad[2],
            unit,
            c->missile.path ? "give geometry.missile_length_unit"
                            : "give it a file of its own and geometry.missile_length_unit");
    return SF_OK;
}

/* Mass and size of a body that is meant as it is drawn. `volume`: m3, of the missile's solid; 0: none is
 * known. */
static void tell_density(const sf_case *c, const sf_model *m, double volume, const sf_sink *sink) {
    double size[3];
    char unit[64];
    find_size(m, m->surface_node_count, m->surface_position, size);
    double box = size[0] * size[1] * size[2];
    double least = volume > 0 && !(sf_model_whole(m) > 1) ? volume : box;
    name_unit(c, true, unit);
    if (sf_missile_is_driven(m) || !(box > 0) || !(volume > 0 || sf_model_whole(m) > 1))
        return; /* of a face alone nothing is known */
    if (m->missile.mass > DENSEST * least)
        sf_sink_tell(
            sink, SF_WARNING,
            "missile.mass: %g kg in a body of %.4g cm3 is denser than any metal: %s; is that the unit of "
            "its geometry?",
            m->missile.mass, 1e6 * least, unit);
    else if (m->missile.mass < LIGHTEST * box)
        sf_sink_tell(
            sink, SF_WARNING,
            "missile.mass: %g kg in a body of %.4g x %.4g x %.4g mm is lighter than any foam: %s; is that "
            "the unit of its geometry?",
            m->missile.mass, 1e3 * size[0], 1e3 * size[1], 1e3 * size[2], unit);
}

static sf_status check_mass(const sf_model *m, sf_error *err) {
    double share = m->missile.mass / sf_model_whole(m), heaviest = 0;
    for (int64_t k = 0; k < m->contact_count; k++)
        heaviest = fmax(heaviest, m->mass[m->contact_node[k]]);
    if (sf_missile_is_driven(m) || share > heaviest)
        return SF_OK;
    return SF_REFUSE(err,
                     "missile.mass: %g kg, of which the model has 1/%lld, is not more than the heaviest node "
                     "of the contact surface (%g kg)",
                     m->missile.mass, (long long)m->symmetry_factor, heaviest);
}

/* ---- the missile's place ---- */

static const double TOUCHING = 1e-3; /* of the thickness */

/* The missile is placed at its gap from the contact group; no other part of the pad may be nearer. Only nodes
 * above the missile's leading point can be. */
static sf_status check_outside(const sf_case *c, const sf_model *m, sf_error *err) {
    const sf_surface missile = sf_surface_of_missile(m);
    const double *d = m->missile.direction, slack = TOUCHING * m->thickness;
    double lead = -INFINITY;
    for (int64_t k = 0; k < m->surface_node_count; k++)
        lead = fmax(lead, sf_dot3(&m->surface_position[3 * k], d));
    if (m->missile.shape == SF_SHAPE_SPHERE)
        lead = fmax(lead, sf_dot3(m->missile.sphere_centre, d) + m->missile.sphere_radius);
    for (int64_t i = 0; i < m->node_count; i++) {
        const double *x = &m->position[3 * i];
        if (sf_dot3(x, d) >= lead + m->missile.gap - slack)
            continue;
        double travel = sf_missile_travel(&missile, &m->missile, x);
        if (travel < m->missile.gap - slack)
            return SF_REFUSE(err,
                             "the missile starts inside the pad: at its gap from the group \"%s\" it has "
                             "passed the pad's node at (%.4g, %.4g, %.4g) mm by %.4g mm: is every surface "
                             "that it meets in pad.contact?",
                             c->contact_group, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2],
                             1e3 * (m->missile.gap - travel));
    }
    return SF_OK;
}

/* ---- a spinning missile's flight ---- */

/* Moves the surface to where it is `before` (s) its arrival. */
static void move_surface(const sf_model *m, double before, double *position) {
    double shift[3], quaternion[4];
    sf_flight_displacement(&m->missile, before, shift);
    sf_flight_orientation(&m->missile, before, quaternion);
    for (int64_t k = 0; k < m->surface_node_count; k++) {
        double arm[3];
        sf_sub3(&m->surface_position[3 * k], m->missile.centre, arm);
        sf_rotate(quaternion, arm, &position[3 * k]);
        for (int c = 0; c < 3; c++)
            position[3 * k + c] += m->missile.centre[c] + shift[c];
    }
}

/* A missile that turns while it falls must reach the pad in the pose of its geometry, and not before. */
static sf_status check_arrival(const sf_model *m, sf_error *err) {
    enum { POSES = 64 };
    sf_missile_card card = m->missile;
    double rate = sqrt(sf_dot3(card.angular_velocity, card.angular_velocity)), flight = sf_flight_time(&card);
    if (!sf_missile_turns(m) || !(rate * flight > 0))
        return SF_OK;
    sf_surface surface = sf_surface_of_missile(m);
    SF_OWNED double *position = sf_alloc(err, 3 * surface.node_count, sizeof *position, "missile's flight");
    surface.position = position;
    card.shape = SF_SHAPE_SURFACE;
    for (int k = 1; k <= POSES && err->status == SF_OK; k++) {
        double before = flight * k / POSES, distance = 0;
        move_surface(m, before, position);
        if (sf_missile_distance(&surface, &card, m->position, m->contact_count, m->contact_node, &distance,
                                SF_IGNORED) == SF_OK &&
            distance < -TOUCHING * m->thickness)
            SF_REFUSE(err,
                      "missile.angular_velocity: the missile turns so fast that another part of it is %.3g "
                      "mm inside the pad %.3g ms before it arrives in the pose of its geometry: draw it as "
                      "it first touches the pad",
                      -1e3 * distance, 1e3 * before);
    }
    return err->status;
}

/* ---- symmetry ---- */

/* The symmetry group that the case holds in a plane x or y = `place`; NULL: there is none of that axis. */
static const char *find_plane(const sf_case *c, const sf_mesh *mesh, const sf_model *m, int axis,
                              double *place) {
    for (int g = 0; g < c->symmetry_count; g++) {
        const sf_node_set *set = sf_mesh_find_set(mesh, c->symmetry_group[g]);
        if (set && sf_group_is_plane(m, set, axis, place))
            return set->name;
    }
    return NULL;
}

/* On which side of the plane the pad lies. */
static double side_of_pad(const sf_model *m, int axis, double place) {
    double sum = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        sum += m->position[3 * i + axis] - place;
    return sum < 0 ? -1 : 1;
}

static double triangle_distance(const double x[3], const double a[3], const double b[3], const double c[3]) {
    double nearest[3];
    int feature;
    sf_triangle_nearest(a, b, c, x, nearest, &feature);
    return sf_distance3(nearest, x);
}

/* A missile that is drawn on both sides of the plane is its own mirror image: the model has one side alone.
 * The longest edges of a triangulation, which need not be symmetric, give the slack. */
static sf_status check_mirror(const sf_model *m, int axis, double place, double extent, const char *name,
                              sf_error *err) {
    enum { MOST_POINTS = 2000 };
    static const double OF_EDGE = 0.25; /* half of the sagitta of a coarse sphere, and more */
    int64_t stride = 1 + m->surface_node_count / MOST_POINTS;
    double longest = 0;
    for (int64_t k = 0; k < 3 * m->surface_triangle_count; k++) {
        const double *a = &m->surface_position[3 * (int64_t)m->surface_triangle[k]],
                     *b = &m->surface_position[3 * (int64_t)m->surface_triangle[k % 3 == 2 ? k - 2 : k + 1]];
        longest = fmax(longest, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
    }
    double slack = SYMMETRIC * extent + OF_EDGE * fmin(longest, 0.1 * extent);
    for (int64_t v = 0; v < m->surface_node_count; v += stride) {
        const double *own = &m->surface_position[3 * v];
        double x[3] = {own[0], own[1], own[2]}, nearest = INFINITY;
        x[axis] = 2 * place - x[axis];
        for (int64_t t = 0; t < m->surface_triangle_count && nearest > slack; t++) {
            const double *corner[3];
            sf_corners(m->surface_position, &m->surface_triangle[3 * t], corner);
            nearest = fmin(nearest, triangle_distance(x, corner[0], corner[1], corner[2]));
        }
        if (nearest > slack)
            return SF_REFUSE(err,
                             "the missile is not symmetric about the plane \"%s\" (%c = %g mm), of which the "
                             "model has one side: its point at (%.4g, %.4g, %.4g) mm has its mirror image "
                             "%.4g mm beside the surface; model the whole pad and the whole missile",
                             name, 'x' + axis, 1e3 * place, 1e3 * own[0], 1e3 * own[1], 1e3 * own[2],
                             1e3 * nearest);
    }
    return SF_OK;
}

/* The contact sees what stands over the modelled part of the pad: that must be half of a symmetric missile,
 * which may be modelled as a half or as a whole. */
static sf_status check_plane(const sf_model *m, int axis, double place, const char *name, sf_error *err) {
    double lows[3], highs[3];
    sf_box3(m->surface_node_count, m->surface_position, lows, highs);
    double low = lows[axis], high = highs[axis], extent = high - low;
    if (m->missile.shape == SF_SHAPE_SPHERE) {
        double off = m->missile.sphere_centre[axis] - place;
        if (fabs(off) <= AT_PLANE * m->missile.sphere_radius)
            return SF_OK;
        return SF_REFUSE(err,
                         "the centre of the missile's sphere lies %g mm off the symmetry plane \"%s\" (%c = "
                         "%g mm): it must lie on it",
                         1e3 * off, name, 'x' + axis, 1e3 * place);
    }
    double before = side_of_pad(m, axis, place) > 0 ? place - low : high - place, behind = extent - before;
    if (fabs(before) <= AT_PLANE * extent)
        return SF_OK;
    if (fabs(before - behind) <= SYMMETRIC * extent)
        return check_mirror(m, axis, place, extent, name, err);
    return SF_REFUSE(err,
                     "the missile spans %c = %g to %g mm, neither one side of the symmetry plane \"%s\" (%c "
                     "= %g mm) from that plane on nor both sides alike",
                     'x' + axis, 1e3 * low, 1e3 * high, name, 'x' + axis, 1e3 * place);
}

/* The edges of one triangle alone, which bound the missile's surface. */
typedef struct rims {
    int64_t count;
    sf_half_edge *list; /* [count]; owned */
} rims;

static rims list_rims(const sf_model *m, sf_error *err) {
    int64_t all = 3 * m->surface_triangle_count;
    rims r = {0, sf_half_edges(m->surface_triangle_count, m->surface_triangle, err)};
    for (int64_t k = 0, end; r.list && k < all; k = end) {
        end = sf_half_edges_end(r.list, k, all);
        if (end == k + 1)
            r.list[r.count++] = r.list[k];
    }
    return r;
}

/* True if a rim of the surface runs up or down in the plane x or y = `place`: the missile was cut there. A
 * level rim is that of an open top or of a flat platen. */
static bool is_cut(const sf_model *m, const rims *r, int axis, double place, double extent) {
    for (int64_t k = 0; k < r->count; k++) {
        const double *a = &m->surface_position[3 * (int64_t)r->list[k].low],
                     *b = &m->surface_position[3 * (int64_t)r->list[k].high];
        if (fabs(a[axis] - place) <= 1e-9 * extent && fabs(b[axis] - place) <= 1e-9 * extent &&
            fabs(a[2] - b[2]) > 1e-6 * extent)
            return true;
    }
    return false;
}

/* Zero for a place that is zero within the rounding of the mesh. */
static double round_off(double place, double extent) {
    return fabs(place) > 1e-9 * extent ? place : 0;
}

/* Without a symmetry plane of this axis the missile must be whole. */
static sf_status check_whole(const sf_model *m, const rims *r, int axis, sf_error *err) {
    double low[3], high[3];
    sf_box3(m->surface_node_count, m->surface_position, low, high);
    double extent = high[axis] - low[axis];
    bool below = is_cut(m, r, axis, low[axis], extent);
    if (!below && !is_cut(m, r, axis, high[axis], extent))
        return SF_OK;
    return SF_REFUSE(
        err,
        "the missile is cut open in the plane %c = %g mm, where the pad has no symmetry plane: "
        "half a missile over a whole pad; draw the whole missile, or, if the pad is cut there, too, "
        "name the group of that side in pad.symmetry",
        'x' + axis, 1e3 * round_off(below ? low[axis] : high[axis], extent));
}

/* ---- edges that point at the pad ---- */

static const double STEEP = 0.5; /* sine of the slope from which a sheet with a free edge is a blade */

/* The sine of the slope at which the triangle runs over its edge towards the pad; `middle` of that edge. */
static double edge_slope(const sf_model *m, int64_t t, int side, double middle[3]) {
    const double *a = &m->surface_position[3 * (int64_t)m->surface_triangle[3 * t + side]],
                 *b = &m->surface_position[3 * (int64_t)m->surface_triangle[3 * t + (side + 1) % 3]],
                 *c = &m->surface_position[3 * (int64_t)m->surface_triangle[3 * t + (side + 2) % 3]];
    double along[3], out[3];
    for (int i = 0; i < 3; i++) {
        middle[i] = 0.5 * (a[i] + b[i]);
        along[i] = b[i] - a[i];
        out[i] = middle[i] - c[i];
    }
    double share = sf_dot3(out, along) / sf_dot3(along, along);
    for (int i = 0; i < 3; i++)
        out[i] -= share * along[i];
    return sf_dot3(out, m->missile.direction) / sqrt(sf_dot3(out, out));
}

/* Can the pad meet the edge before any other part of the missile? */
static bool leads(const sf_model *m, const double middle[3]) {
    const sf_surface missile = sf_surface_of_missile(m);
    double ahead = 2 * m->thickness + m->missile.gap, x[3], low[3], high[3];
    for (int i = 0; i < 3; i++)
        x[i] = middle[i] + ahead * m->missile.direction[i];
    sf_box3(m->node_count, m->position, low, high);
    bool over = x[2] < low[2]; /* it comes as far as the base within twice the thickness */
    for (int i = 0; i < 2; i++)
        over = over && middle[i] > low[i] && middle[i] < high[i];
    return over && sf_missile_travel(&missile, &m->missile, x) > ahead * (1 - 1e-6);
}

/* Contact acts on faces: beside the free edge of a steep sheet the pad would pass. */
static sf_status check_blades(const sf_model *m, const rims *r, sf_error *err) {
    for (int64_t k = 0; k < r->count; k++) {
        double middle[3], slope = edge_slope(m, r->list[k].slot / 3, (int)(r->list[k].slot % 3), middle);
        if (!(slope < STEEP) && leads(m, middle)) /* also a triangle without area, of no slope */
            return SF_REFUSE(err,
                             "missile.group: the surface ends in an edge at (%.4g, %.4g, %.4g) mm that "
                             "points at the pad, in a sheet %.3g degrees steep: the pad would pass beside "
                             "it; close the missile below, or leave that part out of the group",
                             1e3 * middle[0], 1e3 * middle[1], 1e3 * middle[2],
                             asin(fmin(slope, 1)) * 180 / M_PI);
    }
    return SF_OK;
}

static sf_status check_symmetry(const sf_case *c, const sf_mesh *mesh, const sf_model *m, sf_error *err) {
    const rims r = list_rims(m, err);
    for (int axis = 0; axis < 2 && err->status == SF_OK; axis++) {
        double place = 0;
        const char *name = find_plane(c, mesh, m, axis, &place);
        if (name)
            check_plane(m, axis, place, name, err);
        else
            check_whole(m, &r, axis, err);
    }
    if (err->status == SF_OK && m->missile.shape == SF_SHAPE_SURFACE)
        check_blades(m, &r, err);
    free(r.list);
    return err->status;
}

/* ---- the pad's edge ---- */

static const double ON_EDGE = 1e-3; /* of the thickness */
static const double BESIDE =
    0.5; /* of the zone's half width: so near to the edge a good part of it hangs over */

/* A place on the pad's top, and the way from it to the edge of the convex outline of the contact nodes. */
typedef struct margin {
    double at[2], middle[2]; /* m, the impact point, and the middle of the top */
    double reach;            /* m, to the nearest edge, below 0 outside */
    int axis;                /* of the edge's normal: 0 x, 1 y, 2 neither */
} margin;

/* Symmetry planes are no edges. */
static margin find_margin(const sf_model *m) {
    enum { DIRECTIONS = 360 };
    margin e = {.reach = INFINITY, .axis = 2};
    bool plane[2];
    double low[3], high[3], place;
    sf_box3(0, NULL, low, high);
    for (int64_t k = 0; k < m->contact_count; k++)
        sf_box3_add(&m->position[3 * (int64_t)m->contact_node[k]], low, high);
    for (int c = 0; c < 2; c++) {
        plane[c] = sf_symmetry_plane(m, c, &place);
        e.at[c] = m->missile.impact[c];
        e.middle[c] = plane[c] ? place : 0.5 * (low[c] + high[c]);
    }
    for (int k = 0; k < DIRECTIONS; k++) {
        double angle = 2 * M_PI * k / DIRECTIONS, n[2] = {cos(angle), sin(angle)}, most = -INFINITY;
        for (int64_t i = 0; i < m->contact_count; i++) {
            const double *x = &m->position[3 * (int64_t)m->contact_node[i]];
            double way = 0;
            for (int c = 0; c < 2; c++) /* the mirrored half reaches as far */
                way += plane[c] ? fabs(n[c] * (x[c] - e.at[c])) : n[c] * (x[c] - e.at[c]);
            most = fmax(most, way);
        }
        if (most < e.reach) {
            e.reach = most;
            e.axis = k % (DIRECTIONS / 4) ? 2 : k / (DIRECTIONS / 4) % 2;
        }
    }
    return e;
}

/* Refuses a pad with a symmetry plane that also ends below the missile's middle: the group of that side is
 * missing. A missile that falls on an edge has a position. */
static sf_status check_cut(const sf_case *c, const sf_model *m, sf_error *err) {
    const margin e = find_margin(m);
    if (c->position_given || m->symmetry_factor == 1 || e.axis == 2 ||
        fabs(e.reach) > ON_EDGE * m->thickness || sf_missile_is_driven(m))
        return SF_OK;
    return SF_REFUSE(
        err,
        "the pad is cut open in the plane %c = %.4g mm, below the middle of the missile, and no symmetry "
        "group holds that side: name its physical surface in pad.symmetry, or, if the missile is to "
        "fall on the edge, give missile.position = [\"%.6g mm\", \"%.6g mm\"]",
        'x' + e.axis, 1e3 * e.at[e.axis], 1e3 * e.at[0], 1e3 * e.at[1]);
}

/* A plate that covers the whole top, a rectangle, may lie anywhere. */
static bool covers_top(const sf_model *m, const sf_contact_zone *zone) {
    double low[3], high[3];
    sf_box3(0, NULL, low, high);
    for (int64_t k = 0; k < m->contact_count; k++)
        sf_box3_add(&m->position[3 * (int64_t)m->contact_node[k]], low, high);
    return zone->area >= 0.99 * (double)m->symmetry_factor * (high[0] - low[0]) * (high[1] - low[1]);
}

static void tell_edge(const sf_model *m, const sf_contact_zone *zone, const sf_sink *sink) {
    if (m->axisymmetric || sf_missile_is_driven(m) || m->contact_count == 0)
        return;
    const margin e = find_margin(m);
    if (e.reach < BESIDE * zone->half_width && !covers_top(m, zone))
        sf_sink_tell(
            sink, SF_WARNING,
            "the missile falls on the edge of the pad: its impact point, (%.4g, %.4g) mm, lies %.3g mm %s the "
            "outline of the top; missile.position = [\"%.4g mm\", \"%.4g mm\"] is the middle of the top",
            1e3 * e.at[0], 1e3 * e.at[1], 1e3 * fabs(e.reach), e.reach < 0 ? "outside" : "inside",
            1e3 * e.middle[0], 1e3 * e.middle[1]);
}

/* ---- symmetry groups that the case does not hold ---- */

static bool holds(const sf_case *c, const char *name) {
    return sf_case_has_name(c->symmetry_count, c->symmetry_group, name) ||
           sf_case_has_name(c->fixed_count, c->fixed_group, name) ||
           sf_case_has_name(c->sliding_count, c->sliding_group, name);
}

static void tell_free_planes(const sf_case *c, const sf_mesh *mesh, const sf_sink *sink) {
    for (int k = 0; k < mesh->set_count; k++)
        if (strncmp(mesh->set[k].name, "symmetry", 8) == 0 && !holds(c, mesh->set[k].name))
            sf_sink_tell(sink, SF_WARNING,
                         "pad.symmetry leaves out the group \"%s\" of the geometry: that "
                         "side is free, and the modelled part counts as the whole pad",
                         mesh->set[k].name);
}

/* ---- materials ---- */

static void tell_cautions(const sf_model *m, const sf_sink *sink) {
    char text[512];
    for (int64_t k = 0; k < m->material_count; k++)
        if (m->material[k].law->caution &&
            m->material[k].law->caution(m->material[k].card, text, sizeof text))
            sf_sink_tell(sink, SF_WARNING, "%s", text);
}

/* ---- spacing ---- */

enum { REASON_SIZE = 256 };

static void describe_spacing(const sf_model *m, const sf_contact_zone *zone, char text[REASON_SIZE]) {
    snprintf(text, REASON_SIZE,
             "the nodal spacing under the missile is %.3g mm, in a pad of %.4g mm with a contact zone of "
             "%.3g mm half width: expected error of a_max about %.2g %%, mostly too low",
             1e3 * zone->spacing, 1e3 * m->thickness, 1e3 * zone->half_width, 100 * m->expected_mesh_error);
}

static sf_status check_spacing(const sf_case *c, const sf_model *m, const sf_contact_zone *zone,
                               sf_error *err) {
    char reason[REASON_SIZE];
    if (m->expected_mesh_error <= c->mesh_error_limit)
        return SF_OK;
    describe_spacing(m, zone, reason);
    return SF_REFUSE(err, "%s, over pad.mesh_error_limit (%.3g %%): take a finer mesh, or raise that key",
                     reason, 100 * c->mesh_error_limit);
}

sf_status sf_drop_check(const sf_case *c, const sf_mesh *mesh, const sf_model *m, sf_error *err) {
    SF_TRY(check_sizes(c, m, err));
    SF_TRY(check_outside(c, m, err));
    if (m->axisymmetric)
        return SF_OK;
    SF_TRY(check_symmetry(c, mesh, m, err));
    return check_cut(c, m, err);
}

sf_status sf_drop_check_contact(const sf_case *c, const sf_model *m, const sf_contact_zone *zone,
                                sf_error *err) {
    SF_TRY(check_spacing(c, m, zone, err));
    SF_TRY(check_mass(m, err));
    return check_arrival(m, err);
}

void sf_drop_warn(const sf_case *c, const sf_mesh *mesh, const sf_model *m, const sf_contact_zone *zone,
                  double volume, const sf_sink *sink) {
    tell_free_planes(c, mesh, sink);
    tell_density(c, m, volume, sink);
    tell_edge(m, zone, sink);
    tell_cautions(m, sink);
}

void sf_drop_warn_mesh(const sf_model *m, const sf_contact_zone *zone, const sf_sink *sink) {
    char reason[REASON_SIZE];
    if (!(m->expected_mesh_error >= sf_good_run_limits()->mesh))
        return;
    describe_spacing(m, zone, reason);
    sf_sink_tell(sink, SF_WARNING, "%s", reason);
}
