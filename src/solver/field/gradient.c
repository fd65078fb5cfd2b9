/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/gradient.h"

#include <stdlib.h>

int64_t sf_gradient_longest(const sf_model *m) {
    int64_t most = 0;
    for (int64_t l = 0; l < m->node_count; l++)
        most =
            m->domain_ptr[l + 1] - m->domain_ptr[l] > most ? m->domain_ptr[l + 1] - m->domain_ptr[l] : most;
    return most;
}

void sf_gradient_order(const sf_model *m, int64_t l, int32_t *order) {
    int64_t first = m->domain_ptr[l];
    sf_packed_order(m->position, &m->domain_node[first], m->domain_ptr[l + 1] - first, (int32_t)l, order);
}

/* All rows into `bytes`, which may be domain_b itself if rows never overtake their own numbers. */
static sf_status pack_rows(const sf_model *m, uint8_t *bytes, sf_error *err) {
    unsigned long most = (unsigned long)sf_gradient_longest(m);
    int32_t *order = sf_alloc(err, most, sizeof *order, "gradient");
    double *row = sf_alloc(err, 3 * most, sizeof *row, "gradient");
    for (int64_t l = 0; l < m->node_count && err->status == SF_OK; l++) {
        int64_t first = m->domain_ptr[l], count = m->domain_ptr[l + 1] - first;
        memcpy(row, &m->domain_b[3 * first], 3 * (size_t)count * sizeof *row);
        sf_gradient_order(m, l, order);
        sf_pack_row(count, order, row, &bytes[sf_packed_start(l, first)]);
    }
    free(order);
    free(row);
    return err->status;
}

sf_status sf_gradient_build(const sf_model *m, uint8_t **gradient, sf_error *err) {
    *gradient =
        sf_alloc(err, (unsigned long)sf_packed_start(m->node_count, m->domain_nnz), 1, "smoothed gradient");
    return *gradient ? pack_rows(m, *gradient, err) : err->status;
}

static bool fits_in_place(const sf_model *m) {
    for (int64_t l = 0; l < m->node_count; l++)
        if (m->domain_ptr[l + 1] - m->domain_ptr[l] < SF_TAKERS)
            return false;
    return true;
}

sf_status sf_gradient_take(sf_model *m, uint8_t **gradient, sf_error *err) {
    if (!fits_in_place(m)) {
        sf_gradient_build(m, gradient, err);
        free(m->domain_b);
    } else if (pack_rows(m, (uint8_t *)m->domain_b, err) == SF_OK) {
        void *shrunk = realloc(m->domain_b, (size_t)sf_packed_start(m->node_count, m->domain_nnz));
        *gradient = shrunk ? shrunk : (uint8_t *)m->domain_b;
    } else
        return err->status;
    m->domain_b = NULL;
    return err->status;
}
