/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/model.h"

#include "base/mat3.h"
#include "material/low_density_foam.h"

#define TABLE(member, type, rows, columns, path, units, text)                                                \
    { offsetof(sf_model, member), type, offsetof(sf_model, rows), 0, columns, path, units, text, false }
#define ARRAY(member, type, rows, path, units, text) TABLE(member, type, rows, 1, path, units, text)
/* The starts of rows: one more than there are rows. */
#define STARTS(member, rows, path, text)                                                                     \
    { offsetof(sf_model, member), I64, offsetof(sf_model, rows), 1, 1, path, "1", text, false }
#define SCALAR(member, type, path, units, text)                                                              \
    { offsetof(sf_model, member), type, SIZE_MAX, 0, 1, path, units, text, false }
#define LATER_SCALAR(member, type, path, units, text)                                                        \
    { offsetof(sf_model, member), type, SIZE_MAX, 0, 1, path, units, text, true }
#define F64 SF_H5_F64
#define I32 SF_H5_I32
#define I64 SF_H5_I64
#define U8 SF_H5_U8

static const sf_model_field fields[] = {
    SCALAR(node_count, I64, "/cloud/count", "1", "number of nodes"),
    TABLE(position, F64, node_count, 3, "/cloud/position", "m", "reference position X"),
    ARRAY(volume, F64, node_count, "/cloud/volume", "m3", "volume of the smoothing domain"),
    ARRAY(mass, F64, node_count, "/cloud/mass", "kg", "lumped mass"),
    ARRAY(spacing, F64, node_count, "/cloud/spacing", "m", "nodal spacing h"),
    ARRAY(support, F64, node_count, "/cloud/support", "m", "kernel radius R"),
    ARRAY(node_material, U8, node_count, "/cloud/material", "1", "number of the material, ascending"),
    SCALAR(domain_nnz, I64, "/domain/count", "1", "number of (domain, node) pairs"),
    STARTS(domain_ptr, node_count, "/domain/ptr", "row starts of the smoothed gradient"),
    ARRAY(domain_node, I32, domain_nnz, "/domain/node", "1", "node J of each entry"),
    TABLE(domain_b, F64, domain_nnz, 3, "/domain/b", "m-1", "smoothed gradient of the shape function of J"),
    SCALAR(phi_nnz, I64, "/shape/count", "1", "number of (node, node) pairs"),
    STARTS(phi_ptr, node_count, "/shape/ptr", "row starts of the shape functions at the nodes"),
    ARRAY(phi_node, I32, phi_nnz, "/shape/node", "1", "node J of each entry"),
    ARRAY(phi_value, F64, phi_nnz, "/shape/value", "1", "shape function of J at node I"),
    SCALAR(edge_nnz, I64, "/edge/count", "1", "number of directed edges"),
    STARTS(edge_ptr, node_count, "/edge/ptr", "row starts of the edge adjacency"),
    ARRAY(edge_node, I32, edge_nnz, "/edge/node", "1", "node at the other end"),
    SCALAR(cell_count, I64, "/mesh/cell_count", "1", "number of background cells"),
    SCALAR(cell_nnz, I64, "/mesh/vertex_count", "1", "number of cell vertices"),
    ARRAY(cell_type, U8, cell_count, "/mesh/cell_type", "1", "XDMF topology code"),
    STARTS(cell_ptr, cell_count, "/mesh/cell_ptr", "start of each cell in cell_node"),
    ARRAY(cell_node, I32, cell_nnz, "/mesh/cell_node", "1", "vertices in VTK order"),
    SCALAR(fixed_count, I64, "/fixed/count", "1", "number of constrained nodes"),
    ARRAY(fixed_node, I32, fixed_count, "/fixed/node", "1", "constrained node"),
    ARRAY(fixed_mask, U8, fixed_count, "/fixed/mask", "1", "held components: bit 0 x, 1 y, 2 z"),
    ARRAY(fixed_base, U8, fixed_count, "/fixed/base", "1", "1: part of the base, 0: symmetry plane only"),
    SCALAR(contact_count, I64, "/contact/count", "1", "number of contact points"),
    ARRAY(contact_node, I32, contact_count, "/contact/node", "1",
          "node that the missile may touch: of pad.contact and of the other free faces"),
    ARRAY(contact_area, F64, contact_count, "/contact/area", "m2", "area of the surface that belongs to it"),
    LATER_SCALAR(contact_face_count, I64, "/contact/face_count", "1",
                 "faces that the missile's edges may press between nodes, 0: none"),
    TABLE(contact_face, I32, contact_face_count, 3, "/contact/face", "1",
          "their nodes, outwards; of a section two, counter-clockwise, and the first one again"),
    SCALAR(tie_count, I64, "/tie/count", "1", "number of ties between layers"),
    ARRAY(tie_node, I32, tie_count, "/tie/node", "1", "tied node"),
    ARRAY(tie_other, I32, tie_count, "/tie/other", "1", "node of another layer at the same place"),
    ARRAY(tie_mask, U8, tie_count, "/tie/mask", "1", "tied components: bit 0 x, 1 y, 2 z"),
    SCALAR(rest_count, I64, "/anvil/count", "1", "nodes that rest on the anvil, 0: the pad is held"),
    ARRAY(rest_node, I32, rest_count, "/anvil/node", "1", "node that rests on the anvil"),
    ARRAY(rest_load, F64, rest_count, "/anvil/load", "N", "its part of the weight of the modelled part"),
    LATER_SCALAR(skin_count, I64, "/skin/count", "1",
                 "triangles of the pad that may touch it or the anvil, 0: none"),
    TABLE(skin_triangle, I32, skin_count, 3, "/skin/triangle", "1", "their nodes, outwards"),
    LATER_SCALAR(skin_friction, F64, "/skin/friction", "1", "Coulomb coefficient between them"),
    LATER_SCALAR(skin_alone, I64, "/skin/alone", "1", "1: they touch the supports only"),
    LATER_SCALAR(skin_watched, I64, "/skin/watched", "1",
                 "1: they pass through each other, which ends the run"),
    LATER_SCALAR(support_count, I64, "/support/count", "1", "rigid supports"),
    LATER_SCALAR(support_node_count, I64, "/support/node_count", "1", "nodes of their surfaces"),
    LATER_SCALAR(support_triangle_count, I64, "/support/triangle_count", "1",
                 "triangles of them, 0: there are none"),
    TABLE(support_position, F64, support_node_count, 3, "/support/position", "m", "their positions"),
    TABLE(support_triangle, I32, support_triangle_count, 3, "/support/triangle", "1", "outward triangles"),
    ARRAY(support_part, U8, support_triangle_count, "/support/part", "1", "number of their support"),
    ARRAY(support_friction, F64, support_count, "/support/friction", "1",
          "Coulomb coefficient of the pad against each support"),
    LATER_SCALAR(support_travel, F64, "/support/travel", "m",
                 "of the missile along its direction until it touches a support, 0: never"),
    LATER_SCALAR(membrane_count, I64, "/membrane/count", "1", "triangles of the membrane, 0: there is none"),
    TABLE(membrane_triangle, I32, membrane_count, 3, "/membrane/triangle", "1", "their nodes"),
    ARRAY(membrane_share, F64, membrane_count, "/membrane/share", "1",
          "part of the thickness: 0.5 of the triangles on both diagonals of a quadrangle"),
    LATER_SCALAR(membrane.modulus, F64, "/membrane/modulus", "Pa", "Young's modulus"),
    LATER_SCALAR(membrane.poisson, F64, "/membrane/poisson", "1", "Poisson's ratio"),
    LATER_SCALAR(membrane.thickness, F64, "/membrane/thickness", "m", "thickness"),
    LATER_SCALAR(membrane.density, F64, "/membrane/density", "kg m-3", "density"),
    LATER_SCALAR(membrane.fabric, I64, "/membrane/fabric", "1", "1: no compression"),
    SCALAR(anvil.depth, F64, "/anvil/depth", "m",
           "of the anvil below the undeformed pad's top, 0: there is none"),
    SCALAR(anvil.friction, F64, "/anvil/friction", "1", "Coulomb coefficient against a resting pad"),
    SCALAR(surface_node_count, I64, "/missile/surface_node_count", "1", "nodes of the missile's surface"),
    SCALAR(surface_triangle_count, I64, "/missile/surface_triangle_count", "1", "triangles of it"),
    TABLE(surface_position, F64, surface_node_count, 3, "/missile/surface_position", "m",
          "position at t = 0"),
    TABLE(surface_triangle, I32, surface_triangle_count, 3, "/missile/surface_triangle", "1",
          "outward triangles"),
    SCALAR(motion_count, I64, "/missile/motion_count", "1", "points of the prescribed motion, 0: none"),
    ARRAY(motion_time, F64, motion_count, "/missile/motion_time", "s", "times of the prescribed motion"),
    ARRAY(motion_displacement, F64, motion_count, "/missile/motion_displacement", "m",
          "displacement along the direction at these times"),
    SCALAR(frame_time_count, I64, "/run/frame_time_count", "1", "number of further frames"),
    ARRAY(frame_time, F64, frame_time_count, "/run/frame_time", "s", "times of further frames"),
    SCALAR(symmetry_factor, I64, "/model/symmetry_factor", "1", "modelled parts that make the whole"),
    SCALAR(thickness, F64, "/model/thickness", "m",
           "foam under the contact, along the missile's path, its vertical part"),
    LATER_SCALAR(air, F64, "/model/air", "m", "gaps on the same way, which close first"),
    SCALAR(expected_mesh_error, F64, "/model/expected_mesh_error", "1",
           "expected relative error of a_max by the mesh, 0: not estimated"),
    SCALAR(slit_fraction, F64, "/model/slit_fraction", "1",
           "part of the nodes that lie at a slit, hole or gap narrower than their supports"),
    SCALAR(material_count, I64, "/material/count", "1", "number of materials"),
    SCALAR(missile.mass, F64, "/missile/mass", "kg", "mass of the whole missile"),
    SCALAR(missile.speed, F64, "/missile/speed", "m s-1", "speed at first contact"),
    SCALAR(missile.direction[0], F64, "/missile/direction_x", "1", "direction of motion, x"),
    SCALAR(missile.direction[1], F64, "/missile/direction_y", "1", "direction of motion, y"),
    SCALAR(missile.direction[2], F64, "/missile/direction_z", "1", "direction of motion, z"),
    SCALAR(missile.friction, F64, "/missile/friction", "1", "Coulomb coefficient"),
    SCALAR(missile.gravity, F64, "/missile/gravity", "m s-2", "on the missile"),
    LATER_SCALAR(missile.down[0], F64, "/missile/gravity_x", "1", "its direction, x; without it: -z"),
    LATER_SCALAR(missile.down[1], F64, "/missile/gravity_y", "1", "its direction, y"),
    LATER_SCALAR(missile.down[2], F64, "/missile/gravity_z", "1", "its direction, z"),
    SCALAR(missile.gap, F64, "/missile/gap", "m", "distance from the pad at t = 0"),
    SCALAR(missile.clearance, F64, "/missile/clearance", "m",
           "height of its lowest point above the undeformed pad's top at t = 0"),
    SCALAR(missile.impact_known, I64, "/missile/impact_known", "1", "1: the next two are the impact point"),
    SCALAR(missile.impact[0], F64, "/missile/impact_x", "m",
           "where the missile's lowest point arrives at the pad's top, x"),
    SCALAR(missile.impact[1], F64, "/missile/impact_y", "m", "the same, y"),
    SCALAR(missile.shape, I64, "/missile/shape", "1", "0 exact sphere cap, 1 triangulated surface"),
    SCALAR(missile.sphere_centre[0], F64, "/missile/sphere_centre_x", "m", "centre at t = 0, x"),
    SCALAR(missile.sphere_centre[1], F64, "/missile/sphere_centre_y", "m", "centre at t = 0, y"),
    SCALAR(missile.sphere_centre[2], F64, "/missile/sphere_centre_z", "m", "centre at t = 0, z"),
    SCALAR(missile.sphere_radius, F64, "/missile/sphere_radius", "m", "radius"),
    SCALAR(missile.sphere_cap_cosine, F64, "/missile/sphere_cap_cosine", "1", "cosine that bounds the cap"),
    SCALAR(missile.freedom, I64, "/missile/freedom", "1", "0 guided along its direction, 1 free"),
    SCALAR(missile.centre[0], F64, "/missile/centre_x", "m", "centre of mass at t = 0, x; of a free missile"),
    SCALAR(missile.centre[1], F64, "/missile/centre_y", "m", "centre of mass at t = 0, y"),
    SCALAR(missile.centre[2], F64, "/missile/centre_z", "m", "centre of mass at t = 0, z"),
    SCALAR(missile.inertia[0], F64, "/missile/inertia_xx", "kg m2",
           "tensor of inertia about the centre of mass"),
    SCALAR(missile.inertia[1], F64, "/missile/inertia_yy", "kg m2", "tensor of inertia"),
    SCALAR(missile.inertia[2], F64, "/missile/inertia_zz", "kg m2", "tensor of inertia"),
    SCALAR(missile.inertia[3], F64, "/missile/inertia_xy", "kg m2",
           "tensor of inertia, - integral of x y dm"),
    SCALAR(missile.inertia[4], F64, "/missile/inertia_yz", "kg m2",
           "tensor of inertia, - integral of y z dm"),
    SCALAR(missile.inertia[5], F64, "/missile/inertia_xz", "kg m2",
           "tensor of inertia, - integral of x z dm"),
    SCALAR(missile.angular_velocity[0], F64, "/missile/angular_velocity_x", "rad s-1", "at t = 0, x"),
    SCALAR(missile.angular_velocity[1], F64, "/missile/angular_velocity_y", "rad s-1", "at t = 0, y"),
    SCALAR(missile.angular_velocity[2], F64, "/missile/angular_velocity_z", "rad s-1", "at t = 0, z"),
    SCALAR(run.end_time, F64, "/run/end_time", "s", "end of the simulated time"),
    SCALAR(run.step_safety, F64, "/run/step_safety", "1", "fraction of the stability limit"),
    SCALAR(run.step_limit, F64, "/run/step_limit", "s", "largest time step"),
    LATER_SCALAR(run.speed_scatter, F64, "/run/speed_scatter", "1",
                 "standard deviation of the missile's speed over it"),
    LATER_SCALAR(run.thickness_tolerance, F64, "/run/thickness_tolerance", "m",
                 "standard deviation of the pad's thickness"),
    LATER_SCALAR(run.temperature, F64, "/run/temperature", "K",
                 "of the pad, to which the materials are taken; 0: not given"),
    LATER_SCALAR(series_count, I64, "/series/count", "1", "drops of a series on one pad; 0: a single drop"),
    ARRAY(series_interval, F64, series_count, "/series/interval", "s",
          "from the drop before to each; 0 of the first"),
    ARRAY(series_model, I64, series_count, "/series/model", "1",
          "hash of a model of its own, NAME-2.h5 of the second; 0: it is this one"),
    SCALAR(run.stabilisation, F64, "/run/stabilisation", "1", "stabilisation coefficient"),
    SCALAR(run.energy_limit, F64, "/run/energy_limit", "1", "energy error that stops the run"),
    SCALAR(run.frame_interval, F64, "/run/frame_interval", "s", "time between frames"),
    SCALAR(run.output_fields, I64, "/run/output_fields", "1", "bits of the fields in a frame"),
    SCALAR(run.stop_after_rebound, I64, "/run/stop_after_rebound", "1", "1: end when the missile has left"),
    SCALAR(run.kinematic, I64, "/run/kinematic", "1",
           "figures of 0: the specific force, as an accelerometer reads it; 1: the kinematic acceleration"),
    LATER_SCALAR(pair_count, I64, "/skin/pair_count", "1",
                 "pairs of materials between whose faces the friction is another, 0: there are none"),
    TABLE(pair_layer, U8, pair_count, 2, "/skin/pair_layer", "1", "numbers of their materials, ascending"),
    ARRAY(pair_friction, F64, pair_count, "/skin/pair_friction", "1", "Coulomb coefficient between them"),
    ARRAY(skin_half, U8, skin_count, "/skin/half", "1",
          "1, 2: halves of a quadrangle, its nodes 0, 1, 2 and 0, 2, 3; 0: a triangle"),
    /* New fields stand at the end: their number is part of the hash of a model. */
    LATER_SCALAR(skin_centroids, I64, "/skin/centroids", "1",
                 "1: their centroids are points of contact, too, unless they are halves"),
    LATER_SCALAR(axisymmetric, I64, "/model/axisymmetric", "1",
                 "1: a plane section, x the radius and y = 0; B is then (b_R, b_theta, b_Z)"),
#define REFERENCE(member, units, text)                                                                       \
    LATER_SCALAR(section.member, F64, "/model/section/" #member, units, text),
    SF_SECTION_DROP(REFERENCE)
#undef REFERENCE
};

const sf_model_field *sf_model_fields(size_t *count) {
    *count = sizeof fields / sizeof fields[0];
    return fields;
}

double sf_model_whole(const sf_model *model) {
    return (double)model->symmetry_factor;
}

void sf_model_series_file(const char *first, int64_t drop, char *path, size_t size) {
    size_t length = strlen(first);
    const char *end = length > 3 && strcmp(first + length - 3, ".h5") == 0 ? ".h5" : "";
    if (drop > 1)
        snprintf(path, size, "%.*s-%lld%s", (int)(length - strlen(end)), first, (long long)drop, end);
    else
        snprintf(path, size, "%s", first);
}

bool sf_missile_is_driven(const sf_model *model) {
    return model->motion_count > 0;
}

bool sf_missile_turns(const sf_model *model) {
    return model->missile.freedom == SF_MISSILE_FREE;
}

bool sf_missile_inertia_is_possible(const double inertia[6], double principal[3]) {
    static const double SLACK = 1e-9; /* a thin plate's moments are equal to the sum */
    const double negative[6] = {-inertia[0], -inertia[1], -inertia[2], -inertia[3], -inertia[4], -inertia[5]};
    principal[2] = sf_sym3_largest(inertia);
    principal[0] = -sf_sym3_largest(negative);
    principal[1] = inertia[0] + inertia[1] + inertia[2] - principal[0] - principal[2];
    return principal[0] > 1e-9 * principal[2] && principal[2] <= (1 + SLACK) * (principal[0] + principal[1]);
}

double sf_missile_card_depth(const sf_missile_card *card, double displacement) {
    return -card->direction[2] * displacement - card->clearance;
}

double sf_model_informed_strain(const sf_model *model) {
    double least = INFINITY;
    for (int64_t k = 0; k < model->material_count; k++)
        least = fmin(least, sf_material_informed(&model->material[k]));
    return least;
}

double sf_model_lock_up(const sf_model *model, double *begin) {
    static const double BENDS = 0.95; /* of the pole, of a table that reaches farther */
    *begin = NAN;
    /* by name: the two shared libraries each have the laws at addresses of their own */
    if (model->material_count != 1 || strcmp(model->material[0].law->name, sf_low_density_foam.name) != 0)
        return NAN;
    const sf_foam_card *card = sf_foam_card_of(&model->material[0]);
    double pole = card->densification_limit, start = card->densification_start;
    if (!(pole < 1))
        return NAN;
    *begin = fmin(BENDS * pole, start > 0 ? start : card->curves.curve_strain[card->curves.curve_points - 1]);
    return pole;
}

double sf_model_density(const sf_model *model) {
    double mass = 0, volume = 0;
    if (model->material_count == 1)
        return sf_material_density(&model->material[0]);
    for (int64_t i = 0; i < model->node_count; i++) {
        mass += model->mass[i];
        volume += model->volume[i];
    }
    return mass / volume;
}

sf_status sf_model_take_materials(sf_model *model, sf_material *material, int count, sf_error *err) {
    if (!model->node_material)
        model->node_material = sf_alloc(err, model->node_count, 1, "materials of the nodes");
    model->material = sf_alloc(err, count, sizeof *model->material, "materials");
    SF_TRY(err->status);
    model->material_count = count;
    memcpy(model->material, material, (size_t)count * sizeof *material);
    memset(material, 0, (size_t)count * sizeof *material);
    return SF_OK;
}

static size_t item_bytes(const sf_model_field *field) {
    static const size_t bytes[] = {[F64] = 8, [I32] = 4, [I64] = 8, [U8] = 1};
    return (size_t)field->columns * bytes[field->type];
}

sf_status sf_model_copy(const sf_model *from, sf_model *out, sf_error *err) {
    *out = *from;
    out->material = sf_alloc(err, from->material_count, sizeof *out->material, "materials");
    for (size_t k = 0; k < sizeof fields / sizeof fields[0]; k++) {
        const sf_model_field *f = &fields[k];
        if (f->rows_offset == SIZE_MAX)
            continue;
        void **array = (void **)((char *)out + f->offset);
        const void *old = *array;
        int64_t rows = *(const int64_t *)((const char *)from + f->rows_offset) + f->rows_extra;
        *array = old ? sf_alloc(err, rows, item_bytes(f), "a model") : NULL;
        if (*array)
            memcpy(*array, old, (size_t)rows * item_bytes(f));
    }
    for (int64_t k = 0; err->status == SF_OK && k < from->material_count; k++)
        sf_material_copy(&from->material[k], &out->material[k], err);
    if (err->status != SF_OK)
        sf_model_free(out);
    return err->status;
}

void sf_model_free(sf_model *model) {
    for (int64_t k = 0; model->material && k < model->material_count; k++)
        sf_material_free(&model->material[k]);
    for (size_t k = 0; k < sizeof fields / sizeof fields[0]; k++)
        if (fields[k].rows_offset != SIZE_MAX)
            free(*(void **)((char *)model + fields[k].offset));
    SF_CLEAR(model, model->material, model->set);
}

void sf_model_drop_mesh(sf_model *model) {
    sf_release(&model->cell_type);
    sf_release(&model->cell_ptr);
    sf_release(&model->cell_node);
    model->cell_count = model->cell_nnz = 0;
}

void sf_model_drop_domain_nodes(sf_model *model) {
    sf_release(&model->domain_node);
    sf_release(&model->support);
}

void sf_model_drop_edges(sf_model *model) {
    sf_release(&model->edge_ptr);
    sf_release(&model->edge_node);
}

/* The nodes of such a plane are held along its normal, but not as part of the base. */
bool sf_symmetry_plane(const sf_model *m, int axis, double *place) {
    for (int64_t k = 0; k < m->fixed_count; k++)
        if (!m->fixed_base[k] && m->fixed_mask[k] & (1 << axis)) {
            *place = m->position[3 * (int64_t)m->fixed_node[k] + axis];
            return true;
        }
    *place = 0;
    return false;
}

bool sf_model_skin_is_quadrangle(const sf_model *m, int64_t k) {
    const int32_t *one = &m->skin_triangle[3 * (k - 1)], *two = &m->skin_triangle[3 * k];
    return m->skin_half[k - 1] == 1 && m->skin_half[k] == 2 && one[0] == two[0] && one[2] == two[1];
}

double sf_model_friction(const sf_model *m, int one, int other) {
    int low = one < other ? one : other, high = one < other ? other : one;
    for (int64_t k = 0; k < m->pair_count; k++)
        if (m->pair_layer[2 * k] == low && m->pair_layer[2 * k + 1] == high)
            return m->pair_friction[k];
    return m->skin_friction;
}

int64_t sf_model_skin_triangles(const sf_model *m) {
    int64_t count = m->skin_count;
    for (int64_t k = 1; k < m->skin_count; k++)
        count -= 2 * sf_model_skin_is_quadrangle(m, k);
    return count;
}

int64_t sf_model_skin_centroids(const sf_model *m) {
    return m->skin_centroids && !m->skin_alone ? sf_model_skin_triangles(m) : 0;
}
