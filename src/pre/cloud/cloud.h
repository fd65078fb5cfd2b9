/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "case/case.h"
#include "pre/cloud/dual.h"

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

/* Checks that the pad is one body, or several with `separate`: its parts share cell faces, and no cells lie
 * in each other. */

/* SF_ERR_INPUT, with the place, if a node or a face of the pad's surface lies inside a cell, if the cells are
 * not all connected through faces (unless `separate`), or if those around a node are not. The cost is linear
 * in the number of cells. */
sf_status sf_connectivity_check(const sf_mesh *mesh, const sf_dual *dual, bool separate, sf_error *err);

/* Checks that the surface groups that a case names lie on the surface of the pad; where cells are missing
 * they do not. */

/* SF_ERR_INPUT, with the place, if a face of the groups for contact, base or symmetry has no cell of the pad
 * behind it, if one of contact or symmetry lies inside the pad, or if a face in the plane of a symmetry group
 * is not in that group. Groups that do not exist, and sets without faces, are left to others. */
sf_status sf_group_check(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, sf_error *err);

/* Smoothing domains: volumes, smoothed gradients B and shape functions at the nodes (Chen, Wu, Yoon, You
 * 2001; theory eq. 4-6).
 *
 * Internal facets carry the moving least squares phi at their triangles' centroids; each facet is evaluated
 * once and added with + and - to its two domains. On the boundary phi is interpolated between the face's
 * vertices, so that boundary tractions are exactly nodal forces of u_h: this makes the patch test with
 * constrained u_h exact (docs/adr/0002). */

/* Figures of the supports, and of the nodes that do not see each other. */
typedef struct sf_domain_figures {
    double worst_condition;     /* of the moment matrices used */
    double worst_position[3];   /* m, where */
    int64_t enlarged_count;     /* nodes whose support was enlarged */
    double largest_enlargement; /* factor on R, 1 = none */
    int64_t hidden_count;       /* nodes from which near ones are hidden by a slit or a gap */
    double hidden_distance;     /* m, the smallest one between such two nodes */
    double hidden_position[3];  /* m, between them */
} sf_domain_figures;

typedef struct sf_domains {
    double *volume;    /* [n] m3 */
    int64_t *ptr;      /* [n + 1] rows of B */
    int32_t *node;     /* [ptr[n]] ascending within a row */
    double *b;         /* [ptr[n]][3] m-1 */
    int64_t *phi_ptr;  /* [n + 1] rows of phi at the nodes */
    int32_t *phi_node; /* [phi_ptr[n]] ascending within a row */
    double *phi_value; /* [phi_ptr[n]] */
    sf_domain_figures figures;
} sf_domains;

/* Builds everything. `support` [n] holds R on entry; where a moment matrix is singular or worse conditioned
 * than `condition_limit`, the supports of the nodes around it grow by 15 % until it is not (at most 12 times,
 * then SF_ERR_MODEL with the position), and `support` returns what was used. */
sf_status sf_domains_build(const sf_mesh *mesh, const sf_dual *dual, double condition_limit, double *support,
                           sf_domains *out, sf_error *err);
/* Only the hidden nodes of a mesh, with the supports [n] given: hidden_* of `*out`, which owns nothing. */
sf_status sf_domains_find_gaps(const sf_mesh *mesh, const sf_dual *dual, const double *support,
                               sf_domains *out, sf_error *err);
void sf_domains_free(sf_domains *domains);

/* Adds the integral of phi_I N over the boundary to `sum` [n][3], m2 (theory eq. 6). */
void sf_domains_boundary_integral(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *domains,
                                  double *sum);

/* The identities that a discretisation must satisfy to rounding (theory, section "Invariants"). */

typedef struct sf_invariants {
    double unity;     /* largest |sum_J B_J| h over the domains */
    double linear;    /* largest entry of |sum_J X_J B_J^T - I| over the domains */
    double volume;    /* |sum V / mesh volume - 1| */
    double telescope; /* largest |sum_L V_L B_I^L - boundary integral of phi_I N| / h^2 over the nodes */
    double shape;     /* largest |sum phi - 1| and |sum phi X - X| / h at the nodes */
} sf_invariants;

/* Measures them. `volume` is the mesh volume (m3), `spacing` [n] the nodal spacing. */
sf_status sf_invariants_measure(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *domains,
                                const double *spacing, double volume, sf_invariants *out, sf_error *err);

/* SF_ERR_MODEL if one of them exceeds 1e-10. */
sf_status sf_invariants_check(const sf_invariants *invariants, sf_error *err);

/* The smoothing domains of a mesh, kept in a store (io/folder.h) for the drops of a campaign. */

/* sf_domains_build, unless the store (NULL: none) has its results of the same mesh, supports and limit, by
 * this very program. The same bits. */
sf_status sf_domain_store_build(const char *folder, const sf_mesh *mesh, const sf_dual *dual,
                                double condition_limit, double *support, sf_domains *out, sf_error *err);
