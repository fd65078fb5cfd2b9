/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometries through gmsh: a session reads what gmsh can open (.geo, .msh, .step with groups), sets its
 * parameters, meshes it if it holds no mesh, and hands out the pad's cells and the missile's surface. gmsh
 * itself runs in a confined process (mesher.h), one for each geometry. */
#pragma once
#include "pre/mesh/mesher.h"
#include "pre/mesh/mesh.h"

typedef struct sf_gmsh {
    sf_mesher_limits limits; /* for each geometry; zeros: those of mesher.h */
    const char *store;       /* folder from which meshes are taken if they are there, and where they are kept
                                (pre/mesh/mesh_store.h); borrowed; NULL: none */
    char version[64];        /* of the gmsh that meshed the last geometry: "4.8.4", "4.8.4 (unconfined)" */
    /* Every file that the geometries so far read; owned, NULL: no geometry. A line SF_GMSH_FILES_OF for each
     * geometry, then a line for each file: hash of its content (16 hexadecimal digits), blank, path as it was
     * asked for, from the folder of that geometry or absolute. The line SF_GMSH_UNKNOWN_FILES stands for
     * files that are not known, because gmsh was not confined. */
    char *files;
    sf_mesher_spare spare; /* for `limits`, where several geometries follow each other */
    sf_meshed open;        /* the last geometry */
    char file[512];        /* its path, for sentences */
} sf_gmsh;

sf_status sf_gmsh_begin(sf_gmsh **session, sf_error *err);
void sf_gmsh_end(sf_gmsh **session);

/* Opens a geometry with its parameters and meshes it. Errors: those of sf_mesher_run. Replaces the mesh that
 * was open. */
sf_status sf_gmsh_load(sf_gmsh *session, const sf_geo_source *source, sf_error *err);

/* The pad: cells of the volume group `pad_group`, and all surface groups on its boundary, scaled by `unit` (m
 * per unit). Errors name the groups that exist; an entity in two groups of the same dimension, an empty
 * group, a cell type other than linear tetrahedron, pyramid, prism, hexahedron are refused. */
sf_status sf_gmsh_read_mesh(sf_gmsh *session, const char *pad_group, double unit, sf_mesh *mesh,
                            sf_error *err);

/* The volumes of a pad, for sf_gmsh_read_layers. */
typedef struct sf_pad_volumes {
    int count;
    const char *const *group; /* [count] volume groups, one for each layer */
    bool layers;              /* no volume without one */
    bool alone;               /* the geometry holds nothing but the pad */
    bool section;             /* where there are no volumes the groups are of surfaces, and those on its
                                 boundary of curves */
} sf_pad_volumes;

/* The same of a pad of layers, with sf_mesh.cell_layer. Refuses a volume without a layer, or, of a pad of one
 * material, in another named group: one that shares faces with the pad, or any if the pad is alone. */
sf_status sf_gmsh_read_layers(sf_gmsh *session, const sf_pad_volumes *volumes, double unit, sf_mesh *mesh,
                              sf_error *err);

/* The triangles (quadrangles are split) of the surface group, turned outwards. */
sf_status sf_gmsh_read_surface(sf_gmsh *session, const char *surface_group, double unit, sf_surface *surface,
                               sf_error *err);

/* The profile of a missile of revolution, a curve group of a geometry without volumes, drawn in z = 0 with
 * the radius along x and the height along y: points in the half plane y = 0, without triangles. */
bool sf_gmsh_has_profile(const sf_gmsh *session, const char *curve_group);
sf_status sf_gmsh_read_profile(sf_gmsh *session, const char *curve_group, double unit, sf_surface *profile,
                               sf_error *err);

/* Adds to the surface that was read last the hull of the cells behind it. */
sf_status sf_gmsh_read_hull(sf_gmsh *session, const char *surface_group, double unit, sf_surface *surface,
                            sf_error *err);
