/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A resting pad on the anvil, a rigid plane z = constant below its underside (theory, section "Anvil";
 * docs/adr/0019). The contact itself is that of contact.h, with the anvil as a second partner.
 *
 * At t = 0 the pad has settled: the anvil's loads q0 (sf_model.rest_load) carry its weight. The reference
 * configuration is that state, so that weight and the stress that it causes act on the coefficients with the
 * sum -Phi^T q0, a constant. */
#ifndef SF_SOLVER_CONTACT_ANVIL_H
#define SF_SOLVER_CONTACT_ANVIL_H

#include "base/error.h"
#include "model/model.h"
#include "solver/contact/contact_rows.h"

typedef struct sf_anvil {
    int64_t count;     /* nodes that the weight acts on; 0: the pad is held */
    int32_t *node;     /* [count] ascending */
    double (*pull)[3]; /* [count] N, constant */
} sf_anvil;

sf_status sf_anvil_build(const sf_model *model, const sf_contact_rows *rows, sf_anvil *anvil, sf_error *err);
void sf_anvil_free(sf_anvil *anvil);

/* Adds the pull to force [node_count][3], N. */
void sf_anvil_pull(const sf_anvil *anvil, double *force);

/* Work (J) of the pull on the coefficients d [node_count][3], m, since t = 0. */
double sf_anvil_work(const sf_anvil *anvil, const double *d);

/* Height (m) above the anvil of a resting node at x. */
static inline double sf_anvil_gap(const sf_model *model, int64_t node, const double x[3]) {
    return x[2] - model->position[3 * node + 2];
}

#endif
