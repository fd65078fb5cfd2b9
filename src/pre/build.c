/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/build.h"

#include "base/mat3.h"
#include "base/sets.h"
#include "model/model_check.h"
#include "model/motion.h"
#include "model/stability.h"
#include "pre/cloud/axis.h"
#include "pre/cloud/cloud.h"
#include "pre/cloud/connectivity.h"
#include "pre/foam_path.h"
#include "pre/free_faces.h"
#include "pre/mesh/missile_shape.h"
#include "pre/mesh/section.h"
#include "pre/missile_body.h"
#include "pre/support.h"

static const double CLEAR =
    0.05; /* of the anvil's depth: way from the first touch to the anvil that is a drop */

/* Cloud arrays that come straight from the mesh. */
static void take_mesh(sf_mesh *mesh, sf_model *m, sf_build_report *report) {
    for (int64_t k = 0; k < mesh->cell_count; k++)
        report->cells[mesh->cell_type[k]]++;
    report->orphan_count = mesh->orphan_count;
    double low[3], high[3];
    sf_box3(mesh->node_count, mesh->position, low, high);
    m->thickness = high[2] - low[2];
    m->axisymmetric = sf_mesh_is_section(mesh);
    m->node_count = mesh->node_count;
    m->cell_count = mesh->cell_count;
    m->cell_nnz = mesh->cell_ptr[mesh->cell_count];
    m->position = mesh->position;
    m->cell_type = mesh->cell_type;
    m->cell_ptr = mesh->cell_ptr;
    m->cell_node = mesh->cell_node;
    mesh->position = NULL;
    mesh->cell_type = NULL;
    mesh->cell_ptr = NULL;
    mesh->cell_node = NULL;
    mesh->node_count = mesh->cell_count = 0;
}

/* The worst of all layers. */
static void report_domains(const sf_domain_figures *d, sf_domain_figures *worst) {
    worst->enlarged_count += d->enlarged_count;
    worst->largest_enlargement = fmax(worst->largest_enlargement, d->largest_enlargement);
    if (d->worst_condition > worst->worst_condition) {
        worst->worst_condition = d->worst_condition;
        memcpy(worst->worst_position, d->worst_position, sizeof d->worst_position);
    }
    if (d->hidden_count > 0 && (worst->hidden_count == 0 || d->hidden_distance < worst->hidden_distance)) {
        worst->hidden_distance = d->hidden_distance;
        memcpy(worst->hidden_position, d->hidden_position, sizeof d->hidden_position);
    }
    worst->hidden_count += d->hidden_count;
}

/* Puts a layer's array of `count` items behind the `used` items in *array, and releases it: the first one is
 * taken as it is. */
static void append(void *array, int64_t used, void **more, int64_t count, size_t size, sf_error *err) {
    void *old;
    memcpy(&old, array, sizeof old);
    void *all = old ? realloc(old, (size_t)(used + count) * size) : *more;
    if (!all) {
        SF_NO_MEMORY(err, "a layer of %lld items", (long long)count);
        return;
    }
    memcpy(array, &all, sizeof all);
    if (old) {
        memcpy((char *)all + (size_t)used * size, *more, (size_t)count * size);
        free(*more);
    }
    *more = NULL;
}

/* Nodes of each row. */
typedef struct list {
    int64_t **ptr;
    int32_t **node;
} list;

/* The lists `more` of a layer of `n` nodes, the first of which is number `first`: rows behind the `nnz`
 * entries of the layers before. */
static void append_list(list to, list more, int64_t *nnz, int64_t first, int64_t n, sf_error *err) {
    int64_t count = (*more.ptr)[n];
    for (int64_t k = 0; k < count; k++)
        (*more.node)[k] += (int32_t)first;
    for (int64_t k = 0; k <= n; k++)
        (*more.ptr)[k] += *nnz;
    append(to.ptr, first, (void **)more.ptr, n + 1, sizeof **to.ptr, err);
    append(to.node, *nnz, (void **)more.node, count, sizeof **to.node, err);
    *nnz += count;
}

/* The domains and edges of a layer of `n` nodes, the first of which is number `first` of the model. */
static void take_domains(sf_domains *d, sf_dual *dual, int64_t first, int64_t n, sf_model *m, sf_error *err) {
    append(&m->volume, first, (void **)&d->volume, n, sizeof *m->volume, err);
    append(&m->domain_b, m->domain_nnz, (void **)&d->b, d->ptr[n], 3 * sizeof *m->domain_b, err);
    append_list((list){&m->domain_ptr, &m->domain_node}, (list){&d->ptr, &d->node}, &m->domain_nnz, first, n,
                err);
    append(&m->phi_value, m->phi_nnz, (void **)&d->phi_value, d->phi_ptr[n], sizeof *m->phi_value, err);
    append_list((list){&m->phi_ptr, &m->phi_node}, (list){&d->phi_ptr, &d->phi_node}, &m->phi_nnz, first, n,
                err);
    append_list((list){&m->edge_ptr, &m->edge_node}, (list){&dual->edge_ptr, &dual->edge_node}, &m->edge_nnz,
                first, n, err);
}

/* A part of the surface that the missile may touch faces it; what looks away, as the far side of a tube,
 * waits. */
static sf_status check_facing(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual,
                              const sf_node_set *contact, sf_error *err) {
    static const double LEAST = 1e-3; /* of the area */
    sf_surface_sides sides;
    SF_TRY(sf_surface_find_sides(mesh, dual, contact, c->missile_card.direction, &sides, err));
    if (!(sides.facing > LEAST * sides.area))
        return SF_REFUSE(err,
                         "pad.contact: the surface group \"%s\" does not face the missile, which moves along "
                         "(%g, %g, %g): are pad.contact and pad.fixed exchanged, or is the pad upside down?",
                         contact->name, c->missile_card.direction[0], c->missile_card.direction[1],
                         c->missile_card.direction[2]);
    return SF_OK;
}

static double volume_of(const sf_mesh *mesh) {
    double sum = 0;
    for (int64_t k = 0; k < mesh->cell_count; k++)
        sum += sf_mesh_cell_volume(mesh, k);
    return sum;
}

sf_status sf_model_build_layer(const sf_case *c, const sf_model_layer *l, sf_model *m,
                               sf_build_report *report, sf_error *err) {
    SF_OWNED_BY(sf_domains_free) sf_domains domains = {0};
    const sf_mesh *mesh = l->mesh;
    sf_dual *dual = l->dual;
    int64_t n = mesh->node_count, first = l->first;
    double *spacing = m->spacing + first, *support = m->support + first;
    sf_cloud_spacing(mesh, dual, spacing);
    for (int64_t i = 0; i < n; i++)
        support[i] = c->support_ratio * spacing[i];
    if (sf_domain_store_build(c->store, mesh, dual, c->condition_limit, support, &domains, err) == SF_OK &&
        sf_invariants_measure(mesh, dual, &domains, spacing, volume_of(mesh), &report->invariants, err) ==
            SF_OK &&
        sf_invariants_check(&report->invariants, err) == SF_OK &&
        sf_cloud_masses(mesh, dual, &domains, sf_material_density(l->material), m->mass + first, err) ==
            SF_OK) {
        if (c->layer_count > 1)
            domains.figures.hidden_count = 0; /* report_gaps */
        report_domains(&domains.figures, &report->domains);
        take_domains(&domains, dual, first, n, m, err);
    }
    return err->status;
}

/* Nodes of a layer do not see each other through another one, which is no gap: of layers the gaps are those
 * of the whole mesh, with the larger support of each place. */
static sf_status report_gaps(const sf_mesh *mesh, const sf_dual *dual, const sf_layers *layers, sf_model *m,
                             sf_build_report *report, sf_error *err) {
    sf_domains gaps;
    SF_OWNED double *support = sf_alloc(err, mesh->node_count, sizeof *support, "supports");
    for (int64_t i = 0; support && i < layers->first[layers->count]; i++)
        support[layers->origin[i]] = fmax(support[layers->origin[i]], m->support[i]);
    if (support && sf_domains_find_gaps(mesh, dual, support, &gaps, err) == SF_OK)
        report_domains(&gaps.figures, &report->domains);
    m->slit_fraction = (double)report->domains.hidden_count / (double)mesh->node_count;
    return err->status;
}

/* Each layer as a mesh of its own. */
static sf_status build_layers(const sf_case *c, const sf_mesh *mesh, const sf_layers *layers, sf_model *m,
                              sf_build_report *report, sf_error *err) {
    for (int k = 0; k < layers->count && err->status == SF_OK; k++) {
        sf_mesh part;
        sf_dual dual = {0};
        if (sf_layers_part(mesh, layers, k, &part, err) == SF_OK &&
            sf_dual_build(&part, &dual, err) == SF_OK &&
            sf_model_build_layer(c, &(sf_model_layer){&part, &dual, &c->layer[k], layers->first[k]}, m,
                                 report, err) == SF_OK)
            memset(m->node_material + layers->first[k], k, (size_t)(layers->first[k + 1] - layers->first[k]));
        sf_dual_free(&dual);
        sf_mesh_free(&part);
    }
    return err->status;
}

static sf_status build_contact(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual,
                               const sf_layers *layers, double *area, sf_error *err) {
    const sf_node_set *contact = sf_mesh_find_set(mesh, c->contact_group);
    if (contact && sf_layers_area(mesh, dual, layers, contact, area, err) == SF_OK)
        check_facing(c, mesh, dual, contact, err);
    return err->status;
}

/* Arrays over the nodes. */
static sf_status alloc_cloud(sf_model *m, int64_t count, double **contact_area, sf_error *err) {
    m->spacing = sf_alloc(err, count, sizeof *m->spacing, "spacing");
    m->support = sf_alloc(err, count, sizeof *m->support, "supports");
    m->mass = sf_alloc(err, count, sizeof *m->mass, "masses");
    m->node_material = sf_alloc(err, count, 1, "materials of the nodes");
    *contact_area = sf_alloc(err, count, sizeof **contact_area, "areas");
    return err->status;
}

/* Spacing, supports, domains, masses, and contact_area [node_count], m2. The mesh is whole for the checks,
 * then parted, and ends in the model. */
static sf_status build_cloud(const sf_case *c, sf_mesh *mesh, sf_model *m, sf_layers *layers,
                             double **contact_area, sf_build_report *report, sf_error *err) {
    SF_OWNED_BY(sf_dual_free) sf_dual dual = {0};
    SF_TRY(sf_mesh_check(mesh, &report->mesh_volume, err));
    SF_TRY(sf_cloud_reorder(mesh, err));
    SF_TRY(sf_dual_build(mesh, &dual, err));
    SF_TRY(sf_group_check(c, mesh, &dual, err));
    SF_TRY(sf_connectivity_check(mesh, &dual, c->separate, err));
    SF_TRY(sf_layers_build(c, mesh, &dual, layers, err));
    report->interfaces = layers->interfaces;
    sf_cloud_hash(mesh, report->mesh_hash);
    SF_TRY(alloc_cloud(m, layers->first[layers->count], contact_area, err));
    SF_TRY(build_contact(c, mesh, &dual, layers, *contact_area, err));
    SF_TRY(sf_membrane_take(c, mesh, &dual, layers, m, err));
    if (layers->count > 1) {
        SF_TRY(build_layers(c, mesh, layers, m, report, err));
        SF_TRY(report_gaps(mesh, &dual, layers, m, report, err));
        SF_TRY(sf_layers_split(mesh, &dual, layers, err));
    } else {
        const sf_model_layer whole = {mesh, &dual, c->layer ? c->layer : &c->material, 0};
        SF_TRY(sf_model_build_layer(c, &whole, m, report, err));
        m->slit_fraction = (double)report->domains.hidden_count / (double)mesh->node_count;
    }
    take_mesh(mesh, m, report);
    sf_membrane_weigh(m);
    return SF_OK;
}

static sf_status mark_symmetry(const sf_case *c, const sf_mesh *mesh, sf_model *m, uint8_t *mask,
                               sf_error *err) {
    m->symmetry_factor = 1;
    int seen = 0;
    for (int64_t i = 0; m->axisymmetric && i < m->node_count; i++)
        mask[i] = (uint8_t)(m->position[3 * i] > 0 ? 0 : SF_FIX_X); /* the axis */
    if (m->axisymmetric)
        return SF_OK;
    for (int g = 0; g < c->symmetry_count; g++) {
        if (!c->symmetry_given && !sf_mesh_find_set(mesh, c->symmetry_group[g]))
            continue;
        const sf_node_set *set = sf_group_need(mesh, "pad.symmetry", c->symmetry_group[g], err);
        SF_TRY(err->status);
        int axis = sf_group_plane_axis(m, set);
        if (axis != 0 && axis != 1)
            return SF_REFUSE(err, "the symmetry group \"%s\" is not a plane normal to x or y", set->name);
        if (fabs(c->missile_card.direction[axis]) > 1e-12)
            return SF_REFUSE(err,
                             "missile.direction has the component %g normal to the symmetry plane \"%s\": an "
                             "oblique impact needs a model without that plane",
                             c->missile_card.direction[axis], set->name);
        if (seen & (1 << axis))
            return SF_REFUSE(err, "the symmetry group \"%s\" is a second plane normal to %c", set->name,
                             'x' + axis);
        seen |= 1 << axis;
        m->symmetry_factor *= 2;
        for (int64_t k = 0; k < set->count; k++)
            mask[set->node[k]] |= (uint8_t)(1 << axis);
    }
    return SF_OK;
}

/* The points of the contact set: [*count] ascending nodes, owned by the caller. `area` [node_count] of the
 * nodes becomes that of the points. */
static int32_t *gather_contact(const sf_layers *layers, const sf_model *m, const sf_node_set *set,
                               double *area, int64_t *count, sf_error *err) {
    SF_OWNED int32_t *point = sf_alloc(err, set->count, sizeof *point, "contact points");
    for (int64_t k = 0; point && k < set->count; k++) {
        int32_t node = set->node[k];
        point[k] = sf_layers_heaviest(layers, m, node);
        area[point[k]] += point[k] == node ? 0 : area[node];
    }
    return point ? sf_list_number(m->node_count, set->count, point, count, "contact points", err) : NULL;
}

/* Likewise of the resting nodes, 1 in `rest`. */
static sf_status gather_rest(const sf_layers *layers, const sf_model *m, uint8_t *rest, sf_error *err) {
    SF_OWNED uint8_t *point = sf_alloc(err, m->node_count, 1, "resting nodes");
    for (int32_t i = 0; point && i < (int32_t)m->node_count; i++)
        if (rest[i])
            point[sf_layers_heaviest(layers, m, i)] = 1;
    if (point)
        memcpy(rest, point, (size_t)m->node_count);
    return err->status;
}

/* Groups to constrained nodes (with their components) and contact points. */
static sf_status build_sets(const sf_case *c, const sf_mesh *mesh, const sf_layers *layers,
                            double *contact_area, sf_model *m, sf_build_report *report, sf_error *err) {
    SF_OWNED uint8_t *mask = sf_alloc(err, m->node_count, 1, "constraints");
    SF_OWNED uint8_t *base = sf_alloc(err, m->node_count, 1, "constraints");
    SF_OWNED uint8_t *rest = sf_alloc(err, m->node_count, 1, "constraints");
    const sf_base_marks marks = {mask, base, rest};
    SF_OWNED int32_t *contact = NULL;
    int64_t points = 0;
    if (err->status != SF_OK || mark_symmetry(c, mesh, m, mask, err) != SF_OK)
        return err->status;
    if (sf_base_mark(c, mesh, m, &marks, err) != SF_OK || gather_rest(layers, m, rest, err) != SF_OK ||
        sf_base_rest(c, &marks, m, err) != SF_OK || sf_layers_hold(layers, mask, base, m, err) != SF_OK)
        return err->status;
    for (int64_t i = 0; i < m->node_count; i++)
        m->fixed_count += mask[i] != 0;
    const sf_node_set *set = sf_group_need(mesh, "pad.contact", c->contact_group, err);
    if (!set || !(contact = gather_contact(layers, m, set, contact_area, &points, err)))
        return err->status;
    SF_ALLOC_ALL(err, "contact points", SF_ROOM(m->contact_node, points), SF_ROOM(m->contact_area, points));
    SF_TRY(SF_ALLOC_ALL(err, "constraints", SF_ROOM(m->fixed_node, m->fixed_count),
                        SF_ROOM(m->fixed_mask, m->fixed_count), SF_ROOM(m->fixed_base, m->fixed_count)));
    /* A node that is held altogether cannot give way to the missile: it is no contact point. */
    for (int64_t k = 0; k < points; k++)
        if (mask[contact[k]] != (SF_FIX_X | SF_FIX_Y | SF_FIX_Z))
            m->contact_node[m->contact_count++] = contact[k];
    int64_t free_along = 0; /* can be pressed */
    for (int64_t k = 0; k < points; k++)
        free_along += !(mask[contact[k]] & SF_FIX_Z);
    report->contact_held = free_along == 0;
    if (report->contact_held) {
        memcpy(m->contact_node, contact, (size_t)points * sizeof *contact);
        m->contact_count = points;
    }
    for (int64_t k = 0; k < m->contact_count; k++)
        m->contact_area[k] = contact_area[m->contact_node[k]];
    int64_t used = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        if (!mask[i])
            continue;
        m->fixed_node[used] = (int32_t)i;
        m->fixed_mask[used] = mask[i];
        m->fixed_base[used++] = base[i];
    }
    return err->status;
}

/* A half or quarter of a missile would be held by its planes. */
static sf_status check_freedom(const sf_case *c, const sf_model *m, sf_error *err) {
    if (c->freedom == SF_MISSILE_GUIDED || m->symmetry_factor == 1)
        return SF_OK;
    return SF_REFUSE(err,
                     "missile.freedom: a free missile needs the whole pad and the whole missile; this model "
                     "is 1/%lld of them",
                     (long long)m->symmetry_factor);
}

static double across(const double direction[3], const double a[3], const double b[3]) {
    double r[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, along = sf_dot3(r, direction);
    return sqrt(fmax(sf_dot3(r, r) - along * along, 0));
}

/* Why the missile meets no contact node, `miss`: is it over them, but passes between them? */
static sf_status tell_miss(const sf_model *m, const sf_surface *surface, const sf_error *miss,
                           sf_error *err) {
    const double *d = m->missile.direction, *low = surface->position;
    double width = 0, nearest = INFINITY, spacing = 0;
    for (int64_t k = 1; k < surface->node_count; k++)
        low = sf_dot3(&surface->position[3 * k], d) > sf_dot3(low, d) ? &surface->position[3 * k] : low;
    for (int64_t k = 0; k < surface->node_count; k++)
        width = fmax(width, across(d, low, &surface->position[3 * k]));
    for (int64_t k = 0; k < m->contact_count; k++) {
        int64_t i = m->contact_node[k];
        double distance = across(d, low, &m->position[3 * i]);
        spacing = distance < nearest ? m->spacing[i] : spacing;
        nearest = fmin(nearest, distance);
    }
    if (miss->status == SF_ERR_MODEL && width < 2 * spacing && nearest < 2 * spacing)
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the missile is too narrow for the mesh: no part of it is farther than %.3g mm from "
                       "its lowest point, across its direction, and it passes between the contact nodes, "
                       "which are %.3g mm apart there: take a finer mesh",
                       1e3 * width, 1e3 * spacing);
    return SF_FAIL(err, miss->status, "%s", miss->text);
}

/* The missile's way, along its direction, to where it starts with gap 0: to the first touch of a contact
 * node, `touch`. Where it meets the anvil before, or at once after that, through a hole, it starts at the
 * height of the pad's top: a start on the anvil would be a run without a curve. */
static double way_to_start(const sf_model *m, const sf_surface *surface, double touch) {
    double lowest[3], down = -m->missile.direction[2], fall = m->anvil.depth / down;
    sf_impact_lowest(surface, &m->missile, lowest);
    double to_top = (lowest[2] - sf_impact_top(m)) / down;
    bool through = m->anvil.depth > 0 && touch > to_top + (1 - CLEAR) * fall;
    return through ? to_top : touch;
}

/* Places the missile `gap` away from there and moves its surface into the model. */
static sf_status build_missile(const sf_case *c, sf_surface *surface, sf_missile_body *body, sf_model *m,
                               sf_error *err) {
    double distance = 0, impact[3];
    sf_error miss = SF_ERROR_INIT;
    m->missile = c->missile_card;
    bool profile = m->axisymmetric && surface->triangle_count == 0;
    if (check_freedom(c, m, err) != SF_OK || (profile && sf_section_take_missile(surface, err) != SF_OK) ||
        sf_surface_orient(surface, m->missile.direction, err) != SF_OK ||
        sf_missile_set_shape(surface, c->shape_rule, &m->missile, err) != SF_OK ||
        (m->axisymmetric && !profile && sf_section_take_missile(surface, err) != SF_OK) ||
        sf_impact_place(c, m, surface, &m->missile, err) != SF_OK ||
        sf_missile_take_body(c, surface, m, body, err) != SF_OK)
        return err->status;
    if (sf_missile_distance(surface, &m->missile, m->position, m->contact_count, m->contact_node, &distance,
                            &miss) != SF_OK)
        return tell_miss(m, surface, &miss, err);
    double travel = way_to_start(m, surface, distance) - m->missile.gap;
    for (int64_t k = 0; k < 3 * surface->node_count; k++)
        surface->position[k] += travel * m->missile.direction[k % 3];
    for (int k = 0; k < 3; k++) {
        m->missile.sphere_centre[k] += travel * m->missile.direction[k];
        body->solid.centroid[k] += travel * m->missile.direction[k];
        if (sf_missile_turns(m))
            m->missile.centre[k] += travel * m->missile.direction[k];
    }
    m->surface_node_count = surface->node_count;
    m->surface_triangle_count = surface->triangle_count;
    m->surface_position = surface->position;
    m->surface_triangle = surface->triangle;
    surface->position = NULL;
    surface->triangle = NULL;
    sf_surface_free(surface);
    const sf_surface placed = sf_surface_of_missile(m);
    sf_impact_lowest(&placed, &m->missile, impact);
    m->missile.clearance = impact[2] - sf_impact_top(m); /* of its lowest point above the pad */
    m->missile.impact_known = 1;
    sf_impact_point(m, impact);
    for (int k = 0; k < 2; k++) /* below a nanometre it is rounding */
        m->missile.impact[k] = fabs(impact[k]) < 1e-9 ? 0 : impact[k];
    return SF_OK;
}

/* The anvil first: the missile may meet it before the pad. */
static sf_status place(const sf_case *c, sf_build_report *report, sf_surface *surface, sf_model *m,
                       sf_error *err) {
    sf_base_place_anvil(c, &report->hold, m);
    SF_TRY(build_missile(c, surface, &report->body, m, err));
    SF_TRY(sf_support_find_travel(m, err));
    if (m->axisymmetric) /* a plate */
        return SF_OK;
    return sf_foam_path_measure(m, &report->between, err);
}

/* A prescribed motion stays above the plane of the pad's underside: where the anvil is there, it would end
 * the run (solver/run/run.h). */
static sf_status check_depth(const sf_model *m, sf_error *err) {
    double depth = sf_missile_card_depth(&m->missile, sf_motion_measure(m).displacement);
    const sf_material *foam = &m->material[0];
    double limit =
        m->material_count == 1 && foam->law->limit_strain ? foam->law->limit_strain(foam->card) : 1;
    if (!sf_missile_is_driven(m) ||
        depth < m->thickness * (1 - 1e-9) * limit) /* a difference of coordinates */
        return SF_OK;
    if (depth < m->thickness * (1 - 1e-9))
        return SF_REFUSE(err,
                         "missile.motion compresses the pad by %.4g mm of %.4g mm, a strain of %.4g: its "
                         "foam cannot be compressed beyond %.4g, the limit of its densification",
                         1e3 * depth, 1e3 * m->thickness, depth / m->thickness, limit);
    return SF_REFUSE(err, "missile.motion presses the missile %.6g mm deep into a pad that is %.6g mm thick",
                     1e3 * depth, 1e3 * m->thickness);
}

static sf_status take_series(const sf_case *c, sf_model *m, sf_error *err) {
    unsigned long count = c->drops > 1 ? (unsigned long)c->drops : 0;
    if (count == 0)
        return SF_OK;
    SF_ALLOC_ALL(err, "series", SF_ROOM(m->series_interval, count), SF_ROOM(m->series_model, count));
    for (unsigned long k = 0; k < count && err->status == SF_OK; k++)
        m->series_interval[k] = c->drop[k].interval;
    m->series_count = (int64_t)count;
    return err->status;
}

static sf_status take_cards(sf_case *c, sf_model *m, sf_error *err) {
    m->frame_time = sf_alloc(err, c->frame_time_count, sizeof *m->frame_time, "frame times");
    SF_TRY(err->status);
    m->frame_time_count = c->frame_time_count;
    memcpy(m->frame_time, c->frame_time, (size_t)c->frame_time_count * sizeof *m->frame_time);
    SF_TRY(
        sf_model_take_materials(m, c->layer ? c->layer : &c->material, c->layer ? c->layer_count : 1, err));
    m->motion_count = c->motion_count;
    m->motion_time = c->motion_time;
    m->motion_displacement = c->motion_displacement;
    c->motion_time = c->motion_displacement = NULL;
    c->motion_count = 0;
    SF_TRY(take_series(c, m, err));
    m->run = c->run;
    m->run.kinematic = c->kinematic;
    if (m->skin_count > 0 && !m->skin_alone && !c->stabilised)
        m->run.stabilisation = SF_FOLD_STABILISATION;
    return check_depth(m, err);
}

/* `critical`: the node with the shortest step. */
static sf_status measure_step(const sf_model *m, int64_t *critical, sf_build_report *report, sf_error *err) {
    double load;
    SF_TRY(sf_stability_first_step(m, &report->first_step, critical, &report->slowdown, err));
    SF_TRY(sf_stability_membrane(m, &load, err));
    report->first_step = sf_stability_with_membrane(load, report->first_step);
    return SF_OK;
}

/* A run that would stop at its first step, of the node `critical`. */
static sf_status check_first_step(const sf_model *m, double first, int64_t critical, sf_error *err) {
    const sf_material *material = sf_model_material(m, critical);
    double step = m->run.step_safety * first, least = SF_SMALLEST_STEP * m->run.end_time;
    if (step >= least)
        return SF_OK;
    return SF_REFUSE(err,
                     "the first stable time step is %.3g s, below %g of solver.end_time (%g s), where a run "
                     "stops: the foam is too stiff or too viscous (%s%s: %s, ED, eta, DAMP), or too light",
                     step, SF_SMALLEST_STEP, m->run.end_time, material->name[0] ? "materials." : "material",
                     material->name, material->law->stiffness_keys);
}

/* Faces of a slit that touch each other do not pass through each other. */
static sf_status find_skin(const sf_case *c, sf_model *m, sf_build_report *report, sf_error *err) {
    if (m->axisymmetric) { /* the faces of a plate meet no other ones */
        report->unheld[0] = NAN;
        return SF_OK;
    }
    SF_TRY(sf_skin_find(c, m, report->unheld, err));
    if (m->skin_count > 0 && !m->skin_alone)
        m->slit_fraction = 0;
    else if (m->support_triangle_count == 0)
        m->air = 0; /* nothing closes */
    return SF_OK;
}

/* Faces of a pad without contact with itself pass through each other; and a key may have no effect. */
static void tell_contact(const sf_case *c, const sf_model *m, const sf_build_report *r, const sf_sink *sink) {
    if (c->triangle_centroids && sf_model_skin_centroids(m) == 0)
        sf_sink_tell(sink, SF_WARNING,
                     "pad.triangle_centroids has no effect: no triangles of the pad may touch each other");
    if (r->domains.hidden_count > 0 && (m->skin_count == 0 || m->skin_alone))
        sf_sink_tell(sink, SF_WARNING,
                     "the pad has a slit, hole or gap narrower than the supports: nodes %.3g mm apart at "
                     "(%.4g, %.4g, %.4g) mm do not act on each other; its faces pass through each other "
                     "where they meet",
                     1e3 * r->domains.hidden_distance, 1e3 * r->domains.hidden_position[0],
                     1e3 * r->domains.hidden_position[1], 1e3 * r->domains.hidden_position[2]);
    if (!isnan(r->unheld[0]))
        sf_sink_tell(sink, SF_WARNING,
                     "pad.self_contact is \"off\", and the face at (%.4g, %.4g, %.4g) mm has another face of "
                     "the pad, or the anvil, before it: it passes through where they meet",
                     1e3 * r->unheld[0], 1e3 * r->unheld[1], 1e3 * r->unheld[2]);
}

/* After the checks that say more of the missile: a sheet on its edge, for one. */
static sf_status check_between(const sf_build_report *report, sf_error *err) {
    const sf_error *between = &report->between;
    return between->status == SF_OK ? SF_OK : SF_FAIL(err, between->status, "%s", between->text);
}

sf_status sf_model_build(sf_case *c, sf_mesh *mesh, sf_surface *surface, sf_model *m, sf_build_report *report,
                         const sf_sink *sink, sf_error *err) {
    memset(m, 0, sizeof *m);
    memset(report, 0, sizeof *report);
    SF_OWNED double *contact_area = NULL;
    sf_layers layers = {0};
    int64_t critical = 0;
    if (build_cloud(c, mesh, m, &layers, &contact_area, report, err) == SF_OK &&
        build_sets(c, mesh, &layers, contact_area, m, report, err) == SF_OK &&
        (!m->axisymmetric || sf_axis_project(m, err) == SF_OK) &&
        sf_hold_find(m, &report->hold, err) == SF_OK && (sf_layers_loosen(c, m), true) &&
        sf_support_take(c, mesh, m, err) == SF_OK && place(c, report, surface, m, err) == SF_OK &&
        find_skin(c, m, report, err) == SF_OK && take_cards(c, m, err) == SF_OK) {
        if (!report->contact_held) {
            sf_contact_zone_measure(m, &report->zone);
            m->expected_mesh_error = sf_mesh_error_expect(m, &report->zone);
        }
        if (sf_drop_check(c, mesh, m, err) == SF_OK && check_between(report, err) == SF_OK &&
            (report->contact_held ||
             (m->axisymmetric ? sf_contact_take_sides(m, err)
                              : sf_contact_add_free(&layers, m, &report->zone, err)) == SF_OK) &&
            sf_drop_check_contact(c, m, &report->zone, err) == SF_OK && sf_model_check(m, err) == SF_OK &&
            measure_step(m, &critical, report, err) == SF_OK &&
            check_first_step(m, report->first_step, critical, err) == SF_OK) {
            sf_drop_warn(c, mesh, m, &report->zone, report->body.solid.volume, sink);
            sf_hold_warn(&report->hold, m, sink);
            tell_contact(c, m, report, sink);
            if (c->separate)
                sf_hold_warn_apart(m, sink, err);
        }
    }
    sf_layers_free(&layers);
    if (err->status != SF_OK)
        sf_model_free(m);
    return err->status;
}
