/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/build.h"

#include "core/motion.h"
#include "core/stability.h"
#include "solver/material/law.h"
#include "pre/cloud/cloud.h"
#include "pre/cloud/connectivity.h"
#include "pre/cloud/domains.h"
#include "pre/drop_check.h"
#include "pre/cloud/dual.h"
#include "pre/cloud/group_check.h"
#include "pre/cloud/surface_area.h"
#include "pre/mesh/missile_shape.h"
#include "pre/mesh/surface_orient.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Cloud arrays that come straight from the mesh. */
static void take_mesh(sf_mesh *mesh, sf_model *m, sf_build_report *report) {
    for (int64_t k = 0; k < mesh->cell_count; k++)
        report->cells[mesh->cell_type[k]]++;
    report->orphan_count = mesh->orphan_count;
    double low = INFINITY, high = -INFINITY;
    for (int64_t i = 0; i < mesh->node_count; i++) {
        low = fmin(low, mesh->position[3 * i + 2]);
        high = fmax(high, mesh->position[3 * i + 2]);
    }
    m->thickness = high - low;
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

static void take_domains(sf_domains *d, sf_dual *dual, sf_model *m, sf_build_report *report) {
    report->enlarged_count = d->enlarged_count;
    report->largest_enlargement = d->largest_enlargement;
    report->worst_condition = d->worst_condition;
    memcpy(report->worst_position, d->worst_position, sizeof d->worst_position);
    report->hidden_count = d->hidden_count;
    m->slit_fraction = (double)d->hidden_count / (double)m->node_count;
    report->hidden_distance = d->hidden_distance;
    memcpy(report->hidden_position, d->hidden_position, sizeof d->hidden_position);
    m->volume = d->volume;
    m->domain_nnz = d->ptr[m->node_count];
    m->domain_ptr = d->ptr;
    m->domain_node = d->node;
    m->domain_b = d->b;
    m->phi_nnz = d->phi_ptr[m->node_count];
    m->phi_ptr = d->phi_ptr;
    m->phi_node = d->phi_node;
    m->phi_value = d->phi_value;
    m->edge_nnz = 2 * dual->edge_count;
    m->edge_ptr = dual->edge_ptr;
    m->edge_node = dual->edge_node;
    memset(d, 0, sizeof *d);
    dual->edge_ptr = NULL;
    dual->edge_node = NULL;
}

/* The surface that the missile may touch is the pad's upper side, and only that. */
static sf_status check_facing(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual,
                              const sf_node_set *contact, sf_error *err) {
    static const double LEAST = 1e-3, MOST_AWAY = 1e-2; /* of the area */
    sf_surface_sides sides;
    if (sf_surface_look(mesh, dual, contact, c->missile_card.direction, &sides, err) != SF_OK)
        return err->status;
    if (!(sides.facing > LEAST * sides.area))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "pad.contact: the surface group \"%s\" does not face the missile, which moves along (%g, "
            "%g, %g): are pad.contact and pad.fixed exchanged, or is the pad upside down?",
            contact->name, c->missile_card.direction[0], c->missile_card.direction[1],
            c->missile_card.direction[2]);
    if (sides.away > MOST_AWAY * sides.area)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "pad.contact: %.3g %% of the surface group \"%s\" face away from the missile: it may hold "
            "the pad's upper side only",
            100 * sides.away / sides.area, contact->name);
    return SF_OK;
}

/* Spacing, supports, domains, masses, and contact_area [node_count], m2; the mesh is whole until take_mesh.
 */
static sf_status build_cloud(const sf_case *c, sf_mesh *mesh, sf_model *m, double **contact_area,
                             sf_build_report *report, sf_error *err) {
    sf_dual dual = {0};
    sf_domains domains = {0};
    int64_t n = mesh->node_count;
    if (sf_mesh_check(mesh, &report->mesh_volume, err) != SF_OK || sf_cloud_reorder(mesh, err) != SF_OK ||
        sf_dual_build(mesh, &dual, err) != SF_OK || sf_group_check(c, mesh, &dual, err) != SF_OK ||
        sf_connectivity_check(mesh, &dual, err) != SF_OK)
        goto done;
    sf_cloud_hash(mesh, report->mesh_hash);
    m->spacing = sf_alloc(err, (unsigned long)n, sizeof *m->spacing, "spacing");
    m->support = sf_alloc(err, (unsigned long)n, sizeof *m->support, "supports");
    m->mass = sf_alloc(err, (unsigned long)n, sizeof *m->mass, "masses");
    *contact_area = sf_alloc(err, (unsigned long)n, sizeof **contact_area, "areas");
    if (err->status != SF_OK)
        goto done;
    sf_cloud_spacing(mesh, &dual, m->spacing);
    const sf_node_set *contact = sf_mesh_find_set(mesh, c->contact_group);
    if (contact && (sf_surface_area(mesh, &dual, contact, *contact_area, err) != SF_OK ||
                    check_facing(c, mesh, &dual, contact, err) != SF_OK))
        goto done;
    for (int64_t i = 0; i < n; i++)
        m->support[i] = c->support_ratio * m->spacing[i];
    if (sf_domains_build(mesh, &dual, c->condition_limit, m->support, &domains, err) != SF_OK ||
        sf_invariants_measure(mesh, &dual, &domains, m->spacing, report->mesh_volume, &report->invariants,
                              err) != SF_OK ||
        sf_invariants_check(&report->invariants, err) != SF_OK)
        goto done;
    for (int64_t i = 0; i < n; i++)
        m->mass[i] = sf_material_density(&c->material) * domains.volume[i];
    take_mesh(mesh, m, report);
    take_domains(&domains, &dual, m, report);
done:
    sf_domains_free(&domains);
    sf_dual_free(&dual);
    return err->status;
}

/* A set that the case names under `key`; the sentence lists the groups that exist. */
static const sf_node_set *need_set(const sf_mesh *mesh, const char *key, const char *name, sf_error *err) {
    const sf_node_set *set = sf_mesh_find_set(mesh, name);
    if (set)
        return set;
    char known[512] = "";
    size_t used = 0;
    for (int k = 0; k < mesh->set_count && used < sizeof known; k++)
        used +=
            (size_t)snprintf(known + used, sizeof known - used, "%s\"%s\"", k ? ", " : "", mesh->set[k].name);
    SF_FAIL(err, SF_ERR_INPUT, "%s names the surface group \"%s\", which the pad does not have; it has %s",
            key, name, mesh->set_count ? known : "none");
    return NULL;
}

/* The axis (0 x, 1 y, 2 z) that a planar set is normal to, or -1. */
static int plane_axis(const sf_model *m, const sf_node_set *set) {
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t k = 0; k < set->count; k++) {
            low = fmin(low, m->position[3 * (int64_t)set->node[k] + axis]);
            high = fmax(high, m->position[3 * (int64_t)set->node[k] + axis]);
        }
        if (high - low <= 1e-9 * m->thickness)
            return axis;
    }
    return -1;
}

static sf_status mark_symmetry(const sf_case *c, const sf_mesh *mesh, sf_model *m, uint8_t *mask,
                               sf_error *err) {
    m->symmetry_factor = 1;
    int seen = 0;
    for (int g = 0; g < c->symmetry_count; g++) {
        if (!c->symmetry_given && !sf_mesh_find_set(mesh, c->symmetry_group[g]))
            continue;
        const sf_node_set *set = need_set(mesh, "pad.symmetry", c->symmetry_group[g], err);
        if (!set)
            return err->status;
        int axis = plane_axis(m, set);
        if (axis != 0 && axis != 1)
            return SF_FAIL(err, SF_ERR_INPUT, "the symmetry group \"%s\" is not a plane normal to x or y",
                           set->name);
        if (fabs(c->missile_card.direction[axis]) > 1e-12)
            return SF_FAIL(err, SF_ERR_INPUT,
                           "missile.direction has the component %g normal to the symmetry plane \"%s\": an "
                           "oblique impact needs a model without that plane",
                           c->missile_card.direction[axis], set->name);
        if (seen & (1 << axis))
            return SF_FAIL(err, SF_ERR_INPUT, "the symmetry group \"%s\" is a second plane normal to %c",
                           set->name, 'x' + axis);
        seen |= 1 << axis;
        m->symmetry_factor *= 2;
        for (int64_t k = 0; k < set->count; k++)
            mask[set->node[k]] |= (uint8_t)(1 << axis);
    }
    return SF_OK;
}

/* Surfaces on a smooth anvil: held along their normal. */
static sf_status mark_sliding(const sf_case *c, const sf_mesh *mesh, const sf_model *m, uint8_t *mask,
                              uint8_t *base, sf_error *err) {
    for (int g = 0; g < c->sliding_count; g++) {
        const sf_node_set *set = need_set(mesh, "pad.sliding", c->sliding_group[g], err);
        if (!set)
            return err->status;
        int axis = plane_axis(m, set);
        if (axis < 0)
            return SF_FAIL(err, SF_ERR_INPUT, "the sliding group \"%s\" is not a plane normal to x, y or z",
                           set->name);
        for (int64_t k = 0; k < set->count; k++) {
            mask[set->node[k]] |= (uint8_t)(1 << axis);
            base[set->node[k]] = 1;
        }
    }
    return SF_OK;
}

/* Groups to constrained nodes (with their components) and contact points. */
static sf_status build_sets(const sf_case *c, const sf_mesh *mesh, const double *contact_area, sf_model *m,
                            sf_build_report *report, sf_error *err) {
    uint8_t *mask = sf_alloc(err, (unsigned long)m->node_count, 1, "constraints");
    uint8_t *base = sf_alloc(err, (unsigned long)m->node_count, 1, "constraints");
    if (err->status != SF_OK || mark_symmetry(c, mesh, m, mask, err) != SF_OK)
        goto done;
    for (int g = 0; g < c->fixed_count; g++) {
        const sf_node_set *set = need_set(mesh, "pad.fixed", c->fixed_group[g], err);
        if (!set)
            goto done;
        for (int64_t k = 0; k < set->count; k++) {
            mask[set->node[k]] = SF_FIX_X | SF_FIX_Y | SF_FIX_Z;
            base[set->node[k]] = 1;
        }
    }
    if (mark_sliding(c, mesh, m, mask, base, err) != SF_OK)
        goto done;
    for (int64_t i = 0; i < m->node_count; i++)
        m->fixed_count += mask[i] != 0;
    const sf_node_set *contact = need_set(mesh, "pad.contact", c->contact_group, err);
    if (!contact)
        goto done;
    m->contact_node = sf_alloc(err, (unsigned long)contact->count, sizeof *m->contact_node, "contact points");
    m->contact_area = sf_alloc(err, (unsigned long)contact->count, sizeof *m->contact_area, "contact points");
    m->fixed_node = sf_alloc(err, (unsigned long)m->fixed_count, sizeof *m->fixed_node, "constraints");
    m->fixed_mask = sf_alloc(err, (unsigned long)m->fixed_count, 1, "constraints");
    m->fixed_base = sf_alloc(err, (unsigned long)m->fixed_count, 1, "constraints");
    if (err->status != SF_OK)
        goto done;
    /* A node that is held altogether cannot give way to the missile: it is no contact point. */
    for (int64_t k = 0; k < contact->count; k++)
        if (mask[contact->node[k]] != (SF_FIX_X | SF_FIX_Y | SF_FIX_Z))
            m->contact_node[m->contact_count++] = contact->node[k];
    int64_t free_along = 0; /* can be pressed */
    for (int64_t k = 0; k < contact->count; k++)
        free_along += !(mask[contact->node[k]] & SF_FIX_Z);
    report->contact_held = free_along == 0;
    if (report->contact_held) {
        memcpy(m->contact_node, contact->node, (size_t)contact->count * sizeof *contact->node);
        m->contact_count = contact->count;
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
done:
    free(mask);
    free(base);
    return err->status;
}

/* Height (m) of the missile's lowest point above the pad's highest. */
static double find_clearance(const sf_model *m) {
    const sf_missile_card *card = &m->missile;
    double low = INFINITY, high = -INFINITY;
    for (int64_t k = 0; k < m->surface_node_count; k++)
        low = fmin(low, m->surface_position[3 * k + 2]);
    if (card->shape == SF_SHAPE_SPHERE && -card->direction[2] >= card->sphere_cap_cosine)
        low = card->sphere_centre[2] - card->sphere_radius; /* where no node of the surface may be */
    for (int64_t i = 0; i < m->node_count; i++)
        high = fmax(high, m->position[3 * i + 2]);
    return low - high;
}

/* Places the missile `gap` away from first contact and moves its surface into the model. */
static sf_status build_missile(const sf_case *c, sf_surface *surface, sf_model *m, sf_error *err) {
    double distance = 0;
    m->missile = c->missile_card;
    if (sf_surface_orient(surface, m->missile.direction, err) != SF_OK ||
        sf_missile_set_shape(surface, c->shape_rule, &m->missile, err) != SF_OK ||
        sf_missile_distance(surface, &m->missile, m->position, m->contact_count, m->contact_node, &distance,
                            err) != SF_OK)
        return err->status;
    double travel = distance - m->missile.gap;
    for (int64_t k = 0; k < 3 * surface->node_count; k++)
        surface->position[k] += travel * m->missile.direction[k % 3];
    for (int k = 0; k < 3; k++)
        m->missile.sphere_centre[k] += travel * m->missile.direction[k];
    m->surface_node_count = surface->node_count;
    m->surface_triangle_count = surface->triangle_count;
    m->surface_position = surface->position;
    m->surface_triangle = surface->triangle;
    surface->position = NULL;
    surface->triangle = NULL;
    sf_surface_free(surface);
    m->missile.clearance = find_clearance(m);
    return SF_OK;
}

/* A driven missile does not stop at the anvil. */
static sf_status check_depth(const sf_model *m, sf_error *err) {
    double depth = sf_missile_card_depth(&m->missile, sf_motion_measure(m).displacement);
    if (depth < m->thickness * (1 - 1e-9)) /* the clearance is a difference of coordinates */
        return SF_OK;
    return SF_FAIL(err, SF_ERR_INPUT,
                   "missile.motion presses the missile %.6g mm deep into a pad that is %.6g mm thick",
                   1e3 * depth, 1e3 * m->thickness);
}

static sf_status take_cards(sf_case *c, sf_model *m, sf_error *err) {
    m->frame_time = sf_alloc(err, (unsigned long)c->frame_time_count, sizeof *m->frame_time, "frame times");
    if (!m->frame_time)
        return err->status;
    m->frame_time_count = c->frame_time_count;
    memcpy(m->frame_time, c->frame_time, (size_t)c->frame_time_count * sizeof *m->frame_time);
    if (sf_model_take_material(m, &c->material, err) != SF_OK)
        return err->status;
    m->motion_count = c->motion_count;
    m->motion_time = c->motion_time;
    m->motion_displacement = c->motion_displacement;
    c->motion_time = c->motion_displacement = NULL;
    c->motion_count = 0;
    m->run = c->run;
    m->run.kinematic = c->kinematic;
    return check_depth(m, err);
}

/* The bound on the step at rest. */
static sf_status first_step(const sf_model *m, double *step, int64_t *critical, double *constant,
                            sf_error *err) {
    double *c = sf_alloc(err, (unsigned long)m->node_count, sizeof *c, "stability constants");
    if (!c || sf_stability_constants(m, c, err) != SF_OK) {
        free(c);
        return err->status;
    }
    *step = INFINITY;
    for (int64_t i = 0; i < m->node_count; i++) {
        const sf_material *material = sf_model_material(m, i);
        double tangent, viscosity;
        material->law->rest_bounds(material->card, sf_material_length(material, m->spacing[i]), &tangent,
                                   &viscosity);
        double own = sf_stability_step(c[i], tangent, viscosity);
        if (own < *step) {
            *step = own;
            *critical = i;
            *constant = c[i];
        }
    }
    free(c);
    return SF_OK;
}

static void set_stretch(double f[9][SF_LANES], double stretch) {
    memset(f, 0, 9 * sizeof *f);
    for (int l = 0; l < SF_LANES; l++) {
        f[0][l] = f[4][l] = 1;
        f[8][l] = stretch;
    }
}

/* The steps shrink as the foam stiffens, by its curves and its rate terms: takes the law of the node with the
 * shortest first step through half a sine of compression that begins at the missile's speed over the
 * thickness, and returns the mean over time of the first step over the present one. */
static sf_status estimate_slowdown(const sf_model *m, int64_t critical, double constant, double first,
                                   double *slowdown, sf_error *err) {
    enum { STEPS = 400 };
    const double deepest = 0.7, speed = fmax(m->missile.speed, 1e-3);
    const sf_material *material = sf_model_material(m, critical);
    double length = sf_material_length(material, m->spacing[critical]), sum = 0,
           start = fmin(m->run.step_limit, m->run.step_safety * first);
    sf_law_batch batch;
    sf_material_law law;
    if (sf_material_law_build(material, &law, err) != SF_OK)
        return err->status;
    memset(&batch, 0, sizeof batch);
    set_stretch(batch.f, 1);
    for (int l = 0; l < SF_LANES; l++)
        batch.length[l] = length;
    for (int k = 1; k <= STEPS; k++) {
        memcpy(batch.f_old, batch.f, sizeof batch.f);
        set_stretch(batch.f, 1 - deepest * sin(M_PI * k / STEPS));
        law.law->update(law.numbers, M_PI * deepest * m->thickness / speed / STEPS, &batch);
        double own = sf_stability_step(constant, batch.tangent[0], batch.viscosity[0]);
        sum += start / fmin(m->run.step_limit, m->run.step_safety * own);
    }
    *slowdown = sum / STEPS;
    sf_material_law_free(&law);
    return SF_OK;
}

static sf_status measure_step(const sf_model *m, sf_build_report *report, sf_error *err) {
    int64_t critical = 0;
    double constant = 0;
    report->slowdown = 1;
    if (first_step(m, &report->first_step, &critical, &constant, err) != SF_OK || sf_missile_is_driven(m))
        return err->status;
    return estimate_slowdown(m, critical, constant, report->first_step, &report->slowdown, err);
}

static void estimate_mesh_error(sf_model *m, sf_build_report *report) {
    if (report->contact_held)
        return;
    sf_contact_zone_measure(m, &report->zone);
    m->expected_mesh_error = sf_mesh_error_expect(m, &report->zone);
}

/* A run that would stop at its first step. */
static sf_status check_first_step(const sf_model *m, double first, sf_error *err) {
    double step = m->run.step_safety * first, least = SF_SMALLEST_STEP * m->run.end_time;
    if (step >= least)
        return SF_OK;
    return SF_FAIL(
        err, SF_ERR_INPUT,
        "the first stable time step is %.3g s, below %g of solver.end_time (%g s), where a run "
        "stops: the foam is too stiff or too viscous (material.E, curve, ED, eta, DAMP), or too light",
        step, SF_SMALLEST_STEP, m->run.end_time);
}

/* The pad has no contact with itself. */
static void tell_slits(const sf_build_report *r, const sf_sink *sink) {
    if (r->hidden_count > 0)
        sf_sink_tell(
            sink, SF_WARNING,
            "the pad has a slit, hole or gap narrower than the supports: nodes %.3g mm apart at (%.4g, %.4g, "
            "%.4g) mm do not act on each other; its faces pass through each other where they meet",
            1e3 * r->hidden_distance, 1e3 * r->hidden_position[0], 1e3 * r->hidden_position[1],
            1e3 * r->hidden_position[2]);
}

sf_status sf_model_build(sf_case *c, sf_mesh *mesh, sf_surface *surface, sf_model *m, sf_build_report *report,
                         const sf_sink *sink, sf_error *err) {
    memset(m, 0, sizeof *m);
    memset(report, 0, sizeof *report);
    double *contact_area = NULL;
    if (build_cloud(c, mesh, m, &contact_area, report, err) == SF_OK &&
        build_sets(c, mesh, contact_area, m, report, err) == SF_OK &&
        sf_hold_find(m, &report->hold, err) == SF_OK && build_missile(c, surface, m, err) == SF_OK &&
        take_cards(c, m, err) == SF_OK) {
        estimate_mesh_error(m, report);
        if (sf_drop_check(c, mesh, m, &report->zone, err) == SF_OK && sf_model_check(m, err) == SF_OK &&
            measure_step(m, report, err) == SF_OK && check_first_step(m, report->first_step, err) == SF_OK) {
            sf_drop_warn(c, mesh, m, &report->zone, sink);
            sf_hold_warn(&report->hold, m, sink);
            tell_slits(report, sink);
        }
    }
    free(contact_area);
    if (err->status != SF_OK)
        sf_model_free(m);
    return err->status;
}
