/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/free_faces.h"

#include "base/grid.h"
#include "base/mat3.h"
#include "base/sets.h"
#include "pre/mesh/missile_shape.h"
#include "pre/support.h"

/* ---- faces that may touch ---- */

static const double ALONG = 0.99; /* least cosine of a face that is held along its normal */

typedef struct shape {
    double centroid[3], normal[3], radius, area; /* m, -, m, m2 */
} shape;

static shape shape_of(const sf_model *m, const int32_t node[3]) {
    shape s = {{0}, {0}, 0, 0};
    const double *x[3];
    sf_corners(m->position, node, x);
    sf_triangle_normal(x[0], x[1], x[2], s.normal);
    s.area = 0.5 * sqrt(sf_dot3(s.normal, s.normal));
    sf_unit3(s.normal);
    for (int r = 0; r < 3; r++)
        s.centroid[r] = x[0][r] + ((x[1][r] - x[0][r]) + (x[2][r] - x[0][r])) / 3;
    for (int k = 0; k < 3; k++)
        s.radius = fmax(s.radius, sf_distance3(x[k], s.centroid));
    return s;
}

/* The components that are held at each node, and 8 where it is tied to another layer. */
static uint8_t *mark_nodes(const sf_model *m, sf_error *err) {
    uint8_t *mark = sf_alloc(err, m->node_count, 1, "skin of the pad");
    for (int64_t k = 0; mark && k < m->fixed_count; k++)
        mark[m->fixed_node[k]] |= m->fixed_mask[k];
    for (int64_t k = 0; mark && k < m->tie_count; k++) {
        mark[m->tie_node[k]] |= 8;
        mark[m->tie_other[k]] |= 8;
    }
    return mark;
}

/* False for a face that is tied, in a symmetry plane or glued to the base: nothing can touch it. */
static bool is_open(const uint8_t *mark, const int32_t node[3], const shape *s) {
    uint8_t all = mark[node[0]] & mark[node[1]] & mark[node[2]];
    for (int r = 0; r < 3; r++)
        if ((all >> r) & 1 && fabs(s->normal[r]) > ALONG)
            return false;
    return !(all & 8);
}

/* The open faces, with the grid that finds them by their place. */
typedef struct faces {
    int64_t count;
    int32_t *node;    /* [count][3] */
    uint8_t *half;    /* [count] as of sf_model.skin_half */
    shape *shape;     /* [count] */
    double *position; /* [count][3] m, centroids, for the grid */
    double *radius;   /* [count] m */
    double low[3], high[3], largest;
    sf_grid grid;
} faces;

static void faces_free(faces *f) {
    sf_grid_free(&f->grid);
    SF_CLEAR(f, f->node, f->half, f->shape, f->position, f->radius);
}

static sf_status faces_find(const sf_model *m, faces *f, sf_error *err) {
    int64_t all = 0;
    SF_OWNED uint8_t *mark = mark_nodes(m, err);
    *f = (faces){0};
    if (mark && sf_skin_triangles(&SF_CELLS_OF(m), &all, &f->node, &f->half, err) == SF_OK) {
        SF_ALLOC_ALL(err, "skin of the pad", SF_ROOM(f->shape, all), SF_ROOM(f->position, 3 * all),
                     SF_ROOM(f->radius, all));
    }
    for (int64_t i = 0; err->status == SF_OK && i < all; i++) {
        const shape s = shape_of(m, &f->node[3 * i]);
        if (!is_open(mark, &f->node[3 * i], &s))
            continue;
        int64_t k = f->count++;
        memmove(&f->node[3 * k], &f->node[3 * i], 3 * sizeof *f->node);
        f->half[k] = f->half[i];
        f->shape[k] = s;
        f->radius[k] = s.radius;
        f->largest = fmax(f->largest, s.radius);
        memcpy(&f->position[3 * k], s.centroid, sizeof s.centroid);
    }
    sf_box3(m->node_count, m->position, f->low, f->high);
    if (err->status == SF_OK && f->count > 0)
        sf_grid_build(&f->grid, f->count, f->position, f->radius, err);
    if (err->status != SF_OK)
        faces_free(f);
    return err->status;
}

/* ---- can the foam touch itself? ---- */

/* Length (m) of the ray from face i outwards inside the pad's box, at most `most`. */
static double length_in_box(const faces *f, int64_t i, double most) {
    const shape *s = &f->shape[i];
    for (int r = 0; r < 3; r++) {
        double n = s->normal[r], end = n > 0 ? f->high[r] : f->low[r];
        if (fabs(n) > 1e-9)
            most = fmin(most, (end - s->centroid[r]) / n);
    }
    return most;
}

/* True if the ray from face i, of this length (m), meets the outside of another face. `near` [f->count] is
 * work space. */
static bool meets_face(const sf_model *m, const faces *f, int64_t i, double length, int32_t *near) {
    const shape *s = &f->shape[i];
    double step = 2 * f->largest;
    for (double at = 0; at < length + step; at += step) {
        double place[3];
        for (int r = 0; r < 3; r++)
            place[r] = s->centroid[r] + at * s->normal[r];
        int64_t count = sf_grid_gather(&f->grid, place, step, f->count, near);
        for (int64_t k = 0; k < count; k++) {
            const double *x[3];
            if (near[k] == i || sf_dot3(f->shape[near[k]].normal, s->normal) > 0)
                continue;
            sf_corners(m->position, &f->node[3 * (int64_t)near[k]], x);
            double travel = -sf_triangle_travel(x[0], x[1], x[2], s->normal, s->centroid);
            if (travel > 0 && travel < length)
                return true;
        }
    }
    return false;
}

/* True if the ray from face i, of this length (m) in the pad's box, ends at a symmetry plane within half the
 * thickness: beyond it the face's mirror image comes as far. */
static bool meets_image(const sf_model *m, const shape *s, double length) {
    double place;
    for (int axis = 0; axis < 2; axis++) {
        double n = s->normal[axis];
        if (!sf_symmetry_plane(m, axis, &place) || fabs(n) < 1e-9)
            continue;
        double at = (place - s->centroid[axis]) / n;
        if (at > 0 && at <= length * (1 + 1e-9) && 2 * at < m->thickness)
            return true;
    }
    return false;
}

/* *first: a face that can touch another one, its image, or the anvil; -1: none can. */
static sf_status find_touching(const sf_model *m, const faces *f, int64_t *first, sf_error *err) {
    static const double LEAST = 1e-6, DOWN = -0.2; /* of the thickness; cosine of a face over the anvil */
    SF_OWNED int32_t *near = sf_alloc(err, f->count, sizeof *near, "skin of the pad");
    double anvil = f->high[2] - m->anvil.depth;
    *first = -1;
    for (int64_t i = 0; near && i < f->count && *first < 0; i++) {
        const shape *s = &f->shape[i];
        double length = length_in_box(f, i, m->thickness), height = s->centroid[2] - anvil;
        bool over = m->anvil.depth > 0 && s->normal[2] < DOWN && height > LEAST * m->thickness;
        if ((over && -height / s->normal[2] < m->thickness) ||
            (length > LEAST * m->thickness &&
             (meets_image(m, s, length) || meets_face(m, f, i, length, near))))
            *first = i;
    }
    return err->status;
}

/* The friction of loose layers that is not that of all faces. */
static sf_status take_pairs(const sf_case *c, sf_model *m, sf_error *err) {
    m->skin_friction = c->self_friction;
    m->skin_centroids = c->triangle_centroids && !m->skin_alone && sf_model_skin_triangles(m) > 0;
    SF_ALLOC_ALL(err, "friction of layers", SF_ROOM(m->pair_layer, 2 * SF_CASE_MAX_INTERFACES),
                 SF_ROOM(m->pair_friction, SF_CASE_MAX_INTERFACES));
    for (int k = 0; err->status == SF_OK && k < c->interface_count; k++) {
        const sf_case_interface *i = &c->interface[k];
        if (i->kind != SF_INTERFACE_LOOSE || i->friction == m->skin_friction)
            continue;
        bool falls = i->layer[0] > i->layer[1];
        m->pair_layer[2 * m->pair_count] = (uint8_t)i->layer[falls];
        m->pair_layer[2 * m->pair_count + 1] = (uint8_t)i->layer[!falls];
        m->pair_friction[m->pair_count++] = i->friction;
    }
    return err->status;
}

/* ---- faces of hexahedra that do not match ---- */

/* True if the node lies on the triangle of half k of a quadrangle, across a gap that is narrow, and far from
 * its corners: the two sides do not match there. */
static bool is_unmatched(const sf_model *m, const faces *f, const double x[3], const double n[3],
                         double spacing, int64_t k) {
    static const double AGAINST = -0.95, APART = 0.1; /* cosine of the normals; of the spacing */
    const double *corner[3];
    double near[3], off[3];
    int feature;
    sf_corners(m->position, &f->node[3 * k], corner);
    if (!f->half[k] || sf_dot3(n, f->shape[k].normal) > AGAINST)
        return false;
    sf_triangle_nearest(corner[0], corner[1], corner[2], x, near, &feature);
    sf_sub3(near, x, off);
    double gap = sf_dot3(off, n), least = INFINITY;
    for (int c = 0; c < 3; c++)
        least = fmin(least, sf_distance3(near, corner[c]));
    return gap >= 0 && sf_dot3(off, off) - gap * gap < 1e-6 * spacing * spacing && least > APART * spacing;
}

/* The Coulomb coefficient between the faces i and k. */
static double friction_between(const sf_model *m, const faces *f, int64_t i, int64_t k) {
    return sf_model_friction(m, m->node_material[f->node[3 * i]], m->node_material[f->node[3 * k]]);
}

/* Refuses quadrangles that do not match, touch and slide without friction: beyond a strain of 0.45 the foam
 * buckles there, a column of cells beside the next (33 g where equal cells have 44.9 g). */
static sf_status check_matching(const sf_model *m, const faces *f, sf_error *err) {
    static const double NARROW = 0.5; /* of the spacing: wider gaps close where the foam comes to lie */
    SF_OWNED int32_t *near = sf_alloc(err, f->count, sizeof *near, "skin of the pad");
    for (int64_t i = 0; near && i < 3 * f->count; i++) {
        const double *x = &m->position[3 * (int64_t)f->node[i]], *n = f->shape[i / 3].normal;
        double spacing = m->spacing[f->node[i]];
        int64_t count = f->half[i / 3] ? sf_grid_gather(&f->grid, x, NARROW * spacing, f->count, near) : 0;
        for (int64_t k = 0; k < count; k++)
            if (is_unmatched(m, f, x, n, spacing, near[k]) && friction_between(m, f, i / 3, near[k]) == 0)
                return SF_REFUSE(
                    err,
                    "pad.self_friction: hexahedra of two parts touch at (%.4g, %.4g, %.4g) mm, where "
                    "their nodes do not match, and slide without friction: pressed beyond a strain of "
                    "0.45 they buckle there; give friction (pad.self_friction = 0.3, or that of the "
                    "interface) or both parts equal spacings",
                    1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
    }
    return err->status;
}

sf_status sf_skin_find(const sf_case *c, sf_model *m, double unheld[3], sf_error *err) {
    SF_OWNED_BY(faces_free) faces f = {0};
    int64_t first = -1;
    bool loose = false;
    unheld[0] = NAN;
    for (int k = 0; k < c->interface_count; k++)
        loose = loose || c->interface[k].kind == SF_INTERFACE_LOOSE;
    SF_TRY(faces_find(m, &f, err));
    if (f.count > 0 && (loose || c->separate))
        first = 0;
    else if (f.count > 0)
        find_touching(m, &f, &first, err);
    bool off = c->self_contact == SF_SELF_CONTACT_OFF,
         itself = !off && (first >= 0 || c->self_contact == SF_SELF_CONTACT_ON);
    if (first >= 0 && off)
        memcpy(unheld, f.shape[first].centroid, sizeof f.shape[first].centroid);
    m->skin_watched = off && first >= 0;
    if (err->status == SF_OK && f.count > 0 && (itself || m->skin_watched || m->support_triangle_count > 0)) {
        m->skin_count = f.count;
        m->skin_triangle = f.node;
        m->skin_half = f.half;
        m->skin_alone = !itself;
        if (take_pairs(c, m, err) == SF_OK && itself)
            check_matching(m, &f, err);
        f.node = NULL; /* the model's */
        f.half = NULL;
    }
    return err->status;
}

enum { FREE, ADDED, LEFT_OUT, NAMED };

/* Sets the faces between contact points: those that the missile's edges may press. */
static sf_status take_faces(const sf_layers *layers, const faces *f, const uint8_t *mark, sf_model *m,
                            sf_error *err) {
    m->contact_face = sf_alloc(err, 3 * (unsigned long)f->count, sizeof *m->contact_face, "faces in contact");
    for (int64_t k = 0; m->contact_face && k < f->count; k++) {
        int32_t *node = &m->contact_face[3 * m->contact_face_count];
        int held = 0;
        for (int c = 0; c < 3; c++) {
            node[c] = sf_layers_heaviest(layers, m, f->node[3 * k + c]);
            held += mark[node[c]] == LEFT_OUT;
        }
        m->contact_face_count += held == 0;
    }
    return err->status;
}

sf_status sf_contact_add_free(const sf_layers *layers, sf_model *m, sf_contact_zone *zone, sf_error *err) {
    static const double FACING = -0.64; /* largest cosine of a face that goes on from the named ones */
    SF_OWNED_BY(faces_free) faces f = {0};
    SF_OWNED uint8_t *mark = sf_alloc(err, m->node_count, 1, "contact points");
    SF_OWNED double *area = sf_alloc(err, m->node_count, sizeof *area, "contact points");
    SF_OWNED double *seen = sf_alloc(err, m->node_count, sizeof *seen, "contact points");
    SF_OWNED int32_t *node = sf_alloc(err, m->node_count, sizeof *node, "contact points");
    double unnamed = 0;
    SF_TRY(err->status);
    SF_TRY(faces_find(m, &f, err));
    for (int64_t k = 0; k < m->fixed_count; k++)
        if (m->fixed_base[k] || m->fixed_mask[k] == (SF_FIX_X | SF_FIX_Y | SF_FIX_Z))
            mark[m->fixed_node[k]] = LEFT_OUT;
    for (int64_t k = 0; k < m->rest_count; k++)
        mark[m->rest_node[k]] = LEFT_OUT;
    for (int64_t k = 0; k < m->contact_count; k++) {
        mark[m->contact_node[k]] = NAMED;
        area[m->contact_node[k]] = m->contact_area[k];
    }
    for (int64_t k = 0; k < 3 * f.count; k++) {
        int32_t point = sf_layers_heaviest(layers, m, f.node[k]);
        double third = f.shape[k / 3].area / 3;
        int named = 0;
        for (int c = 0; c < 3; c++)
            named += mark[sf_layers_heaviest(layers, m, f.node[k - k % 3 + c])] == NAMED;
        mark[point] = mark[point] == FREE ? ADDED : mark[point];
        area[point] += mark[point] == ADDED ? third : 0;
        if (named < 3 && sf_dot3(f.shape[k / 3].normal, m->missile.direction) < FACING) {
            seen[point] += third;
            unnamed += third;
        }
    }
    m->contact_count = 0;
    for (int32_t i = 0; i < (int32_t)m->node_count; i++)
        if (mark[i] == ADDED || mark[i] == NAMED) {
            double whole = mark[i] == NAMED ? area[i] + seen[i] : area[i];
            seen[m->contact_count] = mark[i] == NAMED ? whole : seen[i];
            area[m->contact_count] = whole;
            node[m->contact_count++] = i;
        }
    SF_FREE(m->contact_node, m->contact_area);
    m->contact_node = node;
    m->contact_area = seen;
    node = NULL;
    if (unnamed > 0) {
        sf_contact_zone_measure(m, zone);
        m->expected_mesh_error = sf_mesh_error_expect(m, zone);
    }
    m->contact_area = area;
    area = NULL;
    return m->missile.shape == SF_SHAPE_SURFACE ? take_faces(layers, &f, mark, m, err) : SF_OK;
}

static bool is_contact_point(const sf_model *m, int32_t node) {
    int64_t at = sf_list_find(m->contact_node, 0, m->contact_count, node);
    return at < m->contact_count && m->contact_node[at] == node;
}

sf_status sf_contact_take_sides(sf_model *m, sf_error *err) {
    int64_t count = 0;
    SF_OWNED int32_t *side = NULL;
    if (m->missile.shape != SF_SHAPE_SURFACE)
        return SF_OK;
    SF_TRY(sf_section_sides(&SF_CELLS_OF(m), &count, &side, err));
    m->contact_face = sf_alloc(err, 3 * (unsigned long)count, sizeof *m->contact_face, "sides in contact");
    for (int64_t k = 0; m->contact_face && k < count; k++) {
        const int32_t face[3] = {side[2 * k], side[2 * k + 1], side[2 * k]};
        if (is_contact_point(m, face[0]) && is_contact_point(m, face[1]))
            memcpy(&m->contact_face[3 * m->contact_face_count++], face, sizeof face);
    }
    return err->status;
}

/* ---- covers without cells ---- */

/* Adds the triangles of a boundary face: of a quadrangle those on both diagonals. */
static void add_face(const sf_mesh *mesh, const sf_layers *l, const sf_boundary_face *face, sf_model *m) {
    int layer = mesh->cell_layer ? mesh->cell_layer[face->cell] : 0;
    for (int k = 0; k < (face->size == 4 ? 4 : 1); k++) {
        for (int v = 0; v < 3; v++)
            m->membrane_triangle[3 * m->membrane_count + v] =
                sf_layers_copy(l, face->node[(k + v) % face->size], layer);
        m->membrane_share[m->membrane_count++] = face->size == 4 ? 0.5 : 1;
    }
}

static sf_status add_group(const sf_mesh *mesh, const sf_dual *dual, const sf_layers *l,
                           const sf_node_set *set, uint8_t *taken, sf_model *m, sf_error *err) {
    int64_t before = m->membrane_count;
    SF_OWNED uint8_t *member = sf_surface_members(mesh, set, err);
    for (int64_t f = 0; member && f < dual->face_count && err->status == SF_OK; f++) {
        const sf_boundary_face *face = &dual->face[f];
        bool inside = sf_surface_has_face(face, member);
        if (inside && taken[f]++)
            SF_REFUSE(err, "membrane.faces: a face of the group \"%s\" is in another one, too", set->name);
        else if (inside)
            add_face(mesh, l, face, m);
    }
    if (err->status == SF_OK && m->membrane_count == before)
        SF_REFUSE(err, "membrane.faces: no face of the group \"%s\" is on the surface of the pad", set->name);
    return err->status;
}

sf_status sf_membrane_take(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, const sf_layers *l,
                           sf_model *m, sf_error *err) {
    unsigned long most = 4 * (unsigned long)dual->face_count;
    if (c->membrane_count == 0)
        return SF_OK;
    SF_OWNED uint8_t *taken = sf_alloc(err, dual->face_count, 1, "membrane");
    m->membrane = c->membrane_card;
    SF_ALLOC_ALL(err, "membrane", SF_ROOM(m->membrane_triangle, 3 * most), SF_ROOM(m->membrane_share, most));
    for (int g = 0; g < c->membrane_count && err->status == SF_OK; g++) {
        const sf_node_set *set = sf_group_need(mesh, "membrane.faces", c->membrane_group[g], err);
        if (set)
            add_group(mesh, dual, l, set, taken, m, err);
    }
    return err->status;
}

void sf_membrane_weigh(sf_model *m) {
    double area = m->membrane.density * m->membrane.thickness;
    for (int64_t t = 0; t < m->membrane_count; t++) {
        const int32_t *node = &m->membrane_triangle[3 * t];
        double normal[3];
        sf_face_normal(m->position, node, normal);
        for (int k = 0; k < 3; k++)
            m->mass[node[k]] += area * m->membrane_share[t] * sqrt(sf_dot3(normal, normal)) / 6;
    }
}
