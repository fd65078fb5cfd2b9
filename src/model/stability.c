/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/stability.h"

#include "base/mat3.h"
#include <stdlib.h>

sf_status sf_stability_constants(const sf_model *model, double *c, sf_error *err) {
    double *share = sf_alloc(err, (unsigned long)model->node_count, sizeof *share, "stability constants");
    if (!share)
        return err->status;
    for (int64_t l = 0; l < model->node_count; l++)
        for (int64_t k = model->domain_ptr[l]; k < model->domain_ptr[l + 1]; k++) {
            const double *b = &model->domain_b[3 * k];
            share[model->domain_node[k]] += model->volume[l] * sqrt(sf_dot3(b, b));
        }
    for (int64_t l = 0; l < model->node_count; l++) {
        double sum[6] = {0};
        for (int64_t k = model->domain_ptr[l]; k < model->domain_ptr[l + 1]; k++) {
            const double *b = &model->domain_b[3 * k];
            int32_t node = model->domain_node[k];
            double length = sqrt(sf_dot3(b, b));
            if (!(length > 0))
                continue;
            double weight = share[node] / (model->volume[l] * length * model->mass[node]);
            const double outer[6] = {b[0] * b[0], b[1] * b[1], b[2] * b[2],
                                     b[0] * b[1], b[1] * b[2], b[0] * b[2]};
            for (int q = 0; q < 6; q++)
                sum[q] += weight * outer[q];
        }
        c[l] = model->volume[l] * sf_sym3_largest(sum);
    }
    free(share);
    return SF_OK;
}
