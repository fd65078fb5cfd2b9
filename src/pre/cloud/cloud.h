/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "case/case.h"
#include "pre/cloud/dual.h"
#include "base/sets.h"

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

/* Masses (kg) [mesh->node_count] of the nodes: rho V_I, but light nodes, which would set the time step of the
 * whole pad, and their neighbours spread theirs by their shape functions. Mass and centre of mass stay. */
sf_status sf_cloud_masses(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *domains, double density,
                          double *mass, sf_error *err);

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

/* Widens `out`, zeros at first, by them. `volume` is the mesh volume (m3), `spacing` [n] the nodal spacing.
 */
sf_status sf_invariants_measure(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *domains,
                                const double *spacing, double volume, sf_invariants *out, sf_error *err);

/* SF_ERR_MODEL if one of them exceeds 1e-10. */
sf_status sf_invariants_check(const sf_invariants *invariants, sf_error *err);

/* The smoothing domains of a mesh, kept in a store (io/folder.h) for the drops of a campaign. */

/* sf_domains_build, unless the store (NULL: none) has its results of the same mesh, supports and limit, by
 * this very program. The same bits. */
sf_status sf_domain_store_build(const char *folder, const sf_mesh *mesh, const sf_dual *dual,
                                double condition_limit, double *support, sf_domains *out, sf_error *err);

/* Which nodes do not see each other although they are near? The support of a node is a ball; across a slit or
 * a gap it would join what is apart. Two nodes see each other if mesh edges lead from one to the other
 * without leaving a ball that is little larger than their distance (docs/adr/0015). */

/* The nodes hidden from one node. */
typedef struct sf_hidden {
    int64_t count;
    int32_t *node; /* [count] ascending; NULL if there is none */
} sf_hidden;

/* For every node the hidden ones among those whose support meets the ball of radius reach[node] (m) about it.
 * In a convex body there is none. The same for any number of threads. Returns [mesh->node_count], owned by
 * the caller (sf_visibility_free), or NULL. */
sf_hidden *sf_visibility_build(const sf_mesh *mesh, const sf_dual *dual, const sf_grid *grid,
                               const double *reach, sf_error *err);
void sf_visibility_free(sf_hidden *hidden, int64_t node_count);

/* Removes the hidden nodes from the `count` ascending candidates; returns how many remain. */
int64_t sf_visibility_filter(const sf_hidden *hidden, int64_t count, int32_t *candidate);

/* Moving least squares shape functions: linear basis, cubic B-spline weight with one radius per node
 * (Belytschko, Lu, Gu 1994; theory eq. 1-3). The basis is shifted to the point of evaluation and scaled by
 * the local radius. */

enum { SF_MLS_MAX_NODES = 1024 };

/* The nodes that the approximation is built on; borrowed. */
typedef struct sf_mls_cloud {
    const double *position; /* [n][3] m */
    const double *support;  /* [n] m, R */
} sf_mls_cloud;

/* Shape functions at one point. */
typedef struct sf_mls_point {
    int count;                      /* nodes whose support covers the point */
    int32_t node[SF_MLS_MAX_NODES]; /* in the order of the candidates */
    double value[SF_MLS_MAX_NODES]; /* phi */
    double condition;               /* 1-norm condition number of the moment matrix; infinite if singular */
} sf_mls_point;

/* Evaluates phi at `x` from `count` candidate nodes (those out of reach are skipped). Returns 0, or -1 when
 * the moment matrix is singular or too many nodes reach the point: only `count` and `condition` are set then.
 */
int sf_mls_evaluate(const sf_mls_cloud *cloud, const double x[3], int64_t count, const int32_t *candidate,
                    sf_mls_point *out);

/* Cubic B-spline weight of q = distance / R: 2/3 at 0, zero from 1 on. */
double sf_mls_weight(double q);

/* A pad of layers: one conforming mesh, parted at the interfaces. Each layer gets nodes of its own, so that
 * no shape function reaches across, and ties join the nodes that stand at one place (docs/adr/0017). */

/* Two nodes of the parted mesh at one place, whose layers share a face there. */
typedef struct sf_layer_tie {
    int32_t node, other; /* ascending */
    uint8_t mask;        /* SF_FIX_* bits: components of u_h that are the same on both sides */
} sf_layer_tie;

/* Two layers that share faces, or that the case names. */
typedef struct sf_interface {
    int layer[2];    /* ascending */
    int kind;        /* SF_INTERFACE_* */
    double friction; /* -, of a loose one */
    int64_t faces;   /* of the mesh, that they share; 0: separate bodies */
} sf_interface;

enum { SF_INTERFACES_LISTED = 64 };
typedef struct sf_interfaces {
    int count; /* of all; the first SF_INTERFACES_LISTED are listed */
    sf_interface at[SF_INTERFACES_LISTED];
} sf_interfaces;

/* Nodes of the parted mesh stand layer by layer, in each in the order of the whole mesh. */
typedef struct sf_layers {
    int count;
    int64_t *first;    /* [count + 1] node where a layer begins; the last is their number */
    int32_t *origin;   /* [first[count]] the node of the whole mesh */
    int64_t *copy_ptr; /* [nodes of the whole mesh + 1] */
    int32_t *copy;     /* [first[count]] the nodes at a node of the whole mesh, ascending */
    int64_t tie_count; /* ascending by node and other; some may follow from others */
    sf_layer_tie *tie;
    int64_t *together; /* [first[count]] the same for nodes that are tied in all components */
    sf_interfaces interfaces;
} sf_layers;

/* `mesh`, whole, with its dual; the case's layers and interfaces. SF_ERR_INPUT with the place: an interface
 * that is not tied and not normal to an axis, or layers of the case's interfaces that do not touch. On
 * failure `*layers` is empty. */
sf_status sf_layers_build(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, sf_layers *layers,
                          sf_error *err);
void sf_layers_free(sf_layers *layers);

/* The node of a layer at a node of the whole mesh, which it has. */
int32_t sf_layers_copy(const sf_layers *layers, int32_t node, int layer);

/* The heaviest of the nodes at one place that are tied altogether: it stands for all of them as the contact
 * point (solver/contact/contact_rows.h). Needs the model's masses. */
int32_t sf_layers_heaviest(const sf_layers *layers, const sf_model *model, int32_t node);

/* The cells and nodes of a layer with numbers of their own; sets are left out. On failure `*part` is empty.
 */
sf_status sf_layers_part(const sf_mesh *mesh, const sf_layers *layers, int layer, sf_mesh *part,
                         sf_error *err);

/* Adds to area [first[count]], m2, the share of each node in the faces of a set. */
sf_status sf_layers_area(const sf_mesh *mesh, const sf_dual *dual, const sf_layers *layers,
                         const sf_node_set *set, double *area, sf_error *err);

/* Parts the whole mesh at its interfaces. A set keeps the nodes of those layers that have a face in it. */
sf_status sf_layers_split(sf_mesh *mesh, const sf_dual *dual, const sf_layers *layers, sf_error *err);

/* Carries what is held over the ties (`mask` and `base`, [first[count]], as of sf_model.fixed_mask and
 * fixed_base), and writes to the model the ties that follow neither from that nor from each other. */
sf_status sf_layers_hold(const sf_layers *layers, uint8_t *mask, uint8_t *base, sf_model *model,
                         sf_error *err);
/* Removes the ties of loose interfaces, after they have told what holds the layers: from there on the layers
 * only touch (the model's skin). */
void sf_layers_loosen(const sf_case *c, sf_model *model);
