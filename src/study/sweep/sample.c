/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/sample.h"

#include <gsl/gsl_qrng.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <stdlib.h>
#include <string.h>

int64_t sf_sample_rows(sf_sampling method, int d, int64_t count) {
    return method == SF_SAMPLING_SALTELLI ? count * (d + 2) : count;
}

static sf_status draw_shift(int d, uint64_t seed, double *shift, sf_error *err) {
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    if (!rng)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for random numbers");
    gsl_rng_set(rng, seed);
    for (int i = 0; i < d; i++)
        shift[i] = gsl_rng_uniform_pos(rng);
    gsl_rng_free(rng);
    return SF_OK;
}

/* The sequence, or, with another seed than 1, moved as a whole (modulo 1; Cranley and Patterson 1976,
 * doi:10.1137/0713071): each coordinate is as evenly spread, at other points. */
static sf_status sobol(int d, int64_t count, uint64_t seed, double *u, sf_error *err) {
    double shift[SF_SOBOL_DIMENSIONS] = {0};
    if (d > SF_SOBOL_DIMENSIONS)
        return SF_FAIL(err, SF_ERR_INPUT, "the Sobol' sequence has at most %d coordinates, not %d",
                       SF_SOBOL_DIMENSIONS, d);
    gsl_qrng *q = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)d);
    if (!q)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the Sobol' sequence");
    if (seed != 1 && draw_shift(d, seed, shift, err) != SF_OK)
        goto done;
    for (int64_t k = 0; k < count; k++) {
        gsl_qrng_get(q, u + k * d);
        for (int i = 0; i < d; i++) {
            double x = u[k * d + i] + shift[i];
            u[k * d + i] = x > 1 ? x - 1 : x < 1 ? x : 0.5; /* 1 is no quantile */
        }
    }
done:
    gsl_qrng_free(q);
    return err->status;
}

/* One stratum of each coordinate for each point, shuffled; the place within it at random. */
static sf_status latin(gsl_rng *rng, int d, int64_t count, double *u, sf_error *err) {
    int64_t *stratum = sf_alloc(err, (unsigned long)count, sizeof *stratum, "strata");
    for (int i = 0; i < d && stratum; i++) {
        for (int64_t k = 0; k < count; k++)
            stratum[k] = k;
        gsl_ran_shuffle(rng, stratum, (size_t)count, sizeof *stratum);
        for (int64_t k = 0; k < count; k++)
            u[k * d + i] = ((double)stratum[k] + gsl_rng_uniform_pos(rng)) / (double)count;
    }
    free(stratum);
    return err->status;
}

static void independent(gsl_rng *rng, int d, int64_t count, double *u) {
    for (int64_t k = 0; k < count * d; k++)
        u[k] = gsl_rng_uniform_pos(rng);
}

static sf_status saltelli(int d, int64_t count, uint64_t seed, double *u, sf_error *err) {
    double *both = sf_alloc(err, (unsigned long)count, 2 * (unsigned long)d * sizeof *both, "samples");
    if (both && sobol(2 * d, count, seed, both, err) == SF_OK)
        for (int64_t k = 0; k < count; k++)
            for (int block = 0; block < d + 2; block++) {
                double *row = u + (block * count + k) * d;
                memcpy(row, both + 2 * k * d + (block == 1 ? d : 0), (size_t)d * sizeof *row);
                if (block >= 2)
                    row[block - 2] = both[2 * k * d + d + block - 2];
            }
    free(both);
    return err->status;
}

sf_status sf_sample(sf_sampling method, int d, int64_t count, uint64_t seed, double *u, sf_error *err) {
    if (method == SF_SAMPLING_SOBOL)
        return sobol(d, count, seed, u, err);
    if (method == SF_SAMPLING_SALTELLI)
        return saltelli(d, count, seed, u, err);
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    if (!rng)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for random numbers");
    gsl_rng_set(rng, seed);
    if (method == SF_SAMPLING_LATIN)
        latin(rng, d, count, u, err);
    else
        independent(rng, d, count, u);
    gsl_rng_free(rng);
    return err->status;
}
