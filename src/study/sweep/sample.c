/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/plan.h"

#include <gsl/gsl_qrng.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

int64_t sf_sample_rows(sf_sampling method, int d, int64_t count) {
    return method == SF_SAMPLING_SALTELLI ? count * (d + 2) : count;
}

gsl_rng *sf_sample_random(uint64_t seed, sf_error *err) {
    gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
    if (rng)
        gsl_rng_set(rng, seed);
    else
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for random numbers");
    return rng;
}

static sf_status draw_shift(int d, uint64_t seed, double *shift, sf_error *err) {
    gsl_rng *rng = sf_sample_random(seed, err);
    for (int i = 0; rng && i < d; i++)
        shift[i] = gsl_rng_uniform_pos(rng);
    gsl_rng_free(rng);
    return err->status;
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
    gsl_rng *rng = sf_sample_random(seed, err);
    if (rng && method == SF_SAMPLING_LATIN)
        latin(rng, d, count, u, err);
    else if (rng)
        independent(rng, d, count, u);
    gsl_rng_free(rng);
    return err->status;
}

enum { RESAMPLES = 1000, FEWER_RESAMPLES = 200, LARGE = 200000 };

typedef struct sample {
    int d;
    int64_t n, used;
    const double *y;
    int64_t *place; /* [used] of the samples that are whole */
} sample;

static double at(const sample *s, int block, int64_t k) {
    return s->y[block * s->n + s->place[k]];
}

static void list_whole(sample *s) {
    for (int64_t k = 0; k < s->n; k++) {
        bool whole = true;
        for (int block = 0; block < s->d + 2; block++)
            whole &= isfinite(s->y[block * s->n + k]) != 0;
        if (whole)
            s->place[s->used++] = k;
    }
}

/* Both indices of every coordinate from the samples `pick` (NULL: all); `out` [2 d]. */
static void estimate(const sample *s, const int64_t *pick, double *out) {
    double sum = 0, squares = 0, n = (double)s->used;
    for (int64_t k = 0; k < s->used; k++)
        sum += at(s, 0, pick ? pick[k] : k) + at(s, 1, pick ? pick[k] : k);
    double mean = sum / (2 * n);
    for (int i = 0; i < 2 * s->d; i++)
        out[i] = 0;
    for (int64_t k = 0; k < s->used; k++) {
        int64_t p = pick ? pick[k] : k;
        double a = at(s, 0, p) - mean, b = at(s, 1, p) - mean;
        squares += a * a + b * b;
        for (int i = 0; i < s->d; i++) {
            double mixed = at(s, 2 + i, p) - mean;
            out[i] += b * (mixed - a);
            out[s->d + i] += 0.5 * (mixed - a) * (mixed - a);
        }
    }
    for (int i = 0; i < 2 * s->d; i++)
        out[i] = squares > 0 ? out[i] / (0.5 * squares) : NAN;
}

/* value [resamples][2 d] */
static sf_status resample(const sample *s, uint64_t seed, int resamples, double *value, sf_error *err) {
    gsl_rng *rng = sf_sample_random(seed, err);
    int64_t *pick = sf_alloc(err, (unsigned long)s->used, sizeof *pick, "bootstrap samples");
    for (int r = 0; r < resamples && err->status == SF_OK; r++) {
        for (int64_t k = 0; k < s->used; k++)
            pick[k] = (int64_t)gsl_rng_uniform_int(rng, (unsigned long)s->used);
        estimate(s, pick, value + r * 2 * s->d);
    }
    gsl_rng_free(rng);
    free(pick);
    return err->status;
}

/* The interval of column i of the resamples. */
static void interval(const double *value, int resamples, int columns, int i, double *scratch, double *low,
                     double *high) {
    for (int r = 0; r < resamples; r++)
        scratch[r] = value[r * columns + i];
    gsl_sort(scratch, 1, (size_t)resamples);
    *low = gsl_stats_quantile_from_sorted_data(scratch, 1, (size_t)resamples, 0.025);
    *high = gsl_stats_quantile_from_sorted_data(scratch, 1, (size_t)resamples, 0.975);
}

static sf_status evaluate(const sample *s, uint64_t seed, sf_index *index, sf_error *err) {
    int columns = 2 * s->d, resamples = s->used * s->d > LARGE ? FEWER_RESAMPLES : RESAMPLES;
    double *value = sf_alloc(err, (unsigned long)resamples, (unsigned long)columns * sizeof *value,
                             "the bootstrap"),
           *all = sf_alloc(err, (unsigned long)columns, sizeof *all, "indices"),
           *scratch = sf_alloc(err, (unsigned long)resamples, sizeof *scratch, "the bootstrap");
    if (err->status == SF_OK && resample(s, seed, resamples, value, err) == SF_OK) {
        estimate(s, NULL, all);
        for (int i = 0; i < s->d && isfinite(all[i]); i++) {
            index[i].first = all[i];
            index[i].total = all[s->d + i];
            interval(value, resamples, columns, i, scratch, &index[i].first_low, &index[i].first_high);
            interval(value, resamples, columns, s->d + i, scratch, &index[i].total_low, &index[i].total_high);
        }
    }
    free(value);
    free(all);
    free(scratch);
    return err->status;
}

sf_status sf_indices(int d, int64_t n, const double *y, uint64_t seed, sf_index *index, int64_t *used,
                     sf_error *err) {
    sample s = {.d = d, .n = n, .y = y, .place = sf_alloc(err, (unsigned long)n, sizeof(int64_t), "samples")};
    for (int i = 0; i < d; i++)
        index[i] = (sf_index){NAN, NAN, NAN, NAN, NAN, NAN};
    if (s.place) {
        list_whole(&s);
        if (s.used >= SF_INDEX_LEAST && (double)s.used >= SF_INDEX_SHARE * (double)n)
            evaluate(&s, seed, index, err);
    }
    *used = s.used;
    free(s.place);
    return err->status;
}
