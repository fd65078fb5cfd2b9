/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/operators.h"

#include "core/stability.h"
#include <stdlib.h>
#include <string.h>

static sf_status build_pairs(const sf_model *m, sf_operators *op, sf_error *err) {
    op->pair = sf_alloc(err, (unsigned long)m->edge_nnz, sizeof *op->pair, "stabilisation pairs");
    for (int64_t i = 0; i < m->node_count && op->pair; i++)
        for (int64_t k = m->edge_ptr[i]; k < m->edge_ptr[i + 1]; k++) {
            int64_t j = m->edge_node[k];
            double square = 0;
            for (int c = 0; c < 3; c++) {
                double x = m->position[3 * j + c] - m->position[3 * i + c];
                square += x * x;
            }
            double share = m->volume[i] / (double)(m->edge_ptr[i + 1] - m->edge_ptr[i]) +
                           m->volume[j] / (double)(m->edge_ptr[j + 1] - m->edge_ptr[j]);
            op->pair[k] = m->run.stabilisation * 0.5 * share / square;
        }
    return err->status;
}

sf_status sf_operators_build(const sf_model *m, sf_operators *op, sf_error *err) {
    memset(op, 0, sizeof *op);
    unsigned long n = (unsigned long)m->node_count;
    op->damp_length = sf_alloc(err, n, sizeof *op->damp_length, "DAMP lengths");
    op->stability = sf_alloc(err, n, sizeof *op->stability, "stability constants");
    if (err->status == SF_OK && sf_foam_build(&m->foam, &op->foam, err) == SF_OK &&
        sf_stability_constants(m, op->stability, err) == SF_OK && sf_halo_build(m, &op->halo, err) == SF_OK &&
        build_pairs(m, op, err) == SF_OK && sf_constraint_build(m, &op->constraint, err) == SF_OK &&
        sf_contact_gram_build(m, &op->gram, err) == SF_OK &&
        sf_missile_surface_build(m, &op->surface, err) == SF_OK)
        for (unsigned long i = 0; i < n; i++)
            op->damp_length[i] = m->foam.damp_length > 0 ? m->foam.damp_length : m->spacing[i];
    if (err->status != SF_OK)
        sf_operators_free(op);
    return err->status;
}

void sf_operators_free(sf_operators *op) {
    sf_foam_free(&op->foam);
    sf_halo_free(&op->halo);
    sf_constraint_free(&op->constraint);
    sf_contact_gram_free(&op->gram);
    sf_missile_surface_free(&op->surface);
    free(op->damp_length);
    free(op->stability);
    free(op->pair);
    memset(op, 0, sizeof *op);
}
