/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/run/results_file.h"

#include "model/symmetry.h"
#include "solver/missile.h"
#include <math.h>
#include <stdio.h>

/* Where the symmetry plane normal to an axis lies; NaN: there is none. */
static double find_plane(const sf_model *m, int axis) {
    double place;
    return sf_symmetry_plane(m, axis, &place) ? place : NAN;
}

static sf_status write_arrays(const sf_model *m, sf_h5 *file, sf_error *err) {
    int64_t driven = sf_missile_is_driven(m), turns = sf_missile_turns(m);
    const double unknown = NAN, *impact = m->missile.impact_known ? m->missile.impact : NULL;
    const double informed = sf_model_informed_strain(m);
    const double gravity = sf_missile_free_fall(m), density = sf_model_density(m);
    const double plane[2] = {find_plane(m, 0), find_plane(m, 1)};
    const double radius = m->missile.shape == SF_SHAPE_SPHERE ? m->missile.sphere_radius : 0;
    const struct {
        sf_h5_info info;
        sf_h5_type type;
        int rank;
        int64_t dims[2];
        const void *data;
    } item[] = {
        /* clang-format off */
        {{"/model/position", "m", "reference position of the nodes"}, SF_H5_F64, 2, {m->node_count, 3}, m->position},
        {{"/model/volume", "m3", "volume of the smoothing domains"}, SF_H5_F64, 1, {m->node_count, 0}, m->volume},
        {{"/model/cell_type", "1", "XDMF topology code"}, SF_H5_U8, 1, {m->cell_count, 0}, m->cell_type},
        {{"/model/cell_ptr", "1", "start of each cell in cell_node"}, SF_H5_I64, 1, {m->cell_count + 1, 0}, m->cell_ptr},
        {{"/model/cell_node", "1", "vertices in VTK order"}, SF_H5_I32, 1, {m->cell_nnz, 0}, m->cell_node},
        {{"/model/surface_position", "m", "missile surface at t = 0"}, SF_H5_F64, 2, {m->surface_node_count, 3}, m->surface_position},
        {{"/model/surface_triangle", "1", "missile surface triangles"}, SF_H5_I32, 2, {m->surface_triangle_count, 3}, m->surface_triangle},
        {{"/model/symmetry_factor", "1", "modelled parts that make the whole"}, SF_H5_I64, 0, {0}, &m->symmetry_factor},
        {{"/model/symmetry_x", "m", "where the symmetry plane normal to x lies; NaN: there is none"}, SF_H5_F64, 0, {0}, &plane[0]},
        {{"/model/symmetry_y", "m", "the same of that normal to y"}, SF_H5_F64, 0, {0}, &plane[1]},
        {{"/model/thickness", "m", "pad thickness"}, SF_H5_F64, 0, {0}, &m->thickness},
        {{"/model/expected_mesh_error", "1", "expected relative error of a_max from the spacing, 0: not estimated"}, SF_H5_F64, 0, {0}, &m->expected_mesh_error},
        {{"/model/slit_fraction", "1", "part of the nodes that lie at a slit, hole or gap narrower than their supports"}, SF_H5_F64, 0, {0}, &m->slit_fraction},
        {{"/model/anvil_depth", "m", "of the anvil below the undeformed pad's top, 0: there is none"}, SF_H5_F64, 0, {0}, &m->anvil.depth},
        {{"/model/density", "kg m-3", "mean density of the undeformed pad"}, SF_H5_F64, 0, {0}, &density},
        {{"/model/informed_strain", "1", "least, over the materials, of the strain up to which data inform"}, SF_H5_F64, 0, {0}, &informed},
        {{"/model/missile_mass", "kg", "mass of the whole missile"}, SF_H5_F64, 0, {0}, &m->missile.mass},
        {{"/model/missile_speed", "m s-1", "speed at t = 0"}, SF_H5_F64, 0, {0}, &m->missile.speed},
        {{"/model/impact_x", "m", "where the missile's lowest point arrives at the pad's top, x; NaN: not known"}, SF_H5_F64, 0, {0}, impact ? &impact[0] : &unknown},
        {{"/model/impact_y", "m", "the same, y"}, SF_H5_F64, 0, {0}, impact ? &impact[1] : &unknown},
        {{"/model/missile_driven", "1", "1: the missile had a prescribed motion, 0: none"}, SF_H5_I64, 0, {0}, &driven},
        {{"/model/missile_free", "1", "1: the missile had six degrees of freedom, 0: it was guided or driven"}, SF_H5_I64, 0, {0}, &turns},
        {{"/model/missile_centre", "m", "centre of mass at t = 0; of a free missile"}, SF_H5_F64, 1, {3, 0}, m->missile.centre},
        {{"/model/sphere_radius", "m", "of the missile's exact sphere, 0: contact with its triangles"}, SF_H5_F64, 0, {0}, &radius},
        {{"/model/sphere_centre", "m", "of the missile's exact sphere at t = 0"}, SF_H5_F64, 1, {3, 0}, m->missile.sphere_centre},
        {{"/model/gravity_along", "m s-2", "acceleration of the missile in free flight, along its direction"}, SF_H5_F64, 0, {0}, &gravity},
        {{"/model/kinematic", "1", "figures of 0: the specific force; 1: the kinematic acceleration"}, SF_H5_I64, 0, {0}, &m->run.kinematic},
        {{"/model/missile_direction", "1", "direction of motion"}, SF_H5_F64, 1, {3, 0}, sf_missile_direction(m)},
        /* clang-format on */
    };
    for (size_t k = 0; k < sizeof item / sizeof item[0]; k++)
        if (sf_h5_write(file, &item[k].info, item[k].type, item[k].rank, item[k].dims, item[k].data, err) !=
            SF_OK)
            return err->status;
    return SF_OK;
}

/* The layers of a pad of several materials. */
static sf_status write_layers(const sf_model *m, sf_h5 *file, sf_error *err) {
    double density[SF_MATERIAL_MAX], informed[SF_MATERIAL_MAX];
    char names[SF_MATERIAL_MAX * SF_MATERIAL_NAME_SIZE];
    size_t used = 0;
    if (m->material_count < 2)
        return SF_OK;
    for (int64_t k = 0; k < m->material_count; k++) {
        const sf_material *material = &m->material[k];
        density[k] = sf_material_density(material);
        informed[k] = sf_material_informed(material);
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", k ? "\n" : "", material->name);
    }
    sf_h5_write(file, &(sf_h5_info){"/model/node_layer", "1", "number of the layer of each node, ascending"},
                SF_H5_U8, 1, &m->node_count, m->node_material, err);
    sf_h5_write(file, &(sf_h5_info){"/model/layer_density", "kg m-3", "density of each layer"}, SF_H5_F64, 1,
                &m->material_count, density, err);
    sf_h5_write(file,
                &(sf_h5_info){"/model/layer_informed_strain", "1",
                              "strain up to which data inform the material of each layer"},
                SF_H5_F64, 1, &m->material_count, informed, err);
    return sf_h5_write_text(
        file, &(sf_h5_info){"/model/layer_names", "1", "names of the layers, a line each"}, names, err);
}

sf_status sf_results_create(const char *path, const sf_model *m, const sf_h5 *model_file,
                            const sf_provenance *provenance, sf_h5 **file, sf_error *err) {
    if (sf_h5_create(path, file, err) != SF_OK)
        return err->status;
    if (sf_provenance_write(*file, "softfall-results", provenance, err) == SF_OK &&
        sf_provenance_copy(model_file, *file, err) == SF_OK && write_arrays(m, *file, err) == SF_OK &&
        write_layers(m, *file, err) == SF_OK)
        return SF_OK;
    sf_error ignored = SF_ERROR_INIT;
    sf_h5_close(file, &ignored);
    return err->status;
}
