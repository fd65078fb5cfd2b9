/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ARRAY(member, type, rows, extra, columns, path, units, text)                                         \
    { offsetof(sf_model, member), type, offsetof(sf_model, rows), extra, columns, path, units, text, false }
#define SCALAR(member, type, path, units, text)                                                              \
    { offsetof(sf_model, member), type, SIZE_MAX, 0, 1, path, units, text, false }
/* What models of older versions do not hold. */
#define OPTIONAL_ARRAY(member, type, rows, path, units, text)                                                \
    { offsetof(sf_model, member), type, offsetof(sf_model, rows), 0, 1, path, units, text, true }
#define OPTIONAL_SCALAR(member, type, path, units, text)                                                     \
    { offsetof(sf_model, member), type, SIZE_MAX, 0, 1, path, units, text, true }
#define F64 SF_MODEL_F64
#define I32 SF_MODEL_I32
#define I64 SF_MODEL_I64
#define U8 SF_MODEL_U8

static const sf_model_field fields[] = {
    SCALAR(node_count, I64, "/cloud/count", "1", "number of nodes"),
    ARRAY(position, F64, node_count, 0, 3, "/cloud/position", "m", "reference position X"),
    ARRAY(volume, F64, node_count, 0, 1, "/cloud/volume", "m3", "volume of the smoothing domain"),
    ARRAY(mass, F64, node_count, 0, 1, "/cloud/mass", "kg", "lumped mass"),
    ARRAY(spacing, F64, node_count, 0, 1, "/cloud/spacing", "m", "nodal spacing h"),
    ARRAY(support, F64, node_count, 0, 1, "/cloud/support", "m", "kernel radius R"),
    SCALAR(domain_nnz, I64, "/domain/count", "1", "number of (domain, node) pairs"),
    ARRAY(domain_ptr, I64, node_count, 1, 1, "/domain/ptr", "1", "row starts of the smoothed gradient"),
    ARRAY(domain_node, I32, domain_nnz, 0, 1, "/domain/node", "1", "node J of each entry"),
    ARRAY(domain_b, F64, domain_nnz, 0, 3, "/domain/b", "m-1",
          "smoothed gradient of the shape function of J"),
    SCALAR(phi_nnz, I64, "/shape/count", "1", "number of (node, node) pairs"),
    ARRAY(phi_ptr, I64, node_count, 1, 1, "/shape/ptr", "1",
          "row starts of the shape functions at the nodes"),
    ARRAY(phi_node, I32, phi_nnz, 0, 1, "/shape/node", "1", "node J of each entry"),
    ARRAY(phi_value, F64, phi_nnz, 0, 1, "/shape/value", "1", "shape function of J at node I"),
    SCALAR(edge_nnz, I64, "/edge/count", "1", "number of directed edges"),
    ARRAY(edge_ptr, I64, node_count, 1, 1, "/edge/ptr", "1", "row starts of the edge adjacency"),
    ARRAY(edge_node, I32, edge_nnz, 0, 1, "/edge/node", "1", "node at the other end"),
    SCALAR(cell_count, I64, "/mesh/cell_count", "1", "number of background cells"),
    SCALAR(cell_nnz, I64, "/mesh/vertex_count", "1", "number of cell vertices"),
    ARRAY(cell_type, U8, cell_count, 0, 1, "/mesh/cell_type", "1", "XDMF topology code"),
    ARRAY(cell_ptr, I64, cell_count, 1, 1, "/mesh/cell_ptr", "1", "start of each cell in cell_node"),
    ARRAY(cell_node, I32, cell_nnz, 0, 1, "/mesh/cell_node", "1", "vertices in VTK order"),
    SCALAR(fixed_count, I64, "/fixed/count", "1", "number of constrained nodes"),
    ARRAY(fixed_node, I32, fixed_count, 0, 1, "/fixed/node", "1", "constrained node"),
    ARRAY(fixed_mask, U8, fixed_count, 0, 1, "/fixed/mask", "1", "held components: bit 0 x, 1 y, 2 z"),
    ARRAY(fixed_base, U8, fixed_count, 0, 1, "/fixed/base", "1",
          "1: part of the base, 0: symmetry plane only"),
    SCALAR(contact_count, I64, "/contact/count", "1", "number of contact points"),
    ARRAY(contact_node, I32, contact_count, 0, 1, "/contact/node", "1", "node that the missile may touch"),
    ARRAY(contact_area, F64, contact_count, 0, 1, "/contact/area", "m2",
          "area of the surface that belongs to it"),
    SCALAR(surface_node_count, I64, "/missile/surface_node_count", "1", "nodes of the missile's surface"),
    SCALAR(surface_triangle_count, I64, "/missile/surface_triangle_count", "1", "triangles of it"),
    ARRAY(surface_position, F64, surface_node_count, 0, 3, "/missile/surface_position", "m",
          "position at t = 0"),
    ARRAY(surface_triangle, I32, surface_triangle_count, 0, 3, "/missile/surface_triangle", "1",
          "outward triangles"),
    OPTIONAL_SCALAR(motion_count, I64, "/missile/motion_count", "1",
                    "points of the prescribed motion, 0: free missile"),
    OPTIONAL_ARRAY(motion_time, F64, motion_count, "/missile/motion_time", "s",
                   "times of the prescribed motion"),
    OPTIONAL_ARRAY(motion_displacement, F64, motion_count, "/missile/motion_displacement", "m",
                   "displacement along the direction at these times"),
    SCALAR(frame_time_count, I64, "/run/frame_time_count", "1", "number of further frames"),
    ARRAY(frame_time, F64, frame_time_count, 0, 1, "/run/frame_time", "s", "times of further frames"),
    SCALAR(symmetry_factor, I64, "/model/symmetry_factor", "1", "modelled parts that make the whole"),
    SCALAR(thickness, F64, "/model/thickness", "m", "pad thickness"),
    SCALAR(foam.density, F64, "/foam/density", "kg m-3", "density of the undeformed foam"),
    SCALAR(foam.modulus, F64, "/foam/modulus", "Pa", "E"),
    SCALAR(foam.hysteresis_hu, F64, "/foam/hu", "1", "HU"),
    SCALAR(foam.hysteresis_shape, F64, "/foam/shape", "1", "SHAPE"),
    SCALAR(foam.damp, F64, "/foam/damp", "1", "DAMP"),
    SCALAR(foam.damp_length, F64, "/foam/damp_length", "m", "length of DAMP, 0: nodal spacing"),
    SCALAR(foam.maxwell_modulus, F64, "/foam/maxwell_modulus", "Pa", "ED"),
    SCALAR(foam.maxwell_rate, F64, "/foam/maxwell_rate", "s-1", "BETA1"),
    SCALAR(foam.kelvin_viscosity, F64, "/foam/kelvin_viscosity", "Pa s", "eta"),
    SCALAR(foam.tension_cutoff, F64, "/foam/tension_cutoff", "Pa", "largest tensile nominal stress"),
    SCALAR(foam.densification_start, F64, "/foam/densification_start", "1", "strain, 0: end of the table"),
    SCALAR(foam.densification_limit, F64, "/foam/densification_limit", "1", "strain of infinite stress"),
    SCALAR(foam.densification_exponent, F64, "/foam/densification_exponent", "1",
           "exponent, 0: by continuity"),
    SCALAR(foam.rate_filter_time, F64, "/foam/rate_filter_time", "s",
           "time constant of the strain-rate filter"),
    SCALAR(foam.curve_count, I64, "/foam/curve_count", "1", "number of compression curves"),
    SCALAR(foam.curve_points, I64, "/foam/curve_points", "1", "number of points of all curves"),
    ARRAY(foam.curve_rate, F64, foam.curve_count, 0, 1, "/foam/curve_rate", "s-1",
          "strain rate of each curve"),
    ARRAY(foam.curve_ptr, I64, foam.curve_count, 1, 1, "/foam/curve_ptr", "1", "start of each curve"),
    ARRAY(foam.curve_strain, F64, foam.curve_points, 0, 1, "/foam/curve_strain", "1", "engineering strain"),
    ARRAY(foam.curve_stress, F64, foam.curve_points, 0, 1, "/foam/curve_stress", "Pa", "engineering stress"),
    SCALAR(missile.mass, F64, "/missile/mass", "kg", "mass of the whole missile"),
    SCALAR(missile.speed, F64, "/missile/speed", "m s-1", "speed at t = 0"),
    SCALAR(missile.direction[0], F64, "/missile/direction_x", "1", "direction of motion, x"),
    SCALAR(missile.direction[1], F64, "/missile/direction_y", "1", "direction of motion, y"),
    SCALAR(missile.direction[2], F64, "/missile/direction_z", "1", "direction of motion, z"),
    SCALAR(missile.friction, F64, "/missile/friction", "1", "Coulomb coefficient"),
    SCALAR(missile.gravity, F64, "/missile/gravity", "m s-2", "along -z"),
    SCALAR(missile.gap, F64, "/missile/gap", "m", "distance from the pad at t = 0"),
    SCALAR(missile.shape, I64, "/missile/shape", "1", "0 exact sphere cap, 1 triangulated surface"),
    SCALAR(missile.sphere_centre[0], F64, "/missile/sphere_centre_x", "m", "centre at t = 0, x"),
    SCALAR(missile.sphere_centre[1], F64, "/missile/sphere_centre_y", "m", "centre at t = 0, y"),
    SCALAR(missile.sphere_centre[2], F64, "/missile/sphere_centre_z", "m", "centre at t = 0, z"),
    SCALAR(missile.sphere_radius, F64, "/missile/sphere_radius", "m", "radius"),
    SCALAR(missile.sphere_cap_cosine, F64, "/missile/sphere_cap_cosine", "1", "cosine that bounds the cap"),
    SCALAR(run.end_time, F64, "/run/end_time", "s", "end of the simulated time"),
    SCALAR(run.step_safety, F64, "/run/step_safety", "1", "fraction of the stability limit"),
    SCALAR(run.step_limit, F64, "/run/step_limit", "s", "largest time step"),
    SCALAR(run.stabilisation, F64, "/run/stabilisation", "1", "stabilisation coefficient"),
    SCALAR(run.energy_limit, F64, "/run/energy_limit", "1", "energy error that stops the run"),
    SCALAR(run.frame_interval, F64, "/run/frame_interval", "s", "time between frames"),
    SCALAR(run.output_fields, I64, "/run/output_fields", "1", "bits of the fields in a frame"),
    SCALAR(run.stop_after_rebound, I64, "/run/stop_after_rebound", "1", "1: end when the missile has left"),
};

const sf_model_field *sf_model_fields(size_t *count) {
    *count = sizeof fields / sizeof fields[0];
    return fields;
}

void sf_model_free(sf_model *model) {
    for (size_t k = 0; k < sizeof fields / sizeof fields[0]; k++)
        if (fields[k].rows_offset != SIZE_MAX)
            free(*(void **)((char *)model + fields[k].offset));
    memset(model, 0, sizeof *model);
}

void sf_model_drop_mesh(sf_model *model) {
    free(model->cell_type);
    free(model->cell_ptr);
    free(model->cell_node);
    model->cell_type = NULL;
    model->cell_ptr = NULL;
    model->cell_node = NULL;
    model->cell_count = model->cell_nnz = 0;
}

void sf_model_drop_domain_nodes(sf_model *model) {
    free(model->domain_node);
    free(model->support);
    model->domain_node = NULL;
    model->support = NULL;
}

void sf_model_drop_edges(sf_model *model) {
    free(model->edge_ptr);
    free(model->edge_node);
    model->edge_ptr = NULL;
    model->edge_node = NULL;
}

/* Is i in an ascending list, in which *next is the first that is not below an earlier i? */
static bool is_next(const int32_t *list, int64_t count, int64_t i, int64_t *next) {
    while (*next < count && list[*next] < i)
        ++*next;
    return *next < count && list[*next] == i;
}

/* A block that cannot be made smaller stays as it is. */
static void *shrink(void *block, size_t size) {
    void *smaller = realloc(block, size > 0 ? size : 1);
    return smaller ? smaller : block;
}

void sf_model_drop_inner_shapes(sf_model *m) {
    int64_t count = 0, begin = 0, next_fixed = 0, next_contact = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        bool held = is_next(m->fixed_node, m->fixed_count, i, &next_fixed);
        bool touched = is_next(m->contact_node, m->contact_count, i, &next_contact);
        int64_t end = m->phi_ptr[i + 1], length = held || touched ? end - begin : 0;
        memmove(&m->phi_node[count], &m->phi_node[begin], (size_t)length * sizeof *m->phi_node);
        memmove(&m->phi_value[count], &m->phi_value[begin], (size_t)length * sizeof *m->phi_value);
        begin = end;
        count += length;
        m->phi_ptr[i + 1] = count;
    }
    m->phi_nnz = count;
    m->phi_node = shrink(m->phi_node, (size_t)count * sizeof *m->phi_node);
    m->phi_value = shrink(m->phi_value, (size_t)count * sizeof *m->phi_value);
}
