/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/alike.h"

#include <string.h>

static const char TOP[] = "top", BASE[] = "base";
enum { PROFILE = 64 }; /* points of the sphere's */

/* Node `column` of `row`, both from 0, in a grid of `columns` by `rows` cells. */
static int32_t node_at(int64_t column, int64_t row, int64_t columns) {
    return (int32_t)(row * (columns + 1) + column);
}

static void fill_cells(int64_t columns, int64_t rows, double width, double height, sf_mesh *m) {
    for (int64_t j = 0; j <= rows; j++)
        for (int64_t i = 0; i <= columns; i++) {
            double *x = &m->position[3 * (int64_t)node_at(i, j, columns)];
            x[0] = width * (double)i / (double)columns;
            x[2] = height * ((double)j / (double)rows - 1);
        }
    for (int64_t c = 0; c < m->cell_count; c++) {
        int64_t i = c % columns, j = c / columns;
        const int32_t node[4] = {node_at(i, j, columns), node_at(i + 1, j, columns),
                                 node_at(i + 1, j + 1, columns), node_at(i, j + 1, columns)};
        m->cell_type[c] = SF_CELL_QUADRANGLE;
        m->cell_ptr[c + 1] = 4 * (c + 1);
        memcpy(&m->cell_node[4 * c], node, sizeof node);
    }
}

static sf_status add_row(const char *name, int64_t row, int64_t columns, sf_mesh *m, sf_error *err) {
    sf_node_set *set = &m->set[m->set_count++];
    SF_ALLOC_ALL(err, "the section", SF_ROOM(set->node, columns + 1), SF_ROOM(set->face, 4 * columns));
    if (err->status == SF_OK && !(set->name = strdup(name)))
        SF_NO_MEMORY(err, "the section");
    SF_TRY(err->status);
    set->count = columns + 1;
    set->face_count = columns;
    for (int64_t i = 0; i <= columns; i++)
        set->node[i] = node_at(i, row, columns);
    for (int64_t i = 0; i < columns; i++) {
        const int32_t face[4] = {-1, -1, set->node[i], set->node[i + 1]};
        memcpy(&set->face[4 * i], face, sizeof face);
    }
    return SF_OK;
}

/* A rectangle below z = 0, at least as wide as the zone and a thickness beside it. */
static sf_status make_plate(const sf_contact_zone *zone, double thickness, sf_mesh *m, sf_error *err) {
    int64_t columns = (int64_t)fmax(2, ceil((zone->half_width + thickness) / zone->spacing)),
            rows = (int64_t)fmax(2, round(thickness / zone->spacing));
    m->node_count = (columns + 1) * (rows + 1);
    m->cell_count = columns * rows;
    if (m->node_count > SF_SECTIONS_MOST)
        return SF_REFUSE(err, "the plate has more than %d nodes", SF_SECTIONS_MOST);
    SF_ALLOC_ALL(err, "the section", SF_ROOM(m->position, 3 * m->node_count),
                 SF_ROOM(m->cell_type, m->cell_count), SF_ROOM(m->cell_ptr, m->cell_count + 1),
                 SF_ROOM(m->cell_node, 4 * m->cell_count), SF_ROOM(m->cell_layer, m->cell_count),
                 SF_ROOM(m->set, 2));
    SF_TRY(err->status);
    fill_cells(columns, rows, zone->spacing * (double)columns, thickness, m);
    SF_TRY(add_row(TOP, rows, columns, m, err));
    sf_mesh_orient(m);
    return add_row(BASE, 0, columns, m, err);
}

/* The radius of the missile's sphere, or of that whose zone is as wide at that depth. */
static double find_radius(const sf_model *m, const sf_contact_zone *zone) {
    double width = zone->half_width, depth = SF_CONTACT_ZONE_DEPTH * m->thickness;
    return m->missile.shape == SF_SHAPE_SPHERE
               ? m->missile.sphere_radius
               : fmax(0.5 * (width * width + depth * depth) / depth, 1.001 * width);
}

/* The lower half of a sphere, from the axis on. */
static sf_status make_sphere(double radius, sf_surface *s, sf_error *err) {
    s->node_count = PROFILE + 1;
    s->position = sf_alloc(err, 3 * s->node_count, sizeof *s->position, "the missile's profile");
    for (int k = 0; s->position && k <= PROFILE; k++) {
        double angle = 0.5 * M_PI * k / PROFILE;
        s->position[3 * k] = radius * sin(angle);
        s->position[3 * k + 2] = radius * (1 - cos(angle));
    }
    return err->status;
}

sf_status sf_alike_make(const sf_case *c, const sf_model *model, const sf_contact_zone *zone, sf_mesh *mesh,
                        sf_surface *missile, sf_error *err) {
    if (c->layer_count > 0 || c->membrane_count > 0 || sf_missile_is_driven(model) || !(zone->half_width > 0))
        return SF_REFUSE(err, "no axisymmetric drop is like this one: several foams, a cover, or a "
                              "prescribed motion");
    if (make_plate(zone, model->thickness, mesh, err) != SF_OK ||
        make_sphere(find_radius(model, zone), missile, err) != SF_OK) {
        sf_mesh_free(mesh);
        sf_surface_free(missile);
    }
    return err->status;
}

static void name_group(char group[SF_CASE_NAME_SIZE], const char *name) {
    snprintf(group, SF_CASE_NAME_SIZE, "%s", name);
}

void sf_alike_case(sf_case *c) {
    static const double DOWN[3] = {0, 0, -1};
    sf_missile_card *missile = &c->missile_card;
    missile->speed *= fabs(missile->direction[2]);
    memcpy(missile->direction, DOWN, sizeof DOWN);
    name_group(c->contact_group, TOP);
    name_group(c->fixed_group[0], BASE);
    c->fixed_count = 1;
    c->base_rule = SF_BASE_GLUED;
    c->sliding_count = c->symmetry_count = c->support_count = c->membrane_count = 0;
    c->interface_count = c->sliding_pair_count = c->loose_pair_count = 0;
    c->separate = c->triangle_centroids = 0;
    c->self_contact = SF_SELF_CONTACT_OFF;
    c->freedom = SF_MISSILE_GUIDED;
    c->inertia_count = c->centre_count = c->angular_velocity_count = 0;
    c->position_given = false;
    c->shape_rule = 0;
    memcpy(c->up, (const double[3]){0, 0, 1}, sizeof c->up);
}
