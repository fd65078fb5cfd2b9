/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "model/model.h"

/* The rows Phi_c over the nodes, by which coefficients move the contact points and forces there act on the
 * coefficients. The row of a point of one cloud is phi of its node.
 * Copies of a node in several layers, tied in every component, are one point: each layer has the share m_i
 * / sum m of it, m_i = 1 / (phi_i M^-1 phi_i^T) being its inertia there. So a force accelerates all copies
 * alike, and leaves nothing to the tie at this point; the mobility is 1 / sum m. */

typedef struct sf_point_rows {
    int64_t *ptr;    /* [points + 1] */
    int32_t *node;   /* [..] coefficient, ascending within the part of each layer */
    double *value;   /* [..] - */
    double *by_mass; /* [..] kg-1, value over the mass of the coefficient */
    double
        spread; /* -, largest sum |Phi| of a point: none is faster than this times the fastest coefficient */
} sf_point_rows;

/* Makes the rows of `count` nodes. */
sf_status sf_point_rows_build(const sf_model *model, int64_t count, const int32_t *node, sf_point_rows *rows,
                              sf_error *err);
void sf_point_rows_free(sf_point_rows *rows);
