/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/section.h"

#include "base/mat3.h"
#include "base/sets.h"
#include "pre/cloud/dual.h"
#include "pre/mesh/refine.h"
#include <string.h>

static const double ON_AXIS = 1e-6; /* of the radius: on the axis */
static const double PLATE = 1e-6;   /* of the volume: a plate */

#define NOT_AXISYMMETRIC "geometry.model: the drop is not axisymmetric: "

sf_status sf_section_check_case(const sf_case *c, sf_error *err) {
    const double *d = c->missile_card.direction;
    const struct {
        bool wrong;
        const char *why;
    } list[] = {
        {d[2] > -1 + 1e-12, "missile.direction is oblique; leave it out for a straight impact"},
        {c->freedom == SF_MISSILE_FREE, "missile.freedom is \"free\"; a guided missile is needed"},
        {c->position_given && (c->missile_position[0] != 0 || c->missile_position[1] != 0),
         "missile.position lies off the axis; leave it out"},
        {c->support_count > 0, "the pad has supports (posts, feet); model a quarter or the whole"},
        {c->membrane_count > 0, "the pad has a cover without cells (membrane); model a quarter or the whole"},
        {c->separate != 0, "pad.separate lets bodies lie loose; model a quarter or the whole"},
        {c->self_contact == SF_SELF_CONTACT_ON,
         "pad.self_contact is \"on\"; faces of a plate meet no other ones, leave it out"},
        {c->up[2] != 1, "pad.up turns the pad; a plate with its top along z is needed"},
    };
    for (size_t k = 0; k < sizeof list / sizeof list[0]; k++)
        if (list[k].wrong)
            return SF_REFUSE(err, NOT_AXISYMMETRIC "%s", list[k].why);
    for (int k = 0; k < c->interface_count; k++)
        if (c->interface[k].kind == SF_INTERFACE_LOOSE)
            return SF_REFUSE(err, NOT_AXISYMMETRIC "%s: loose layers need a quarter or the whole",
                             c->interface[k].key);
    return SF_OK;
}

/* ---- the pad ---- */

/* The place of a face among those of the dual's boundary, as sf_face_compare has them. */
typedef struct sorted_face {
    int32_t node[4];
    int64_t at;
} sorted_face;

static sorted_face *sort_boundary(const sf_dual *dual, sf_error *err) {
    sorted_face *list = sf_alloc(err, dual->face_count, sizeof *list, "faces of the section");
    for (int64_t f = 0; list && f < dual->face_count; f++) {
        memcpy(list[f].node, dual->face[f].node, sizeof list[f].node);
        for (int a = 1; a < 4; a++)
            for (int b = a; b > 0 && list[f].node[b] < list[f].node[b - 1]; b--) {
                int32_t swap = list[f].node[b];
                list[f].node[b] = list[f].node[b - 1];
                list[f].node[b - 1] = swap;
            }
        list[f].at = f;
    }
    if (list)
        qsort(list, (size_t)dual->face_count, sizeof *list, sf_face_compare);
    return list;
}

/* The symmetry group of the case in the plane y = 0; NULL: there is none. */
static const sf_node_set *find_plane(const sf_case *c, const sf_mesh *mesh, double slack) {
    for (int g = 0; g < c->symmetry_count; g++) {
        const sf_node_set *set = sf_mesh_find_set(mesh, c->symmetry_group[g]);
        bool inside = set && set->face_count > 0;
        for (int64_t k = 0; inside && k < set->count; k++)
            inside = fabs(mesh->position[3 * (int64_t)set->node[k] + 1]) <= slack;
        if (inside)
            return set;
    }
    return NULL;
}

/* Cells of the section from the faces of the plane, with the numbers of the solid's nodes. */
static sf_status take_cells(const sf_mesh *solid, const sf_dual *dual, const sf_node_set *plane,
                            sf_mesh *section, sf_error *err) {
    int64_t count = plane->face_count;
    SF_OWNED sorted_face *list = sort_boundary(dual, err);
    SF_ALLOC_ALL(err, "the section", SF_ROOM(section->cell_type, count),
                 SF_ROOM(section->cell_ptr, count + 1), SF_ROOM(section->cell_node, 4 * count),
                 SF_ROOM(section->cell_layer, count));
    for (int64_t f = 0; f < count && err->status == SF_OK; f++) {
        const sorted_face *found =
            bsearch(&plane->face[4 * f], list, (size_t)dual->face_count, sizeof *list, sf_face_compare);
        if (!found)
            return SF_REFUSE(err, "pad.symmetry: a face of the group \"%s\" lies on no cell of the pad",
                             plane->name);
        const sf_boundary_face *face = &dual->face[found->at];
        section->cell_type[f] = face->size == 3 ? SF_CELL_TRIANGLE : SF_CELL_QUADRANGLE;
        section->cell_layer[f] = solid->cell_layer ? solid->cell_layer[face->cell] : 0;
        section->cell_ptr[f + 1] = section->cell_ptr[f] + face->size;
        memcpy(&section->cell_node[section->cell_ptr[f]], face->node,
               (size_t)face->size * sizeof *face->node);
    }
    section->cell_count = count;
    return err->status;
}

/* The nodes of the cells get numbers of their own; `number` [solid nodes] -1: none. */
static sf_status take_nodes(const sf_mesh *solid, int32_t *number, sf_mesh *section, sf_error *err) {
    int64_t entries = section->cell_ptr[section->cell_count];
    for (int64_t i = 0; i < solid->node_count; i++)
        number[i] = -1;
    for (int64_t k = 0; k < entries; k++)
        number[section->cell_node[k]] = 0;
    for (int64_t i = 0; i < solid->node_count; i++)
        if (number[i] == 0)
            number[i] = (int32_t)section->node_count++;
    section->position = sf_alloc(err, 3 * section->node_count, sizeof *section->position, "the section");
    for (int64_t i = 0; section->position && i < solid->node_count; i++)
        if (number[i] >= 0)
            memcpy(&section->position[3 * (int64_t)number[i]], &solid->position[3 * i],
                   3 * sizeof *section->position);
    for (int64_t k = 0; k < entries; k++)
        section->cell_node[k] = number[section->cell_node[k]];
    return err->status;
}

/* The sides of the section whose nodes all belong to a group of the solid. */
static sf_status take_set(const sf_node_set *from, const int32_t *number, const sf_dual *dual, int64_t nodes,
                          sf_mesh *section, sf_error *err) {
    sf_node_set *set = &section->set[section->set_count];
    SF_OWNED uint8_t *member = sf_alloc(err, nodes, 1, "the section");
    SF_OWNED uint8_t *kept = sf_alloc(err, nodes, 1, "the section");
    set->face = sf_alloc(err, 4 * dual->face_count, sizeof *set->face, "the section");
    set->node = sf_alloc(err, nodes, sizeof *set->node, "the section");
    set->name = err->status == SF_OK ? strdup(from->name) : NULL;
    section->set_count++;
    SF_TRY(err->status);
    for (int64_t k = 0; k < from->count; k++)
        if (number[from->node[k]] >= 0)
            member[number[from->node[k]]] = 1;
    for (int64_t f = 0; f < dual->face_count; f++) {
        const int32_t *side = dual->face[f].node;
        if (!sf_surface_has_face(&dual->face[f], member))
            continue;
        int32_t *face = &set->face[4 * set->face_count++];
        face[0] = face[1] = -1;
        face[2] = side[0] < side[1] ? side[0] : side[1];
        face[3] = side[0] < side[1] ? side[1] : side[0];
        kept[side[0]] = kept[side[1]] = 1;
    }
    for (int32_t i = 0; i < (int32_t)nodes; i++)
        if (kept[i])
            set->node[set->count++] = i;
    return SF_OK;
}

/* Groups without a side in the section, and symmetry planes, are no sets of it. */
static sf_status take_sets(const sf_case *c, const sf_mesh *solid, const int32_t *number, sf_mesh *section,
                           sf_error *err) {
    SF_OWNED_BY(sf_dual_free) sf_dual dual = {0};
    section->set = sf_alloc(err, solid->set_count, sizeof *section->set, "the section");
    SF_TRY(sf_dual_build(section, &dual, err));
    for (int s = 0; section->set && s < solid->set_count && err->status == SF_OK; s++) {
        if (sf_case_has_name(c->symmetry_count, c->symmetry_group, solid->set[s].name) ||
            take_set(&solid->set[s], number, &dual, section->node_count, section, err) != SF_OK)
            continue;
        sf_node_set *set = &section->set[section->set_count - 1];
        if (set->face_count > 0)
            continue;
        SF_FREE(set->name, set->node, set->face);
        *set = (sf_node_set){0};
        section->set_count--;
    }
    return err->status;
}

/* A plate fills its box, and so does each of its layers. */
static sf_status check_plate(const sf_mesh *solid, sf_error *err) {
    for (int layer = 0; layer < SF_CASE_MAX_LAYERS; layer++) {
        double low[3], high[3], volume = 0;
        sf_box3(0, NULL, low, high);
        for (int64_t c = 0; c < solid->cell_count; c++) {
            if ((solid->cell_layer ? solid->cell_layer[c] : 0) != layer)
                continue;
            volume += sf_mesh_cell_volume(solid, c);
            for (int64_t k = solid->cell_ptr[c]; k < solid->cell_ptr[c + 1]; k++)
                sf_box3_add(&solid->position[3 * (int64_t)solid->cell_node[k]], low, high);
        }
        double box = (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
        if (volume > 0 && !(fabs(volume / box - 1) <= PLATE))
            return SF_REFUSE(err,
                             NOT_AXISYMMETRIC
                             "the pad is no plate: it fills %.4g %% of its box (posts, feet, "
                             "holes, slopes); model a quarter or the whole",
                             100 * volume / box);
    }
    return SF_OK;
}

static sf_status cut(const sf_case *c, const sf_mesh *solid, sf_mesh *section, sf_error *err) {
    double low[3], high[3];
    sf_box3(solid->node_count, solid->position, low, high);
    double slack = ON_AXIS * (high[0] - low[0]);
    SF_TRY(check_plate(solid, err));
    const sf_node_set *plane = find_plane(c, solid, slack);
    if (!plane || fabs(low[0]) > slack || fabs(low[1]) > slack)
        return SF_REFUSE(err, NOT_AXISYMMETRIC
                         "its pad is no quarter of a plate, x >= 0 and y >= 0, with a "
                         "symmetry group in the plane y = 0: with geo/pad.geo and geo/layers.geo add "
                         "--set geometry.parameters.quarter=1");
    if (fabs(high[1] / high[0] - 1) > 1e-6)
        return SF_REFUSE(err, NOT_AXISYMMETRIC "the pad is %g by %g mm; a square or round one is needed",
                         2e3 * high[0], 2e3 * high[1]);
    SF_OWNED_BY(sf_dual_free) sf_dual dual = {0};
    SF_OWNED int32_t *number = sf_alloc(err, solid->node_count, sizeof *number, "the section");
    if (number && sf_dual_build(solid, &dual, err) == SF_OK &&
        take_cells(solid, &dual, plane, section, err) == SF_OK &&
        take_nodes(solid, number, section, err) == SF_OK)
        take_sets(c, solid, number, section, err);
    section->orphan_count = solid->orphan_count;
    return err->status;
}

/* Nodes near the axis are on it; all others lie on one side. */
static sf_status place_nodes(sf_mesh *mesh, bool drawn, sf_error *err) {
    double low[3], high[3];
    for (int64_t i = 0; drawn && i < mesh->node_count; i++) {
        double *x = &mesh->position[3 * i];
        if (x[2] != 0)
            return SF_REFUSE(err,
                             "geometry.file: the section leaves its plane at (%.4g, %.4g, %.4g) mm: draw it "
                             "in z = 0, the radius along x and the height along y",
                             1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
        x[2] = x[1];
    }
    sf_box3(mesh->node_count, mesh->position, low, high);
    double slack = ON_AXIS * fmax(fabs(low[0]), fabs(high[0]));
    if (low[0] < -slack)
        return SF_REFUSE(err,
                         "geometry.file: the section crosses the axis: it reaches x = %.4g mm, and x is the "
                         "radius; draw the half with x >= 0",
                         1e3 * low[0]);
    if (low[0] > slack)
        return SF_REFUSE(err,
                         "geometry.file: the section does not reach the axis: it begins at x = %.4g mm; "
                         "draw it from x = 0 on (a pad with a hole needs a quarter or the whole)",
                         1e3 * low[0]);
    for (int64_t i = 0; i < mesh->node_count; i++) {
        mesh->position[3 * i] *= fabs(mesh->position[3 * i]) > slack;
        mesh->position[3 * i + 1] = 0;
    }
    return SF_OK;
}

static sf_status check_rectangle(const sf_mesh *mesh, sf_error *err) {
    double low[3], high[3], volume = 0;
    sf_box3(mesh->node_count, mesh->position, low, high);
    for (int64_t c = 0; c < mesh->cell_count; c++)
        volume += sf_mesh_cell_volume(mesh, c);
    double whole = M_PI * high[0] * high[0] * (high[2] - low[2]);
    if (fabs(volume / whole - 1) <= PLATE)
        return SF_OK;
    return SF_REFUSE(err,
                     NOT_AXISYMMETRIC "the section is no rectangle: it fills %.4g %% of its cylinder (feet, "
                                      "holes, slopes); model a quarter or the whole",
                     100 * volume / whole);
}

/* Moves the section onto the axis and judges it. */
static sf_status finish(sf_mesh *section, bool drawn, sf_error *err) {
    double volume;
    SF_TRY(place_nodes(section, drawn, err));
    sf_mesh_orient(section);
    SF_TRY(sf_mesh_check(section, &volume, err));
    return check_rectangle(section, err);
}

sf_status sf_section_cut(const sf_case *c, const sf_mesh *solid, sf_mesh *section, sf_error *err) {
    double volume;
    if (sf_mesh_check(solid, &volume, err) != SF_OK || cut(c, solid, section, err) != SF_OK ||
        finish(section, false, err) != SF_OK)
        sf_mesh_free(section);
    return err->status;
}

sf_status sf_section_take_pad(const sf_case *c, sf_mesh *mesh, sf_error *err) {
    if (sf_mesh_is_section(mesh))
        return finish(mesh, true, err);
    sf_mesh section = {0};
    sf_section_cut(c, mesh, &section, err);
    sf_mesh_free(mesh);
    *mesh = section;
    return err->status;
}

/* ---- the missile ---- */

static const double OFF_PROFILE = 0.002; /* of the extent: on the profile */
static const double TWIST = 0.06;        /* root mean square of a normal's part along the circumference */
enum { SECTORS = 72 };

/* A point of the profile, by its angle at a point of the axis from straight down. */
typedef struct profile_point {
    double angle, radius, z;
} profile_point;

SF_ORDER_BY(by_angle, profile_point, angle, radius)

/* Root mean square over the area of the part of the unit normal along the circumference. */
static double twist_of(const sf_surface *s) {
    double sum = 0, area = 0;
    for (int64_t t = 0; t < s->triangle_count; t++) {
        const double *x[3];
        double n[3], middle[3];
        sf_corners(s->position, &s->triangle[3 * t], x);
        sf_face_normal(s->position, &s->triangle[3 * t], n);
        for (int c = 0; c < 3; c++)
            middle[c] = x[0][c] + x[1][c] + x[2][c];
        double size = sqrt(sf_dot3(n, n)), radius = hypot(middle[0], middle[1]);
        double along = radius > 0 && size > 0 ? (middle[0] * n[1] - middle[1] * n[0]) / (radius * size) : 0;
        sum += size * along * along;
        area += size;
    }
    return area > 0 ? sqrt(sum / area) : 1;
}

/* Distance of a point of the profile from the straight line between two others. */
static double off_line(const profile_point *a, const profile_point *p, const profile_point *b) {
    double dr = b->radius - a->radius, dz = b->z - a->z, length = hypot(dr, dz);
    double off = hypot(p->radius - a->radius, p->z - a->z);
    return length > 0 ? fabs((p->radius - a->radius) * dz - (p->z - a->z) * dr) / length : off;
}

/* Drops points that lie within `slack` (m) of the lines between those that are kept; returns how many. */
static int64_t thin_out(profile_point *p, int64_t count, double slack) {
    int64_t kept = 1, last = 0;
    for (int64_t k = 1; k < count; k++) {
        bool straight = k + 1 < count;
        for (int64_t i = last + 1; straight && i <= k; i++)
            straight = off_line(&p[kept - 1], &p[i], &p[k + 1]) <= slack;
        if (straight)
            continue;
        p[kept++] = p[k];
        last = k;
    }
    return kept;
}

/* Points of the profile [*count], from the axis at the bottom on; owned by the caller. */
static profile_point *find_profile(const sf_surface *s, int64_t *count, sf_error *err) {
    double low[3], high[3], extent, outer = 0;
    SF_OWNED profile_point *p = sf_alloc(err, s->node_count + 2, sizeof *p, "the missile's profile");
    sf_box3(s->node_count, s->position, low, high);
    extent = fmax(high[2] - low[2], fmax(high[0], high[1]));
    double middle = 0.5 * (low[2] + high[2]);
    for (int64_t k = 0; p && k < s->node_count; k++) {
        const double *x = &s->position[3 * k];
        double radius = hypot(x[0], x[1]);
        outer = fmax(outer, radius);
        p[k] = (profile_point){0, radius > ON_AXIS * extent ? radius : 0, x[2]};
    }
    if (!p)
        return NULL;
    if (s->triangle_count > 0 && !(twist_of(s) <= TWIST)) {
        SF_REFUSE(err, NOT_AXISYMMETRIC "the missile is no body of revolution about the axis x = y = 0");
        return NULL;
    }
    if (high[2] - low[2] < ON_AXIS * outer) /* a flat face is seen from above */
        middle = high[2] + outer;
    for (int64_t k = 0; k < s->node_count; k++)
        p[k].angle = atan2(p[k].radius, middle - p[k].z);
    qsort(p, (size_t)s->node_count, sizeof *p, by_angle);
    *count = s->node_count;
    double steep =
        2 + 4 * outer / fmax(high[2] - low[2], ON_AXIS * outer); /* of a flat face of that height */
    for (int64_t k = 1; k < *count; k++) {
        double before = hypot(p[k - 1].radius, middle - p[k - 1].z),
               own = hypot(p[k].radius, middle - p[k].z);
        if (fabs(own - before) > OFF_PROFILE * extent + steep * own * (p[k].angle - p[k - 1].angle)) {
            SF_REFUSE(err,
                      NOT_AXISYMMETRIC
                      "the missile is no body of revolution about the axis x = y = 0, or its "
                      "profile is not seen from one point of the axis: near a height of "
                      "%.4g mm its radius is %.4g mm and %.4g mm",
                      1e3 * p[k].z, 1e3 * p[k - 1].radius, 1e3 * p[k].radius);
            return NULL;
        }
    }
    *count = thin_out(p, *count, 5e-5 * extent);
    if (*count < 2) {
        SF_REFUSE(err, NOT_AXISYMMETRIC "the missile's surface has no profile");
        return NULL;
    }
    if (p[0].radius > 0) { /* a mesh without a node on the axis */
        memmove(&p[1], &p[0], (size_t)*count * sizeof *p);
        p[0].radius = 0;
        ++*count;
    }
    profile_point *out = p;
    p = NULL;
    return out;
}

/* Rings of nodes about the axis; the middle of a sector lies in the half plane y = 0, on the profile. */
static void turn_profile(const profile_point *p, int64_t count, sf_surface *s) {
    double outward = 1 / cos(M_PI / SECTORS);
    int64_t ring = 1;
    s->position[0] = s->position[1] = 0;
    s->position[2] = p[0].z;
    s->node_count = 1;
    for (int64_t k = 1; k < count; k++) {
        for (int a = 0; a < SECTORS; a++) {
            double angle = (2 * a - 1) * M_PI / SECTORS, *x = &s->position[3 * s->node_count++];
            x[0] = p[k].radius * outward * cos(angle);
            x[1] = p[k].radius * outward * sin(angle);
            x[2] = p[k].z;
        }
        for (int a = 0; a < SECTORS; a++) {
            int32_t b = (a + 1) % SECTORS, lower = (int32_t)ring + a, next = (int32_t)ring + b;
            int32_t *t = &s->triangle[3 * s->triangle_count];
            if (k == 1) {
                memcpy(t, (const int32_t[3]){0, next, lower}, 3 * sizeof *t);
                s->triangle_count++;
                continue;
            }
            memcpy(t, (const int32_t[6]){lower - SECTORS, next - SECTORS, next, lower - SECTORS, next, lower},
                   6 * sizeof *t);
            s->triangle_count += 2;
        }
        ring += SECTORS;
    }
}

sf_status sf_section_take_missile(sf_surface *s, sf_error *err) {
    int64_t count = 0;
    SF_OWNED profile_point *p = find_profile(s, &count, err);
    sf_surface out = {0};
    SF_TRY(err->status);
    SF_ALLOC_ALL(err, "the missile's surface", SF_ROOM(out.position, 3 * (1 + (count - 1) * SECTORS)),
                 SF_ROOM(out.triangle, 6 * count * SECTORS), SF_ROOM(out.solid, 2 * count * SECTORS));
    if (err->status == SF_OK) {
        turn_profile(p, count, &out);
        memset(out.solid, 1, (size_t)out.triangle_count);
        memcpy(out.origin, s->origin, sizeof out.origin);
        sf_surface_free(s);
        *s = out;
    } else {
        sf_surface_free(&out);
    }
    return err->status;
}

/* ---- the edge of a flat missile ---- */

static const double FLAT = 1e-3;    /* of the missile's radius: a flat face rises by less */
static const double EDGE_REACH = 2; /* spacings: finer cells about the edge, and largest width of an edge */
enum { EDGE_LEVELS = 2 };

/* Largest radius of the profile up to the height z. */
static double radius_at(const profile_point *p, int64_t count, double z) {
    double radius = p[0].radius;
    for (int64_t k = 1; k < count; k++) {
        if (p[k].z > z) {
            double part = (z - p[k - 1].z) / (p[k].z - p[k - 1].z);
            return fmax(radius, p[k - 1].radius + part * (p[k].radius - p[k - 1].radius));
        }
        radius = fmax(radius, p[k].radius);
    }
    return radius;
}

/* Length of the side of a group that has the radius on it; 0: none has. */
static double side_at(const sf_mesh *mesh, const sf_node_set *set, double radius) {
    for (int64_t f = 0; f < set->face_count; f++) {
        double a = mesh->position[3 * (int64_t)set->face[4 * f + 2]],
               b = mesh->position[3 * (int64_t)set->face[4 * f + 3]];
        if (fmin(a, b) <= radius && radius < fmax(a, b))
            return fabs(b - a);
    }
    return 0;
}

/* Splits the cells whose middles lie between two radii, above the height z. */
static sf_status split_band(const double radius[2], double z, sf_mesh *mesh, sf_error *err) {
    sf_mesh fine = {.orphan_count = mesh->orphan_count};
    SF_OWNED uint8_t *marked = sf_alloc(err, mesh->cell_count, 1, "cells below an edge");
    for (int64_t c = 0; marked && c < mesh->cell_count; c++) {
        int64_t first = mesh->cell_ptr[c];
        double middle[3];
        sf_mesh_middle(mesh, &mesh->cell_node[first], mesh->cell_ptr[c + 1] - first, middle);
        marked[c] = middle[0] > radius[0] && middle[0] < radius[1] && middle[2] > z;
    }
    SF_TRY(err->status);
    SF_TRY(sf_section_refine(mesh, marked, &fine, err));
    sf_mesh_free(mesh);
    *mesh = fine;
    return SF_OK;
}

sf_status sf_section_refine_edge(const sf_case *c, const sf_surface *missile, sf_mesh *mesh, sf_error *err) {
    const sf_node_set *contact = sf_mesh_find_set(mesh, c->contact_group);
    sf_error none = SF_ERROR_INIT;
    int64_t count = 0;
    SF_OWNED profile_point *p = contact ? find_profile(missile, &count, &none) : NULL;
    if (!p)
        return SF_OK;
    double low[3], high[3],
        outer = radius_at(p, count, INFINITY), flat = radius_at(p, count, p[0].z + FLAT * outer),
        spacing = side_at(mesh, contact, flat), edge = radius_at(p, count, p[0].z + spacing);
    sf_box3(mesh->node_count, mesh->position, low, high);
    if (!(flat > EDGE_REACH * spacing && edge - flat <= EDGE_REACH * spacing))
        return SF_OK;
    for (int k = 0; k < EDGE_LEVELS && SF_EDGE_ROWS * spacing > high[2] - low[2]; k++, spacing /= 2) {
        double reach = EDGE_REACH * spacing;
        SF_TRY(split_band((const double[2]){flat - reach, edge + reach}, high[2] - reach, mesh, err));
    }
    return SF_OK;
}
