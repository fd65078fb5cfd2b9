/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "pre/cloud/domains.h"

/* The cloud of particles: the nodes of the background mesh, their order and their spacing. */

/* Renumbers the nodes of a mesh along a Morton curve, so that neighbours in space are neighbours in memory.
 * Positions, cells and sets follow; the order depends on the positions only. */
sf_status sf_cloud_reorder(sf_mesh *mesh, sf_error *err);

/* A node of a lattice has six edges; one of a tetrahedral mesh has some fourteen, of which the longest reach
 * past nearer nodes and would make the support needlessly large. */
enum { SF_SPACING_NEIGHBOURS = 8 };

/* Spacing h of each node: the mean length of its eight shortest mesh edges (of all, if there are fewer), m.
 * This is the lattice constant on a lattice, its faces, edges and corners included. `spacing` is
 * [node_count]. */
void sf_cloud_spacing(const sf_mesh *mesh, const sf_dual *dual, double *spacing);

/* FNV-1a (64 bit) of positions, cell types, vertices and layers, as 16 hex digits and NUL. */
void sf_cloud_hash(const sf_mesh *mesh, char text[17]);

/* Masses (kg) [mesh->node_count] of the nodes: rho V_I, but light nodes, which would set the time step of the
 * whole pad, and their neighbours spread theirs by their shape functions. Mass and centre of mass stay. */
sf_status sf_cloud_masses(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *domains, double density,
                          double *mass, sf_error *err);

/* The smoothing domains of a mesh, kept in a store (io/folder.h) for the drops of a campaign. */

/* sf_domains_build, unless the store (NULL: none) has its results of the same mesh, supports and limit, by
 * this very program. The same bits. */
sf_status sf_domain_store_build(const char *folder, const sf_mesh *mesh, const sf_dual *dual,
                                double condition_limit, double *support, sf_domains *out, sf_error *err);
