/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_data.h"

#include <math.h>
#include <stdlib.h>

static const double LAST_PART = 0.85; /* densification is fitted from this part of the shortest test on */
static const double FINER = 1.4; /* than cross-validation: the bend that a smoother curve cuts off stays below
                                    the scatter, of which alone the intervals tell */

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

/* The branches on the chosen sides, 0 loading, 1 unloading. */
static int list_branches(const sf_compression_data *data, int sides,
                         sf_scatter_branch branches[SF_SCATTER_BRANCHES]) {
    int branch_count = 0;
    for (int k = 0; k < data->config->test_count; k++)
        for (int side = 0; side < sides; side++) {
            int first, count;
            sf_compression_branch(data, k, side == 1, &first, &count);
            if (count > 0)
                branches[branch_count++] =
                    (sf_scatter_branch){count, &data->strain[first], &data->stress[first],
                                        &data->smooth[first], &data->sigma[first]};
        }
    return branch_count;
}

static sf_status estimate(sf_compression_data *data, sf_error *err) {
    sf_scatter_branch branches[SF_SCATTER_BRANCHES];
    int intervals, all = list_branches(data, 2, branches);
    if (sf_scatter_estimate(all, branches, &data->scatter, err) != SF_OK)
        return err->status;
    int loading = list_branches(data, 1, branches);
    if (sf_scatter_intervals(loading, branches, &intervals, err) != SF_OK)
        return err->status;
    data->intervals = (int)ceil(FINER * intervals * sf_spline_part(data->end, data->start));
    return SF_OK;
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
        estimate(data, err);
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
