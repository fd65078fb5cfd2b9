/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SF_SOLVER_CONTACT_SKIN_H
#define SF_SOLVER_CONTACT_SKIN_H
#include "solver/contact/contact_rows.h"

/* The faces of the pad that may touch the pad itself or the anvil, as the solver needs them
 * (solver/contact/self_contact.h). */

/* Constants of the skin. Its nodes are numbered from 0, ascending in the model. */
typedef struct sf_skin {
    int64_t count; /* nodes; 0: nothing touches */
    int32_t *node; /* [count] of the model */
    int64_t facet_count;
    int32_t *facet;       /* [facet_count][3] nodes of the skin, turned outwards */
    int64_t *ring_ptr;    /* [count + 1] */
    int32_t *ring;        /* [..] facets at each node */
    uint8_t *held;        /* [count] SF_FIX_* bits */
    uint8_t *rests;       /* [count] 1: the anvil presses the node in the missile's solve (contact.h) */
    double *normal;       /* [count][3] outward at rest, unit */
    double *facet_normal; /* [facet_count][3] likewise */
    double anvil;         /* m, height of its plane; -infinity: there is none */
    double spread;        /* -, largest sum |Phi| of a node */
    double spacing;       /* m, smallest of the skin */
    sf_contact_rows rows;
} sf_skin;

sf_status sf_skin_build(const sf_model *model, sf_skin *skin, sf_error *err);
void sf_skin_free(sf_skin *skin);
#endif
