/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/model_report.h"

#include "model/model.h"
#include "pre/missile_body.h"
#include "base/units.h"
#include "pre/impact.h"
#include <math.h>

/* For the estimate only (docs/performance.md): node-steps per second on two cores, and the steps of a drop
 * that rebounds half-way to the end time, over those that the guaranteed steps would need to the end. */
static const double RATE = 3.5e6, TYPICAL = 0.32;

static void print_range(FILE *out, const char *name, const double *value, int64_t count, double scale,
                        const char *unit) {
    double low = INFINITY, high = -INFINITY, sum = 0;
    for (int64_t i = 0; i < count; i++) {
        low = fmin(low, value[i]);
        high = fmax(high, value[i]);
        sum += value[i];
    }
    fprintf(out, "%-26s%.3f to %.3f %s, mean %.3f\n", name, scale * low, scale * high, unit,
            scale * sum / (double)count);
}

static void print_neighbours(FILE *out, const sf_model *m) {
    int64_t low = INT64_MAX, high = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        int64_t count = m->domain_ptr[i + 1] - m->domain_ptr[i] - 1;
        low = count < low ? count : low;
        high = count > high ? count : high;
    }
    fprintf(out, "%-26s%lld to %lld, mean %.1f\n", "neighbours of a domain", (long long)low, (long long)high,
            (double)m->domain_nnz / (double)m->node_count - 1);
}

static void print_impact(FILE *out, const sf_model *m) {
    double speed = m->missile.speed, energy = 0.5 * m->missile.mass * speed * speed;
    fprintf(out, "%-26s%.4g kg at %.4g m/s: kinetic energy %.4g J, momentum %.4g kg m/s\n", "missile",
            m->missile.mass, speed, energy, m->missile.mass * speed);
    fprintf(out, "%-26s%.4g m in free fall\n", "equivalent drop height",
            speed * speed / (2 * SF_STANDARD_GRAVITY));
}

static void print_freedom(FILE *out, const sf_model *m) {
    const sf_missile_card *card = &m->missile;
    double p[3];
    sf_missile_inertia_is_possible(card->inertia, p);
    fprintf(out, "%-26scentre of mass (%.5g, %.5g, %.5g) mm, principal moments %.5g, %.5g, %.5g kg cm2\n",
            "missile, free", 1e3 * card->centre[0], 1e3 * card->centre[1], 1e3 * card->centre[2], 1e4 * p[0],
            1e4 * p[1], 1e4 * p[2]);
}

static void print_motion(FILE *out, const sf_model *m) {
    const sf_motion_range range = sf_motion_measure(m);
    fprintf(out, "%-26sprescribed motion of %lld points to %.4g ms, to %.4g mm, at most %.4g m/s\n",
            "missile", (long long)range.points, 1e3 * range.end_time, 1e3 * range.displacement, range.speed);
}

/* m3, of the nodes of material k; of a model with one material that of the mesh itself. */
static double volume_of(const sf_model *m, const sf_build_report *r, int64_t k) {
    double volume = 0;
    if (m->material_count == 1)
        return r->mesh_volume;
    for (int64_t i = 0; i < m->node_count; i++)
        volume += m->node_material[i] == k ? m->volume[i] : 0;
    return volume;
}

/* Prints the mass properties of a missile that is drawn whole and closed. */
static void print_body(FILE *out, const sf_model *m) {
    sf_solid solid;
    sf_error open = SF_ERROR_INIT;
    double lowest[3];
    const sf_surface missile = {.node_count = m->surface_node_count,
                                .position = m->surface_position,
                                .triangle_count = m->surface_triangle_count,
                                .triangle = m->surface_triangle};
    if (sf_solid_measure(m->surface_node_count, m->surface_position, m->surface_triangle_count,
                         m->surface_triangle, &solid, &open) != SF_OK)
        return;
    sf_impact_lowest(&missile, &m->missile, lowest);
    fprintf(out, "%-26s%.4g cm3, its centroid %.4g mm above its lowest point", "missile body",
            1e6 * solid.volume, 1e3 * (solid.centroid[2] - lowest[2]));
    if (m->missile.mass > 0)
        fprintf(out, "; if uniform %.4g kg/m3", m->missile.mass / solid.volume);
    fputc('\n', out);
}

static void print_masses(FILE *out, const sf_model *m, const sf_build_report *r) {
    double mass = 0, parts = 0, whole = sf_model_whole(m), volume = r->mesh_volume;
    for (int64_t i = 0; i < m->node_count; i++)
        mass += m->mass[i];
    for (int64_t k = 0; k < m->material_count; k++)
        parts += sf_material_density(&m->material[k]) * volume_of(m, r, k);
    fprintf(out, "%-26s%.6f kg modelled; density x volume = %.6f kg (difference %.1e)\n", "pad mass", mass,
            parts, mass / parts - 1);
    fprintf(out, "%-26s%.1f x %.6g cm3, thickness %.4g mm\n", "pad volume", whole, 1e6 * volume,
            1e3 * m->thickness);
    if (sf_missile_is_driven(m))
        print_motion(out, m);
    else
        print_impact(out, m);
    if (sf_missile_turns(m))
        print_freedom(out, m);
    if (m->missile.shape == SF_SHAPE_SPHERE)
        fprintf(out, "%-26sexact sphere cap, radius %.5g mm\n", "missile contact",
                1e3 * m->missile.sphere_radius);
    else
        fprintf(out, "%-26s%lld triangles\n", "missile contact", (long long)m->surface_triangle_count);
    print_body(out, m);
    fprintf(out, "%-26s(%.4g, %.4g) mm: there the missile's lowest point arrives\n", "impact point",
            1e3 * m->missile.impact[0] + 0.0, 1e3 * m->missile.impact[1] + 0.0);
}

static void print_mesh_error(FILE *out, const sf_model *m, const sf_contact_zone *zone) {
    fprintf(out, "%-26s%.4g mm; contact zone %.4g cm2, half width %.4g mm\n", "spacing under missile",
            1e3 * zone->spacing, 1e4 * zone->area, 1e3 * zone->half_width);
    if (m->expected_mesh_error > 0)
        fprintf(out, "%-26sabout %.2g %% of a_max, from the spacing\n", "expected mesh error",
                100 * m->expected_mesh_error);
    else
        fprintf(out, "%-26snot estimated\n", "expected mesh error");
}

static double first_step(const sf_model *m, const sf_build_report *r) {
    return fmin(m->run.step_safety * r->first_step, m->run.step_limit);
}

static double expected_steps(const sf_model *m, const sf_build_report *r) {
    return TYPICAL * r->slowdown * m->run.end_time / first_step(m, r);
}

double sf_report_seconds(const sf_model *m, const sf_build_report *r) {
    return expected_steps(m, r) * (double)m->node_count / RATE;
}

static void print_cost(FILE *out, const sf_model *m, const sf_build_report *r) {
    double step = first_step(m, r), steps = expected_steps(m, r), n = (double)m->node_count;
    double bytes = 26 * (double)m->domain_nnz + 12 * (double)m->phi_nnz + 7 * (double)m->edge_nnz + 541 * n +
                   720 * (double)(m->fixed_count + sf_model_points(m));
    fprintf(out, "%-26s%.2f us (bound %.2f us)\n", "first time step, at least", 1e6 * step,
            1e6 * r->first_step);
    fprintf(out, "%-26s%.0f MB (%.2f kB per node)\n", "memory of the solver", bytes / 1e6, bytes / n / 1e3);
    fprintf(out, "%-26s%.0f s on two cores, for about %.0f steps (to a factor of 2)\n", "typical run time",
            sf_report_seconds(m, r), steps);
}

void sf_report_print(FILE *out, const sf_model *m, const sf_build_report *r) {
    fprintf(out, "%-26s%lld, 1/%lld of the pad\n", "nodes", (long long)m->node_count,
            (long long)m->symmetry_factor);
    fprintf(out, "%-26s%lld hexahedra, %lld pyramids, %lld prisms, %lld tetrahedra\n", "cells",
            (long long)r->cells[SF_CELL_HEXAHEDRON], (long long)r->cells[SF_CELL_PYRAMID],
            (long long)r->cells[SF_CELL_PRISM], (long long)r->cells[SF_CELL_TETRAHEDRON]);
    if (r->orphan_count > 0)
        fprintf(out, "%-26s%lld nodes that no cell uses\n", "left out", (long long)r->orphan_count);
    print_range(out, "nodal spacing", m->spacing, m->node_count, 1e3, "mm");
    print_neighbours(out, m);
    fprintf(out, "%-26s%.3g at (%.4g, %.4g, %.4g) mm\n", "worst conditioning", r->worst_condition,
            1e3 * r->worst_position[0], 1e3 * r->worst_position[1], 1e3 * r->worst_position[2]);
    if (r->enlarged_count > 0)
        fprintf(out, "%-26sat %lld nodes, by up to %.2f\n", "support enlarged", (long long)r->enlarged_count,
                r->largest_enlargement);
    if (r->hidden_count > 0)
        fprintf(out, "%-26s%lld nodes, the nearest %.3g mm apart\n", "across slits and gaps",
                (long long)r->hidden_count, 1e3 * r->hidden_distance);
    fprintf(out, "%-26ssum B %.1e, sum X B %.1e, volume %.1e, telescoping %.1e, phi %.1e\n", "invariants",
            r->invariants.unity, r->invariants.linear, r->invariants.volume, r->invariants.telescope,
            r->invariants.shape);
    fprintf(out, "%-26s%lld held, %lld may be touched", "boundary nodes", (long long)m->fixed_count,
            (long long)m->contact_count);
    if (m->rest_count > 0)
        fprintf(out, ", %lld rest on the anvil", (long long)m->rest_count);
    fputc('\n', out);
    print_masses(out, m, r);
    print_mesh_error(out, m, &r->zone);
    print_cost(out, m, r);
    fprintf(out, "%-26s%s\n", "mesh hash", r->mesh_hash);
}
