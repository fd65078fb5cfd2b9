/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/weights.h"

#include "study/fit/posterior/target.h"
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdlib.h>

enum { BOOTSTRAPS = 4000 };

void sf_evidence_weights(int models, const double *value, double *weight) {
    double largest = -INFINITY, sum = 0;
    for (int m = 0; m < models; m++)
        largest = isfinite(value[m]) ? fmax(largest, value[m]) : largest;
    for (int m = 0; m < models; m++)
        sum += weight[m] = isfinite(value[m]) ? exp(value[m] - largest) : 0;
    for (int m = 0; m < models && sum > 0; m++)
        weight[m] /= sum;
}

sf_status sf_predictive_weights(int models, int groups, const double *log_density, uint64_t seed,
                                double *weight, sf_error *err) {
    double *share = sf_alloc(err, (unsigned long)groups, sizeof *share, "weights"),
           *alpha = sf_alloc(err, (unsigned long)groups, sizeof *alpha, "weights"),
           *sum = sf_alloc(err, (unsigned long)models, sizeof *sum, "weights"),
           *part = sf_alloc(err, (unsigned long)models, sizeof *part, "weights");
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    if (!random)
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for a random generator");
    if (err->status == SF_OK) {
        gsl_rng_set(random, (unsigned long)sf_seed_of(seed, 77) & 0xffffffffu);
        for (int g = 0; g < groups; g++)
            alpha[g] = 1;
        for (int m = 0; m < models; m++)
            weight[m] = 0;
        for (int b = 0; b < BOOTSTRAPS; b++) {
            gsl_ran_dirichlet(random, (size_t)groups, alpha, share);
            for (int m = 0; m < models; m++) {
                sum[m] = 0;
                for (int g = 0; g < groups; g++)
                    sum[m] += groups * share[g] * log_density[m * groups + g];
            }
            sf_evidence_weights(models, sum, part);
            for (int m = 0; m < models; m++)
                weight[m] += part[m] / BOOTSTRAPS;
        }
    }
    if (random)
        gsl_rng_free(random);
    free(share);
    free(alpha);
    free(sum);
    free(part);
    return err->status;
}
