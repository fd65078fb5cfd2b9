/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "solver/point_rows.h"

/* The weight of a resting pad (theory, section "Anvil"; docs/adr/0019). At t = 0 the pad has settled: the
 * anvil's loads q0 (sf_model.rest_load) carry its weight. The reference configuration is that state, so that
 * weight and the stress that it causes act on the coefficients with the sum -Phi^T q0, a constant. */
typedef struct sf_weight {
    int64_t count;     /* nodes that it acts on; 0: the pad is held */
    int32_t *node;     /* [count] ascending */
    double (*pull)[3]; /* [count] N, constant */
} sf_weight;

sf_status sf_weight_build(const sf_model *model, const sf_point_rows *rows, sf_weight *weight, sf_error *err);
void sf_weight_free(sf_weight *weight);

/* Adds the pull to force [node_count][3], N. */
void sf_weight_pull(const sf_weight *weight, double *force);

/* Returns the work (J) of the pull on the coefficients d [node_count][3], m, since t = 0. */
double sf_weight_work(const sf_weight *weight, const double *d);
