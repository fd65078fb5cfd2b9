/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/contact/anvil.h"

#include "base/mat3.h"
#include <stdlib.h>
#include <string.h>

/* load [node_count] += Phi^T q0. */
static void add_loads(const sf_model *m, const sf_contact_rows *rows, double *load) {
    for (int64_t c = 0; c < m->rest_count; c++)
        for (int64_t k = rows->ptr[m->contact_count + c]; k < rows->ptr[m->contact_count + c + 1]; k++)
            load[rows->node[k]] += rows->value[k] * m->rest_load[c];
}

sf_status sf_anvil_build(const sf_model *m, const sf_contact_rows *rows, sf_anvil *anvil, sf_error *err) {
    int64_t count = 0;
    memset(anvil, 0, sizeof *anvil);
    if (m->rest_count == 0)
        return SF_OK;
    double *load = sf_alloc(err, (unsigned long)m->node_count, sizeof *load, "weight of the pad");
    if (load)
        add_loads(m, rows, load);
    for (int64_t i = 0; load && i < m->node_count; i++)
        count += load[i] != 0;
    anvil->node = sf_alloc(err, (unsigned long)count, sizeof *anvil->node, "weight of the pad");
    anvil->pull = sf_alloc(err, (unsigned long)count, sizeof *anvil->pull, "weight of the pad");
    for (int64_t i = 0; err->status == SF_OK && i < m->node_count; i++)
        if (load[i] != 0) {
            anvil->node[anvil->count] = (int32_t)i;
            anvil->pull[anvil->count++][2] = -load[i];
        }
    free(load);
    if (err->status != SF_OK)
        sf_anvil_free(anvil);
    return err->status;
}

void sf_anvil_free(sf_anvil *anvil) {
    free(anvil->node);
    free(anvil->pull);
    memset(anvil, 0, sizeof *anvil);
}

void sf_anvil_pull(const sf_anvil *anvil, double *force) {
    for (int64_t k = 0; k < anvil->count; k++)
        for (int r = 0; r < 3; r++)
            force[3 * (int64_t)anvil->node[k] + r] += anvil->pull[k][r];
}

double sf_anvil_work(const sf_anvil *anvil, const double *d) {
    double work = 0;
    for (int64_t k = 0; k < anvil->count; k++)
        work += sf_dot3(anvil->pull[k], &d[3 * (int64_t)anvil->node[k]]);
    return work;
}
