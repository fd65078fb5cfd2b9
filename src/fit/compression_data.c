/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/compression_data.h"

#include <math.h>
#include <stdlib.h>

static const double LAST_PART = 0.85; /* densification is fitted from this part of the shortest test on */

void sf_compression_branch(const sf_compression_data *data, int test, bool unloading, int *first,
                           int *count) {
    const sf_compression_test *t = data->config->test;
    *first = 0;
    for (int k = 0; k < test; k++)
        *first += t[k].count;
    *first += unloading ? t[test].loading : 0;
    *count = unloading ? t[test].count - t[test].loading : t[test].loading;
}

static void fill(sf_compression_data *data) {
    int at = 0;
    double shortest = 1;
    for (int k = 0; k < data->config->test_count; k++) {
        const sf_compression_test *t = &data->config->test[k];
        data->end = fmax(data->end, t->largest_strain);
        shortest = fmin(shortest, t->largest_strain);
        for (int i = 0; i < t->count; i++, at++) {
            data->test[at] = k;
            data->unloading[at] = i >= t->loading;
            data->strain[at] = fmax(0, t->strain[i]);
            data->stress[at] = t->stress[i];
        }
    }
    data->start =
        data->config->densification_start > 0 ? data->config->densification_start : LAST_PART * shortest;
}

static sf_status estimate_scatter(sf_compression_data *data, sf_error *err) {
    sf_scatter_branch branches[2 * SF_COMPRESSION_TESTS];
    int branch_count = 0;
    for (int k = 0; k < data->config->test_count; k++)
        for (int side = 0; side < 2; side++) {
            int first, count;
            sf_compression_branch(data, k, side == 1, &first, &count);
            if (count > 0)
                branches[branch_count++] =
                    (sf_scatter_branch){count, &data->strain[first], &data->stress[first],
                                        &data->smooth[first], &data->sigma[first]};
        }
    return sf_scatter_estimate(branch_count, branches, &data->scatter, err);
}

sf_status sf_compression_data_init(const sf_compression_config *config, sf_compression_data *data,
                                   sf_error *err) {
    *data = (sf_compression_data){.config = config};
    for (int k = 0; k < config->test_count; k++)
        data->count += config->test[k].count;
    unsigned long n = (unsigned long)data->count;
    data->test = sf_alloc(err, n, sizeof *data->test, "test points");
    data->unloading = sf_alloc(err, n, sizeof *data->unloading, "test points");
    data->strain = sf_alloc(err, n, sizeof *data->strain, "test points");
    data->stress = sf_alloc(err, n, sizeof *data->stress, "test points");
    data->smooth = sf_alloc(err, n, sizeof *data->smooth, "test points");
    data->sigma = sf_alloc(err, n, sizeof *data->sigma, "test points");
    if (err->status == SF_OK) {
        fill(data);
        estimate_scatter(data, err);
    }
    if (err->status != SF_OK)
        sf_compression_data_free(data);
    return err->status;
}

void sf_compression_data_free(sf_compression_data *data) {
    free(data->test);
    free(data->unloading);
    free(data->strain);
    free(data->stress);
    free(data->smooth);
    free(data->sigma);
    *data = (sf_compression_data){0};
}
