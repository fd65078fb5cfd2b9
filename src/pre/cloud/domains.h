/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smoothing domains: volumes, smoothed gradients B and shape functions at the nodes (Chen, Wu, Yoon, You
 * 2001; theory eq. 4-6).
 *
 * Internal facets carry the moving least squares phi at their triangles' centroids; each facet is evaluated
 * once and added with + and - to its two domains. On the boundary phi is interpolated between the face's
 * vertices, so that boundary tractions are exactly nodal forces of u_h: this makes the patch test with
 * constrained u_h exact (docs/adr/0002).
 *
 * Of a section a domain is a ring: V = 2 pi sum R dA, b_theta = 2 pi sum phi dA / V by the same points, b_R =
 * (sum phi 2 pi R N_R dl) / V - b_theta, b_Z = (sum phi 2 pi R N_Z dl) / V (theory, section "Axisymmetric
 * drops"). b_R + b_theta telescopes. */
#pragma once
#include "pre/cloud/dual.h"

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
    double *b;         /* [ptr[n]][3] m-1; of a section (b_R, b_theta, b_Z) */
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

/* Widens `out`, zeros at first, by them. `volume` is the mesh volume (m3), `spacing` [n] the nodal spacing.
 */
sf_status sf_invariants_measure(const sf_mesh *mesh, const sf_dual *dual, const sf_domains *domains,
                                const double *spacing, double volume, sf_invariants *out, sf_error *err);

/* SF_ERR_MODEL if one of them exceeds 1e-10. */
sf_status sf_invariants_check(const sf_invariants *invariants, sf_error *err);
