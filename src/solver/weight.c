/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/weight.h"

#include "base/mat3.h"

/* load [node_count] += Phi^T q0. */
static void add_loads(const sf_model *m, const sf_point_rows *rows, double *load) {
    for (int64_t c = 0; c < m->rest_count; c++)
        for (int64_t k = rows->ptr[m->contact_count + c]; k < rows->ptr[m->contact_count + c + 1]; k++)
            load[rows->node[k]] += rows->value[k] * m->rest_load[c];
}

sf_status sf_weight_build(const sf_model *m, const sf_point_rows *rows, sf_weight *weight, sf_error *err) {
    int64_t count = 0;
    memset(weight, 0, sizeof *weight);
    if (m->rest_count == 0)
        return SF_OK;
    SF_OWNED double *load = sf_alloc(err, m->node_count, sizeof *load, "weight of the pad");
    if (load)
        add_loads(m, rows, load);
    for (int64_t i = 0; load && i < m->node_count; i++)
        count += load[i] != 0;
    SF_ALLOC_ALL(err, "weight of the pad", SF_ROOM(weight->node, count), SF_ROOM(weight->pull, count));
    for (int64_t i = 0; err->status == SF_OK && i < m->node_count; i++)
        if (load[i] != 0) {
            weight->node[weight->count] = (int32_t)i;
            weight->pull[weight->count++][2] = -load[i];
        }
    if (err->status != SF_OK)
        sf_weight_free(weight);
    return err->status;
}

void sf_weight_free(sf_weight *weight) {
    SF_CLEAR(weight, weight->node, weight->pull);
}

void sf_weight_pull(const sf_weight *weight, double *force) {
    for (int64_t k = 0; k < weight->count; k++)
        for (int r = 0; r < 3; r++)
            force[3 * (int64_t)weight->node[k] + r] += weight->pull[k][r];
}

double sf_weight_work(const sf_weight *weight, const double *d) {
    double work = 0;
    for (int64_t k = 0; k < weight->count; k++)
        work += sf_dot3(weight->pull[k], &d[3 * (int64_t)weight->node[k]]);
    return work;
}
