/* SPDX-License-Identifier: GPL-3.0-or-later */

#include "model/model_check.h"

#include "base/hash.h"
#include "base/sets.h"
#include "base/mat3.h"
#include "io/h5_data.h"
#include "model/cells.h"

#include "model/flight.h"
#include "model/motion.h"

typedef struct csr {
    const char *name;
    int64_t rows, nnz;
    const int64_t *ptr;   /* [rows + 1] */
    const int32_t *index; /* [nnz] */
} csr;

/* Monotone pointers from 0 to nnz, indices in [0, limit), rows strictly ascending. */
static sf_status check_csr(csr list, int64_t limit, bool ascending, sf_error *err) {
    const char *name = list.name;
    int64_t rows = list.rows, nnz = list.nnz;
    const int64_t *ptr = list.ptr;
    const int32_t *index = list.index;
    if (ptr[0] != 0 || ptr[rows] != nnz)
        return SF_FAIL(err, SF_ERR_MODEL, "%s: row starts run from %lld to %lld, not from 0 to %lld", name,
                       (long long)ptr[0], (long long)ptr[rows], (long long)nnz);
    for (int64_t i = 0; i < rows; i++)
        if (ptr[i + 1] < ptr[i] || ptr[i + 1] > nnz)
            return SF_FAIL(err, SF_ERR_MODEL, "%s: row %lld ends before it starts", name, (long long)i);
    for (int64_t i = 0; i < rows; i++)
        for (int64_t k = ptr[i]; k < ptr[i + 1]; k++) {
            if (index[k] < 0 || index[k] >= limit)
                return SF_FAIL(err, SF_ERR_MODEL, "%s: row %lld: a node" SF_OUTSIDE("%d", "0", "%lld"), name,
                               (long long)i, index[k], (long long)limit - 1);
            if (ascending && k > ptr[i] && index[k] <= index[k - 1])
                return SF_FAIL(err, SF_ERR_MODEL, "%s: row %lld is not in ascending order", name,
                               (long long)i);
        }
    return SF_OK;
}

static sf_status check_set(const char *name, int64_t count, const int32_t *node, int64_t limit,
                           sf_error *err) {
    for (int64_t k = 0; k < count; k++)
        if (node[k] < 0 || node[k] >= limit || (k > 0 && node[k] <= node[k - 1]))
            return SF_FAIL(err, SF_ERR_MODEL, "%s: entry %lld (node %d) is out of range or out of order",
                           name, (long long)k, node[k]);
    return SF_OK;
}

static sf_status check_finite(const sf_model *model, sf_error *err) {
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    for (size_t k = 0; k < count; k++) {
        if (field[k].type != SF_H5_F64)
            continue;
        const char *base = (const char *)model;
        bool scalar = field[k].rows_offset == SIZE_MAX;
        int64_t rows = scalar ? 1 : *(const int64_t *)(base + field[k].rows_offset) + field[k].rows_extra;
        const double *data =
            scalar ? (const double *)(base + field[k].offset) : *(double *const *)(base + field[k].offset);
        for (int64_t i = 0; i < rows * field[k].columns; i++)
            if (!isfinite(data[i]))
                return SF_FAIL(err, SF_ERR_MODEL, "%s: entry %lld is not finite", field[k].path,
                               (long long)i);
    }
    return SF_OK;
}

static sf_status check_bound(const char *name, double value, double low, double high, sf_error *err) {
    if (!(value >= low && value <= high))
        return SF_FAIL(err, SF_ERR_MODEL, "%s" SF_OUTSIDE("%g", "%g", "%g"), name, value, low, high);
    return SF_OK;
}

/* Fails if one of the bytes is above `most`; the number of the byte follows `name` in the sentence. */
static sf_status check_bytes(const char *name, int64_t count, const uint8_t *byte, int64_t most,
                             sf_error *err) {
    for (int64_t k = 0; k < count; k++)
        if (byte[k] > most)
            return SF_FAIL(err, SF_ERR_MODEL, "%s %lld" SF_OUTSIDE("%d", "0", "%lld"), name, (long long)k,
                           byte[k], (long long)most);
    return SF_OK;
}

static sf_status check_materials(const sf_model *m, sf_error *err) {
    if (m->material_count < 1 || m->material_count > SF_MATERIAL_MAX)
        return SF_FAIL(err, SF_ERR_MODEL, "the number of materials" SF_OUTSIDE("%lld", "1", "%d"),
                       (long long)m->material_count, SF_MATERIAL_MAX);
    for (int64_t k = 0; k < m->material_count; k++)
        SF_TRY(sf_material_check(&m->material[k], k, err));
    SF_TRY(check_bytes("material of node", m->node_count, m->node_material, m->material_count - 1, err));
    for (int64_t i = 1; i < m->node_count; i++)
        if (m->node_material[i] < m->node_material[i - 1])
            return SF_FAIL(err, SF_ERR_MODEL,
                           "node %lld is of material %d, after one of %d: they must ascend", (long long)i,
                           m->node_material[i], m->node_material[i - 1]);
    return SF_OK;
}

static sf_status check_motion(const sf_model *m, sf_error *err) {
    int64_t last = m->motion_count - 1;
    if (m->motion_count == 0)
        return SF_OK;
    if (m->motion_count < 2 || m->motion_time[0] != 0 || m->motion_displacement[0] != 0)
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the missile's motion has %lld points; it needs 2, the first (0, 0)",
                       (long long)m->motion_count);
    for (int64_t k = 1; k <= last; k++)
        if (!(m->motion_time[k] > m->motion_time[k - 1]))
            return SF_FAIL(err, SF_ERR_MODEL, "the missile's motion: the times do not ascend at %g s",
                           m->motion_time[k]);
    if (!(m->run.end_time <= m->motion_time[last] * (1 + SF_MOTION_SLACK)))
        return SF_FAIL(err, SF_ERR_MODEL,
                       "the end time %g s lies beyond the missile's motion, which ends at %g s",
                       m->run.end_time, m->motion_time[last]);
    return check_bound("largest speed of the missile's motion (m/s)", sf_motion_measure(m).speed, 1e-9,
                       SF_MOTION_MAX_SPEED, err);
}

static sf_status check_freedom(const sf_model *m, sf_error *err) {
    const sf_missile_card *card = &m->missile;
    double p[3];
    if (card->freedom == SF_MISSILE_GUIDED)
        return SF_OK;
    if (sf_missile_is_driven(m) || m->symmetry_factor != 1)
        return SF_FAIL(err, SF_ERR_MODEL, "a free missile cannot be driven, nor be 1/%lld of the whole",
                       (long long)m->symmetry_factor);
    if (!sf_missile_inertia_is_possible(card->inertia, p))
        return SF_FAIL(
            err, SF_ERR_MODEL,
            "the missile's inertia has the principal moments %g, %g and %g kg m2: no body has them", p[0],
            p[1], p[2]);
    for (int c = 0; c < 3; c++) {
        SF_TRY(check_bound("place of the missile's centre (m)", card->centre[c], -2e3, 2e3, err));
        SF_TRY(check_bound("angular velocity of the missile (rad/s)", card->angular_velocity[c], -1e3, 1e3,
                           err));
    }
    return SF_OK;
}

static sf_status check_cards(const sf_model *m, sf_error *err) {
    bool driven = sf_missile_is_driven(m);
    const struct {
        const char *name;
        double value, low, high;
    } bound[] = {
        {"missile mass (kg)", m->missile.mass, driven ? 0 : 1e-9, driven ? 0 : 1e9},
        {"missile speed (m/s)", m->missile.speed, driven ? 0 : 1e-9, driven ? 0 : 200},
        {"missile friction", m->missile.friction, 0, 10},
        {"missile gravity (m/s2)", m->missile.gravity, 0, driven ? 0 : 1e4},
        {"missile gap (m)", m->missile.gap, 0, 1e3},
        {"missile clearance (m)", m->missile.clearance, -1e3, 1e3},
        {"knowledge of the impact point", (double)m->missile.impact_known, 0, 1},
        {"missile shape", (double)m->missile.shape, 0, 1},
        {"missile freedom", (double)m->missile.freedom, 0, 1},
        {"missile sphere radius (m)", m->missile.sphere_radius, m->missile.shape ? 0 : 1e-9, 1e3},
        {"missile sphere cap cosine", m->missile.sphere_cap_cosine, -1 - 1e-9, 1 + 1e-9},
        {"anvil depth (m)", m->anvil.depth, 0, 1e3},
        {"skin friction", m->skin_friction, 0, 10},
        {"skin alone", (double)m->skin_alone, 0, 1},
        {"skin centroids", (double)m->skin_centroids, 0, 1},
        {"skin watched", (double)m->skin_watched, 0, (double)m->skin_alone},
        {"membrane modulus (Pa)", m->membrane.modulus, m->membrane_count > 0 ? 1e-9 : 0, 1e12},
        {"membrane Poisson's ratio", m->membrane.poisson, 0, 0.5},
        {"membrane thickness (m)", m->membrane.thickness, m->membrane_count > 0 ? 1e-12 : 0, 1},
        {"membrane density (kg/m3)", m->membrane.density, 0, 1e5},
        {"fabric membrane", (double)m->membrane.fabric, 0, 1},
        {"number of supports", (double)m->support_count, m->support_triangle_count > 0, SF_SUPPORTS},
        {"missile's way to the support (m)", m->support_travel, 0, 1e6},
        {"anvil friction", m->anvil.friction, 0, 10},
        {"axisymmetric model", (double)m->axisymmetric, 0, m->symmetry_factor == 1},
        {"symmetry factor", (double)m->symmetry_factor, 1, 4},
        {"pad thickness (m)", m->thickness, 1e-6, 1e3},
        {"air below the missile (m)", m->air, 0, 1e3},
        {"expected mesh error", m->expected_mesh_error, 0, 1e6},
        {"a_max of the section (g)", m->section.a_max_g, 0, 1e9},
        {"HIC of the section", m->section.hic, 0, 1e15},
        {"indentation of the section (m)", m->section.indentation, 0, 1e3},
        {"uncertainty of the section's a_max", m->section.a_max_error, 0, 1e6},
        {"uncertainty of the section's HIC", m->section.hic_error, 0, 1e6},
        {"uncertainty of the section's indentation", m->section.indentation_error, 0, 1e6},
        {"change of a_max by the speed", m->section.a_max_by_speed, -1, 1e6},
        {"change of HIC by the speed", m->section.hic_by_speed, -1, 1e6},
        {"change of a_max by the thickness", m->section.a_max_by_thickness, -1, 1e6},
        {"change of HIC by the thickness", m->section.hic_by_thickness, -1, 1e6},
        {"slit fraction", m->slit_fraction, 0, 1},
        {"end time (s)", m->run.end_time, 1e-9, 1e3},
        {"step safety", m->run.step_safety, 1e-3, 1},
        {"step limit (s)", m->run.step_limit, 1e-12, 1e3},
        {"stabilisation coefficient", m->run.stabilisation, 0, 10},
        {"energy limit", m->run.energy_limit, 1e-9, 1e9},
        {"temperature (K)", m->run.temperature, 0, 600},
        {"drops of a series", (double)m->series_count, 0, SF_SERIES_MOST},
        {"frame interval (s)", m->run.frame_interval, 1e-9, 1e3},
        {"number of frames", m->run.end_time / m->run.frame_interval, 0, SF_MOST_FRAMES},
    };
    for (size_t k = 0; k < sizeof bound / sizeof bound[0]; k++)
        SF_TRY(check_bound(bound[k].name, bound[k].value, bound[k].low, bound[k].high, err));
    for (int64_t k = 1; k < m->series_count; k++)
        SF_TRY(check_bound("interval of a series (s)", m->series_interval[k], 1e-3, 1e7, err));
    if (m->symmetry_factor == 3)
        return SF_FAIL(err, SF_ERR_MODEL, "the symmetry factor is 3; 1, 2 and 4 are possible");
    double length = sf_dot3(m->missile.direction, m->missile.direction);
    if (fabs(length - 1) > 1e-9)
        return SF_FAIL(err, SF_ERR_MODEL, "missile direction has length %g, expected 1", sqrt(length));
    double down = sf_dot3(m->missile.down, m->missile.down);
    if (down != 0 && fabs(down - 1) > 1e-9)
        return SF_FAIL(err, SF_ERR_MODEL, "the direction of gravity has length %g, expected 1", sqrt(down));
    if (!isfinite(sf_flight_time(&m->missile)))
        return SF_FAIL(err, SF_ERR_MODEL,
                       "a fall over the missile's gap of %g m makes it faster than its %g m/s",
                       m->missile.gap, m->missile.speed);
    if (check_motion(m, err) != SF_OK || check_freedom(m, err) != SF_OK)
        return err->status;
    return check_materials(m, err);
}

static sf_status check_surface(const char *name, int64_t count, const int32_t *triangle, int64_t nodes,
                               sf_error *err) {
    for (int64_t k = 0; k < 3 * count; k++)
        if (triangle[k] < 0 || triangle[k] >= nodes)
            return SF_FAIL(err, SF_ERR_MODEL, "%s triangle %lld: a node" SF_OUTSIDE("%d", "0", "%lld"), name,
                           (long long)k / 3, triangle[k], (long long)nodes - 1);
    return SF_OK;
}

static sf_status check_supports(const sf_model *m, sf_error *err) {
    SF_TRY(
        check_surface("support", m->support_triangle_count, m->support_triangle, m->support_node_count, err));
    SF_TRY(check_bytes("support of triangle", m->support_triangle_count, m->support_part,
                       m->support_count - 1, err));
    for (int64_t k = 0; k < m->support_count; k++)
        SF_TRY(check_bound("support friction", m->support_friction[k], 0, 10, err));
    return SF_OK;
}

static sf_status check_pairs(const sf_model *m, sf_error *err) {
    for (int64_t k = 0; k < m->pair_count; k++) {
        const uint8_t *layer = &m->pair_layer[2 * k];
        if (layer[0] >= layer[1] || layer[1] >= m->material_count)
            return SF_FAIL(err, SF_ERR_MODEL,
                           "a pair is of the materials %d and %d: two of 0 to %lld, ascending", layer[0],
                           layer[1], (long long)m->material_count - 1);
        SF_TRY(check_bound("friction of a pair", m->pair_friction[k], 0, 10, err));
    }
    return SF_OK;
}

static sf_status check_mesh(const sf_model *m, sf_error *err) {
    SF_TRY(check_csr((csr){"background cells", m->cell_count, m->cell_nnz, m->cell_ptr, m->cell_node},
                     m->node_count, false, err));
    for (int64_t c = 0; c < m->cell_count; c++) {
        const sf_cell_shape *shape = sf_cell_shape_of(m->cell_type[c]);
        if (!shape || sf_cell_is_plane(shape) != (m->axisymmetric != 0) ||
            m->cell_ptr[c + 1] - m->cell_ptr[c] != shape->vertices)
            return SF_FAIL(err, SF_ERR_MODEL, "background cell %lld has type %d and %lld vertices",
                           (long long)c, m->cell_type[c], (long long)(m->cell_ptr[c + 1] - m->cell_ptr[c]));
    }
    return check_surface("missile", m->surface_triangle_count, m->surface_triangle, m->surface_node_count,
                         err);
}

/* Triangles of three different nodes of the cloud. */
static sf_status check_triangles(const char *name, const sf_model *m, int64_t count, const int32_t *triangle,
                                 sf_error *err) {
    for (int64_t k = 0; k < 3 * count; k++) {
        const int32_t *node = &triangle[k - k % 3];
        if (triangle[k] < 0 || triangle[k] >= m->node_count || node[0] == node[1] || node[1] == node[2] ||
            node[2] == node[0])
            return SF_FAIL(err, SF_ERR_MODEL,
                           "triangle %lld of the %s has the nodes %d, %d, %d: three of 0 to %lld are needed",
                           (long long)k / 3, name, node[0], node[1], node[2], (long long)m->node_count - 1);
    }
    return SF_OK;
}

/* Every node of a contact face is a contact point; a side of a section ends with its first node again. */
static sf_status check_faces(const sf_model *m, sf_error *err) {
    if (!m->axisymmetric)
        SF_TRY(check_triangles("contact's face", m, m->contact_face_count, m->contact_face, err));
    for (int64_t k = 0; k < 3 * m->contact_face_count; k++) {
        const int32_t *face = &m->contact_face[k - k % 3];
        if (m->axisymmetric && (face[0] == face[1] || face[0] != face[2]))
            return SF_FAIL(err, SF_ERR_MODEL,
                           "contact face %lld of a section has the nodes %d, %d, %d: two, and the first one "
                           "again, are needed",
                           (long long)k / 3, face[0], face[1], face[2]);
        int64_t at = sf_list_find(m->contact_node, 0, m->contact_count, m->contact_face[k]);
        if (at == m->contact_count || m->contact_node[at] != m->contact_face[k])
            return SF_FAIL(err, SF_ERR_MODEL, "contact face %lld has node %d, which is no contact point",
                           (long long)k / 3, m->contact_face[k]);
    }
    return SF_OK;
}

static sf_status check_areas(const sf_model *m, sf_error *err) {
    for (int64_t k = 0; k < m->contact_count; k++)
        if (!(m->contact_area[k] >= 0))
            return SF_FAIL(err, SF_ERR_MODEL, "the area of contact point %lld is %g m2", (long long)k,
                           m->contact_area[k]);
    return SF_OK;
}

static sf_status check_loads(const sf_model *m, sf_error *err) {
    double sum = 0;
    for (int64_t k = 0; k < m->rest_count; k++) {
        if (!(m->rest_load[k] >= 0))
            return SF_FAIL(err, SF_ERR_MODEL, "the anvil's load on resting node %lld is %g N", (long long)k,
                           m->rest_load[k]);
        sum += m->rest_load[k];
    }
    if (m->rest_count > 0 && !(sum > 0))
        return SF_FAIL(err, SF_ERR_MODEL, "the pad rests on the anvil without weight");
    return SF_OK;
}

/* Nodes of a section lie in the half plane. */
static sf_status check_section(const sf_model *m, sf_error *err) {
    for (int64_t i = 0; m->axisymmetric && i < m->node_count; i++)
        if (!(m->position[3 * i] >= 0 && m->position[3 * i + 1] == 0))
            return SF_FAIL(
                err, SF_ERR_MODEL,
                "node %lld of the axisymmetric model lies at x = %g m, y = %g m: x must be 0 or more, "
                "y 0",
                (long long)i, m->position[3 * i], m->position[3 * i + 1]);
    return SF_OK;
}

static sf_status check_nodes(const sf_model *m, sf_error *err) {
    SF_TRY(check_section(m, err));
    for (int64_t i = 0; i < m->node_count; i++)
        if (!(m->volume[i] > 0 && m->mass[i] > 0 && m->spacing[i] > 0 && m->support[i] > 0))
            return SF_FAIL(err, SF_ERR_MODEL,
                           "node %lld has volume %g m3, mass %g kg, spacing %g m, support %g m: all must be "
                           "above 0",
                           (long long)i, m->volume[i], m->mass[i], m->spacing[i], m->support[i]);
    return SF_OK;
}

/* True if `node` is in row i of the edges, which ascends. */
static bool has_edge(const sf_model *m, int64_t i, int64_t node) {
    int64_t k = sf_list_find(m->edge_node, m->edge_ptr[i], m->edge_ptr[i + 1], node);
    return k < m->edge_ptr[i + 1] && m->edge_node[k] == node;
}

/* Edges join two nodes that are apart, and both know it. */
static sf_status check_edges(const sf_model *m, sf_error *err) {
    for (int64_t i = 0; i < m->node_count; i++)
        for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++) {
            int64_t j = m->edge_node[k];
            if (!(sf_distance3(&m->position[3 * j], &m->position[3 * i]) > 0))
                return SF_FAIL(err, SF_ERR_MODEL, "edge from node %lld to node %lld has no length",
                               (long long)i, (long long)j);
            if (!has_edge(m, j, i))
                return SF_FAIL(err, SF_ERR_MODEL, "node %lld has an edge to node %lld, which has none back",
                               (long long)i, (long long)j);
        }
    return SF_OK;
}

static sf_status check_constraints(const sf_model *m, sf_error *err) {
    for (int64_t k = 0; k < m->fixed_count; k++)
        if (m->fixed_mask[k] < 1 || m->fixed_mask[k] > (SF_FIX_X | SF_FIX_Y | SF_FIX_Z) ||
            m->fixed_base[k] > 1)
            return SF_FAIL(err, SF_ERR_MODEL,
                           "constrained node %d has mask %d (1 to 7 are possible) and base %d (0 or 1)",
                           m->fixed_node[k], m->fixed_mask[k], m->fixed_base[k]);
    return SF_OK;
}

/* A tie joins two nodes at one place, the first of an earlier layer. */
static sf_status check_ties(const sf_model *m, sf_error *err) {
    for (int64_t k = 0; k < m->tie_count; k++) {
        int64_t a = m->tie_node[k], b = m->tie_other[k];
        if (a < 0 || b <= a || b >= m->node_count || (k > 0 && a < m->tie_node[k - 1]) ||
            m->tie_mask[k] < 1 || m->tie_mask[k] > (SF_FIX_X | SF_FIX_Y | SF_FIX_Z))
            return SF_FAIL(err, SF_ERR_MODEL, "tie %lld joins the nodes %lld and %lld of %lld with mask %d",
                           (long long)k, (long long)a, (long long)b, (long long)m->node_count,
                           m->tie_mask[k]);
        if (memcmp(&m->position[3 * a], &m->position[3 * b], 3 * sizeof *m->position) != 0)
            return SF_FAIL(err, SF_ERR_MODEL, "tie %lld joins the nodes %lld and %lld, which are apart",
                           (long long)k, (long long)a, (long long)b);
    }
    return SF_OK;
}

static sf_status check_frame_times(const sf_model *m, sf_error *err) {
    for (int64_t k = 0; k < m->frame_time_count; k++)
        if (m->frame_time[k] < 0 || (k > 0 && m->frame_time[k] < m->frame_time[k - 1]))
            return SF_FAIL(err, SF_ERR_MODEL, "frame time %g s is negative or out of order",
                           m->frame_time[k]);
    return SF_OK;
}

sf_status sf_model_check(const sf_model *m, sf_error *err) {
    if (m->node_count < 1 || m->node_count > INT32_MAX)
        return SF_FAIL(err, SF_ERR_MODEL, "the model has %lld nodes", (long long)m->node_count);
    if (m->contact_count < 1 || m->surface_triangle_count < 1)
        return SF_FAIL(err, SF_ERR_MODEL, "the model has no contact points or no missile surface");
    if (check_finite(m, err) != SF_OK || check_cards(m, err) != SF_OK ||
        check_triangles("pad's skin", m, m->skin_count, m->skin_triangle, err) != SF_OK ||
        check_bytes("half of the skin's triangle", m->skin_count, m->skin_half, 2, err) != SF_OK ||
        check_triangles("membrane", m, m->membrane_count, m->membrane_triangle, err) != SF_OK ||
        check_supports(m, err) != SF_OK || check_pairs(m, err) != SF_OK)
        return err->status;
    if (check_nodes(m, err) != SF_OK || check_frame_times(m, err) != SF_OK)
        return err->status;
    if (check_csr((csr){"smoothing domains", m->node_count, m->domain_nnz, m->domain_ptr, m->domain_node},
                  m->node_count, true, err) != SF_OK ||
        check_csr((csr){"shape functions", m->node_count, m->phi_nnz, m->phi_ptr, m->phi_node}, m->node_count,
                  true, err) != SF_OK ||
        check_csr((csr){"edges", m->node_count, m->edge_nnz, m->edge_ptr, m->edge_node}, m->node_count, true,
                  err) != SF_OK ||
        check_edges(m, err) != SF_OK ||
        check_set("constrained nodes", m->fixed_count, m->fixed_node, m->node_count, err) != SF_OK ||
        check_set("contact nodes", m->contact_count, m->contact_node, m->node_count, err) != SF_OK ||
        check_faces(m, err) != SF_OK ||
        check_set("resting nodes", m->rest_count, m->rest_node, m->node_count, err) != SF_OK ||
        check_loads(m, err) != SF_OK || check_areas(m, err) != SF_OK || check_constraints(m, err) != SF_OK ||
        check_ties(m, err) != SF_OK)
        return err->status;
    return check_mesh(m, err);
}

static uint64_t hash_of(const sf_model *model) {
    size_t count;
    const sf_model_field *field = sf_model_fields(&count);
    const char *base = (const char *)model;
    uint64_t hash = SF_HASH_START;
    for (size_t k = 0; k < count; k++) {
        const char *member = base + field[k].offset;
        static const char zero[8];
        if (field[k].later && memcmp(member, zero, sf_h5_size(field[k].type)) == 0)
            continue;
        if (field[k].later) /* one of those that are left out must not pass for another */
            hash = sf_hash_identity(hash, &k, sizeof k);
        if (field[k].rows_offset == SIZE_MAX) {
            hash = sf_hash_identity(hash, member, sf_h5_size(field[k].type));
            continue;
        }
        const void *data = *(void *const *)member;
        int64_t rows = *(const int64_t *)(base + field[k].rows_offset) + field[k].rows_extra;
        if (data)
            hash = sf_hash_identity(hash, data,
                                    (size_t)rows * (size_t)field[k].columns * sf_h5_size(field[k].type));
    }
    for (int64_t k = 0; k < model->material_count; k++)
        hash = sf_material_hash(hash, &model->material[k]);
    return hash;
}

void sf_model_foam_hash(const sf_model *model, char text[SF_MODEL_HASH_SIZE]) {
    uint64_t hash = SF_HASH_START;
    for (int64_t k = 0; k < model->material_count; k++)
        hash = sf_material_hash(hash, &model->material[k]);
    snprintf(text, SF_MODEL_HASH_SIZE, "%016llx", (unsigned long long)hash);
}

void sf_model_hash(const sf_model *model, char text[SF_MODEL_HASH_SIZE]) {
    snprintf(text, SF_MODEL_HASH_SIZE, "%016llx", (unsigned long long)hash_of(model));
}
