/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "model/model.h"

/* The rows Phi_c over the nodes, by which coefficients move the contact points and forces there act on the
 * coefficients, for the points of sf_model_points. The row of a point of one cloud is phi of its node.
 * Copies of a node in several layers, tied in every component, are one point: each layer has the share m_i
 * / sum m of it, m_i = 1 / (phi_i M^-1 phi_i^T) being its inertia there. So a force accelerates all copies
 * alike, and leaves nothing to the tie at this point; the mobility is 1 / sum m. */

typedef struct sf_contact_rows {
    int64_t *ptr;  /* [points + 1] */
    int32_t *node; /* [..] coefficient, ascending within the part of each layer */
    double *value; /* [..] - */
} sf_contact_rows;

sf_status sf_contact_rows_build(const sf_model *model, sf_contact_rows *rows, sf_error *err);
/* The rows of any `count` nodes. */
sf_status sf_contact_rows_of_nodes(const sf_model *model, int64_t count, const int32_t *node,
                                   sf_contact_rows *rows, sf_error *err);
void sf_contact_rows_free(sf_contact_rows *rows);

/* The accelerations of surface points by a contact force at another: A = Phi M^-1 Phi^T over the contact
 * points, those of the missile and those of the anvil (sf_model_points), a sparse symmetric matrix; the
 * same for the three components because the mass is lumped. */

typedef struct sf_contact_gram {
    int64_t *ptr;     /* [contacts + 1] */
    int32_t *index;   /* [..] contact point, ascending within a row */
    double *value;    /* [..] kg-1 */
    double *diagonal; /* [contacts] kg-1 */
    double spread;    /* -, largest sum |Phi| of a contact point: no point is faster than this times the
                         fastest coefficient */
    double spacing;   /* m, smallest of the missile's contact points */
} sf_contact_gram;

sf_status sf_contact_gram_build(const sf_model *model, const sf_contact_rows *rows, sf_contact_gram *gram,
                                sf_error *err);
void sf_contact_gram_free(sf_contact_gram *gram);
