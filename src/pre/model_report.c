/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/model_report.h"

#include "base/mat3.h"
#include "base/text.h"
#include "model/flight.h"
#include "model/motion.h"
#include "pre/mesh/missile_shape.h"
#include "pre/missile_body.h"

/* For the estimate only (docs/performance.md): node-steps per second on two cores, and the steps of a drop
 * that rebounds half-way to the end time, over those that the guaranteed steps would need to the end. */
static const double RATE = 3.5e6, TYPICAL = 0.32;

/* Adds a line; what does not fit is cut. */
static void __attribute__((format(printf, 4, 5)))
add(sf_model_report *out, const char *key, const char *name, const char *format, ...) {
    if (out->count == SF_MODEL_REPORT_LINES)
        return;
    sf_report_line *line = &out->line[out->count++];
    line->key = key;
    line->name = name;
    SF_PRINT_INTO(line->value, format);
}

/* Returns the value of the last line, to be continued. */
static char *last(sf_model_report *out) {
    return out->line[out->count - 1].value;
}

static void add_spacing(sf_model_report *out, const sf_model *m) {
    double low = INFINITY, high = -INFINITY, sum = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        low = fmin(low, m->spacing[i]);
        high = fmax(high, m->spacing[i]);
        sum += m->spacing[i];
    }
    add(out, "nodal_spacing", "nodal spacing", "%.3f to %.3f mm, mean %.3f", 1e3 * low, 1e3 * high,
        1e3 * sum / (double)m->node_count);
}

static void add_neighbours(sf_model_report *out, const sf_model *m) {
    int64_t low = INT64_MAX, high = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        int64_t count = m->domain_ptr[i + 1] - m->domain_ptr[i] - 1;
        low = count < low ? count : low;
        high = count > high ? count : high;
    }
    add(out, "neighbours", "neighbours of a domain", "%lld to %lld, mean %.1f", (long long)low,
        (long long)high, (double)m->domain_nnz / (double)m->node_count - 1);
}

/* The lengths of the box that holds the points [count][3] (mm). */
static void find_size(int64_t count, const double *x, double size[3]) {
    double low[3], high[3];
    sf_box3(count, x, low, high);
    for (int k = 0; k < 3; k++)
        size[k] = 1e3 * (high[k] - low[k]);
}

static void add_size(sf_model_report *out, const sf_model *m) {
    double pad[3], missile[3];
    find_size(m->node_count, m->position, pad);
    find_size(m->surface_node_count, m->surface_position, missile);
    if (m->axisymmetric) {
        add(out, "size", "size", "pad of %.4g mm radius, %.4g mm thick; missile's surface %.4g x %.4g mm",
            pad[0], pad[2], missile[0], missile[2]);
        return;
    }
    add(out, "size", "size as modelled", "pad %.4g x %.4g x %.4g mm, missile's surface %.4g x %.4g x %.4g mm",
        pad[0], pad[1], pad[2], missile[0], missile[1], missile[2]);
}

static void add_impact(sf_model_report *out, const sf_model *m) {
    double speed = m->missile.speed, energy = 0.5 * m->missile.mass * speed * speed;
    add(out, "missile", "missile", "%.4g kg at %.4g m/s: kinetic energy %.4g J, momentum %.4g kg m/s",
        m->missile.mass, speed, energy, m->missile.mass * speed);
    add(out, "drop_height", "equivalent drop height", "%.4g m in free fall",
        speed * speed / (2 * SF_STANDARD_GRAVITY));
    if (m->missile.gap > 0)
        add(out, "flight", "flight to the pad", "%.4g mm in %.4g ms, from %.4g m/s at the start",
            1e3 * m->missile.gap, 1e3 * sf_flight_time(&m->missile), sf_flight_start_speed(&m->missile));
}

static void add_freedom(sf_model_report *out, const sf_model *m) {
    const sf_missile_card *card = &m->missile;
    double p[3];
    sf_missile_inertia_is_possible(card->inertia, p);
    add(out, "missile_free", "missile, free",
        "centre of mass (%.5g, %.5g, %.5g) mm, principal moments %.5g, %.5g, %.5g kg cm2",
        1e3 * card->centre[0], 1e3 * card->centre[1], 1e3 * card->centre[2], 1e4 * p[0], 1e4 * p[1],
        1e4 * p[2]);
}

static void add_motion(sf_model_report *out, const sf_model *m) {
    const sf_motion_range range = sf_motion_measure(m);
    add(out, "missile", "missile",
        "prescribed motion of %lld points to %.4g ms, to %.4g mm, at most %.4g m/s", (long long)range.points,
        1e3 * range.end_time, 1e3 * range.displacement, range.speed);
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

/* In mm; what is rounding of coordinates is 0. */
static double millimetres(double length) {
    return fabs(length) < 1e-9 ? 0 : 1e3 * length;
}

/* Prints the mass properties of a missile that is drawn whole and closed. */
static void add_body(sf_model_report *out, const sf_model *m, const sf_missile_body *body) {
    const sf_solid *solid = &body->solid;
    double lowest[3], inertia[6], p[3];
    const sf_surface missile = sf_surface_of_missile(m);
    if (body->none.status == SF_ERR_INPUT)
        add(out, "missile_body", "missile body", "volume and inertia are unknown: %.160s", body->none.text);
    if (body->none.status != SF_OK)
        return;
    sf_impact_lowest(&missile, &m->missile, lowest);
    add(out, "missile_body", "missile body",
        "%.4g cm3, centroid (%.5g, %.5g, %.5g) mm, %.4g mm above its lowest point", 1e6 * solid->volume,
        millimetres(solid->centroid[0]), millimetres(solid->centroid[1]), millimetres(solid->centroid[2]),
        1e3 * (solid->centroid[2] - lowest[2]));
    double density = m->missile.mass / solid->volume;
    for (int k = 0; k < 6; k++)
        inertia[k] = density * solid->inertia[k];
    sf_missile_inertia_is_possible(inertia, p);
    if (density > 0)
        sf_text_add(last(out), SF_MODEL_REPORT_VALUE,
                    "; if uniform %.4g kg/m3, principal moments %.5g, %.5g, %.5g kg cm2", density, 1e4 * p[0],
                    1e4 * p[1], 1e4 * p[2]);
}

/* A line for each interface of the layers. */
static void add_interfaces(sf_model_report *out, const sf_model *m, const sf_interfaces *all) {
    static const char *const kind[] = {"tied", "sliding", "loose"};
    for (int k = 0; k < all->count && k < SF_INTERFACES_LISTED; k++) {
        const sf_interface *i = &all->at[k];
        add(out, "interface", "interface", "%s, %s: %s", m->material[i->layer[0]].name,
            m->material[i->layer[1]].name, kind[i->kind]);
        if (i->kind == SF_INTERFACE_LOOSE)
            sf_text_add(last(out), SF_MODEL_REPORT_VALUE, ", friction %g", i->friction);
        sf_text_add(last(out), SF_MODEL_REPORT_VALUE, i->faces > 0 ? ", %lld faces" : ", bodies apart",
                    (long long)i->faces);
    }
    if (all->count > SF_INTERFACES_LISTED)
        sf_text_add(last(out), SF_MODEL_REPORT_VALUE, "; and %d more interfaces",
                    all->count - SF_INTERFACES_LISTED);
}

static void add_masses(sf_model_report *out, const sf_model *m, const sf_build_report *r) {
    double mass = 0, parts = 0, whole = sf_model_whole(m), volume = r->mesh_volume;
    for (int64_t i = 0; i < m->node_count; i++)
        mass += m->mass[i];
    for (int64_t k = 0; k < m->material_count; k++)
        parts += sf_material_density(&m->material[k]) * volume_of(m, r, k);
    add(out, "pad_mass", "pad mass", "%.6f kg modelled; density x volume = %.6f kg (difference %.1e)", mass,
        parts, mass / parts - 1);
    add(out, "pad_volume", "pad volume", "%.1f x %.6g cm3, thickness under the missile %.4g mm", whole,
        1e6 * volume, 1e3 * m->thickness);
    if (sf_missile_is_driven(m))
        add_motion(out, m);
    else
        add_impact(out, m);
    if (sf_missile_turns(m))
        add_freedom(out, m);
    if (m->missile.shape == SF_SHAPE_SPHERE)
        add(out, "missile_contact", "missile contact", "exact sphere cap, radius %.5g mm",
            1e3 * m->missile.sphere_radius);
    else
        add(out, "missile_contact", "missile contact", "%lld triangles",
            (long long)m->surface_triangle_count);
    add_body(out, m, &r->body);
    add(out, "impact_point", "impact point", "(%.4g, %.4g) mm: there the missile's lowest point arrives",
        millimetres(m->missile.impact[0]), millimetres(m->missile.impact[1]));
}

static void add_mesh_error(sf_model_report *out, const sf_model *m, const sf_contact_zone *zone) {
    add(out, "spacing_under_missile", "spacing under missile",
        "%.4g mm; contact zone %.4g cm2, half width %.4g mm", 1e3 * zone->spacing, 1e4 * zone->area,
        1e3 * zone->half_width);
    if (m->expected_mesh_error > 0)
        add(out, "mesh_error", "expected mesh error", "about %.2g %% of a_max, from the spacing",
            100 * m->expected_mesh_error);
    else
        add(out, "mesh_error", "expected mesh error", "not estimated");
}

static double first_step(const sf_model *m, const sf_build_report *r) {
    return fmin(m->run.step_safety * r->first_step, m->run.step_limit);
}

static double expected_steps(const sf_model *m, const sf_build_report *r) {
    return TYPICAL * r->slowdown * m->run.end_time / first_step(m, r);
}

/* Expected time of the run on two cores, s, to a factor of 2. */
static double expected_seconds(const sf_model *m, const sf_build_report *r) {
    return expected_steps(m, r) * (double)m->node_count / RATE;
}

static void add_cost(sf_model_report *out, const sf_model *m, const sf_build_report *r) {
    double step = first_step(m, r), steps = expected_steps(m, r), n = (double)m->node_count;
    double bytes = 26 * (double)m->domain_nnz + 12 * (double)m->phi_nnz + 7 * (double)m->edge_nnz + 541 * n +
                   720 * (double)(m->fixed_count + sf_model_points(m));
    add(out, "first_step", "first time step, at least", "%.2f us (bound %.2f us)", 1e6 * step,
        1e6 * r->first_step);
    add(out, "memory", "memory of the solver", "%.0f MB (%.2f kB per node)", bytes / 1e6, bytes / n / 1e3);
    add(out, "run_time", "typical run time", "%.0f s on two cores, for about %.0f steps (to a factor of 2)",
        expected_seconds(m, r), steps);
}

static void add_mesh(sf_model_report *out, const sf_model *m, const sf_build_report *r) {
    if (m->axisymmetric) {
        add(out, "nodes", "nodes", "%lld, in the section of an axisymmetric pad", (long long)m->node_count);
        add(out, "cells", "cells", "%lld quadrangles, %lld triangles",
            (long long)r->cells[SF_CELL_QUADRANGLE], (long long)r->cells[SF_CELL_TRIANGLE]);
        return;
    }
    add(out, "nodes", "nodes", "%lld, 1/%lld of the pad", (long long)m->node_count,
        (long long)m->symmetry_factor);
    add(out, "cells", "cells", "%lld hexahedra, %lld pyramids, %lld prisms, %lld tetrahedra",
        (long long)r->cells[SF_CELL_HEXAHEDRON], (long long)r->cells[SF_CELL_PYRAMID],
        (long long)r->cells[SF_CELL_PRISM], (long long)r->cells[SF_CELL_TETRAHEDRON]);
}

void sf_model_report_make(const sf_model *m, const sf_build_report *r, sf_model_report *out) {
    out->count = 0;
    add_mesh(out, m, r);
    if (r->orphan_count > 0)
        add(out, "left_out", "left out", "%lld nodes that no cell uses", (long long)r->orphan_count);
    add_size(out, m);
    add_spacing(out, m);
    add_neighbours(out, m);
    add(out, "conditioning", "worst conditioning", "%.3g at (%.4g, %.4g, %.4g) mm",
        r->domains.worst_condition, 1e3 * r->domains.worst_position[0], 1e3 * r->domains.worst_position[1],
        1e3 * r->domains.worst_position[2]);
    if (r->domains.enlarged_count > 0)
        add(out, "support_enlarged", "support enlarged", "at %lld nodes, by up to %.2f",
            (long long)r->domains.enlarged_count, r->domains.largest_enlargement);
    if (r->domains.hidden_count > 0)
        add(out, "hidden_nodes", "across slits and gaps", "%lld nodes, the nearest %.3g mm apart",
            (long long)r->domains.hidden_count, 1e3 * r->domains.hidden_distance);
    add(out, "invariants", "invariants", "sum B %.1e, sum X B %.1e, volume %.1e, telescoping %.1e, phi %.1e",
        r->invariants.unity, r->invariants.linear, r->invariants.volume, r->invariants.telescope,
        r->invariants.shape);
    add(out, "boundary_nodes", "boundary nodes", "%lld held, %lld may be touched", (long long)m->fixed_count,
        (long long)m->contact_count);
    if (m->rest_count > 0)
        sf_text_add(last(out), SF_MODEL_REPORT_VALUE, ", %lld rest on the anvil", (long long)m->rest_count);
    const char *support = m->support_triangle_count == 0 ? "" : ", and the support";
    if (!m->skin_alone && m->skin_count > 0)
        sf_text_add(last(out), SF_MODEL_REPORT_VALUE, ", %lld faces may touch each other or the anvil%s",
                    (long long)m->skin_count, support);
    else if (m->skin_alone && m->support_triangle_count > 0)
        sf_text_add(last(out), SF_MODEL_REPORT_VALUE, ", %lld faces may touch the support",
                    (long long)m->skin_count);
    if (m->skin_count > 0 && !m->skin_alone && !m->skin_centroids && sf_model_skin_triangles(m) > 0)
        add(out, "triangles_touch", "triangles that may touch",
            "where they lie on faces that do not match, the stress may be off (16 %% at a node of a test): "
            "pad.triangle_centroids, or hexahedra");
    add_interfaces(out, m, &r->interfaces);
    add_masses(out, m, r);
    add_mesh_error(out, m, &r->zone);
    add_cost(out, m, r);
    add(out, "mesh_hash", "mesh hash", "%s", r->mesh_hash);
}

void sf_model_report_print(FILE *out, const sf_model_report *report) {
    for (int k = 0; k < report->count; k++)
        fprintf(out, "%-26s%s\n", report->line[k].name, report->line[k].value);
}

char *sf_model_report_text(const sf_model_report *report, sf_error *err) {
    SF_TEXT_STREAM(out, text, size);
    for (int k = 0; out && k < report->count; k++)
        fprintf(out, "%s\t%s\t%s\n", report->line[k].key, report->line[k].name, report->line[k].value);
    if (!sf_text_close(out, &text))
        SF_NO_MEMORY(err, "the report of the model");
    return text;
}
