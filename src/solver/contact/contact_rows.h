/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How coefficients move the contact points, and forces there act on the coefficients: rows Phi_c over the
 * nodes, for the points of sf_model_points. That of a point of one cloud is phi of its node. Copies of a node
 * in several layers, tied in every component, are one point: each layer has the share m_i / sum m of it, m_i
 * = 1 / (phi_i M^-1 phi_i^T) being its inertia there. So a force accelerates all copies alike, and leaves
 * nothing to the tie at this point; the mobility is 1 / sum m. */
#ifndef SF_SOLVER_CONTACT_CONTACT_ROWS_H
#define SF_SOLVER_CONTACT_CONTACT_ROWS_H

#include "base/error.h"
#include "model/model.h"

typedef struct sf_contact_rows {
    int64_t *ptr;  /* [points + 1] */
    int32_t *node; /* [..] coefficient, ascending within the part of each layer */
    double *value; /* [..] - */
} sf_contact_rows;

sf_status sf_contact_rows_build(const sf_model *model, sf_contact_rows *rows, sf_error *err);
void sf_contact_rows_free(sf_contact_rows *rows);

#endif
