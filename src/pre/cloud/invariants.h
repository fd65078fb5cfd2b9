/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The identities that a discretisation must satisfy to rounding (theory, section "Invariants"). */
#ifndef SF_PRE_CLOUD_INVARIANTS_H
#define SF_PRE_CLOUD_INVARIANTS_H

#include "base/error.h"
#include "pre/cloud/domains.h"

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

#endif
