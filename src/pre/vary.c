/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/vary.h"

#include "base/mat3.h"
#include "pre/build.h"
#include "pre/cloud/axis.h"
#include <string.h>

/* The cells of one layer with its nodes, [first, end) of the model, as a mesh; positions are borrowed. */
static sf_status take_part(const sf_model *m, int64_t first, int64_t end, sf_mesh *part, sf_error *err) {
    *part = (sf_mesh){.node_count = end - first, .position = &m->position[3 * first]};
    SF_ALLOC_ALL(err, "a layer", SF_ROOM(part->cell_type, m->cell_count),
                 SF_ROOM(part->cell_ptr, m->cell_count + 1), SF_ROOM(part->cell_node, m->cell_nnz));
    for (int64_t c = 0; err->status == SF_OK && c < m->cell_count; c++) {
        const int32_t *node = &m->cell_node[m->cell_ptr[c]];
        int64_t vertices = m->cell_ptr[c + 1] - m->cell_ptr[c], begin = part->cell_ptr[part->cell_count];
        if (node[0] < first || node[0] >= end)
            continue;
        for (int64_t k = 0; k < vertices; k++)
            part->cell_node[begin + k] = node[k] - (int32_t)first;
        part->cell_type[part->cell_count++] = m->cell_type[c];
        part->cell_ptr[part->cell_count] = begin + vertices;
    }
    return err->status;
}

static void free_part(sf_mesh *part) {
    part->position = NULL;
    sf_mesh_free(part);
}

/* The rows of all layers anew. */
static sf_status build_rows(sf_model *m, const sf_kernel *kernel, sf_error *err) {
    SF_OWNED sf_case *c = sf_alloc(err, 1, sizeof *c, "a layer");
    SF_OWNED sf_build_report *report = sf_alloc(err, 1, sizeof *report, "a layer");
    SF_TRY(err->status);
    c->support_ratio = kernel->support_ratio;
    c->condition_limit = kernel->condition_limit;
    c->layer_count = (int)m->material_count;
    sf_free_all(10, (void *[]){m->volume, m->domain_ptr, m->domain_node, m->domain_b, m->phi_ptr, m->phi_node,
                               m->phi_value, m->edge_ptr, m->edge_node, NULL});
    m->volume = m->domain_b = m->phi_value = NULL;
    m->domain_ptr = m->phi_ptr = m->edge_ptr = NULL;
    m->domain_node = m->phi_node = m->edge_node = NULL;
    m->domain_nnz = m->phi_nnz = m->edge_nnz = 0;
    for (int64_t first = 0, end; first < m->node_count && err->status == SF_OK; first = end) {
        SF_OWNED_BY(free_part) sf_mesh part = {0};
        SF_OWNED_BY(sf_dual_free) sf_dual dual = {0};
        for (end = first + 1; end < m->node_count && m->node_material[end] == m->node_material[first]; end++)
            ;
        if (take_part(m, first, end, &part, err) == SF_OK && sf_dual_build(&part, &dual, err) == SF_OK)
            sf_model_build_layer(c, &(sf_model_layer){&part, &dual, sf_model_material(m, first), first}, m,
                                 report, err);
    }
    return err->status == SF_OK ? sf_axis_project(m, err) : err->status;
}

static double mass_of(const sf_model *m) {
    double sum = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        sum += m->mass[i];
    return sum;
}

static void scale_loads(sf_model *m, double factor) {
    for (int64_t k = 0; k < m->rest_count; k++)
        m->rest_load[k] *= factor;
}

/* Moves the missile with the top of the pad. */
static void lift_missile(sf_model *m, double rise) {
    m->missile.sphere_centre[2] += rise;
    m->missile.centre[2] += rise;
    for (int64_t k = 0; k < m->surface_node_count; k++)
        m->surface_position[3 * k + 2] += rise;
}

sf_status sf_vary_thickness(sf_model *m, const sf_kernel *kernel, double thickness, sf_error *err) {
    double factor = thickness / m->thickness, low[3], high[3];
    sf_contact_zone zone;
    if (!m->axisymmetric || !(kernel->support_ratio > 0))
        return SF_REFUSE(
            err, "thickness: the pad of a %s cannot be scaled: build it of a case with another thickness",
            m->axisymmetric ? "model that was read from a file" : "solid model");
    if (!(factor >= SF_VARY_LEAST && factor <= SF_VARY_MOST))
        return SF_REFUSE(
            err,
            "thickness: %g m is %.4g times that of the model, outside %g to %g: build a model of "
            "a case with another thickness",
            thickness, factor, SF_VARY_LEAST, SF_VARY_MOST);
    sf_box3(m->node_count, m->position, low, high);
    for (int64_t i = 0; i < m->node_count; i++)
        m->position[3 * i + 2] = low[2] + factor * (m->position[3 * i + 2] - low[2]);
    double before = mass_of(m);
    lift_missile(m, (factor - 1) * (high[2] - low[2]));
    m->thickness = thickness;
    m->anvil.depth *= factor;
    SF_TRY(build_rows(m, kernel, err));
    scale_loads(m, mass_of(m) / before);
    sf_contact_zone_measure(m, &zone);
    m->expected_mesh_error = sf_mesh_error_expect(m, &zone);
    return SF_OK;
}

sf_status sf_vary_material(sf_model *m, const sf_material *material, sf_error *err) {
    sf_material copy;
    if (m->material_count != 1)
        return SF_REFUSE(err, "material: the pad has %lld materials; a variant changes that of a pad of one",
                         (long long)m->material_count);
    SF_TRY(sf_material_copy(material, &copy, err));
    double factor = sf_material_density(&copy) / sf_material_density(m->material);
    memcpy(copy.name, m->material->name, sizeof copy.name);
    sf_material_free(m->material);
    *m->material = copy;
    for (int64_t i = 0; i < m->node_count; i++)
        m->mass[i] *= factor;
    scale_loads(m, factor);
    return SF_OK;
}
