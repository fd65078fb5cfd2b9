/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a contact force at one surface point accelerates the others: A = Phi M^-1 Phi^T over the contact
 * points, those of the missile and those of the anvil (sf_model_points), a sparse symmetric matrix; the same
 * for the three components because the mass is lumped. */
#ifndef SF_SOLVER_CONTACT_CONTACT_GRAM_H
#define SF_SOLVER_CONTACT_CONTACT_GRAM_H

#include "base/error.h"
#include "model/model.h"
#include "solver/contact/contact_rows.h"

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

#endif
